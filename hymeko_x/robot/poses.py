"""The named configurations of a robot, with those that its format keeps as texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.ids import Id
from hymeko_x.robot.element import Elements
from hymeko_x.robot.elements import PoseSetElement
from hymeko_x.robot.errors import EditError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.parts import PoseSet


class StateElement(PoseSetElement):
    """A named configuration that the robot's format keeps as text (an MJCF keyframe): ``values`` are read, its other fields are not."""

    @property
    def part(self) -> PoseSet:
        """Raises: EditError, because only its coordinates have a form that formats share."""
        raise EditError(f"{self.id} is a text of its format, of which only the values are known here; add a pose of another name")

    @property
    def values(self) -> dict[str, tuple[float, ...]]:
        """The coordinates by joint, in rad or m; quaternions as (w, x, y, z)."""
        found = self.draft.states().get(self.name)
        if found is None:
            raise EditError(f"{self.id} is no longer there")
        return {key.name: numbers for key, numbers in found.items()}


class Poses(Elements[PoseSetElement]):
    """The named configurations: those that every format understands, then those that the robot's format keeps as texts."""

    def __getitem__(self, name: str) -> PoseSetElement:
        if self._draft.find(self._kind, name) is None and name in self._draft.states():
            return StateElement(self._draft, Id(self._kind, name))
        return super().__getitem__(name)

    def __iter__(self) -> Iterator[str]:
        return iter({**dict.fromkeys(super().__iter__()), **dict.fromkeys(self._draft.states())})

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or name in self._draft.states()
