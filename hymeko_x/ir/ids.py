"""The ids of elements."""

from __future__ import annotations

from typing import NamedTuple


class Id(NamedTuple):
    """The key of an element: its kind (``body``, ``joint``, ``shape``, ...) and a name unique among its kind."""

    kind: str
    name: str

    def __str__(self) -> str:
        return f"{self.kind} '{self.name}'"


WORLD = Id("world", "world")
ROOT = Id("mechanism", "")
"""The key under which side tables keep what belongs to the mechanism as a whole."""
