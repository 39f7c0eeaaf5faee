"""Joints that a format with hinges, slides, balls and free roots cannot say as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import WORLD, Id, JointView, Mechanism, coupling_edge, joint_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import UNLIMITED, Body, Coupling, Dof, DofKind, Drive, Joint, Sense, Tendon
from hymeko_x.ir.values import IDENTITY, X, Y, Z
from hymeko_x.rewrite.names import usable_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.ir.values import Vec3
    from hymeko_x.rewrite.context import Context

VELOCITIES = {DofKind.HINGE: 1, DofKind.SLIDE: 1, DofKind.SCREW: 1, DofKind.BALL: 3, DofKind.FREE: 6}
_MOST_VELOCITIES = 6
_TURNS = (DofKind.HINGE, DofKind.BALL)
_LETTERS: Mapping[Vec3, str] = {X: "X", Y: "Y", Z: "Z"}

Place = tuple[Id, str]
"""A dof, from outside: its joint, and the role that names it there (empty where the joint has only one)."""


# ---- rules ---------------------------------------------------------------------------------------------------------------


def expand_screws(mechanism: Mechanism, context: Context) -> Mechanism:
    """A screw becomes a hinge and a slide along the same axis that is coupled to it by the pitch."""
    screws = [view for view in mechanism.joints.values() if any(dof.kind is DofKind.SCREW for dof in view.joint.dofs)]
    if not screws:
        return mechanism
    edges: dict[Id, RobotEdge] = {}
    moved: dict[Place, Place] = {}
    names = names_in_use(mechanism)
    for view in screws:
        dofs: list[Dof] = []
        for number, dof in enumerate(view.joint.dofs):
            name = dof.name or (view.id.name if len(view.joint.dofs) == 1 else f"{view.id.name}_{number}")
            _remember(moved, view, number, (view.id, name))
            if dof.kind is not DofKind.SCREW:
                dofs.append(replace(dof, name=name))
                continue
            slide = Dof(DofKind.SLIDE, dof.axis, anchor=dof.anchor, name=f"{name}_slide")
            dofs += [replace(dof, kind=DofKind.HINGE, pitch=0.0, name=name), slide]
            edges[names.take("coupling", usable_name(f"{name}_screw"))] = _screw(view.id, name, f"{name}_slide", dof)
            context.report.note(
                codes.REWRITTEN,
                f"{view.id} is a screw; it is written as hinge '{name}' and slide '{name}_slide', coupled by the pitch",
                mechanism.origin(view.id),
                element=str(view.id),
            )
        edges[view.id] = _with_dofs(mechanism, view.id, tuple(dofs))
    return _with_edges(mechanism, edges, moved)


def lower_inner_free_joints(mechanism: Mechanism, context: Context) -> Mechanism:
    """A free joint that is not the only one above a child of the world becomes three slides and a ball."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.joints.values():
        dofs = view.joint.dofs
        if not any(dof.kind is DofKind.FREE for dof in dofs) or (len(dofs) == 1 and view.parent == WORLD):
            continue
        new: list[Dof] = []
        for dof in dofs:
            new += _three_slides_and_ball(dof) if dof.kind is DofKind.FREE else [dof]
        edges[view.id] = _with_dofs(mechanism, view.id, tuple(new))
        context.report.note(
            codes.REWRITTEN,
            f"{view.id} floats below {view.parent}, where only a child of the world may; it is written as three slides and a ball",
            mechanism.origin(view.id),
            element=str(view.id),
        )
    return _with_edges(mechanism, edges, {})


