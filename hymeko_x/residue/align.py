"""Finding the alignment: which element of the image is which of the source, and what the image only describes otherwise.

A wrong guess is never a wrong result, only a longer residue: whatever differs behind the alignment becomes an entry.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import WORLD, Id
from hymeko_x.ir.parts import DofKind, Joint, Role, Shape
from hymeko_x.ir.values import IDENTITY, Pose, add, compose, inverse, quat_about, rotate, rotation_angle, scaled
from hymeko_x.residue import Alignment, Fold, Join
from hymeko_x.residue.realign import are_twins, fold_chains, join_twins, move_frames, realign

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import JointView, Mechanism, RobotEdge, RobotGraph
    from hymeko_x.ir.parts import Dof

_SAME_PLACE = 1e-5
"""Frames closer than this (m, rad) are the same: what is left is rounding, in single precision for some formats."""
_ROUNDING = 1e-13
"""How much a number of a quaternion may change when it is written as angles."""
_SCALAR = frozenset({DofKind.HINGE, DofKind.SLIDE, DofKind.SCREW})


def align(image: Mechanism, source: Mechanism) -> tuple[Alignment, Mechanism]:
    """The alignment that leads from the image to the source, and the aligned image. Linear in both."""
    names = other_names(image, source)
    renamed = realign(image, Alignment(tuple(names.items())))
    folds = tuple(_folds(renamed, source))
    folded = fold_chains(renamed, folds)
    joins = tuple(_joins(folded, source))
    joined = join_twins(folded, joins)
    frames = {} if _agree_in_poses(joined, source) else dict(_frames(joined, source))
    return Alignment(tuple(names.items()), folds, joins, tuple(frames.items())), move_frames(joined, frames)


# ---- names -----------------------------------------------------------------------------------------------------------------


def other_names(image: Mechanism, source: Mechanism) -> dict[Id, Id]:
    """The source's id of every element of the image that goes by another one."""
    pairs = _Pairs(image.graph, source.graph)
    pairs.match_world()
    pairs.match_ends()  # bodies by the joints that both have, materials and meshes by the shapes
    for _ in range(2):  # then edges by what they connect, and once more what only those lead to
        pairs.match_edges()
        pairs.match_ends()
    return pairs.names


class _Pairs:
    """Elements of the image without a namesake, and elements of the source without one, being matched."""

    def __init__(self, image: RobotGraph, source: RobotGraph) -> None:
        self.image, self.source = image, source
        self.names: dict[Id, Id] = {}
        mine, theirs = {*image.vertices, *image.edges}, {*source.vertices, *source.edges}
        self.strange = mine - theirs
        self.missing = theirs - mine

    def pair(self, old: Id, new: Id) -> None:
        """They are the same element from now on."""
        is_world = new == WORLD and old.kind == "body" and WORLD not in self.image.vertices  # a link that stands for the world
        if old in self.strange and (is_world or (new in self.missing and old.kind == new.kind)):
            self.names[old] = new
            self.strange.discard(old)
            self.missing.discard(new)

    def match_world(self) -> None:
        """The link that a format without a world calls so, where the source knows no body of that name."""
        if WORLD in self.source.vertices:
            self.pair(Id("body", WORLD.name), WORLD)

    def match_ends(self) -> None:
        """What the arcs of an edge lead to, for the edges that both have."""
        if not self.strange or not self.missing:
            return
        for key, edge in self.image.edges.items():
            strange = [arc for arc in edge.arcs if arc.target in self.strange]
            other = self.source.edges.get(self.names.get(key, key)) if strange else None
            if other is None:
                continue
            ends = {(arc.sign, arc.role): arc.target for arc in other.arcs}
            for arc in strange:
                target = ends.get((arc.sign, arc.role))
                if target is not None:
                    self.pair(arc.target, target)

    def match_edges(self) -> None:
        """Edges of the same kind between the same elements: equal ones first, then in their order."""
        if not self.strange or not self.missing:
            return
        waiting: dict[object, list[Id]] = defaultdict(list)
        for key, edge in self.source.edges.items():
            if key in self.missing:
                waiting[self._ends(key, edge, {})].append(key)
        if not waiting:
            return
        candidates: dict[object, list[Id]] = defaultdict(list)
        for key, edge in self.image.edges.items():
            if key in self.strange:
                candidates[self._ends(key, edge, self.names)].append(key)
        for ends, keys in candidates.items():
            if ends in waiting:
                self._match(keys, waiting[ends])

    def _match(self, old: list[Id], new: list[Id]) -> None:
        if len(old) == len(new) == 1 and _sort(self.source.edges[new[0]]) == _sort(self.image.edges[old[0]]):
            self.pair(old[0], new[0])
            return
        alike: dict[object, list[Id]] = defaultdict(list)
        for key in reversed(new):
            alike[_content(self.source.edges[key])].append(key)
        for key in old:
            same = alike[_content(self.image.edges[key])]
            if same:
                self.pair(key, same.pop())
        left, rest = [key for key in old if key in self.strange], [key for key in new if key in self.missing]
        kinds: dict[object, list[Id]] = defaultdict(list)
        for key in reversed(rest):
            kinds[_sort(self.source.edges[key])].append(key)
        for key in left:
            same = kinds[_sort(self.image.edges[key])]
            if same:
                self.pair(key, same.pop())

    def _ends(self, key: Id, edge: RobotEdge, names: dict[Id, Id]) -> object:
        """What an edge is and what it is on; assets do not count, since they are renamed most often."""
        targets = (names.get(arc.target, arc.target) for arc in edge.arcs if arc.target.kind not in ("mesh", "material", "texture"))
        return key.kind, tuple(targets)


