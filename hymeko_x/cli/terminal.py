"""Diagnostics for people: text on standard error, in colour where a terminal shows it."""

from __future__ import annotations

import os
import re
import sys
from typing import TYPE_CHECKING, TextIO

from hymeko_x.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterable

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
        said = (diagnostic.code.id, _NAMES.sub("", diagnostic.message)) if is_note else number
        groups.setdefault(said, []).append(diagnostic)
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
