"""Realigning an edited image: its elements under the source's names, with the source's frames and joints, and renames followed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.compare.diff import Difference
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import WORLD, WORLD_LINK, Id, pose_weight
from hymeko_x.ir.names import rename, with_dof_names
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Body, Joint, Role, Shape, World
from hymeko_x.ir.values import IDENTITY, apply, compose, inverse, rotate_tensor
from hymeko_x.residue.chains import fold_chains
from hymeko_x.rewrite.references import with_references

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import Inertial, VertexPart
    from hymeko_x.ir.values import Pose
    from hymeko_x.residue import Alignment, Join


def realign(image: Mechanism, alignment: Alignment) -> Mechanism:
    """The same robot as the source describes it; what an editor has taken leaves stays as it is."""
    mechanism = _with_world(rename(image, _free_names(image, alignment)))
    mechanism = fold_chains(mechanism, alignment.folds)
    mechanism = join_twins(mechanism, alignment.joins)
    return move_frames(mechanism, dict(alignment.frames))


def _free_names(image: Mechanism, alignment: Alignment) -> dict[Id, Id]:
    """The source's name of each of the image's elements, where no other element has come to be called so; a world may be there."""
    names = {old: new for old, new in alignment.names if old != new and old in image.graph}
    given: dict[Id, Id] = {}
    for old, new in names.items():
        given.setdefault(new, old)
    names = {old: new for old, new in names.items() if given[new] == old or new == WORLD}
    while taken := [old for old, new in names.items() if new != WORLD and new not in names and new in image.graph]:
        for old in taken:
            del names[old]
    return names


def _with_world(mechanism: Mechanism) -> Mechanism:
    """A body that was renamed to the world is the world from now on, and a world that was renamed to a link is a link."""
    vertices = mechanism.graph.vertices
    other = {WORLD: World()} if isinstance(vertices.get(WORLD), Body) else {}
    link = {WORLD_LINK: Body()} if isinstance(vertices.get(WORLD_LINK), World) else {}
    return mechanism.replace(vertices={**other, **link})


def alignment_differences(alignment: Alignment) -> Iterator[Difference]:
    """What the image describes otherwise, as differences: names, chains, split shapes, frames and coordinates."""
    for old, new in alignment.names:
        if old.name != new.name:
            yield Difference(new, "name", repr(new.name), repr(old.name))
    for fold in alignment.folds:
        yield Difference(fold.joint, "chain", fold.joint.name, " ".join(key.name for key in fold.chain))
    for shape, twin in alignment.joins:
        yield Difference(shape, "role", "both", f"visual, and collision as '{twin.name}'")
    for body, pose in alignment.frames:
        yield Difference(body, "frame", "its own", f"{numbers_text(pose.xyz)}, {numbers_text(pose.quat)} from there")


# ---- split shapes -----------------------------------------------------------------------------------------------------------


def join_twins(mechanism: Mechanism, joins: Iterable[Join]) -> Mechanism:
    """Shapes that are seen and touched alike, as one with the friction of what is touched; also where only that is left."""
    edges: dict[Id, RobotEdge] = {}
    gone: list[Id] = []
    alone: dict[Id, Id] = {}
    for shape, twin in joins:
        seen, touched = mechanism.graph.edges.get(shape), mechanism.graph.edges.get(twin)
        if seen is None and touched is not None:
            alone[twin] = shape
        elif seen is not None and touched is not None and are_twins(seen, touched):
            edges[shape] = replace(seen, data=replace(_shape(seen), role=Role.BOTH, friction=_shape(touched).friction))
            gone.append(twin)
    return rename(mechanism.replace(edges=edges, without=gone), alone) if edges or alone else mechanism


def are_twins(seen: RobotEdge, touched: RobotEdge) -> bool:
    """Whether a visual and a collision shape are the same geometry in the same place."""
    a, b = seen.data, touched.data
    if not isinstance(a, Shape) or not isinstance(b, Shape) or (a.role, b.role) != (Role.VISUAL, Role.COLLISION):
        return False
    return a.geometry == b.geometry and _geometric(seen) == _geometric(touched)


def _geometric(edge: RobotEdge) -> list[RobotArc]:
    return [arc for arc in edge.arcs if arc.role != "material"]


def _shape(edge: RobotEdge) -> Shape:
    assert isinstance(edge.data, Shape)
    return edge.data


# ---- frames of bodies ------------------------------------------------------------------------------------------------------


def move_frames(mechanism: Mechanism, frames: Mapping[Id, Pose]) -> Mechanism:
    """The mechanism with other body frames: each pose is that of the new frame in the old one. Nothing moves."""
    if not frames:
        return mechanism
    back = {key: inverse(pose) for key, pose in frames.items() if key in mechanism.graph.vertices}
    vertices: dict[Id, VertexPart] = {}
    for key, turn in back.items():
        body = mechanism.graph.vertices[key]
        if isinstance(body, Body) and body.inertial is not None:
            vertices[key] = replace(body, inertial=_inertial_seen_from(body.inertial, turn))
    edges = {
        key: _edge_seen_from(edge, back) for key, edge in mechanism.graph.edges.items() if any(arc.target in back for arc in edge.arcs)
    }
    return mechanism.replace(vertices=vertices, edges=edges)


def _inertial_seen_from(inertial: Inertial, back: Pose) -> Inertial:
    tensor = None if inertial.tensor is None else rotate_tensor(back.quat, inertial.tensor)
    return replace(inertial, com=apply(back, inertial.com), tensor=tensor, written=None)


def _edge_seen_from(edge: RobotEdge, back: Mapping[Id, Pose]) -> RobotEdge:
    """An edge whose arcs' poses are given in the frames of the bodies that they point at."""
    arcs = tuple(
        replace(arc, weight=_placed(compose(back[arc.target], pose_weight(arc)))) if arc.target in back and _is_placed(arc) else arc
        for arc in edge.arcs
    )
    return replace(edge, arcs=arcs)