def name_dofs(mechanism: Mechanism, context: Context) -> Mechanism:
    """Every dof gets a name of its own: the joint's where it is the only one, else that with what moves (``_TX``, ``_RZ``)."""
    edges: dict[Id, RobotEdge] = {}
    moved: dict[Place, Place] = {}
    alone = {_only_name(view) for view in mechanism.joints.values() if len(view.joint.dofs) == 1}
    seen: set[str] = set()
    for view in mechanism.joints.values():
        dofs = view.joint.dofs
        new = []
        for number, dof in enumerate(dofs):
            wanted = dof.name or f"{view.id.name}{_suffix(dof, dofs)}"
            name = _unused(wanted, seen) if len(dofs) == 1 else _unused(wanted, alone, seen)
            if wanted != name:
                _warn_of_name(mechanism, view.id, wanted, name, context.report)
            seen.add(name)
            if len(dofs) > 1 or wanted != name:
                dof = replace(dof, name=name)
                _remember(moved, view, number, (view.id, name))
            new.append(dof)
        if tuple(new) != dofs:
            edges[view.id] = _with_dofs(mechanism, view.id, tuple(new))
    return _with_edges(mechanism, edges, moved)


def name_dofs_once(mechanism: Mechanism, context: Context) -> Mechanism:
    """A name that two dofs have, as edits may leave it, stays with the first one. Dofs without a name stay without."""
    named = [(view, number, name) for view in mechanism.joints.values() for number, name in enumerate(_said_names(mechanism, view)) if name]
    taken = {name for _, _, name in named}
    if len(taken) == len(named):
        return mechanism
    changed: dict[Id, list[Dof]] = {}
    moved: dict[Place, Place] = {}
    seen: set[str] = set()
    for view, number, wanted in named:
        if wanted not in seen:
            seen.add(wanted)
            continue
        name = _unused(wanted, taken)
        _warn_of_name(mechanism, view.id, wanted, name, context.report)
        taken.add(name)
        changed.setdefault(view.id, list(view.joint.dofs))[number] = replace(view.joint.dofs[number], name=name)
        _remember(moved, view, number, (view.id, name))
    return _with_edges(mechanism, {key: _with_dofs(mechanism, key, tuple(dofs)) for key, dofs in changed.items()}, moved)


def _said_names(mechanism: Mechanism, view: JointView) -> list[str | None]:
    """What the dofs of a joint are called where nobody has to have a name."""
    if len(view.joint.dofs) == 1:
        only = view.joint.dofs[0].name
        return [only or (None if mechanism.notation(view.id, UNNAMED) else view.id.name)]
    return [dof.name for dof in view.joint.dofs]


def split_overfull_joints(mechanism: Mechanism, context: Context) -> Mechanism:
    """Dofs that cannot sit on one body (more than six, or a rotation below a ball) are spread over bodies in between."""
    overfull = [view for view in mechanism.joints.values() if len(_legal_groups(view.joint.dofs)) > 1]
    if not overfull:
        return mechanism
    vertices: dict[Id, Body] = {}
    edges: dict[Id, RobotEdge] = {}
    moved: dict[Place, Place] = {}
    names = names_in_use(mechanism)
    for view in overfull:
        groups = _legal_groups(view.joint.dofs)
        above, pose = view.parent, view.parent_pose
        for group in groups[:-1]:
            body = names.take("body", f"{view.child.name}_carrier")
            joint = names.take("joint", f"{view.id.name}_carrier")
            vertices[body] = Body()
            edges[joint] = joint_edge(Joint(group), above, body, pose)
            moved |= {(view.id, dof.name or ""): (joint, dof.name or "") for dof in group}
            above, pose = body, IDENTITY
        edges[view.id] = joint_edge(Joint(groups[-1]), above, view.child, pose, view.child_pose)
        context.report.note(
            codes.REWRITTEN,
            f"the dofs of {view.id} cannot all sit on one body; {len(groups) - 1} body in between carries the first ones",
            mechanism.origin(view.id),
            element=str(view.id),
        )
    return _with_edges(mechanism.with_graph(mechanism.graph.replace(vertices=vertices)), edges, moved)


# ---- parts of the rules ----------------------------------------------------------------------------------------------------


def _screw(joint: Id, hinge: str, slide: str, dof: Dof) -> RobotEdge:
    """The slide's coordinate: the pitch times the turn from the reference."""
    edge = coupling_edge(joint, ((joint, (-dof.pitch * dof.ref + 0.0, dof.pitch)),))
    follower, leader = edge.arcs
    return replace(edge, arcs=(replace(follower, role=slide), replace(leader, role=hinge)))


