"""The results as three tables: robots (one row per file), legs (per file and target), costs (per file and step).

``robots`` and ``legs`` are facts, equal in every run over the same files; ``costs`` are measurements. What is counted by
kind or code is a list of (name, count), in the order of the names.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec.structs import asdict

from hymeko_x.corpus.rows import Cost, Leg, Robot

if TYPE_CHECKING:
    from collections.abc import Iterable

    import polars as pl

    from hymeko_x.corpus.rows import Outcome
    from hymeko_x.corpus.store import Store

NAMES = ("robots", "legs", "costs")
PACE = "pace.csv"


class Tables(NamedTuple):
    """The three tables, sorted."""

    robots: pl.DataFrame
    legs: pl.DataFrame
    costs: pl.DataFrame


def tables_of(outcomes: Iterable[Outcome]) -> Tables:
    """The tables of all outcomes, whatever their order."""
    rows: tuple[list[dict[str, Any]], ...] = ([], [], [])
    for outcome in outcomes:
        rows[0].append(_row(outcome.robot))
        rows[1].extend(map(_row, outcome.legs))
        rows[2].extend(map(_row, outcome.costs))
    robots, legs, costs = _frame(Robot, rows[0]), _frame(Leg, rows[1]), _frame(Cost, rows[2])
    return Tables(robots.sort("key"), legs.sort("key", "target"), costs.sort("key", "step"))


def save(tables: Tables, store: Store) -> None:
    """Write the tables as Parquet beside the parts."""
    for name, frame in zip(NAMES, tables, strict=True):
        buffer = io.BytesIO()
        frame.write_parquet(buffer, compression="zstd", statistics=False)
        store.put(f"{name}.parquet", buffer.getvalue())


def load(store: Store) -> Tables:
    """The tables of a run; of one that has not come to its end, what there is.

    Raises: Refusal HX001 when there is nothing.
    """
    import polars as pl

    if not store.has(f"{NAMES[-1]}.parquet") and store.known():
        return tables_of(store.outcomes())
    return Tables(*(pl.read_parquet(io.BytesIO(store.get(f"{name}.parquet"))) for name in NAMES))


def load_pace(store: Store) -> pl.DataFrame | None:
    """How many robots each engine does in a second, if somebody has measured it beside these results."""
    import polars as pl

    return pl.read_csv(io.BytesIO(store.get(PACE))) if store.has(PACE) else None


def _row(row: Robot | Leg | Cost) -> dict[str, Any]:
    return {key: _listed(value) for key, value in asdict(row).items()}


def _listed(value: Any) -> Any:
    """A mapping as a list of named values, since Parquet has no column of mappings with unknown keys."""
    return [{"name": name, "value": item} for name, item in sorted(value.items())] if isinstance(value, Mapping) else value


def _frame(kind: type[Robot | Leg | Cost], rows: list[dict[str, Any]]) -> pl.DataFrame:
    import polars as pl

    types: dict[str, Any] = {"str": pl.String, "int": pl.Int64, "int | None": pl.Int64, "float": pl.Float64, "bool": pl.Boolean}
    types["Mapping[str, int] | None"] = pl.List(pl.Struct({"name": pl.String, "value": pl.Int64}))
    types["Mapping[str, str] | None"] = pl.List(pl.Struct({"name": pl.String, "value": pl.String}))
    return pl.DataFrame(rows, schema={name: types[hint] for name, hint in kind.__annotations__.items()})
