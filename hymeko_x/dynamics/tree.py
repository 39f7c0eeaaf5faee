"""A mechanism as a tree of links with one dof each, ready for recursions: placements, axes and inertias as constants.

A joint with several dofs is a chain of links without mass; bodies that are fixed to each other are one link. A base without a
joint is fixed to the world, or free on request.
"""

from __future__ import annotations

from collections import Counter
from functools import cached_property
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.spatial import ZERO, FramePose, Inertia
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import DofKind
from hymeko_x.ir.values import Pose, compose, inverse, matrix_from_quat, scaled

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism

COORDINATES = {DofKind.BALL: 4, DofKind.FREE: 7}
VELOCITIES = {DofKind.BALL: 3, DofKind.FREE: 6}
"""Numbers of positions and velocities of the dofs that have more than one: quaternions (w, x, y, z), a position before that of a free one;
velocities are linear, then angular, in the axes of the moving frame."""

_ROUNDING = 1e-15
NO_INERTIA = Inertia(0, ZERO, [ZERO, ZERO, ZERO])


class Link(Struct, frozen=True):
    """What one dof moves: ``frame`` is where the dof's frame is in the parent link, -1 the world, before it moves.

    ``q`` and ``v`` are the first columns of its coordinates, ``bodies`` the inertials that are fixed to it with the frames that they
    are given in, ``joint`` and ``number`` the dof's place, ``name`` is that of the dof: no two links have the same.
    """

    joint: Id
    number: int
    parent: int
    frame: FramePose
    dof: parts.Dof
    q: int
    v: int
    bodies: tuple[tuple[FramePose, parts.Inertial], ...] = ()
    name: str = ""

    @property
    def velocities(self) -> int:
        """The number of its velocities."""
        return VELOCITIES.get(self.dof.kind, 1)

    @property
    def coordinates(self) -> int:
        """The number of its positions."""
        return COORDINATES.get(self.dof.kind, 1)


class LinkTree(Struct, frozen=True, dict=True):
    """The links of a mechanism, parents before children; ``bodies`` by id the link that each is part of, and its pose in it."""

    name: str
    links: tuple[Link, ...]
    nq: int
    nv: int
    bodies: Mapping[Id, tuple[int, FramePose]]

    @cached_property
    def places(self) -> Mapping[tuple[Id, int], int]:
        """The places of the links with one coordinate, by joint and number of the dof."""
        return {(link.joint, link.number): place for place, link in enumerate(self.links) if link.coordinates == 1}

    @property
    def rest(self) -> list[float]:
        """The configuration in which every coordinate is at its reference."""
        return [number for link in self.links for number in reference(link)]


def reference(link: Link) -> tuple[float, ...]:
    """The positions of a link at its reference."""
    return (link.dof.ref,) if link.coordinates == 1 else (*[0.0] * (link.coordinates - 4), 1.0, 0.0, 0.0, 0.0)


def frame_of(pose: Pose) -> FramePose:
    """A pose as a frame; entries that are 0, 1 or -1 but for rounding are so exactly."""
    rotation = [[_clean(value) for value in row] for row in matrix_from_quat(pose.quat)]
    return FramePose(rotation, list(pose.xyz))


def _clean(value: float) -> float:
    near = float(round(value))
    return near + 0.0 if abs(value - near) < _ROUNDING else value


def tree_of(mechanism: Mechanism, *, base: str | None = None) -> LinkTree:
    """The tree of a mechanism; ``base`` is what becomes of roots without a joint: fixed (None too) or free.

    Raises: Refusal (HX400) when no joint moves, HX404 for a dof that moves no mass at all.
    """
    links: list[Link] = []
    placed: dict[Id, tuple[int, Pose]] = {WORLD: (-1, Pose())}
    own: dict[int, list[tuple[Id, Pose]]] = {}
    nq = nv = 0
    for body in mechanism.depth_first():
        view = mechanism.parent_joint.get(body)
        dofs = view.joint.dofs if view is not None else (parts.Dof(DofKind.FREE),) if base == "free" else ()
        joint = view.id if view is not None else body
        parent, place = placed.get(view.parent, (-1, Pose())) if view is not None else (-1, Pose())
        place = compose(place, view.parent_pose) if view is not None else place
        for number, dof in enumerate(dofs):
            frame = frame_of(compose(place, Pose(dof.anchor)))
            links.append(Link(joint, number, parent, frame, dof, nq, nv))
            parent, place = len(links) - 1, Pose(scaled(dof.anchor, -1.0))
            nq, nv = nq + links[-1].coordinates, nv + links[-1].velocities
        place = compose(place, inverse(view.child_pose)) if view is not None else place
        placed[body] = (parent, place)
        own.setdefault(parent, []).append((body, place))
    if not links:
        raise refuse(codes.NO_DYNAMICS, f"{mechanism.name}: no joint of it moves", hint="--base free lets its base move")
    named = zip(links, _names(links), strict=True)
    whole = tuple(replace(link, bodies=_inertials(mechanism, own.get(at, [])), name=name) for at, (link, name) in enumerate(named))
    bodies = {body: (link, frame_of(place)) for body, (link, place) in placed.items()}
    tree = LinkTree(mechanism.name, whole, nq, nv, bodies)
    _refuse_massless(mechanism, tree)
    return tree


def _inertials(mechanism: Mechanism, bodies: list[tuple[Id, Pose]]) -> tuple[tuple[FramePose, parts.Inertial], ...]:
    found = []
    for body, place in bodies:
        part = mechanism.graph.vertices[body]
        if isinstance(part, parts.Body) and part.inertial is not None and part.inertial.mass is not None:
            found.append((frame_of(place), part.inertial))
    return tuple(found)


def _refuse_massless(mechanism: Mechanism, tree: LinkTree) -> None:
    """A dof without armature that moves neither mass nor tensor has no equation of motion."""
    moved = [any(_weighs(inertial) for _, inertial in link.bodies) for link in tree.links]
    for number in reversed(range(len(moved))):
        parent = tree.links[number].parent
        if parent >= 0 and moved[number]:
            moved[parent] = True
    for link, found in zip(tree.links, moved, strict=True):
        if not found and not link.dof.armature:
            message = f"{link.joint} moves no mass; the mass matrix is singular"
            hint = "give what it moves a mass and an inertia tensor, or the joint an armature"
            raise refuse(codes.SINGULAR_MASS, message, mechanism.origin(link.joint), element=str(link.joint), hint=hint)


def _weighs(inertial: parts.Inertial) -> bool:
    return bool(inertial.mass) or any(inertial.tensor or ())


def _names(links: Sequence[Link]) -> list[str]:
    """The names of dofs: their own where no other has it, that of their joint, or that of their joint with their number."""
    names = [link.dof.name or (link.joint.name if link.number == 0 else f"{link.joint.name}#{link.number}") for link in links]
    count = Counter(names)
    return [name if count[name] == 1 else f"{link.joint.name}#{link.number}" for name, link in zip(names, links, strict=True)]
