"""The paper's questions asked of real robots: how long is each in each format, and is HyMeKo significantly shorter?

Source: Hajdu & Hegyi, Appl. Mech. 2025, 6(4), 74, section 5 and its tables 4 and 5.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hymeko_x import formats

if TYPE_CHECKING:
    import polars as pl

    from hymeko_x.corpus.rows import Tables

Numbers = NDArray[np.float64]

MEASURES = ("characters", "code", "bytes", "tokens", "gzip")
"""How long a text is: without white space, also without comments, in bytes, in tokens of its own lexer, and compressed."""

FOUND = "as found"
PRINTED = "as printed"
SEED = 74
DRAWS = 10_000
_BLOCK = 2_000_000
HYMEKO = formats.OWN.name
_LONGEST_PLACE = 160


class Shortness(Struct, frozen=True):
    """Whether HyMeKo is shorter than a format, for robots that were found in ``source``.

    ``reduction`` is in percent of the format's length: of the sums, and per robot as median with a bootstrap interval of 95 %.
    ``p`` is that of a one-sided Wilcoxon signed-rank test (HyMeKo is shorter), ``effect`` the matched-pairs rank-biserial
    correlation, from -1 (always longer) to 1 (always shorter).
    """

    source: str
    format: str
    state: str
    measure: str
    robots: int
    hymeko_mean: float
    hymeko_deviation: float
    mean: float
    deviation: float
    reduction_of_sums: float
    median: float
    low: float
    high: float
    shorter: int
    p: float
    effect: float


def lengths_of(tables: Tables, measure: str) -> pl.DataFrame:
    """One row per robot: its format, its length as it was found (None where other files belong to it), and in every format as
    it is printed."""
    import polars as pl

    printed = tables.legs.filter(pl.col("status") == "done").pivot(on="target", index="key", values=measure, aggregate_function="first")
    found = pl.when(pl.col("whole")).then(pl.col(measure)).alias("found")
    robots = tables.robots.filter(pl.col("status") == "done").select("key", "package", "format", found)
    return robots.join(printed, on="key", how="left").sort("key")


def shortness(tables: Tables, measures: tuple[str, ...] = MEASURES) -> tuple[Shortness, ...]:
    """HyMeKo against every format: in the robots' own format as found and as printed, and in every other one as printed."""
    results = []
    for measure in measures:
        frame = lengths_of(tables, measure)
        targets = [name for name in frame.columns if name not in ("key", "package", "format", "found", HYMEKO)]
        for source in sorted(set(frame["format"]) - {HYMEKO}):
            own = frame.filter(frame["format"] == source)
            columns = [(source, FOUND, "found"), *((target, PRINTED, target) for target in sorted(targets))]
            for format, state, column in columns:
                both = own.drop_nulls([HYMEKO, column])
                if len(both) >= 2:
                    results.append(_compare((source, format, state, measure), both[HYMEKO].to_numpy(), both[column].to_numpy()))
    return tuple(results)


def _compare(labels: tuple[str, str, str, str], hymeko: Numbers, other: Numbers) -> Shortness:
    ours, theirs = hymeko.astype(float), other.astype(float)
    reductions = 100.0 * (1.0 - ours / theirs)
    low, high = interval(reductions)
    p, effect = signed_rank(theirs - ours)
    return Shortness(
        *labels,
        len(ours),
        float(ours.mean()),
        float(ours.std(ddof=1)),
        float(theirs.mean()),
        float(theirs.std(ddof=1)),
        float(100.0 * (1.0 - ours.sum() / theirs.sum())),
        float(np.median(reductions)),
        low,
        high,
        int((ours < theirs).sum()),
        p,
        effect,
    )


