"""Diagnostics for people: text on standard error, in colour where a terminal shows it."""

from __future__ import annotations

import os
import re
import sys
from typing import TYPE_CHECKING, TextIO

from msgspec.structs import replace

from hymeko_x.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

MOST_LINES = 40
"""How many kinds of diagnostics of one severity are shown; a summary counts the rest. `--report` has them all."""
_MOST_PLACES = 8
_ALL = "(--report FILE.json lists all)"
_VARIABLE = re.compile(r"'[^']*'|[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
"""What differs between diagnostics that are alike: names and numbers."""

_COLOURS = {Severity.NOTE: "36", Severity.WARNING: "33", Severity.ERROR: "31"}


def show(diagnostics: Iterable[Diagnostic], stream: TextIO | None = None) -> None:
    """Print diagnostics to standard error: one of those that are alike stands for all, with their lines, and long lists are cut."""
    stream = sys.stderr if stream is None else stream
    coloured = is_coloured(stream)
    room = dict.fromkeys(Severity, MOST_LINES)
    left = dict.fromkeys(Severity, 0)
    for alike in alike_diagnostics(diagnostics):
        severity = alike[0].severity
        if room[severity]:
            room[severity] -= 1
            print(render_alike(alike, coloured), file=stream)
        else:
            left[severity] += len(alike)
    for severity, count in left.items():
        if count:
            print(f"... and {count} more of severity {severity.value} {_ALL}", file=stream)


def alike_diagnostics(diagnostics: Iterable[Diagnostic]) -> list[list[Diagnostic]]:
    """Diagnostics that only differ in names and numbers together, where the first of them was made."""
    groups: dict[tuple[str, Severity, str], list[Diagnostic]] = {}
    for diagnostic in diagnostics:
        groups.setdefault((diagnostic.code.id, diagnostic.severity, _VARIABLE.sub("", diagnostic.message)), []).append(diagnostic)
    return list(groups.values())


def render_alike(alike: Sequence[Diagnostic], coloured: bool) -> str:
    """The first of diagnostics that are alike, with the number of the others and their lines."""
    first, *others = alike
    if not others:
        return render(first, coloured)
    places = list(dict.fromkeys(_place(diagnostic, first) for diagnostic in others if diagnostic.origin and diagnostic.origin.line))
    shown = [*places[:_MOST_PLACES], *(["..."] if len(places) > _MOST_PLACES else [])]
    lines = f": line{'s' if len(places) > 1 else ''} {', '.join(shown)}" if places else ""
    return render(replace(first, message=f"{first.message} ({len(others)} more alike{lines})"), coloured)


def _place(diagnostic: Diagnostic, first: Diagnostic) -> str:
    """The line; with its file where that is another one than the first diagnostic's."""
    origin = diagnostic.origin
    assert origin is not None
    return str(origin.line) if first.origin and origin.file == first.origin.file else f"{origin.file}:{origin.line}"


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
    """Colour on a terminal only, or where FORCE_COLOR is set, and never where NO_COLOR is set (https://no-color.org)."""
    if os.environ.get("FORCE_COLOR"):
        return not os.environ.get("NO_COLOR")
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
