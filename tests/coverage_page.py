"""Write docs/coverage.md from what `make coverage` measured: the figure, and every line that no test runs, with the reason.

``python -m tests.coverage_page coverage.json docs/coverage.md`` ends with 1 where the figure fell by more than 0.2 points.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterable
from itertools import groupby
from pathlib import Path
from typing import Any

REASONS: dict[str, str] = {
    "hymeko_x/frontends/xacro/child/": "runs in a process with limits of its own, in which nothing measures",
    "hymeko_x/frontends/mjcf_child.py": "runs in a process with limits of its own, in which nothing measures",
    "hymeko_x/verify/readers/sdf/": "runs in the process of Drake's reader, which ends without the handlers that save what was measured",
    "hymeko_x/verify/readers/apart.py": "serves in the process of a reader, which ends without the handlers that save what was measured",
    "hymeko_x/draw/view/": "answers to a browser: the tests that drive one are `full`",
}
"""Why lines of a file, or of a folder, are not covered; the most specific entry counts."""
UNKNOWN = ""
ALLOWED = 0.2
"""How many points a measurement may be below the last one: some tests depend on the machine."""

_HEAD = """\
# Coverage

Written by `make coverage`. {percent:.1f} % of {statements:,} statements are run by `make test`; these are not:

| file | covered | lines that no test runs | reason |
|---|---|---|---|
"""


def page(measured: dict[str, Any]) -> str:
    """The page of a measurement (`coverage json`)."""
    totals = measured["totals"]
    rows = [
        f"| {path} | {file['summary']['percent_covered']:.0f} % | {', '.join(spans(file['missing_lines']))} | {reason(path)} |\n"
        for path, file in sorted(measured["files"].items())
        if file["missing_lines"]
    ]
    return _HEAD.format(percent=totals["percent_covered"], statements=totals["num_statements"]) + "".join(rows)


def spans(lines: Iterable[int]) -> list[str]:
    """Line numbers as ranges: ``3-5``, ``9``."""
    runs = [[line for _, line in run] for _, run in groupby(enumerate(lines), lambda item: item[1] - item[0])]
    return [f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs]


def reason(path: str) -> str:
    """Why lines of a file are not covered, as far as it is known."""
    return max(((start, text) for start, text in REASONS.items() if path.startswith(start)), default=("", UNKNOWN))[1]


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
