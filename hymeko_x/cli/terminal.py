"""Diagnostics and losses for people: text on standard error, in colour where a terminal shows it."""

from __future__ import annotations

import os
import re
import sys
from collections import defaultdict
from textwrap import shorten
from typing import TYPE_CHECKING, TextIO

from hymeko_x.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from hymeko_x.compare.ledger import Loss

MOST_LINES = 40
"""How many diagnostics of one severity are shown; a summary names the rest. `--report` has them all."""
_EXAMPLES = 3
_ALL = "(--report FILE.json lists all)"
_NAMES = re.compile(r"'[^']*'|\d+")

_COLOURS = {Severity.NOTE: "36", Severity.WARNING: "33", Severity.ERROR: "31"}


def show(diagnostics: Iterable[Diagnostic], stream: TextIO | None = None) -> None:
    """Print diagnostics to standard error: a few notes that say the same of different elements stand for all, and long lists are cut."""
    stream = sys.stderr if stream is None else stream
    coloured = is_coloured(stream)
    room = dict.fromkeys(Severity, MOST_LINES)
    left = dict.fromkeys(Severity, 0)
    for alike in _alike(diagnostics):
        severity = alike[0].severity
        shown = alike[: min(room[severity], _EXAMPLES)]
        for diagnostic in shown:
            print(render(diagnostic, coloured), file=stream)
        room[severity] -= len(shown)
        if shown and len(shown) < len(alike):
            print(f"... and {len(alike) - len(shown)} more like it {_ALL}", file=stream)
        elif not shown:
            left[severity] += len(alike)
    for severity, count in left.items():
        if count:
            print(f"... and {count} more of severity {severity.value} {_ALL}", file=stream)


def _alike(diagnostics: Iterable[Diagnostic]) -> Iterable[list[Diagnostic]]:
    """Notes that only differ in names and numbers together, where the first of them was made; every warning and error alone."""
    groups: dict[object, list[Diagnostic]] = {}
    for number, diagnostic in enumerate(diagnostics):
        is_note = diagnostic.severity is Severity.NOTE
        kind = (diagnostic.code.id, _NAMES.sub("", diagnostic.message)) if is_note else number
        groups.setdefault(kind, []).append(diagnostic)
    return groups.values()


def render(diagnostic: Diagnostic, coloured: bool) -> str:
    """One diagnostic as text: place, severity and code, message, excerpt, hint."""
    if not coloured:
        return str(diagnostic)
    place = paint("1", f"{diagnostic.origin}: ") if diagnostic.origin else ""
    label = paint(f"1;{_COLOURS[diagnostic.severity]}", f"{diagnostic.severity.value}[{diagnostic.code.id}]")
    lines = [f"{place}{label}: {diagnostic.message}", *diagnostic.excerpt]
    if diagnostic.hint:
        lines.append(f"  {paint('1;32', 'hint')}: {diagnostic.hint}")
    return "\n".join(lines)


def paint(style: str, text: str) -> str:
    """The text in an ANSI style."""
    return f"\x1b[{style}m{text}\x1b[0m"


def is_coloured(stream: TextIO) -> bool:
    """Colour on a terminal only, and never where NO_COLOR is set (https://no-color.org)."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


# ---- losses ------------------------------------------------------------------------------------------------------------

_FATES = ("dropped", "approximated", "carried")
_KINDS = ("mechanism", "body", "joint", "loop", "coupling", "tendon", "actuator", "drive", "sensor", "shape", "contact", "frame")
"""What a robot is, before what it looks like and what stands in comments."""

_PLACE = re.compile(r"\[\d+\]")
_WORDS = 40


def show_losses(losses: Sequence[Loss]) -> None:
    """Print the ledger to standard error: elements of one kind together, the worst first, and long lists are cut."""
    groups = list(loss_lines(losses))
    for line in groups[:MOST_LINES]:
        print(line, file=sys.stderr)
    if len(groups) > MOST_LINES:
        print(f"... and {len(groups) - MOST_LINES} more kinds of losses", file=sys.stderr)
    if len(groups) < len(losses) or len(groups) > MOST_LINES:
        print(f"{len(losses)} losses in all; --report FILE.json lists each", file=sys.stderr)


def loss_lines(losses: Sequence[Loss]) -> Iterator[str]:
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
    text = ", ".join([*shown, *more])
    text = f"nothing -> {text}" if first.before is None else f"{text} -> nothing" if first.after is None else text
    return f"{place}loss: {len(losses)} x {f'{kind} {field}'.rstrip()} {fate}: {text}"


def _example(loss: Loss) -> str:
    """The name of the element and what became of it; what the mechanism itself has goes by its first words."""
    name = loss.element.partition(" ")[2]
    if loss.before is not None and loss.after is not None:
        return f"{name} {loss.change}".strip()
    return name or shorten(loss.before or loss.after or "", _WORDS, placeholder="...")
