"""The ledger in a few lines: what got lost, alike things together, the worst first."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.ledger import Loss

_FATES = ("dropped", "approximated", "carried")
_KINDS = ("mechanism", "body", "joint", "loop", "coupling", "tendon", "actuator", "drive", "sensor", "shape", "contact", "frame")
"""What a robot is, before what it looks like and what stands in comments."""

_PLACE = re.compile(r"\[\d+\]")
_EXAMPLES = 3


def lines(losses: Sequence[Loss]) -> Iterator[str]:
    """A line for every group of elements of one kind that lost the same field in the same way."""
    groups: dict[tuple[str, str, str], list[Loss]] = defaultdict(list)
    for loss in losses:
        groups[loss.fate, _kind(loss), _PLACE.sub("[]", loss.field)].append(loss)
    ranked = sorted(groups, key=lambda group: (_FATES.index(group[0]), _rank(group[1], group[2])))
    for group in ranked:
        found = groups[group]
        yield str(found[0]) if len(found) == 1 else _summary(*group, found)


def _kind(loss: Loss) -> str:
    return loss.element.partition(" ")[0]


def _rank(kind: str, field: str) -> tuple[bool, int]:
    """What stands there verbatim comes last."""
    return " " in field, _KINDS.index(kind) if kind in _KINDS else len(_KINDS)


def _summary(fate: str, kind: str, field: str, losses: list[Loss]) -> str:
    place = f"{losses[0].origin}: " if losses[0].origin else ""
    shown = [_example(loss) for loss in losses[:_EXAMPLES]]
    more = [f"and {len(losses) - _EXAMPLES} more"] if len(losses) > _EXAMPLES else []
    return f"{place}loss: {len(losses)} x {f'{kind} {field}'.rstrip()} {fate}: {', '.join([*shown, *more])}"


def _example(loss: Loss) -> str:
    name = loss.element.partition(" ")[2] or loss.element
    return f"{name} {loss.change}" if loss.after is not None and loss.before is not None else name
