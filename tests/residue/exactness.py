"""Two mechanisms compared to the last bit, with everything that stands beside them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from hymeko_x.compare.diff import diff
from hymeko_x.ir.fields import identical
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.residue.sides import by_kind


def unequal(a: Mechanism, b: Mechanism) -> list[str]:
    """What is not the same: values, notations, extras, order."""
    return list(_unequal(a, b))


def _unequal(a: Mechanism, b: Mechanism) -> Iterator[str]:
    yield from map(str, diff(a, b))
    for mine, theirs in ((a.graph.vertices, b.graph.vertices), (a.graph.edges, b.graph.edges)):
        yield from (
            f"{key}: {part} is not {theirs[key]}" for key, part in mine.items() if key in theirs and not identical(part, theirs[key])
        )
        if by_kind(mine) != by_kind(theirs):
            yield f"order: {by_kind(mine)} is not {by_kind(theirs)}"
    for name in ("notations", "stereotypes", "extras"):
        mine, theirs = _filled(getattr(a, name)), _filled(getattr(b, name))
        keys = [key for key in {**mine, **theirs} if not identical(mine.get(key), theirs.get(key))]
        yield from (f"{name} of {key}: {mine.get(key)} is not {theirs.get(key)}" for key in keys)
    if a.layout != b.layout:
        yield f"layout: {a.layout} is not {b.layout}"


def _filled(table: Mapping) -> dict:  # type: ignore[type-arg]
    return {key: dict(value) if isinstance(value, Mapping) else tuple(value) for key, value in table.items() if value}
