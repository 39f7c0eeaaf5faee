"""Write docs/coverage.md from what `make coverage` measured: the figure, and every line that no test runs, with the reason.

Where a file has no reason as a whole, that of its lines is what they do, which their syntax shows.

``python -m tests.coverage_page coverage.json docs/coverage.md`` ends with 1 where the figure fell by more than 0.2 points.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Iterable, Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

REASONS: dict[str, str] = {
    "hymeko_x/frontends/xacro/child/": "runs in a process with limits of its own, in which nothing measures",
    "hymeko_x/frontends/mjcf/child.py": "runs in a process with limits of its own, in which nothing measures",
    "hymeko_x/verify/readers/sdf/": "runs in the process of Drake's reader, which ends without the handlers that save what was measured",
    "hymeko_x/verify/readers/apart.py": "serves in the process of a reader, which ends without the handlers that save what was measured",
    "hymeko_x/draw/view/": "answers to a browser: the tests that drive one are `full`",
}
"""Why lines of a file, or of a folder, are not covered; the most specific entry counts."""
_REPORTS = frozenset(("error", "note", "refuse", "warn"))
"""Functions that report what is wrong with the input."""
REFUSAL, FAILURE, BRANCH = KINDS = ("refusal", "failure", "branch")
_WHOLE = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
ALLOWED = 0.2
"""How many points a measurement may be below the last one: some tests depend on the machine."""

_HEAD = """\
# Coverage

Written by `make coverage`. {percent:.1f} % of {statements:,} statements are run by `make test`; these are not, as no test of it has the
input: a *refusal* raises or reports what is wrong with a file or a call, a *failure* follows an error of the system or of a library,
a *branch* is for input that is right and rare.

| file | covered | lines that no test runs |
|---|---|---|
"""


def page(measured: dict[str, Any]) -> str:
    """The page of a measurement (`coverage json`)."""
    totals = measured["totals"]
    rows = [
        f"| {path} | {file['summary']['percent_covered']:.0f} % | {lines_with_reason(path, file['missing_lines'])} |\n"
        for path, file in sorted(measured["files"].items())
        if file["missing_lines"]
    ]
    return _HEAD.format(percent=totals["percent_covered"], statements=totals["num_statements"]) + "".join(rows)


def lines_with_reason(path: str, lines: list[int]) -> str:
    """The lines of a file, behind the reason of the whole file, or else behind that of each."""
    whole = reason(path)
    if whole:
        return f"{whole}: {', '.join(spans(lines))}"
    kinds = kinds_of_lines(Path(path).read_text("utf-8"))
    found = {kind: [line for line in lines if kinds.get(line, BRANCH) == kind] for kind in KINDS}
    return "; ".join(f"{kind} {', '.join(spans(own))}" for kind, own in found.items() if own)


def kinds_of_lines(source: str) -> dict[int, str]:
    """What the lines of a module do, by number: of a line in several blocks, what the innermost one does."""
    found: dict[int, str] = {}
    for node, statement, is_refusal in _statements(ast.parse(source)):
        is_failure = isinstance(node, ast.ExceptHandler) or isinstance(statement, ast.ExceptHandler)
        kind = FAILURE if is_failure else REFUSAL if is_refusal or _reports(statement) else BRANCH
        for line in range(statement.lineno, (statement.end_lineno or statement.lineno) + 1):
            if found.get(line) != FAILURE:
                found[line] = kind
    return found


def _statements(tree: ast.AST) -> Iterator[tuple[ast.AST, ast.stmt | ast.ExceptHandler, bool]]:
    """Every statement, outer ones first, with what it stands in, and whether that is a block that reports something."""
    for node in ast.walk(tree):
        for name in ("body", "orelse", "finalbody", "handlers"):
            block = getattr(node, name, None)
            if isinstance(block, list):
                is_refusal = not isinstance(node, _WHOLE) and any(map(_reports, block))
                yield from ((node, statement, is_refusal) for statement in block)


def _reports(statement: ast.AST) -> bool:
    """Whether a statement raises an error, or reports what is wrong."""
    if isinstance(statement, ast.Raise):
        return True
    calls = [node.func for node in ast.walk(statement) if isinstance(node, ast.Call)] if isinstance(statement, ast.Expr) else []
    return any((call.attr if isinstance(call, ast.Attribute) else getattr(call, "id", "")) in _REPORTS for call in calls)


def spans(lines: Iterable[int]) -> list[str]:
    """Line numbers as ranges: ``3-5``, ``9``."""
    runs = [[line for _, line in run] for _, run in groupby(enumerate(lines), lambda item: item[1] - item[0])]
    return [f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs]


def reason(path: str) -> str:
    """Why lines of a file are not covered, as far as it is known."""
    return max(((start, text) for start, text in REASONS.items() if path.startswith(start)), default=("", ""))[1]


def figure(text: str) -> float:
    """The figure of a page; 0 where there is none."""
    found = re.search(r"([\d.]+) % of", text)
    return float(found[1]) if found else 0.0


def main(source: str, target: str) -> int:
    """Write the page."""
    before = figure(Path(target).read_text("utf-8")) if Path(target).exists() else 0.0
    text = page(json.loads(Path(source).read_text("utf-8")))
    Path(target).write_text(text, "utf-8")
    sys.stdout.write(f"{figure(text)} % of all statements are covered, {before} % before; see {target}\n")
    return int(figure(text) < before - ALLOWED)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
