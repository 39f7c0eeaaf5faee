"""`hymeko-x dh FILE`: Denavit-Hartenberg tables of every chain, or of the one to a body."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING

from hymeko_x.assets.resolve import search_path
from hymeko_x.cli import exits
from hymeko_x.cli.inputs import input_arguments

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from hymeko_x.verify.dh import Table

_EXACT = 1e-9
_DUST = 1e-9  # in rad and m; --json has all digits


def dh_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `dh`."""
    parser.add_argument("input", metavar="FILE", help="a robot in any format")
    conventions = ("standard", "modified", "hayati")
    parser.add_argument("--convention", choices=conventions, default="standard", help="how the numbers are grouped (default standard)")
    parser.add_argument("--tip", metavar="BODY", help="the body at the end of the chain (default: every chain's end)")
    parser.add_argument("--check", action="store_true", help="compare the tables' kinematics with Pinocchio's; exit 4 beyond 1e-9")
    parser.add_argument("--json", action="store_true", help="print JSON")
    input_arguments(parser)


def run_dh(chosen: argparse.Namespace) -> int:
    """Print one table per chain: a row per joint between two constant transformations. Angles in rad, lengths in m."""
    from hymeko_x.verify import dh, model_of

    model = model_of(chosen.input, packages=dict(chosen.package), search_path=search_path(os.environ), arguments=dict(chosen.arg))
    tips = [chosen.tip] if chosen.tip else [tip for tip in dh.chains(model) if dh.chain(model, tip)[1]]
    tables = [dh.table(model, tip, dh.Convention(chosen.convention)) for tip in tips or [None]]
    errors = [dh.error_against_pinocchio(model, table) if chosen.check else None for table in tables]
    if chosen.json:
        print(json.dumps([as_json(table, error) for table, error in zip(tables, errors, strict=True)], indent=2, ensure_ascii=False))
    else:
        for table, error in zip(tables, errors, strict=True):
            print("\n".join(lines(table, error)), end="\n\n")
    return exits.DIFFERENT if any(error is not None and not error <= _EXACT for error in errors) else exits.DONE


def lines(table: Table, error: float | None = None) -> Iterator[str]:
    """A table as text. The link of a standard row lies behind its joint, that of a modified row before it."""
    tilted = any(row.beta for row in table.rows)
    shifted = table.convention.value == "modified"
    a, alpha = ("a_i-1", "alpha_i-1") if shifted else ("a_i", "alpha_i")
    yield f"{table.start} -> {table.tip} ({table.convention.value})"
    yield f"  {'joint':<24} {'theta':>16} {'d':>16} {a:>12} {alpha:>12}" + (f" {'beta':>12}" if tilted else "")
    for row in table.rows:
        theta, d = (_moving("q", row.theta), _text(row.d)) if row.kind.value != "slide" else (_text(row.theta), _moving("q", row.d))
        beta = f" {_text(row.beta):>12}" if tilted else ""
        yield f"  {row.joint:<24} {theta:>16} {d:>16} {_text(row.a):>12} {_text(row.alpha):>12}{beta}"
    for name, constant in (("base", table.base), ("tool", table.tool)):
        yield from _matrix_lines(name, constant.tolist())
    if error is not None:
        yield f"  largest difference from Pinocchio: {error:.3g}"


def as_json(table: Table, error: float | None) -> dict[str, object]:
    """A table with all digits."""
    rows = [
        {"joint": row.joint, "kind": row.kind.value, "theta": row.theta, "d": row.d, "a": row.a, "alpha": row.alpha, "beta": row.beta}
        for row in table.rows
    ]
    ends = {"from": table.start, "to": table.tip, "convention": table.convention.value}
    constants = {"base": table.base.tolist(), "tool": table.tool.tolist()}
    return {**ends, "rows": rows, **constants, **({} if error is None else {"error": error})}


def _moving(letter: str, offset: float) -> str:
    """The coordinate plus its offset."""
    text = _text(offset)
    if text == "0":
        return letter
    return f"{letter} {text[0]} {text[1:]}" if text.startswith("-") else f"{letter} + {text}"


def _text(value: float) -> str:
    """Seven digits; dust from rounding is zero."""
    return f"{0.0 if abs(value) < _DUST else value:.7g}"


def _matrix_lines(name: str, rows: list[list[float]]) -> Iterator[str]:
    if all(abs(value - (i == k)) < _DUST for i, row in enumerate(rows) for k, value in enumerate(row)):
        yield f"  {name}: identity"
        return
    for number, row in enumerate(rows[:3]):
        label = f"{name}:" if number == 0 else ""
        yield f"  {label:<6}" + "".join(f"{_text(value):>14}" for value in row)
