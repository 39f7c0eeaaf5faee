"""Composing robots: one attached to another, several in a scene, a subtree as a robot of its own."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, TypeVar

from msgspec.json import decode, encode
from msgspec.structs import replace

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, Mechanism, joint_edge, numbers_weight
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.notations import word
from hymeko_x.ir.parts import Body, Dof, DofKind, Joint, World
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse
from hymeko_x.joining import held, is_free, moved_state, on_body, shifted, with_names
from hymeko_x.rewrite.references import names_of
from hymeko_x.robot.data import RobotData
from hymeko_x.robot.draft import Draft, refitted
from hymeko_x.robot.editing import dofs_of, place
from hymeko_x.robot.errors import EditError, unknown_name
from hymeko_x.robot.joining import merged, provenance_of, with_files
from hymeko_x.robot.parting import ASSETS, below, part_of
from hymeko_x.states import with_ids, with_states

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from hymeko_x.ir.mechanism import Extra, RobotArc, RobotEdge
    from hymeko_x.ir.values import Vec3
    from hymeko_x.robot.element import Element
    from hymeko_x.states import Change

R = TypeVar("R", bound=RobotData)

ATTACHED = word("robot.attached")
"""The notation of an edge by which a part is attached: the part's name, and the pose that the edge had in the part's world."""


# ---- attaching -----------------------------------------------------------------------------------------------------------------


def attach(
    host: R,
    part: RobotData,
    at: str | Element = "world",
    *,
    prefix: str = "",
    joint: str | Joint | None = None,
    pose: Pose | Vec3 = IDENTITY,
) -> R:
    """The host with the part attached to a body or frame; the names of the part get the prefix.

    The world of the part is where ``pose`` is in the frame ``at``: what stands there fixed or free is fixed, or moves by ``joint`` (a
    type such as ``"hinge"``, or a Joint with its dofs); what is free stays free in the world. Options, units and
    other settings of the whole are those of the host.

    Raises: EditError when names clash or a joint is given for several roots; KeyError when there is no such body or frame.
    """
    check_robot(part)
    draft = Draft(host.mechanism, lambda: host.completed, is_locked=False)
    body, frame = place(draft, at, pose)
    base = replace(host.mechanism, graph=host.mechanism.graph.replace(vertices={WORLD: World()})) if body == WORLD else host.mechanism
    source = provenance_of(base, part.mechanism)
    is_native = source == host.mechanism.source and formats.native_format(base) is not None
    given = base if is_native else pipeline.fully_completed(base, host.files, Report())
    added = part.mechanism if is_native else part.completed
    added = pipeline.inlined(added, part.files) if prefix else added
    located, files = with_files(base, pipeline.flattened(added), host.files, part.files)
    standing = _standing(with_names(located, lambda word: prefix + word), body, frame, _dofs(joint), part.name)
    whole = refitted(merged(pipeline.flattened(given), standing, source), given)
    states = shifted(part.mechanism, frame) if body == WORLD and frame != IDENTITY else part.mechanism
    return host.changed(_with_states(whole, host.mechanism, states, lambda word: prefix + word), files)


def compose_scene(
    robots: Sequence[R], poses: Sequence[Pose | Vec3] | None = None, *, names: Sequence[str] | None = None, name: str = "scene"
) -> R:
    """Several robots in one world, each at its pose; before the names of each are its own name (or that of ``names``) and a slash.

    Raises: EditError when there is no robot, or when there are not as many poses or names as robots.
    """
    for what, given in (("poses", poses), ("names", names)):
        if given is not None and len(given) != len(robots):
            raise EditError(f"scene '{name}' has {len(robots)} robots and {len(given)} {what}")
    if not robots:
        raise EditError(f"scene '{name}' has no robots")
    for robot in robots:
        check_robot(robot)
    scene = robots[0].changed(Mechanism(name, Hypergraph({WORLD: World()}), source=robots[0].mechanism.source))
    used = names_in_use(Mechanism(name))
    for number, robot in enumerate(robots):
        prefix = used.take("robot", names[number] if names else robot.name or "robot").name
        scene = attach(scene, robot, prefix=f"{prefix}/", pose=IDENTITY if poses is None else poses[number])
    return scene


def check_robot(part: object) -> None:
    """Raises: EditError for what is no robot, such as a path, with what to give instead."""
    if not isinstance(part, RobotData):
        hint = f"; give hymeko_x.load({str(part)!r})" if isinstance(part, str | PathLike) else ""
        raise EditError(f"a part is a Robot, found {part!r}{hint}")


def _standing(part: Mechanism, body: Id, frame: Pose, dofs: Joint | None, name: str) -> Mechanism:
    """The part without its world: what was on it is on the body, and open roots get a joint."""
    edges: dict[Id, RobotEdge] = {}
    notations = dict(part.notations)
    roots = [key for key in part.roots if dofs is not None]
    if len(roots) > 1:
        raise EditError(f"robot '{name}' has {len(roots)} roots, and a joint is for one: {', '.join(key.name for key in roots[:5])}")
    for key, edge in part.graph.edges.items():
        if all(arc.target != WORLD for arc in edge.arcs):
            continue
        arcs = tuple([on_body(arc, body, frame) if arc.target == WORLD else arc for arc in edge.arcs])
        edges[key] = replace(edge, data=held(edge.data, body, dofs), arcs=arcs)
        notations[key] = {**notations.get(key, {}), ATTACHED.name: _remembered(name, edge)}
    names = names_in_use(part)
    for root in part.roots:
        if root not in part.parent_joint:
            key = names.take("joint", f"{root.name}_joint")
            edges[key] = joint_edge(dofs or Joint(), body, root, frame)
            notations[key] = {ATTACHED.name: _remembered(name, None)}
    graph = part.graph.replace(edges=edges, without=[WORLD])
    return replace(part, graph=graph, notations=notations)


def _dofs(joint: str | Joint | None) -> Joint | None:
    return Joint(dofs_of(Id("joint", joint), joint)) if isinstance(joint, str) else joint


def _remembered(name: str, edge: RobotEdge | None) -> str:
    """The name of the part, the kinds of dofs to its world, and the number and poses of the arcs to it."""
    if edge is None:
        return encode((name, (), ())).decode()
    kinds = [dof.kind.value for dof in edge.data.dofs] if isinstance(edge.data, Joint) else []
    return encode((name, kinds, [(number, _numbers(arc)) for number, arc in enumerate(edge.arcs) if arc.target == WORLD])).decode()


def _numbers(arc: RobotArc) -> tuple[float, ...] | None:
    return (*arc.weight.xyz, *arc.weight.quat) if isinstance(arc.weight, Pose) else numbers_weight(arc) or None


def _with_states(whole: Mechanism, host: Mechanism, part: Mechanism, change: Callable[[str], str]) -> Mechanism:
    row = formats.native_format(whole)
    if row is None or row.joins is None:
        return whole
    found: Mechanism = formats.loaded(row.joins)(whole, host, part, change)
    return found


# ---- taking apart --------------------------------------------------------------------------------------------------------------


def detach(robot: R, name: str) -> tuple[R, R]:
    """The robot without a part, and the part: what has this prefix, or else a body with all below it, which is then an open root.

    The slash at the end of a prefix may be left out. What was attached with a prefix gets back its names and its world. Relations
    between the two are in neither.

    Raises: KeyError when no body has this prefix, and none this name.
    """
    bodies = [key.name for key, _ in robot.mechanism.vertices(Body)]
    named = [body for body in bodies if body.startswith(name)]
    if not name or not named:
        raise unknown_name("body or prefix", name, bodies)
    whole = robot.inlined
    rest = Draft(whole, lambda: robot.completed, is_locked=False)
    if name in bodies:
        inside = part_of(whole, below(whole, Id("body", name)))
        rest.remove(key for key in inside if key.kind not in ASSETS)
        return robot.changed(rest.finished()), robot.changed(_only(robot, inside).finished(name))
    name += "/" if all(body.startswith(f"{name}/") for body in named) else ""
    inside = {key for table in (whole.graph.vertices, whole.graph.edges) for key in table if key.name.startswith(name)}
    own = tuple([extra for extra in whole.extras.get(ROOT, ()) if _is_about(extra, name)])
    home = _home(whole, inside, own)
    part = with_names(home, lambda word: word.removeprefix(name))
    part = with_states(
        part, whole, _without_prefix(whole, home, inside, name), lambda key: key.removeprefix(name) if key.startswith(name) else None
    )
    rest.remove(inside)
    left = rest.finished()
    others = tuple([extra for extra in left.extras.get(ROOT, ()) if extra not in own])
    left = replace(left, extras={**left.extras, ROOT: others}) if own else left
    return robot.changed(with_states(left, left, with_ids({}), lambda key: None if key.startswith(name) else key)), robot.changed(part)


def _without_prefix(whole: Mechanism, home: Mechanism, inside: set[Id], prefix: str) -> Change:
    """The change by which elements of a part lose its prefix and are in their own world again, and others are gone."""

    def change(word: str, key: Id | None, numbers: tuple[float, ...]) -> tuple[Id | None, tuple[float, ...]]:
        if key is None or key not in inside:
            return None, numbers
        if is_free(whole, key) and key in home.joints:
            frame = compose(home.joints[key].parent_pose, inverse(whole.joints[key].parent_pose))
            numbers = moved_state(word, numbers, frame)
        return Id(key.kind, key.name.removeprefix(prefix)), numbers

    return change


def subtree(robot: R, body: str) -> R:
    """A body with all below it as a robot of its own; the body is its open root. Raises: KeyError when there is no such body."""
    key = robot.bodies[body].id
    return robot.changed(_only(robot, part_of(robot.mechanism, below(robot.mechanism, key))).finished(body))


def split(robot: R) -> tuple[R, ...]:
    """A robot for each body that stands or floats in the world, with all below it. Relations between them are in none."""
    mechanism = robot.mechanism
    parts = []
    for root, _ in mechanism.vertices(Body):
        above = mechanism.parent_joint.get(root)
        if above is None or above.parent == WORLD:
            inside = part_of(mechanism, below(mechanism, root))
            parts.append(robot.changed(_only(robot, inside if above is None else {*inside, above.id, WORLD}).finished(root.name)))
    return tuple(parts)


def _only(robot: RobotData, inside: set[Id]) -> Draft:
    """The robot without everything else."""
    draft = Draft(robot.inlined, lambda: robot.completed, is_locked=False)
    draft.remove([key for table in (draft.vertices, draft.edges) for key in table if key not in inside])
    return draft


def _is_about(extra: Extra, prefix: str) -> bool:
    """Whether an extra of the whole names something, and only things with this prefix."""
    named = [name for _, name in names_of(extra)]
    return bool(named) and all(name.startswith(prefix) for name in named)


def _home(whole: Mechanism, inside: set[Id], own: tuple[Extra, ...]) -> Mechanism:
    """The elements inside, on their own world again, with their own name and their own extras of the whole."""
    name = whole.name
    edges: dict[Id, RobotEdge] = {}
    notations = {key: found for key, found in whole.notations.items() if key in inside}
    for key in inside & whole.graph.edges.keys():
        edge = whole.graph.edges[key]
        text = notations.get(key, {}).get(ATTACHED.name)
        if text is not None:
            notations[key] = {word: value for word, value in notations[key].items() if word != ATTACHED.name}
            name, kinds, arcs = decode(text, type=tuple[str, tuple[str, ...], tuple[tuple[int, tuple[float, ...] | None], ...]])
            if not arcs:
                continue
            edge = _on_world(edge, kinds, dict(arcs))
        if all(arc.target in inside or arc.target == WORLD for arc in edge.arcs):
            edges[key] = edge
    graph = whole.graph
    has_world = any(arc.target == WORLD for edge in edges.values() for arc in edge.arcs)
    vertices = {key: part for key, part in graph.vertices.items() if key in inside or (has_world and key == WORLD)}
    ordered = {key: edges[key] for key in graph.edges if key in edges}
    extras = {key: found for key, found in whole.extras.items() if key in vertices or key in ordered}
    extras |= {ROOT: own} if own else {}
    layout = tuple(key for key in whole.layout if key in vertices or key in ordered)
    return replace(whole, name=name, graph=Hypergraph(vertices, ordered), extras=extras, notations=notations, layout=layout)


def _on_world(edge: RobotEdge, kinds: Sequence[str], poses: Mapping[int, tuple[float, ...] | None]) -> RobotEdge:
    arcs = list(edge.arcs)
    for number, found in poses.items():
        weight = (
            found if found is None or len(found) != 7 else Pose((found[0], found[1], found[2]), (found[3], found[4], found[5], found[6]))
        )
        arcs[number] = replace(arcs[number], target=WORLD, weight=weight)
    data = edge.data
    if isinstance(data, Joint) and [dof.kind.value for dof in data.dofs] != [*kinds]:
        data = Joint(tuple(Dof(DofKind(kind)) for kind in kinds))
    return replace(edge, data=data, arcs=tuple(arcs))
