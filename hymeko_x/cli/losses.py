"""The ledger in a few lines: what got lost, alike things together, the worst first."""

from __future__ import annotations

import re
from collections import defaultdict
from textwrap import shorten
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.compare.ledger import Loss

_FATES = ("dropped", "approximated", "carried")
_KINDS = ("mechanism", "body", "joint", "loop", "coupling", "tendon", "actuator", "drive", "sensor", "shape", "contact", "frame")
"""What a robot is, before what it looks like and what stands in comments."""

_PLACE = re.compile(r"\[\d+\]")
_EXAMPLES = 3
_WORDS = 40


def lines(losses: Sequence[Loss]) -> Iterator[str]:
    """A line for every group of elements of one kind in which the same became of the same field."""
    groups: dict[tuple[str, str, str, bool, bool], list[Loss]] = defaultdict(list)
    for loss in losses:
        groups[loss.fate, _kind(loss), _PLACE.sub("[]", loss.field), loss.after is None, loss.before is None].append(loss)
    for group in sorted(groups, key=lambda group: (_FATES.index(group[0]), _rank(group[1], group[2]))):
        found = groups[group]
        yield str(found[0]) if len(found) == 1 else _summary(*group[:3], found)


def _kind(loss: Loss) -> str:
    return loss.element.partition(" ")[0]


def _rank(kind: str, field: str) -> tuple[bool, int]:
    """What stands there verbatim comes last."""
    return " " in field, _KINDS.index(kind) if kind in _KINDS else len(_KINDS)


def _summary(fate: str, kind: str, field: str, losses: list[Loss]) -> str:
    """A few of them stand for all: with what they were and are, or on the side of the arrow on which they are there."""
    first = losses[0]
    place = f"{first.origin}: " if first.origin else ""
    shown = [_example(loss) for loss in losses[:_EXAMPLES]]
    more = [f"and {len(losses) - _EXAMPLES} more"] if len(losses) > _EXAMPLES else []
    said = ", ".join([*shown, *more])
    said = f"nothing -> {said}" if first.before is None else f"{said} -> nothing" if first.after is None else said
    return f"{place}loss: {len(losses)} x {f'{kind} {field}'.rstrip()} {fate}: {said}"


def _example(loss: Loss) -> str:
    """The name of the element and what became of it; what the mechanism itself has goes by its first words."""
    name = loss.element.partition(" ")[2]
    if loss.before is not None and loss.after is not None:
        return f"{name} {loss.change}".strip()
    return name or shorten(loss.before or loss.after or "", _WORDS, placeholder="...")