def _is_placed(arc: RobotArc) -> bool:
    """Whether the arc's weight is a pose (or nothing, which is the identity)."""
    return not isinstance(arc.weight, tuple)


def _placed(pose: Pose) -> Pose | None:
    return None if pose == IDENTITY else pose


# ---- other names --------------------------------------------------------------------------------------------------------


def with_old_names(image: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The image under the old names; what is called after its body (``foot/visual``, or the same) follows it."""
    bodies = {new.name: old.name for new, old in names.items() if new.kind == "body"}
    there = {*image.graph.vertices, *image.graph.edges}
    followed: dict[Id, Id] = {}
    for key in there if bodies else ():
        body, stroke, rest = key.name.partition("/")
        old = Id(key.kind, f"{bodies[body]}{stroke}{rest}") if body in bodies else key
        if old not in there:
            followed[key] = old
    return _renamed(image, {**followed, **names})


def with_new_names(mechanism: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The restored mechanism with the new names, those of the dofs of joints included; what had no name has one now."""
    if not names:
        return mechanism
    olds = set(names.values())
    notations = {
        key: {name: text for name, text in own.items() if name != UNNAMED.name} if key in olds else own
        for key, own in mechanism.notations.items()
    }
    mechanism = replace(mechanism, notations=notations)
    back = {old: new for new, old in names.items()}
    dofs = {old.name: new.name for old, new in back.items() if old.kind == "joint"}
    edges: dict[Id, RobotEdge] = {
        key: Edge(with_dof_names(joint, lambda name: dofs.get(name, name)), arcs) for key, joint, arcs in mechanism.edges(Joint)
    }
    return _renamed(mechanism.replace(edges=edges), back)


def _renamed(mechanism: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The mechanism with new ids by the old ones, in references of its notations and fragments as well."""
    return with_references(rename(mechanism, names), names)
