"""The numbers in prose: every page has its blocks between two marks, and the results of a run are what stands in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.corpus import statistics
from hymeko_x.corpus.lost import losses
from hymeko_x.corpus.report import matrix, table
from hymeko_x.corpus.statistics import FOUND, PRINTED, percentage
from hymeko_x.reporting.blocks import renewed_blocks

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import polars as pl

    from hymeko_x.corpus.rows import Tables
    from hymeko_x.corpus.statistics import Shortness

ENOUGH = 99.0
"""What percentage of the accepted files each pair of formats should bring over."""

_MILLION = 1_000_000
_DOLLARS_PER_HOUR = 0.04
"""What one core costs in an hour where computers are let, roughly."""


def renewed(text: str, tables: Tables, pace: pl.DataFrame | None = None) -> str:
    """A page with what the results say in each of its blocks. ``pace`` is the table of ``benchmarks/pace.py``.

    Raises: ValueError when it has no block, or one that is not known.
    """
    return renewed_blocks(text, "hymeko-x corpus stats", lambda name: _content(name, tables, pace))


def _content(name: str, tables: Tables, pace: pl.DataFrame | None) -> str:
    if name == "pace":
        return _pace(pace)
    if name not in _WRITERS:
        raise ValueError(f"there is no block '{name}'; known: {', '.join((*_WRITERS, 'pace'))}")
    return _WRITERS[name](tables)


# ---- robots ----------------------------------------------------------------------------------------------------------


def _pairs(tables: Tables) -> str:
    return f"{matrix(statistics.pair_rows(tables))}\n\nMeasured on {len(tables.robots)} files."


def _summary(tables: Tables) -> str:
    """The run in four sentences."""
    robots, rows = tables.robots, statistics.pair_rows(tables)
    accepted = len(robots.filter(robots["engine"] == "done"))
    asked, same = sum(row.accepted for row in rows), sum(row.same for row in rows)
    whole = len(robots.filter(robots["engine"] == "done")) - statistics.failures(tables)["key"].n_unique()
    poor = [f"{row.source} -> {row.target} ({row.share})" for row in rows if row.accepted and row.percent < ENOUGH]
    below = f"Below {ENOUGH:g} %: {', '.join(poor)}." if poor else f"No pair of formats is below {ENOUGH:g} %."
    return (
        f"{len(robots)} files, of which the reference readers accept {accepted}. Of {asked} conversions of accepted files {same} give the "
        f"same robot ({percentage(same, asked)}); {whole} files are the same robot in every format ({percentage(whole, accepted)}). {below}"
    )


def _failures(tables: Tables) -> str:
    """Every case, one line for each file and cause."""
    found = statistics.failures(tables)
    if found.is_empty():
        return "There is none."
    grouped: dict[tuple[str, str], list[str]] = {}
    for key, _, target, cause in found.rows():
        grouped.setdefault((key, cause), []).append(target)
    return table(["file", "into", "cause"], [[key, ", ".join(targets), cause] for (key, cause), targets in grouped.items()])


# ---- lengths ---------------------------------------------------------------------------------------------------------


def _claims(tables: Tables) -> str:
    """The paper's figures, and those of real robots."""
    short = {(row.source, row.format, row.state): row for row in statistics.shortness(tables, ("code",))}
    lines = []
    for format, claimed in ((format.name, format.claimed_reduction) for format in formats.FORMATS):
        row = short.get((format, format, FOUND))
        if row is None or claimed is None:
            continue
        measured = f"{row.median:.1f} % ({row.low:.1f} to {row.high:.1f})"
        lines.append(
            [format.upper(), f"about {claimed:g} %", measured, f"{row.reduction_of_sums:.1f} %", str(row.robots), _agrees(row, claimed)]
        )
    return table(["shorter than", "paper", "median robot", "all together", "robots", "the paper's figure is"], lines)


def _agrees(row: Shortness, claimed: float) -> str:
    if row.high < claimed:
        return "too high"
    return "too low" if row.low > claimed else "within the interval"


def _shorter(tables: Tables) -> str:
    """HyMeKo against the formats that hold the same content."""
    lines = [
        [
            row.source,
            f"{row.format} {row.state}",
            str(row.robots),
            str(row.shorter),
            f"{row.median:.1f} % ({row.low:.1f} to {row.high:.1f})",
            f"{row.reduction_of_sums:.1f} %",
            f"{row.p:.1g}",
            f"{row.effect:.2f}",
        ]
        for row in statistics.shortness(tables, ("code",))
        if row.state == FOUND or (row.state == PRINTED and not formats.by_name(row.format).holds_points)
    ]
    head = ["found in", "compared with", "robots", "HyMeKo is shorter for", "reduction, median", "of the sums", "p", "effect"]
    return table(head, lines)


# ---- costs -----------------------------------------------------------------------------------------------------------


def _costs(tables: Tables) -> str:
    """What a file costs, and its dearest steps."""
    files, seconds = _spent(tables)
    most = float(tables.costs["megabytes"].max() or 0.0)  # type: ignore[arg-type]
    steps = sorted(statistics.steps(tables).select("step", "processor").rows(), key=lambda row: (-row[1], row[0]))[:4]
    lines = [
        ["files", str(files)],
        ["processor time per file", f"{seconds / files:.2f} s"],
        *([f"of that: {step}", f"{total / files:.2f} s"] for step, total in steps),
        ["most memory of one process", f"{most:.0f} MB"],
    ]
    return table(["", ""], lines)


def _million(tables: Tables) -> str:
    """A million robots at the measured cost, on machines of several sizes."""
    files, seconds = _spent(tables)
    hours = _MILLION * seconds / files / 3600.0
    cores = (2, 64, 1000)
    lines = [
        ["robots per second", *(f"{count * files / seconds:.3g}" for count in cores)],
        ["a million robots, verified", *(_duration(hours / count) for count in cores)],
        ["processor hours", *(f"{hours:.0f}" for _ in cores)],
        [f"at {_DOLLARS_PER_HOUR:g} USD per core and hour", *(f"{hours * _DOLLARS_PER_HOUR:.0f} USD" for _ in cores)],
    ]
    return table(["", *(f"{count:,} cores" for count in cores)], lines)


def _spent(tables: Tables) -> tuple[int, float]:
    return max(1, len(tables.robots)), float(tables.costs["processor"].sum()) or 1e-9


def _duration(hours: float) -> str:
    return f"{hours / 24.0:.1f} days" if hours >= 48.0 else f"{hours:.1f} hours"


def _pace(pace: pl.DataFrame | None) -> str:
    """Robots per second by engine and number of workers."""
    if pace is None:
        return "Not measured yet: `python -m benchmarks.pace` does."
    alone = {row["engine"]: row["robots_per_second"] for row in pace.iter_rows(named=True) if row["workers"] == 1}
    lines = [
        [
            str(row["engine"]),
            str(row["workers"]),
            str(row["files"]),
            f"{row['seconds']:.1f} s",
            f"{row['robots_per_second']:.3f}",
            f"{row['robots_per_second'] / alone[row['engine']]:.2f}" if row["engine"] in alone else "",
        ]
        for row in pace.iter_rows(named=True)
    ]
    return table(["engine", "workers", "files", "time", "robots/s", "times one worker"], lines)


_WRITERS: Mapping[str, Callable[[Tables], str]] = {
    "pairs": _pairs,
    "summary": _summary,
    "failures": _failures,
    "claims": _claims,
    "shorter": _shorter,
    "costs": _costs,
    "million": _million,
    "losses": losses,
}