def interval(values: Numbers) -> tuple[float, float]:
    """The 95 % bootstrap interval of the median (percentile method, 10,000 draws, fixed seed)."""
    generator = np.random.default_rng(SEED)
    block = max(1, _BLOCK // len(values))
    sizes = [min(block, DRAWS - done) for done in range(0, DRAWS, block)]
    medians = np.concatenate([np.median(generator.choice(values, (size, len(values))), axis=1) for size in sizes])
    return float(np.quantile(medians, 0.025)), float(np.quantile(medians, 0.975))


def signed_rank(differences: Numbers) -> tuple[float, float]:
    """The p-value of the one-sided Wilcoxon signed-rank test that differences are positive, and the rank-biserial correlation.

    Source: Wilcoxon 1945; Kerby 2014 for the correlation: (favourable - unfavourable rank sum) / total rank sum.
    """
    from scipy.stats import rankdata, wilcoxon

    changed = differences[differences != 0.0]
    if len(changed) == 0:
        return 1.0, 0.0
    ranks = rankdata(np.abs(changed))
    p = float(wilcoxon(changed, alternative="greater", method="approx").pvalue)
    return p, float((ranks[changed > 0].sum() - ranks[changed < 0].sum()) / ranks.sum())


# ---- pairs of formats ------------------------------------------------------------------------------------------------


class PairRow(Struct, frozen=True):
    """What became of the robots of one format in another one. Counted are those that the source's reference reader accepts.

    ``same`` are converted and, as the engines see them, the same robot; ``exact`` those of them of which the target's own words
    say everything; ``complete`` those that have everything with what the file carries. ``losses`` is the median of what those
    words do not say.
    """

    source: str
    target: str
    files: int
    accepted: int
    converted: int
    same: int
    different: int
    not_comparable: int
    exact: int
    complete: int
    losses: float

    @property
    def percent(self) -> float:
        """Of the accepted files those that converted into the same robot."""
        return 100.0 * self.same / self.accepted if self.accepted else 0.0

    @property
    def share(self) -> str:
        """The same as a text."""
        return percentage(self.same, self.accepted)


def percentage(part: int, whole: int) -> str:
    """A share rounded down to a tenth of a percent, so that only all is 100 %."""
    if part == whole or not whole:
        return "100 %" if whole else "none"
    return f"{1000 * part // whole / 10.0:.1f} %"


def _is_same() -> pl.Expr:
    """Whether the verdict is that the robots are the same, at least as far as a format can say."""
    import polars as pl

    return pl.col("verdict").str.starts_with("same")


def _losses_of_formats(legs: pl.DataFrame) -> pl.Expr:
    """How much the target's own words do not say: the losses of physics and settings, where the run distinguishes these from all losses."""
    import polars as pl

    return pl.coalesce("physical", "losses") if "physical" in legs.columns else pl.col("losses")


def pair_rows(tables: Tables) -> tuple[PairRow, ...]:
    """One row for every pair of formats of the run, in order."""
    import polars as pl

    engines = tables.robots.select("key", "engine")
    legs = tables.legs.join(engines, on="key", how="left")
    rows = []
    for (source, target), all_legs in sorted(legs.group_by("source", "target")):
        accepted = all_legs.filter(pl.col("engine") == "done")
        done = accepted.filter(pl.col("status") == "done")
        alike = done.filter(_is_same())
        same, different, unknown = len(alike), *(len(done.filter(pl.col("verdict") == word)) for word in ("different", "not comparable"))
        exact, complete = len(alike.filter(_losses_of_formats(legs) == 0)), len(alike.filter(pl.col("losses") == pl.col("carried")))
        median = float(np.median(done["losses"].drop_nulls().to_numpy())) if done["losses"].drop_nulls().len() else 0.0
        counts = (len(all_legs), len(accepted), len(done), same, different, unknown, exact, complete)
        rows.append(PairRow(str(source), str(target), *counts, median))
    return tuple(rows)


def kinds(tables: Tables, column: str) -> pl.DataFrame:
    """How often each kind of ``lost``, ``diagnostics`` or ``failed`` occurs: robots per pair of formats, the most frequent first."""
    import polars as pl

    names = tables.legs.select("source", "target", pl.col(column)).explode(column).drop_nulls(column)
    named = names.with_columns(pl.col(column).struct.field("name").alias("kind")).filter(pl.col("kind").is_not_null())
    counted = named.group_by("source", "target", "kind").agg(pl.len().alias("robots"))
    return counted.sort(["source", "target", "robots", "kind"], descending=[False, False, True, False])


def failures(tables: Tables) -> pl.DataFrame:
    """Every conversion of an accepted file that is not done and the same, with its cause."""
    import polars as pl

    engines = tables.robots.select("key", "engine")
    legs = tables.legs.join(engines, on="key", how="left").filter(pl.col("engine") == "done")
    bad = legs.filter((pl.col("status") != "done") | (~_is_same() & (pl.col("verdict") != "")))
    place = pl.element().struct.field("name") + " (" + pl.element().struct.field("value").str.slice(0, _LONGEST_PLACE) + ")"
    failed = pl.col("failed").list.eval(place).list.join("; ")
    ended = pl.col("status") + ": " + pl.col("reason")
    differs = pl.lit("different: ") + failed
    unknown = pl.lit("not comparable: ") + pl.col("verdict_reason")
    cause = pl.when(pl.col("status") != "done").then(ended).when(pl.col("verdict") == "different").then(differs).otherwise(unknown)
    return bad.select("key", "source", "target", cause.alias("cause")).sort("key", "target")


def steps(tables: Tables) -> pl.DataFrame:
    """What each step costs: files, seconds of the clock and of the processor in all, and the most memory."""
    import polars as pl

    costs = tables.costs.group_by("step").agg(
        pl.len().alias("files"),
        pl.col("seconds").sum().round(1),
        pl.col("processor").sum().round(1),
        pl.col("processor").median().round(3).alias("median"),
        pl.col("processor").max().round(1).alias("worst"),
        pl.col("megabytes").max().round(0),
    )
    return costs.sort("step")


def slowest(tables: Tables, count: int = 10) -> pl.DataFrame:
    """The files that took the most processor time, with their most expensive step."""
    import polars as pl

    top = pl.col("step").sort_by("processor").last().alias("step")
    costs = tables.costs.group_by("key").agg(pl.col("processor").sum().round(1), pl.col("megabytes").max().round(0), top)
    return costs.sort(["processor", "key"], descending=[True, False]).head(count)
