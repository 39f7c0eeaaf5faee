"""The results of a run: one small file per robot, written whole as soon as it is known, and tables made of them at the end.

A folder, or any fsspec URL. What is there is complete, so that a run that was killed is continued by leaving out what is there.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import secrets
from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.corpus.rows import Tables, outcome_from_json, tables_of
from hymeko_x.diagnostics import Origin, refuse

if TYPE_CHECKING:
    from collections.abc import Iterator

    import polars as pl
    from fsspec import AbstractFileSystem

    from hymeko_x.corpus.cases import Case
    from hymeko_x.corpus.rows import Outcome

PLAN = "plan.json"
PARTS = "parts"


class Store:
    """Where a run's results are. ``files`` and ``root`` are fsspec's."""

    def __init__(self, place: str) -> None:
        """Raises: Refusal HX002 when the place cannot be used."""
        from fsspec.core import url_to_fs

        try:
            files, root = url_to_fs(place)
        except (ImportError, OSError, ValueError) as error:
            raise refuse(codes.CANNOT_WRITE, f"results cannot be kept there: {error}", Origin(place)) from error
        self.place = place
        self.files: AbstractFileSystem = files
        self.root: str = root.rstrip("/")

    def open(self, plan: dict[str, Any], *, resume: bool) -> None:
        """Begin a run, or continue one with the same plan.

        Raises: Refusal HX002 when the place holds results and the run does not continue them, or those of another plan.
        """
        path = f"{self.root}/{PLAN}"
        if self.files.exists(path):
            kept = json.loads(self.files.cat_file(path))
            if not resume:
                raise refuse(codes.CANNOT_WRITE, "there are results already", Origin(self.place), hint="--resume continues them")
            if kept != json.loads(json.dumps(plan)):
                words = ", ".join(sorted(key for key in {*kept, *plan} if kept.get(key) != json.loads(json.dumps(plan.get(key)))))
                message = f"the results there are of a run with other {words}"
                raise refuse(codes.CANNOT_WRITE, message, Origin(self.place), hint="choose another place with -o")
            return
        self._write(path, plan)

    def known(self) -> set[str]:
        """The names of the parts that are there."""
        folder = f"{self.root}/{PARTS}"
        found = self.files.find(folder) if self.files.exists(folder) else []
        return {path.rpartition("/")[2] for path in found if path.endswith(".json")}

    def add(self, outcome: Outcome) -> None:
        """Keep what was found about one file."""
        name = part_name(outcome.robot.key)
        self._write(f"{self.root}/{PARTS}/{name[:2]}/{name}", outcome.as_json())

    def outcomes(self) -> Iterator[Outcome]:
        """Everything that is there, in the order of the keys."""
        parts = [json.loads(self.files.cat_file(self._path(name))) for name in self.known()]
        yield from map(outcome_from_json, sorted(parts, key=lambda part: str(part["robot"]["key"])))

    def put(self, name: str, data: bytes) -> None:
        """Keep a file beside the parts. It is there whole or not at all."""
        self._write_bytes(f"{self.root}/{name}", data)

    def has(self, name: str) -> bool:
        """Whether there is such a file beside the parts."""
        return bool(self.files.exists(f"{self.root}/{name}"))

    def get(self, name: str) -> bytes:
        """A file beside the parts.

        Raises: Refusal HX001 when it is not there.
        """
        try:
            return bytes(self.files.cat_file(f"{self.root}/{name}"))
        except OSError as error:
            raise refuse(codes.CANNOT_READ, f"there is no '{name}' in the results", Origin(self.place)) from error

    def _path(self, name: str) -> str:
        return f"{self.root}/{PARTS}/{name[:2]}/{name}"

    def _write(self, path: str, document: dict[str, Any]) -> None:
        self._write_bytes(path, json.dumps(document, ensure_ascii=False).encode())

    def _write_bytes(self, path: str, data: bytes) -> None:
        """On a disk through a temporary sibling; elsewhere objects appear whole by themselves.

        Raises: Refusal HX002.
        """
        try:
            self.files.makedirs(path.rpartition("/")[0], exist_ok=True)
            if "file" not in self.files.protocol:
                self.files.pipe_file(path, data)
                return
            temporary = f"{path}.{secrets.token_hex(6)}.part"
            self.files.pipe_file(temporary, data)
            os.replace(temporary, path)
        except OSError as error:
            raise refuse(codes.CANNOT_WRITE, f"cannot be written: {error}", Origin(path)) from error


def part_name(key: str) -> str:
    """The name of the part of a file with this key."""
    return f"{hashlib.sha256(key.encode()).hexdigest()[:32]}.json"


def missing(cases: tuple[Case, ...], store: Store) -> tuple[Case, ...]:
    """The cases that have no part yet."""
    known = store.known()
    return tuple(case for case in cases if part_name(case.key) not in known)


# ---- the tables of a run ------------------------------------------------------------------------------------------

NAMES = ("robots", "legs", "costs")
PACE = "pace.csv"


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
    """How many robots each engine does in a second, if it was measured beside these results."""
    import polars as pl

    return pl.read_csv(io.BytesIO(store.get(PACE))) if store.has(PACE) else None
