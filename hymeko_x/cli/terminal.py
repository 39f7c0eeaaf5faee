"""Diagnostics for people: text on standard error, in colour where a terminal shows it."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, TextIO

from hymeko_x.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterable

MOST_LINES = 40
"""How many diagnostics of one severity are shown; a summary names the rest. `--report` has them all."""

_COLOURS = {Severity.NOTE: "36", Severity.WARNING: "33", Severity.ERROR: "31"}


def show(diagnostics: Iterable[Diagnostic], stream: TextIO | None = None) -> None:
    """Print diagnostics, the worst kinds in full and long lists cut, to standard error."""
    stream = sys.stderr if stream is None else stream
    coloured = is_coloured(stream)
    shown = dict.fromkeys(Severity, 0)
    for diagnostic in diagnostics:
        shown[diagnostic.severity] += 1
        if shown[diagnostic.severity] <= MOST_LINES:
            print(render(diagnostic, coloured), file=stream)
    for severity, count in shown.items():
        if count > MOST_LINES:
            print(f"... and {count - MOST_LINES} more of severity {severity.value} (--report FILE.json lists all)", file=stream)


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
