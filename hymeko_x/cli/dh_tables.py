"""Denavit-Hartenberg tables as people and programs want them: text, Markdown, LaTeX, CSV, JSON."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from hymeko_x.verify.dh import DhRow, Table
    from hymeko_x.verify.dh.lines import DhLink

    Checked = tuple[Table, float | None]

_DUST = 1e-9
"""Below this, in rad and m, a number is rounding and printed as 0; CSV and JSON have all digits."""
_PARTS_OF_PI = sorted({Fraction(n, k) for k in (1, 2, 3, 4, 6) for n in range(1, 2 * k + 1)})
_LATEX_SPECIAL = re.compile(r"([_&%#$])")


class PrintedLine(NamedTuple):
    """A row as it is printed: its name, and theta, d, a, alpha and beta in the words of a style."""

    name: str
    values: tuple[str, ...]


def text(tables: Sequence[Checked]) -> str:
    """Aligned columns; the link of a standard row lies behind its joint, that of a modified row before it."""
    return "".join("\n".join(_text_lines(table, error)) + "\n\n" for table, error in tables)


def _text_lines(table: Table, error: float | None) -> Iterator[str]:
    yield _title(table)
    a, alpha = ("a_i-1", "alpha_i-1") if table.convention.value == "modified" else ("a_i", "alpha_i")
    yield _columns("joint", ("theta", "d", a, alpha, "beta")[: _width(table)])
    yield from (_columns(line.name, line.values) for line in _lines(table, plain))
    if error is not None:
        yield f"  largest difference from Pinocchio: {error:.3g}"


def _columns(name: str, values: Sequence[str]) -> str:
    return f"  {name:<24}" + "".join(f" {value:>{width}}" for value, width in zip(values, (16, 16, 12, 12, 12), strict=False))


def markdown(tables: Sequence[Checked]) -> str:
    """One table per chain; angles in rad, lengths in m."""
    out = []
    for table, _ in tables:
        shift = "<sub>i-1</sub>" if table.convention.value == "modified" else "<sub>i</sub>"
        head = ["joint", "theta<sub>i</sub>", "d<sub>i</sub>", f"a{shift}", f"alpha{shift}", f"beta{shift}"][: _width(table) + 1]
        lines = [[line.name.replace("|", "\\|"), *line.values] for line in _lines(table, plain)]
        cells = [head, ["---", *["---:"] * _width(table)], *lines]
        out.append(f"**{_title(table)}**\n\n" + "".join(f"| {' | '.join(row)} |\n" for row in cells))
    return "\n".join(out)


def latex(tables: Sequence[Checked]) -> str:
    """One tabular per chain."""
    out = []
    for table, _ in tables:
        shift = "{i-1}" if table.convention.value == "modified" else "i"
        head = ["joint", r"$\theta_i$", "$d_i$", f"$a_{shift}$", rf"$\alpha_{shift}$", rf"$\beta_{shift}$"][: _width(table) + 1]
        lines = [[_LATEX_SPECIAL.sub(r"\\\1", line.name), *line.values] for line in _lines(table, in_latex)]
        rows = "".join(f"  {' & '.join(row)} \\\\\n" for row in lines)
        columns = f"l{'r' * _width(table)}"
        begin = f"% {_title(table)}\n\\begin{{tabular}}{{{columns}}}\n  {' & '.join(head)} \\\\ \\hline\n"
        out.append(f"{begin}{rows}\\end{{tabular}}\n")
    return "\n".join(out)


def as_csv(tables: Sequence[Checked]) -> str:
    """A line per row, with all digits: angles in rad, lengths in m. Base and tool are rows of the kind fixed."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(("chain", "convention", "joint", "kind", "theta", "d", "a", "alpha", "beta"))
    for table, _ in tables:
        for name, kind, row in _all_rows(table):
            ends = f"{table.start} -> {table.tip}"
            writer.writerow((ends, table.convention.value, name, kind, *(repr(value) for value in _numbers(row))))
    return out.getvalue()


def as_json(tables: Sequence[Checked]) -> str:
    """The tables with all digits, and base and tool as matrices too."""
    return json.dumps([_document(table, error) for table, error in tables], indent=2, ensure_ascii=False) + "\n"


