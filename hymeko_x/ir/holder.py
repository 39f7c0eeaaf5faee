"""What public functions take as a robot: a mechanism, or an object that has one."""

from __future__ import annotations

from typing import Protocol

from hymeko_x.ir.mechanism import Mechanism


class Holder(Protocol):
    """An object with a mechanism, as :class:`hymeko_x.Robot` is."""

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism."""
        ...

    @property
    def completed(self) -> Mechanism:
        """The mechanism with what only the engine of its format computes, such as inertias from shapes."""
        ...


def mechanism_of(robot: Mechanism | Holder) -> Mechanism:
    """The mechanism itself, or the one that the object has."""
    return robot if isinstance(robot, Mechanism) else robot.mechanism


def completed_of(robot: Mechanism | Holder) -> Mechanism:
    """The mechanism as it is, or that of the object with what only the engine of its format computes."""
    return robot if isinstance(robot, Mechanism) else robot.completed
