"""What changed between two revisions of a robot, as a list for people who review it."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from hymeko_x.compare.units import unit_of
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.values import rotation_angle
from hymeko_x.reporting.summary import counted, word_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.compare.diff import Difference
    from hymeko_x.ir.mechanism import Mechanism

_ENDS = {"lower": "lower position limit", "upper": "upper position limit"}
_VECTOR = re.compile(r"\[([^\[\]]*)\]")
_LONGEST = 80


def markdown(names: tuple[str, str], before: Mechanism, after: Mechanism, found: Sequence[Difference]) -> str:
    """A heading with the number of changes, and a line for each: ``mass of body `hip_left` 1.2 -> 1.4 kg``."""
    title = names[0] if names[0] == names[1] else f"{names[0]} -> {names[1]}"
    heading = f"**{title}**: {counted(len(found), 'change') if found else 'no change'}\n"
    lines = "".join(f"- {_line(one, before, after)}\n" for one in found)
    return f"{heading}\n{lines}" if lines else heading


def _line(found: Difference, before: Mechanism, after: Mechanism) -> str:
    place = "the robot" if found.element == ROOT else f"{found.element.kind} `{_plain(found.element.name)}`"
    if not found.field:
        return f"{place} {'added' if found.before is None else 'removed'}"
    last = found.field.rpartition(".")[2]
    what = f"{_ENDS.get(last) or word_of(found.field)} of {place}"
    if found.before is None or found.after is None:
        return f"{what} {'added' if found.before is None else 'removed'}: {_short(found.after or found.before or '')}"
    turned = _turned(found) if last == "rotation" else None
    if turned is not None:
        return f"{what} turned by {turned:.6g} rad ({math.degrees(turned):.6g} deg)"
    unit = unit_of(before, found.element, found.field) or unit_of(after, found.element, found.field)
    return f"{what} {_short(found.before)} -> {_short(found.after)}" + (f" {unit}" if unit else "")


def _turned(found: Difference) -> float | None:
    """The angle in rad between two rotations; None where one is no quaternion."""
    quats = []
    for text in (found.before, found.after):
        inside = _VECTOR.fullmatch(text or "")
        numbers = [float(word) for word in inside[1].split()] if inside else []
        if len(numbers) != 4:
            return None
        quats.append((numbers[0], numbers[1], numbers[2], numbers[3]))
    return rotation_angle(*quats)


def _short(text: str) -> str:
    shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
    return f"`{_plain(shown)}`" if re.search(r"[<>*_|`]", shown) else shown


def _plain(text: str) -> str:
    return text.replace("`", "'").replace("\n", " ")