def _three_slides_and_ball(dof: Dof) -> list[Dof]:
    """Damping, friction and the like act on each of the six velocities, as they do in a free joint."""
    same = replace(dof, kind=DofKind.SLIDE, limits=UNLIMITED, ref=0.0, written=None)
    prefix = dof.name
    slides = [replace(same, axis=axis, name=f"{prefix}_T{_LETTERS[axis]}" if prefix else None) for axis in (X, Y, Z)]
    return [*slides, replace(same, kind=DofKind.BALL, axis=X, name=f"{prefix}_R" if prefix else None)]


def _suffix(dof: Dof, among: tuple[Dof, ...]) -> str:
    """``_TX`` for a slide along x, ``_RZ`` for a hinge about z, ``_R`` for a ball; numbered where the axis has no letter."""
    if len(among) == 1:
        return ""
    move = "T" if dof.kind is DofKind.SLIDE else "R"
    if dof.kind in (DofKind.BALL, DofKind.FREE):
        return f"_{move}"
    return f"_{move}{_LETTERS.get(dof.axis, among.index(dof) + 1)}"


def _only_name(view: JointView) -> str:
    """The name of the only dof of a joint: its own where it has one, else the joint's."""
    return view.joint.dofs[0].name or view.id.name


def _warn_of_name(mechanism: Mechanism, joint: Id, wanted: str, name: str, report: Report) -> None:
    said = f"'{wanted}' would name two dofs; the one of {joint} is written as '{name}'"
    report.warn(codes.RENAMED, said, mechanism.origin(joint), element=str(joint))


def _unused(name: str, *taken: set[str]) -> str:
    unique, number = name, 1
    while any(unique in names for names in taken):
        number += 1
        unique = f"{name}#{number}"
    return unique


def _legal_groups(dofs: tuple[Dof, ...]) -> list[tuple[Dof, ...]]:
    """The dofs in as few runs as possible that may each sit on one body."""
    if len(dofs) < 2:
        return [dofs] if dofs else []
    groups: list[tuple[Dof, ...]] = []
    run: tuple[Dof, ...] = ()
    for dof in dofs:
        too_many = sum(VELOCITIES[d.kind] for d in (*run, dof)) > _MOST_VELOCITIES
        below_ball = dof.kind in _TURNS and any(d.kind is DofKind.BALL for d in run)
        if run and (too_many or below_ball):
            groups.append(run)
            run = ()
        run = (*run, dof)
    return [*groups, run] if run else groups


def _with_dofs(mechanism: Mechanism, joint: Id, dofs: tuple[Dof, ...]) -> RobotEdge:
    return Edge(Joint(dofs), mechanism.graph.edges[joint].arcs)


def _remember(moved: dict[Place, Place], view: JointView, number: int, place: Place) -> None:
    """Every role under which arcs may have named this dof leads to its new place."""
    dof = view.joint.dofs[number]
    moved[view.id, str(number)] = place
    if len(view.joint.dofs) == 1:
        moved[view.id, ""] = place
    if dof.name:
        moved[view.id, dof.name] = place


def _with_edges(mechanism: Mechanism, edges: Mapping[Id, RobotEdge], moved: Mapping[Place, Place]) -> Mechanism:
    """The mechanism with these edges, and with the arcs to dofs that moved following them."""
    if not edges:
        return mechanism
    followed = dict(_following(mechanism.graph.edges.items(), moved)) if moved else {}
    return mechanism.with_graph(mechanism.graph.replace(edges={**followed, **edges}))


def _following(edges: Iterable[tuple[Id, RobotEdge]], moved: Mapping[Place, Place]) -> Iterable[tuple[Id, RobotEdge]]:
    for key, edge in edges:
        if isinstance(edge.data, Coupling | Drive | Sense | Tendon) and any((arc.target, arc.role) in moved for arc in edge.arcs):
            yield key, replace(edge, arcs=tuple(_moved_arc(arc, moved) for arc in edge.arcs))


def _moved_arc(arc: RobotArc, moved: Mapping[Place, Place]) -> RobotArc:
    target, role = moved.get((arc.target, arc.role), (arc.target, arc.role))
    return replace(arc, target=target, role=role)
