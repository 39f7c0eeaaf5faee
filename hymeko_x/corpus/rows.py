"""The results of a batch run for one robot: facts that every run repeats, and costs that no two runs share.

One :class:`RobotRow` per file, one :class:`Leg` per file and target format, one :class:`Cost` per measured step. Facts and costs
are kept apart, so that the facts of two runs can be compared byte for byte.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec
from msgspec import Struct
from msgspec.structs import asdict, replace

if TYPE_CHECKING:
    from collections.abc import Iterable

    import polars as pl


DONE, REFUSED, FAILED = "done", "refused", "failed"
"""The answers of a step that came to an end: it worked; the input cannot be processed; an exception, which is a bug of ours."""
CRASHED, TIMED_OUT, OUT_OF_MEMORY, UNREAD = "crashed", "timed out", "out of memory", "unread"
"""The answers of a step that did not; and of a conversion whose source could not be read."""


class RobotRow(Struct, frozen=True):
    """One file as it was found. ``engine`` is the answer of the format's reference reader, ``reader`` which one that was where it
    accepts the file; ``whole`` is False where other files of the format are included, so that the lengths are not those of
    the robot."""

    key: str
    package: str
    format: str
    sha256: str = ""
    status: str = DONE
    reason: str = ""
    engine: str = ""
    engine_reason: str = ""
    reader: str = ""
    bodies: int = 0
    joints: int = 0
    dofs: int = 0
    shapes: int = 0
    whole: bool = True
    bytes: int | None = None
    characters: int | None = None
    code: int | None = None
    tokens: int | None = None
    gzip: int | None = None
    diagnostics: Mapping[str, int] | None = None


class Leg(Struct, frozen=True):
    """One conversion: the lengths of the result, what its format cannot represent by kind, the diagnostics by code, and the verdict.

    The lengths are those of the file; what is kept beside it for the way back has ``residue`` bytes. Of the ``losses``,
    ``carried`` are in there, and ``physical`` concern the robot's physics or what only its format understands, not names, forms,
    appearance and comments. ``verdict`` is empty where nothing was verified. ``failed`` are the verifier's quantities that differ,
    with the place of the worst; ``unsaid`` those that one of the formats cannot represent, with the number of elements.
    """

    key: str
    source: str
    target: str
    status: str = DONE
    reason: str = ""
    files: int = 0
    bytes: int | None = None
    characters: int | None = None
    code: int | None = None
    tokens: int | None = None
    gzip: int | None = None
    residue: int = 0
    losses: int | None = None
    carried: int = 0
    physical: int | None = None
    lost: Mapping[str, int] | None = None
    diagnostics: Mapping[str, int] | None = None
    verdict: str = ""
    verdict_reason: str = ""
    failed: Mapping[str, str] | None = None
    unsaid: Mapping[str, int] | None = None


class Cost(Struct, frozen=True):
    """One step: its wall-clock seconds, the processor's seconds, and the peak memory of its process in MB while it lasted."""

    key: str
    step: str
    seconds: float
    processor: float
    megabytes: float


class Outcome(Struct, frozen=True):
    """Everything about one file."""

    robot: RobotRow
    legs: tuple[Leg, ...]
    costs: tuple[Cost, ...]

    def as_json(self) -> dict[str, Any]:
        """The document of one part of a run's results."""
        return msgspec.to_builtins(self)  # type: ignore[no-any-return]


def outcome_from_json(document: Mapping[str, Any]) -> Outcome:
    """The outcome in a part. Raises: KeyError or TypeError when it is none."""
    legs = tuple(Leg(**item) for item in document["legs"])
    return Outcome(RobotRow(**document["robot"]), legs, tuple(Cost(**item) for item in document["costs"]))


def with_verdict(leg: Leg, verdict: Leg) -> Leg:
    """A conversion with its verdict."""
    return replace(leg, verdict=verdict.verdict, verdict_reason=verdict.verdict_reason, failed=verdict.failed, unsaid=verdict.unsaid)


# ---- the same as three tables -----------------------------------------------------------------------------------------


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
    robots, legs, costs = _frame(RobotRow, rows[0]), _frame(Leg, rows[1]), _frame(Cost, rows[2])
    return Tables(robots.sort("key"), legs.sort("key", "target"), costs.sort("key", "step"))


def _row(row: RobotRow | Leg | Cost) -> dict[str, Any]:
    return {key: _listed(value) for key, value in asdict(row).items()}


def _listed(value: Any) -> Any:
    """A mapping as a list of named values, since Parquet has no column of mappings with unknown keys."""
    return [{"name": name, "value": item} for name, item in sorted(value.items())] if isinstance(value, Mapping) else value


def _frame(kind: type[RobotRow | Leg | Cost], rows: list[dict[str, Any]]) -> pl.DataFrame:
    import polars as pl

    types: dict[str, Any] = {"str": pl.String, "int": pl.Int64, "int | None": pl.Int64, "float": pl.Float64, "bool": pl.Boolean}
    types["Mapping[str, int] | None"] = pl.List(pl.Struct({"name": pl.String, "value": pl.Int64}))
    types["Mapping[str, str] | None"] = pl.List(pl.Struct({"name": pl.String, "value": pl.String}))
    return pl.DataFrame(rows, schema={name: types[hint] for name, hint in kind.__annotations__.items()})