def _content(edge: RobotEdge) -> object:
    """The content of an edge, without names."""
    weights = tuple(arc.weight for arc in edge.arcs if arc.target.kind not in ("mesh", "material"))
    data = edge.data
    return (data.geometry, weights) if isinstance(data, Shape) else (data, weights)


def _sort(edge: RobotEdge) -> object:
    """What must be equal for two edges to be the same one, changed."""
    data = edge.data
    if isinstance(data, Shape):
        return type(data.geometry), data.role is Role.COLLISION
    return tuple(dof.kind for dof in data.dofs) if isinstance(data, Joint) else ()


# ---- chains ----------------------------------------------------------------------------------------------------------------


def _folds(image: Mechanism, source: Mechanism) -> Iterable[Fold]:
    """The joints that are a chain in the image, with bodies in it that the source does not have."""
    if not any(key.kind == "body" for key in image.graph.vertices.keys() - source.graph.vertices.keys()):
        return
    for view in source.joints.values():
        chain = _chain_above(image, source, view.child)
        kinds = [dof.kind for joint in chain for dof in joint.joint.dofs]
        if len(chain) > 1 and chain[0].parent == view.parent and kinds == [dof.kind for dof in view.joint.dofs]:
            yield Fold(view.id, tuple(joint.id for joint in chain), tuple(joint.child for joint in chain[:-1]))


def _chain_above(image: Mechanism, source: Mechanism, body: Id) -> list[JointView]:
    """The joints of the image from a body up to the next one that the source knows as well, from above."""
    chain: list[JointView] = []
    above = image.parent_joint.get(body)
    while above is not None:
        chain.append(above)
        if above.parent in source.graph.vertices or above.parent == WORLD:
            return chain[::-1]
        above = image.parent_joint.get(above.parent)
    return []


# ---- shapes ----------------------------------------------------------------------------------------------------------------


def _joins(image: Mechanism, source: Mechanism) -> Iterable[Join]:
    """The shapes of the source that are both visual and collision, which are two shapes in the image."""
    for body, views in source.shapes.items():
        both = [view.id for view in views if view.shape.role is Role.BOTH]
        if not both or body not in image.shapes:
            continue
        free: dict[object, list[Id]] = defaultdict(list)
        for view in reversed(image.shapes[body]):
            if view.shape.role is Role.COLLISION and view.id not in source.graph.edges:
                free[_content(image.graph.edges[view.id])].append(view.id)
        for key in both:
            seen = image.graph.edges.get(key)
            twins = free[_content(seen)] if seen is not None else []
            if seen is not None and twins and are_twins(seen, image.graph.edges[twins[-1]]):
                yield Join(key, twins.pop())


# ---- frames and coordinates --------------------------------------------------------------------------------------------------


def _agree_in_poses(image: Mechanism, source: Mechanism) -> bool:
    """Whether all bodies hang on the same bodies in the same places, so that no frame can be another one."""
    below = image.parent_joint
    for body, view in source.parent_joint.items():
        other = below.get(body)
        if other is None or view.parent != other.parent:
            return False
        if not (_alike(view.parent_pose, other.parent_pose) and _alike(view.child_pose, other.child_pose)):
            return False
        if list(map(_moved_to_zero, view.joint.dofs)) != list(map(_moved_to_zero, other.joint.dofs)):
            return False
    return True


def _alike(a: Pose, b: Pose) -> bool:
    """Whether two poses are the same but for the rounding of a rotation that was written in another notation."""
    return a.xyz == b.xyz and (a.quat == b.quat or all(abs(x - y) <= _ROUNDING for x, y in zip(a.quat, b.quat, strict=True)))


def _frames(image: Mechanism, source: Mechanism) -> Iterable[tuple[Id, Pose]]:
    """Where the source's body frames are in the image's, for the bodies where they differ. Roots have the same in both."""
    there: dict[Id, Pose] = {}
    here: dict[Id, Pose] = {}
    for body in image.depth_first():
        here[body] = _zero_pose(image, body, here)
    for body in source.depth_first():
        above = source.parent_joint.get(body)
        if above is None or above.parent == WORLD or above.parent not in there:
            there[body] = here.get(body, IDENTITY)
            continue
        there[body] = _zero_pose(source, body, there)
        if body not in here:
            continue
        shift = compose(inverse(here[body]), there[body])
        if max(map(abs, shift.xyz)) > _SAME_PLACE or rotation_angle(shift.quat, IDENTITY.quat) > _SAME_PLACE:
            yield body, shift


def _zero_pose(mechanism: Mechanism, body: Id, poses: dict[Id, Pose]) -> Pose:
    """The pose of a body where all coordinates are zero, in its root's frame."""
    above = mechanism.parent_joint.get(body)
    if above is None:
        return IDENTITY
    pose = compose(poses.get(above.parent, IDENTITY), above.parent_pose)
    for dof in above.joint.dofs:
        pose = compose(pose, _moved_to_zero(dof))
    return compose(pose, inverse(above.child_pose))


def _moved_to_zero(dof: Dof) -> Pose:
    """What a dof does between its reference and zero."""
    if dof.ref == 0.0 or dof.kind not in _SCALAR:
        return IDENTITY
    if dof.kind is DofKind.SLIDE:
        return Pose(scaled(dof.axis, -dof.ref))
    turn = quat_about(dof.axis, -dof.ref)
    along = scaled(dof.axis, -dof.ref * dof.pitch)
    return Pose(add(along, add(dof.anchor, scaled(rotate(turn, dof.anchor), -1.0))), turn)
