"""A residue for a robot that became a part of another one, all of its names with a prefix, as `MjSpec.attach` gives it."""

from __future__ import annotations

from typing import Any

from msgspec.structs import replace

from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import ROOT, WORLD, Id
from hymeko_x.residue import Alignment, Residue, Sides

_HOLD_IDS = (Residue, Alignment, Sides, Edge, Arc)


def with_prefix(residue: Residue, prefix: str) -> Residue:
    """The residue with the prefix before every name of an element; the order and the layout of the whole are those of the whole."""
    found: Residue = _prefixed(replace(residue, order=(), layout=None, unplaced=()), prefix)
    return replace(found, source=residue.source)


def _prefixed(value: Any, prefix: str) -> Any:
    """Any part of a residue; as deep as its entries are."""
    if isinstance(value, Id):
        return value if value in (ROOT, WORLD) else Id(value.kind, f"{prefix}{value.name}")
    if isinstance(value, tuple):
        items = [_prefixed(item, prefix) for item in value]
        return type(value)(*items) if hasattr(value, "_fields") else tuple(items)
    if isinstance(value, _HOLD_IDS):
        return replace(value, **{name: _prefixed(getattr(value, name), prefix) for name in value.__struct_fields__})
    return value
