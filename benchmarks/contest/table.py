"""The table of docs/speed.md: how many times as long as hymeko-x everybody takes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.contest.rows import CALL, PROCESS, TEXT
from hymeko_x.corpus.report import table
from hymeko_x.reporting.blocks import renewed_blocks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from benchmarks.contest.rows import Row

BY = "make bench"


def page(text: str, rows: Sequence[Row]) -> str:
    """The page with the tables of these results in its block. Raises: ValueError when it has none."""
    return renewed_blocks(text, BY, lambda name: _content(name, rows))


def _content(name: str, rows: Sequence[Row]) -> str:
    if name != "speed":
        raise ValueError(f"nobody knows what '{name}' is; known: speed")
    notes: list[str] = []
    ways = list(dict.fromkeys(row.way for row in rows))
    tables = [_way([row for row in rows if row.way == way], notes) for way in ways]
    return "\n\n".join([*tables, *([_notes(notes)] if notes else [])])


def _way(rows: Sequence[Row], notes: list[str]) -> str:
    """One table: the first program in seconds and megabytes, the others as multiples of it."""
    columns = list(dict.fromkeys((row.robot, row.kind, amount) for row in rows for amount in _amounts(row)))
    first = {(row.robot, row.kind): row for row in rows if row.program == rows[0].program}
    lines = []
    for program in dict.fromkeys(row.program for row in rows):
        own = {(row.robot, row.kind): row for row in rows if row.program == program}
        cells = [_cell(own.get((robot, kind)), first.get((robot, kind)), amount, notes) for robot, kind, amount in columns]
        lines.append([f"{program} {next(iter(own.values())).version}".strip(), *cells])
    return table([rows[0].way, *(_head(*column) for column in columns)], lines)


def _amounts(row: Row) -> tuple[str, ...]:
    return {CALL: ("seconds",), PROCESS: ("seconds", "megabytes"), TEXT: ("speed",)}[row.kind]


def _head(robot: str, kind: str, amount: str) -> str:
    if kind == PROCESS:
        return f"{robot}: process" if amount == "seconds" else f"{robot}: memory"
    return robot


def _cell(row: Row | None, unit: Row | None, amount: str, notes: list[str]) -> str:
    if row is None:
        return ""
    if row.seconds is None:
        return _noted(row, notes)
    if amount == "speed":
        return f"{(row.megabytes or 0.0) / row.seconds:.2f} MB/s"
    own, ours = (row.seconds, unit and unit.seconds) if amount == "seconds" else (row.megabytes, unit and unit.megabytes)
    if row is unit or not ours or own is None:
        return _absolute(own or 0.0, amount)
    return f"{own / ours:.2g} x" if own < 100.0 * ours else f"{own / ours:.0f} x"


def _absolute(number: float, amount: str) -> str:
    if amount == "megabytes":
        return f"{number:.0f} MB"
    return f"{number * 1e3:.3g} ms" if number < 1.0 else f"{number:.3g} s"


def _noted(row: Row, notes: list[str]) -> str:
    """The number of the note that says why there is no result."""
    reason = f"{row.program}: {row.reason}"
    if reason not in notes:
        notes.append(reason)
    return f"none ({notes.index(reason) + 1})"


def _notes(notes: Sequence[str]) -> str:
    return "\n".join(f"{number}. {note}" for number, note in enumerate(notes, start=1))
