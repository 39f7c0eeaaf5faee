"""The results: one row for every program, way, robot and kind of measurement, kept as CSV."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import asdict

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

RESULTS = Path(__file__).parents[1] / "results/contest.csv"

CALL = "call"
"""Processor time of one call in a process that has done it before."""

PROCESS = "process"
"""Processor time and peak memory of a process that does it once, with its start and its imports."""

TEXT = "text"
"""Processor time of reading or printing so many megabytes of text."""


class Row(Struct, frozen=True):
    """Medians; ``seconds`` is None when there is no result, and ``reason`` says why."""

    way: str
    program: str
    version: str
    robot: str
    kind: str
    seconds: float | None = None
    megabytes: float | None = None
    reason: str = ""


def as_csv(rows: Sequence[Row]) -> str:
    """The rows as text; numbers have as many digits as mean something."""
    out = io.StringIO()
    writer = csv.DictWriter(out, Row.__struct_fields__, lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({**asdict(row), "seconds": _written(row.seconds), "megabytes": _written(row.megabytes)})
    return out.getvalue()


def from_csv(text: str) -> tuple[Row, ...]:
    """What `as_csv` wrote."""
    return tuple(_row(line) for line in csv.DictReader(io.StringIO(text)))


def _row(line: Mapping[str, str]) -> Row:
    seconds, megabytes = _read(line["seconds"]), _read(line["megabytes"])
    return Row(line["way"], line["program"], line["version"], line["robot"], line["kind"], seconds, megabytes, line["reason"])


def _written(number: float | None) -> str:
    return "" if number is None else f"{number:.4g}"


def _read(text: str) -> float | None:
    return float(text) if text else None
