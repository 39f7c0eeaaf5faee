"""The report of a run: Markdown with the tables, the tables as CSV and Parquet, and the figures."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from msgspec.structs import asdict

from hymeko_x.corpus import statistics
from hymeko_x.corpus.figures import figures
from hymeko_x.corpus.statistics import MEASURES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import polars as pl

    from hymeko_x.corpus.rows import Tables
    from hymeko_x.corpus.statistics import PairRow, Shortness

_WORDS = {"characters": "characters", "code": "characters without comments", "bytes": "bytes", "tokens": "tokens", "gzip": "gzip bytes"}


def files_of(tables: Tables) -> Iterator[tuple[str, bytes]]:
    """Every file of the report as (name, content)."""
    import polars as pl

    short = statistics.shortness(tables)
    rows = statistics.pair_rows(tables)
    frames = {
        "shortness": pl.DataFrame([asdict(row) for row in short]),
        "pairs": pl.DataFrame([{**asdict(row), "percent": row.percent} for row in rows]),
        "lost": statistics.kinds(tables, "lost"),
        "diagnostics": statistics.kinds(tables, "diagnostics"),
        "differences": statistics.kinds(tables, "failed"),
        "failures": statistics.failures(tables),
        **{f"lengths_{measure}": statistics.lengths_of(tables, measure) for measure in MEASURES},
    }
    yield "report.md", _report(tables, short, rows).encode()
    for name, frame in frames.items():
        yield f"{name}.csv", frame.write_csv(float_precision=6).encode()
        yield f"{name}.parquet", _parquet(frame)
    yield from figures(tables)


def matrix(rows: Sequence[PairRow]) -> str:
    """The pairs as a Markdown table: of the files that the reference reader accepts, how many are the same robot, and how many complete."""
    sources, targets = (sorted({getattr(row, side) for row in rows}) for side in ("source", "target"))
    cells = {(row.source, row.target): f"{row.same} of {row.accepted} ({row.share}), {row.exact} complete" for row in rows}
    lines = [["from \\ into", *targets], ["---"] * (len(targets) + 1)]
    lines += [[source, *(cells.get((source, target), "") for target in targets)] for source in sources]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _parquet(frame: pl.DataFrame) -> bytes:
    buffer = io.BytesIO()
    frame.write_parquet(buffer, compression="zstd", statistics=False)
    return buffer.getvalue()


def _report(tables: Tables, short: Sequence[Shortness], rows: Sequence[PairRow]) -> str:
    robots = tables.robots
    accepted = len(robots.filter(robots["engine"] == "done"))
    same, asked = sum(row.same for row in rows), sum(row.accepted for row in rows)
    share = f"{100.0 * same / asked:.1f} %" if asked else "none"
    parts = [
        "# What a batch run measured",
        f"{len(robots)} files, {len(robots.filter(robots['status'] == 'done'))} read, "
        f"{accepted} accepted by the reference reader of their format.",
        f"Of {asked} conversions of accepted files {same} give the same robot ({share}).",
        "## Pairs of formats",
        "Of the files that the reference reader of the source accepts, those that convert into the same robot as far as both formats can "
        "say, and of these the complete ones: the target's own words say everything.",
        matrix(rows),
        table(_PAIR_HEAD, _pair_lines(rows)),
        "*all in its words*: the same robots of which the target says everything natively; *all*: those that have everything with what "
        "is kept beside them for the way back; *not in its words*: the median number of fields and elements that are only kept.",
        "## Lengths (the paper's table 4)",
        "Characters without white space and comments; mean and standard deviation, of the robots that were found in each format.",
        table(["found in", "robots", "HyMeKo", "compared with", "length"], _length_lines(short)),
        "## Is HyMeKo shorter? (the paper's table 5)",
        "Reduction in percent of the other format's length: of the sums, and the median over robots with its 95 % bootstrap interval; "
        "one-sided Wilcoxon signed-rank test; effect: rank-biserial correlation.",
        *(part for measure in MEASURES for part in (f"### In {_WORDS[measure]}", table(_SHORT_HEAD, _short_lines(short, measure)))),
        "## What a format's own words do not say",
        "It is left out, or with `--keep` stands beside the file and comes back.",
        table(["from", "into", "kind", "robots"], _top(statistics.kinds(tables, "lost"), 5)),
        "## In what results differ",
        table(["from", "into", "quantity", "robots"], _top(statistics.kinds(tables, "failed"), 5)),
        *_unrepresented(tables),
        "## Every accepted file that is not the same",
        table(["file", "from", "into", "cause"], statistics.failures(tables).rows()),
        "## Figures",
        *(f"![{name}]({name}.svg)" for name in ("pairs", "lengths", "ratios", "sizes")),
    ]
    return "\n\n".join(parts) + "\n"


def _unrepresented(tables: Tables) -> list[str]:
    """What engines see in one file and the other cannot represent, where the run asked for it."""
    if "unsaid" not in tables.legs.columns:
        return []
    head = "## What a format cannot say of the other robot, as the engines see it"
    return [head, table(["from", "into", "quantity", "robots"], _top(statistics.kinds(tables, "unsaid"), 5))]


_PAIR_HEAD = ["from", "into", "accepted", "converted", "same", "different", "not comparable", "all in its words", "all", "not in its words"]
_SHORT_HEAD = ["found in", "compared with", "robots", "shorter", "sums", "median", "95 %", "p", "effect"]


def table(head: Sequence[str], lines: Sequence[Sequence[Any]]) -> str:
    """A table in Markdown."""
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows)


def _pair_lines(rows: Sequence[PairRow]) -> list[list[str]]:
    counts = ("accepted", "converted", "same", "different", "not_comparable", "exact", "complete")
    return [[row.source, row.target, *(str(getattr(row, name)) for name in counts), f"{row.losses:g}"] for row in rows]


def _length_lines(short: Sequence[Shortness]) -> list[list[str]]:
    return [
        [
            row.source,
            str(row.robots),
            f"{row.hymeko_mean:.0f} ± {row.hymeko_deviation:.0f}",
            f"{row.format} {row.state}",
            f"{row.mean:.0f} ± {row.deviation:.0f}",
        ]
        for row in short
        if row.measure == "code"
    ]


def _short_lines(short: Sequence[Shortness], measure: str) -> list[list[str]]:
    return [
        [
            row.source,
            f"{row.format} {row.state}",
            str(row.robots),
            str(row.shorter),
            f"{row.reduction_of_sums:.1f} %",
            f"{row.median:.1f} %",
            f"{row.low:.1f} to {row.high:.1f}",
            f"{row.p:.2g}",
            f"{row.effect:.2f}",
        ]
        for row in short
        if row.measure == measure
    ]


def _top(frame: pl.DataFrame, count: int) -> list[tuple[Any, ...]]:
    """The most frequent kinds of each pair."""
    return frame.group_by("source", "target", maintain_order=True).head(count).select("source", "target", "kind", "robots").rows()


def costs_page(tables: Tables) -> str:
    """What the run cost, as Markdown: measurements, which no two runs share."""
    steps = statistics.steps(tables)
    files = max(1, len(tables.robots))
    total = float(tables.costs["processor"].sum())
    return (
        "\n\n".join(
            [
                "# What the run cost",
                f"{files} files took {total:.0f} s of processor time, {total / files:.2f} s each; "
                f"the most memory of one process was {float(tables.costs['megabytes'].max() or 0):.0f} MB.",  # type: ignore[arg-type]
                table(steps.columns, steps.rows()),
                "The slowest files:",
                table(["file", "processor", "megabytes", "step"], statistics.slowest(tables).rows()),
            ]
        )
        + "\n"
    )