def _document(table: Table, error: float | None) -> dict[str, object]:
    words = ("theta", "d", "a", "alpha", "beta")
    rows = [{"joint": row.joint, "kind": row.kind.value, **dict(zip(words, _numbers(row), strict=True))} for row in table.rows]
    constants = {"base": table.base.tolist(), "tool": table.tool.tolist()}
    printed = {
        name: [dict(zip(words, _numbers(row), strict=True)) for row in found]
        for name, found in (("base_rows", table.base_rows), ("tool_rows", table.tool_rows))
    }
    ends = {"from": table.start, "to": table.tip, "convention": table.convention.value}
    return {**ends, "rows": rows, **constants, **printed, **({} if error is None else {"error": error})}


FORMATS: dict[str, Callable[[Sequence[Checked]], str]] = {
    "text": text,
    "md": markdown,
    "latex": latex,
    "csv": as_csv,
    "json": as_json,
}
"""The styles of `dh --format`."""


# ---- rows ----------------------------------------------------------------------------------------------------------------


def _title(table: Table) -> str:
    return f"{table.start} -> {table.tip} ({table.convention.value})"


def _all_rows(table: Table) -> Iterator[tuple[str, str, DhRow | DhLink]]:
    """Base, joints and tool: name, kind and numbers."""
    yield from (("base", "fixed", row) for row in table.base_rows if not _is_dust(row))
    yield from ((row.joint, row.kind.value, row) for row in table.rows)
    yield from (("tool", "fixed", row) for row in table.tool_rows if not _is_dust(row))


def _numbers(row: DhRow | DhLink) -> tuple[float, float, float, float, float]:
    return row.theta + 0.0, row.d + 0.0, row.a + 0.0, row.alpha + 0.0, row.beta + 0.0  # no negative zeros


def _is_dust(row: DhRow | DhLink) -> bool:
    return all(abs(value) < _DUST for value in _numbers(row))


def _width(table: Table) -> int:
    """How many numbers a row has: five where links of nearly parallel axes have beta."""
    return 5 if any(abs(row.beta) > _DUST for _, _, row in _all_rows(table)) else 4


def _lines(table: Table, style: Callable[[float, bool], str]) -> Iterator[PrintedLine]:
    """The rows with their values as text; a coordinate is q plus its offset."""
    for name, kind, row in _all_rows(table):
        values = [style(row.theta, True), style(row.d, False), style(row.a, False), style(row.alpha, True), style(row.beta, True)]
        if kind != "fixed":
            moving = 1 if kind == "slide" else 0
            values[moving] = _moving(values[moving])
        yield PrintedLine(name, tuple(values[: _width(table)]))


def _moving(offset: str) -> str:
    """The coordinate plus its offset."""
    inside = offset.strip("$")
    sign, size = ("-", inside[1:]) if inside.startswith("-") else ("+", inside)
    moved = "q" if inside == "0" else f"q {sign} {size}"
    return f"${moved}$" if offset.startswith("$") else moved


def plain(value: float, is_angle: bool) -> str:
    """Seven digits; an angle that is a simple part of pi in all of them is written so: -pi/2."""
    part = _part_of_pi(value) if is_angle else None
    if part is None:
        return f"{0.0 if abs(value) < _DUST else value:.7g}"
    above = "pi" if abs(part.numerator) == 1 else f"{abs(part.numerator)}pi"
    return ("-" if part < 0 else "") + above + (f"/{part.denominator}" if part.denominator > 1 else "")


def in_latex(value: float, is_angle: bool) -> str:
    """The same as a formula."""
    part = _part_of_pi(value) if is_angle else None
    if part is None:
        return f"${plain(value, False)}$"
    above = r"\pi" if abs(part.numerator) == 1 else rf"{abs(part.numerator)}\pi"
    size = rf"\frac{{{above}}}{{{part.denominator}}}" if part.denominator > 1 else above
    return f"${'-' if part < 0 else ''}{size}$"


def _part_of_pi(value: float) -> Fraction | None:
    """The simple part of pi that an angle is in seven digits, if it is one."""
    part = next((part for part in _PARTS_OF_PI if f"{float(part) * math.pi:.7g}" == f"{abs(value):.7g}"), None)
    return None if part is None else part if value > 0 else -part
