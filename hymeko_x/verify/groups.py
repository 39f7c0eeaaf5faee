"""A robot as its joints see it: bodies that are fixed to each other are one, named after the joint above them.

Files of one robot from different authors rarely have the same links: some keep a link for each flange and sensor, others merge what
is fixed; names get a prefix; and each author places the frame of a link somewhere else. None of this changes how the robot moves.
In a grouped model the frames follow from the joints alone, so that two such models differ only where the robots do: in the pose where all
coordinates are 0, every frame is turned as the base is, and its origin is the point of its joint's axis next to the origin of the base.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.verify.dh import zero_poses
from hymeko_x.verify.model import WORLD, Array, Body, Dof, Joint, Kind, KinematicModel, Loop
from hymeko_x.verify.renaming import renamed
from hymeko_x.verify.spatial import inverse, rigid, shifted_tensor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

BASE = "base"
"""The name of the group from which most joints come."""

_TURNING = (Kind.HINGE, Kind.SCREW, Kind.BALL)


def grouped(model: KinematicModel, rename: Mapping[str, str] | None = None) -> KinematicModel:
    """The model with one body for each moving group.

    ``rename`` gives joints other names: patterns with at most one ``*``, such as ``{"panda_*": "*"}``; the first that fits counts.
    Actuators, sensors and tendons are left out; a note counts them.
    """
    groups = _Groups(model)
    names = groups.names(rename or {})
    left = len(model.actuators) + len(model.sensors) + len(model.tendons) + len(model.tied_tendons)
    notes = (*model.notes, f"{left} actuators, sensors and tendons were not compared") if left else model.notes
    return replace(
        model,
        bodies=tuple(_renamed(groups.body(leader), name, rename or {}) for leader, name in zip(groups.kept, names, strict=True)),
        loops=tuple(groups.loop(loop) for loop in model.loops),
        actuators=(),
        sensors=(),
        tendons=(),
        tied_tendons=(),
        notes=notes,
    )


def _renamed(body: Body, name: str | None, rename: Mapping[str, str]) -> Body:
    dofs = tuple(dof if dof.name is None else replace(dof, name=renamed(dof.name, rename)) for dof in body.joint.dofs)
    joint = replace(body.joint, dofs=dofs, name=None if body.joint.name is None else renamed(body.joint.name, rename))
    return replace(body, name=name, joint=joint)


class _Groups(Struct, frozen=True, eq=False, dict=True):
    """The moving groups of a model. A group is known by its leader: the body below its joint, or a child of the world."""

    model: KinematicModel

    @cached_property
    def leader(self) -> Sequence[int]:
        """For each body the leader of its group."""
        leaders: list[int] = []
        for i, body in enumerate(self.model.bodies):
            leaders.append(i if i == WORLD or body.joint.dofs or body.parent == WORLD else leaders[body.parent])
        return leaders

    @cached_property
    def kept(self) -> Sequence[int]:
        """The leaders, the world first, parents before children."""
        return [i for i, leader in enumerate(self.leader) if i == leader]

    @cached_property
    def number(self) -> Mapping[int, int]:
        """The index of each group in the grouped model."""
        return {leader: k for k, leader in enumerate(self.kept)}

    @cached_property
    def members(self) -> Mapping[int, Sequence[int]]:
        """The bodies of each group."""
        found: dict[int, list[int]] = {leader: [] for leader in self.kept}
        for i, leader in enumerate(self.leader):
            found[leader].append(i)
        return found

    @cached_property
    def poses(self) -> Array:
        """Of each body the pose in the world, where all coordinates are 0; (bodies, 4, 4)."""
        return zero_poses(self.model)

    @cached_property
    def frames(self) -> Array:
        """Of each leader the frame of its group in the world, where all coordinates are 0; (bodies, 4, 4)."""
        frames = np.array(self.poses)
        base = list(range(len(self.leader)))  # of each leader the root of its tree
        for i in self.kept[1:]:
            body = self.model.bodies[i]
            if not self._is_root(body):
                base[i] = base[self.leader[body.parent]]
                root = frames[base[i]]
                frames[i] = rigid(root[:3, :3], _origin(body.joint.dofs, self.poses[i], root[:3, 3]))
        return frames

    def names(self, rename: Mapping[str, str]) -> list[str | None]:
        """Of each group the name of its joint; the root with most joints is the base, other roots have their own names."""
        below = dict.fromkeys(self.kept, 0)
        for i in reversed(self.kept[1:]):
            below[self.leader[self.model.bodies[i].parent]] += 1 + below[i]
        base = max((i for i in self.kept[1:] if self._is_root(self.model.bodies[i])), key=below.__getitem__, default=WORLD)
        return [BASE if i == base != WORLD else self._name(i, rename) for i in self.kept]

    def _name(self, leader: int, rename: Mapping[str, str]) -> str | None:
        body = self.model.bodies[leader]
        names = (body.joint.name, *(dof.name for dof in body.joint.dofs))
        above = next((name for name in names if name is not None), None)
        return body.name if leader == WORLD or above is None or self._is_root(body) else renamed(above, rename)

    def _is_root(self, body: Body) -> bool:
        """Whether a leader begins a tree: it is fixed to the world, or floats."""
        return body.parent == WORLD and all(dof.kind is Kind.FREE for dof in body.joint.dofs)

    def body(self, leader: int) -> Body:
        """The bodies of a group as one, in the frame of the group and with the name of the leader."""
        first = self.model.bodies[leader]
        bodies = [(self.model.bodies[i], inverse(self.frames[leader]) @ self.poses[i]) for i in self.members[leader]]
        mass = sum(body.mass for body, _ in bodies)
        centres = [place[:3, :3] @ body.com + place[:3, 3] for body, place in bodies]
        com = sum((body.mass * centre for (body, _), centre in zip(bodies, centres, strict=True)), np.zeros(3)) / (mass or 1.0)
        tensor = np.zeros((3, 3))
        for (body, place), centre in zip(bodies, centres, strict=True):
            tensor += shifted_tensor(body.mass, centre - com, place[:3, :3] @ body.tensor @ place[:3, :3].T)
        return replace(
            first,
            parent=-1 if leader == WORLD else self.number[self.leader[first.parent]],
            joint=first.joint if leader == WORLD else self._joint(leader),
            mass=mass,
            com=com,
            tensor=tensor,
            shapes=tuple(replace(shape, pose=place @ shape.pose) for body, place in bodies for shape in body.shapes),
            inertia_is_known=all(body.inertia_is_known for body, _ in bodies),
            tensor_is_known=all(body.tensor_is_known for body, _ in bodies),
        )

    def _joint(self, leader: int) -> Joint:
        """The joint above a group, between the frames of two groups: with C the group's frame in its leader, C_parent^-1 T C."""
        body = self.model.bodies[leader]
        turn = inverse(self.poses[leader]) @ self.frames[leader]
        back = inverse(turn)
        above = inverse(self.frames[self.leader[body.parent]]) @ self.poses[body.parent]
        dofs = tuple(replace(dof, axis=back[:3, :3] @ dof.axis, anchor=back[:3, :3] @ dof.anchor + back[:3, 3]) for dof in body.joint.dofs)
        return replace(body.joint, placement=above @ body.joint.placement @ turn, dofs=dofs)

    def loop(self, loop: Loop) -> Loop:
        """A closure between groups."""
        ends = [
            (self.number[self.leader[i]], inverse(self.frames[self.leader[i]]) @ self.poses[i] @ pose)
            for i, pose in ((loop.body_a, loop.pose_a), (loop.body_b, loop.pose_b))
        ]
        return replace(loop, body_a=ends[0][0], pose_a=ends[0][1], body_b=ends[1][0], pose_b=ends[1][1])


def _origin(dofs: Sequence[Dof], pose: Array, base: Array) -> Array:
    """The point of a joint's axis next to the origin of the base; slides have no line, and leave it there."""
    turning = next((dof for dof in reversed(dofs) if dof.kind in _TURNING), None)
    if turning is None:
        return base
    point: Array = pose[:3, :3] @ turning.anchor + pose[:3, 3]
    if turning.kind is Kind.BALL:
        return point
    axis = pose[:3, :3] @ turning.axis
    nearest: Array = point + axis * (axis @ (base - point))
    return nearest
