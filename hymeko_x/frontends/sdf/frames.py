"""The frame graph: where each link, joint, frame and model is, relative to another one, and what one pose is in another."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse
from hymeko_x.ir.written import clean_pose

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id

_NEAR = 4
"""So many steps up are looked at before poses in the world are compared: near frames then have exactly the numbers of the file."""


class Frames(Struct):
    """Each frame with the frame that it is given in, and its pose there; the world is given in none."""

    given: dict[Id, tuple[Id, Pose]] = field(default_factory=dict)
    _in_world: dict[Id, Pose] = field(default_factory=dict)

    def put(self, frame: Id, base: Id, pose: Pose) -> None:
        """Say where a frame is."""
        self.given[frame] = base, pose

    def cycles(self) -> list[Id]:
        """One frame of every cycle: frames that are given in each other. Linear."""
        done: set[Id] = {WORLD}
        found = []
        for start in self.given:
            path: dict[Id, None] = {}
            frame = start
            while frame not in done and frame in self.given:
                if frame in path:
                    found.append(frame)
                    break
                path[frame] = None
                frame = self.given[frame][0]
            done.update(path)
        return found

    def in_world(self, frame: Id) -> Pose:
        """The pose of a frame in the world. Not recursive."""
        path = []
        while frame not in self._in_world and frame in self.given:
            path.append(frame)
            frame = self.given[frame][0]
        pose = self._in_world.get(frame, IDENTITY)
        for member in reversed(path):
            pose = self._in_world[member] = compose(pose, self.given[member][1])
        return pose

    def relative(self, frame: Id, base: Id) -> Pose:
        """The pose of a frame in another one: numbers of the file as they are, computed ones without noise."""
        direct = self.given.get(frame)
        if direct is not None and direct[0] == base:
            return direct[1]
        near = self._up(frame, base)
        if near is None:
            back = self._up(base, frame)
            near = inverse(back) if back is not None else compose(inverse(self.in_world(base)), self.in_world(frame))
        return near if near is IDENTITY else self._cleaned(near, [*self._steps(frame), *self._steps(base)])

    @staticmethod
    def _cleaned(pose: Pose, given: list[Pose]) -> Pose:
        """A pose without the noise of computing it from those given."""
        if pose in given:
            return pose
        clean, known = clean_pose(pose), {abs(number) for step in given for number in step.xyz}
        x, y, z = (a if abs(a) in known else b for a, b in zip(pose.xyz, clean.xyz, strict=True))
        turn = next((step for step in given if step.quat == pose.quat), clean)
        return Pose((x, y, z), turn.quat, turn.written)

    def _steps(self, frame: Id) -> list[Pose]:
        """The poses of the file on the way up from a frame, as far as near frames are."""
        found: list[Pose] = []
        while frame in self.given and len(found) < _NEAR:
            frame, pose = self.given[frame]
            found.append(pose)
        return found

    def _up(self, frame: Id, base: Id, most: int = _NEAR) -> Pose | None:
        """The pose of a frame in one that is a few steps above it; None where it is not."""
        pose = IDENTITY
        for _ in range(most):
            if frame == base:
                return pose
            if frame not in self.given:
                return None
            frame, step = self.given[frame]
            pose = step if pose is IDENTITY else compose(step, pose)
        return pose if frame == base else None

    def inside(self, frame: Id, model: Id) -> Pose | None:
        """The pose of a frame of a model in the model's own frame, whose place is not known yet; None where it depends on that place."""
        return self._up(frame, model, len(self.given))
