"""What is wrong with a call of the object model, in a message that names the element."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

from hymeko_x.diagnostics import listed

if TYPE_CHECKING:
    from collections.abc import Iterable


class EditError(ValueError):
    """A change that a robot cannot have; the message names the element. Nothing was changed by the call that raised it."""


class UnknownName(KeyError):
    """There is no element of this kind and name; the message lists similar names."""

    def __str__(self) -> str:
        return str(self.args[0])


def unknown_name(kind: str, name: object, known: Iterable[str]) -> UnknownName:
    """The error of a name that no element of this kind has."""
    return UnknownName(f"there is no {kind} {name!r}; {hint_of(str(name), list(known), f'the robot has no {kind}')}")


def hint_of(name: str, names: list[str], otherwise: str) -> str:
    """The names that come near an unknown one, or a few of those that there are; ``otherwise`` where there are none."""
    near = get_close_matches(name, names, 3)
    if near:
        return f"did you mean {' or '.join(map(repr, near))}?"
    return f"there are {listed([*map(repr, names)], 5)}" if names else otherwise
