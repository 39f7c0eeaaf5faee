"""Notations: how authors wrote an element, where the values themselves cannot keep it.

Each format declares its notations in ``formats/X``, with their types. Mechanisms keep them as texts by name, as HyMeKo texts and
residues print them; readers and writers use :meth:`Builder.note` and :meth:`Mechanism.notation`, which take and give the typed value.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING, Generic, TypeVar

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")
E = TypeVar("E", bound=Enum)


class Notation(Struct, Generic[T], frozen=True, eq=False):
    """One notation: its name, how its value is written as text, and how it is read (None: the text means none)."""

    name: str
    write: Callable[[T], str]
    read: Callable[[str], T | None]


def word(name: str) -> Notation[str]:
    """A notation whose value is a text."""
    return Notation(name, str, str)


def words(name: str) -> Notation[tuple[str, ...]]:
    """A notation whose value is several texts without blanks in them."""
    return Notation(name, " ".join, lambda text: tuple(text.split()))


def flag(name: str, text: str = "true") -> Notation[bool]:
    """A notation that an element has or has not."""
    return Notation(name, lambda _: text, lambda _: True)


def choice(name: str, kind: type[E]) -> Notation[E]:
    """A notation whose value is one of a closed list."""
    known = {str(member.value): member for member in kind}
    return Notation(name, lambda member: str(member.value), known.get)


WITHOUT_TENSOR = flag("urdf.tensor", "unspecified")
"""The notation of a body whose source gives its mass alone: its centre and its tensor are not those of its shapes."""
UNNAMED = flag("unnamed", "yes")
"""The notation of an element that its author gave no name."""
