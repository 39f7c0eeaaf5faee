"""Figures of a run as SVG and PNG. The same results give the same bytes: fixed ids, no dates, fixed sizes."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x import formats
from hymeko_x.corpus.statistics import HYMEKO, lengths_of, pair_rows

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import polars as pl
    from matplotlib.figure import Figure

    from hymeko_x.corpus.rows import Tables
    from hymeko_x.corpus.statistics import Numbers, PairRow
    from hymeko_x.formats import Format

_SETTINGS: Any = {
    "backend": "Agg",
    "svg.hashsalt": "hymeko-x",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.grid": True,
    "grid.alpha": 0.3,
}


def figures(tables: Tables) -> Iterator[tuple[str, bytes]]:
    """Every figure as (file name, content)."""
    import matplotlib as mpl

    frame = lengths_of(tables, "code")
    drawings: tuple[tuple[str, Callable[[], Figure]], ...] = (
        ("lengths", lambda: _histograms(frame)),
        ("ratios", lambda: _ratios(frame)),
        ("sizes", lambda: _scatter(frame)),
        ("pairs", lambda: _matrix(pair_rows(tables))),
    )
    with mpl.rc_context(_SETTINGS):
        for name, draw in drawings:
            figure = draw()
            yield f"{name}.svg", _saved(figure, "svg", {"Date": None, "Creator": None})
            yield f"{name}.png", _saved(figure, "png", {"Software": None})


def _saved(figure: Figure, kind: str, metadata: dict[str, None]) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format=kind, dpi=110, metadata=metadata)
    return buffer.getvalue()


def _figure(width: float, height: float) -> Figure:
    from matplotlib.figure import Figure as New

    return New(figsize=(width, height), layout="constrained")


def _formats(frame: pl.DataFrame) -> list[str]:
    names = (format.name for format in formats.families())
    return [name for name in names if name in frame.columns and frame[name].drop_nulls().len() > 1]


def _others() -> list[Format]:
    """The formats that HyMeKo is compared with."""
    return [format for format in formats.families() if format is not formats.OWN]


def _histograms(frame: pl.DataFrame) -> Figure:
    """The distribution of lengths with a kernel density, as the paper's figure 11, for every format as it is printed."""
    names = _formats(frame)
    figure = _figure(8.0, 1.7 * max(1, len(names)))
    axes = np.atleast_1d(figure.subplots(max(1, len(names)), 1, sharex=True))
    for axis, name in zip(axes, names, strict=False):
        values = np.log10(frame[name].drop_nulls().to_numpy())
        axis.hist(values, bins=np.linspace(2.0, 6.0, 61), density=True, alpha=0.4, color=formats.by_name(name).colour)
        _density(axis, values, name)
        axis.set_ylabel(name)
        axis.axvline(float(np.median(values)), color="black", linewidth=0.8, linestyle="--")
    axes[-1].set_xlabel("log10 of characters without white space and comments, as printed (dashed: median)")
    return figure


def _density(axis: object, values: Numbers, name: str) -> None:
    from matplotlib.axes import Axes
    from scipy.stats import gaussian_kde

    assert isinstance(axis, Axes)
    if len(np.unique(values)) < 3:
        return
    places = np.linspace(2.0, 6.0, 400)
    axis.plot(places, gaussian_kde(values)(places), color=formats.by_name(name).colour)


def _ratios(frame: pl.DataFrame) -> Figure:
    """HyMeKo's length over the own format's, per robot: as it was found and as it is printed."""
    import polars as pl

    sources = [format.name for format in _others() if format.name in set(frame["format"])]
    figure = _figure(8.0, 3.2)
    axis = figure.subplots()
    boxes, labels = [], []
    for source in sources:
        own = frame.filter(pl.col("format") == source)
        for column, words in (("found", "as found"), (source, "as printed")):
            both = own.drop_nulls([HYMEKO, column]) if column in own.columns else own.head(0)
            if len(both):
                boxes.append((both[HYMEKO] / both[column]).to_numpy())
                labels.append(f"{source}\n{words}\nn = {len(both)}")
    if boxes:
        axis.boxplot(boxes, tick_labels=labels, showfliers=True, flierprops={"markersize": 2})
        axis.set_yscale("log")
    axis.axhline(1.0, color="black", linewidth=0.8)
    axis.set_ylabel("HyMeKo / format, characters")
    return figure


def _scatter(frame: pl.DataFrame) -> Figure:
    """Every robot in its own format as printed against HyMeKo, on logarithmic axes."""
    import polars as pl

    figure = _figure(5.6, 5.2)
    axis = figure.subplots()
    for format in _others():
        column = format.expands_to if format.expands_to and format.name not in frame.columns else format.name
        own = frame.filter(pl.col("format") == format.name)
        both = own.drop_nulls([HYMEKO, column]) if column in own.columns else own.head(0)
        if len(both):
            label = f"{format.name} ({len(both)})"
            axis.scatter(both[column].to_numpy(), both[HYMEKO].to_numpy(), s=9, alpha=0.6, color=format.colour, label=label)
    ends = np.array([2e2, 1e6])
    axis.plot(ends, ends, color="black", linewidth=0.8)
    axis.plot(ends, ends / 2, color="black", linewidth=0.8, linestyle=":")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("characters in the robot's own format, as printed")
    axis.set_ylabel("HyMeKo (line: equal, dotted: half)")
    axis.legend(loc="upper left")
    return figure


def _matrix(rows: tuple[PairRow, ...]) -> Figure:
    """The share of accepted files that convert into the same robot, for every pair of formats."""
    sources, targets = (sorted({getattr(row, side) for row in rows}) for side in ("source", "target"))
    shares = np.full((len(sources), len(targets)), np.nan)
    figure = _figure(1.4 + 1.0 * len(targets), 1.0 + 0.7 * len(sources))
    axis = figure.subplots()
    for row in rows:
        place = sources.index(row.source), targets.index(row.target)
        shares[place] = row.percent
        axis.text(place[1], place[0], f"{row.share}\n{row.same}/{row.accepted}", ha="center", va="center", fontsize=8)
    axis.imshow(shares, cmap="RdYlGn", vmin=0.0, vmax=100.0, aspect="auto", alpha=0.6)
    axis.set_xticks(range(len(targets)), targets)
    axis.set_yticks(range(len(sources)), sources)
    axis.set_xlabel("into")
    axis.set_ylabel("from")
    axis.grid(visible=False)
    return figure
