"""`hymeko-x corpus run`: every robot through every format, measured."""

from __future__ import annotations

import argparse
import os
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.cli.guard import UsageError
from hymeko_x.corpus import cache, catalog
from hymeko_x.corpus.plan import Limits, Plan, pairs_of
from hymeko_x.corpus.rows import CRASHED, FAILED, OUT_OF_MEMORY, TIMED_OUT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.corpus.cases import Case
    from hymeko_x.corpus.engines import Engine
    from hymeko_x.corpus.rows import Outcome
    from hymeko_x.corpus.tables import Tables

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
"""Each file has one processor; libraries that would take all of them are told so, unless the user said otherwise."""

_ENDED = (CRASHED, TIMED_OUT, OUT_OF_MEMORY, FAILED)


def arguments(parser: argparse.ArgumentParser) -> None:
    """The words of `corpus run`."""
    parser.add_argument("names", nargs="*", metavar="NAME", help="packages of the catalogue (default: all, and this project's own robots)")
    where = "take the files of this folder or fsspec URL instead of the catalogue's (repeatable)"
    parser.add_argument("--from", dest="folders", action="append", default=[], metavar="DIR", help=where)
    parser.add_argument(
        "--pairs", default="all", type=_pairs, metavar="A:B,...", help="the conversions, such as urdf:mjcf,mjcf:usd (default: all)"
    )
    parser.add_argument("--verify", action="store_true", help="have every result compared with its source by the formats' own engines")
    parser.add_argument("--samples", type=_count, default=20, metavar="N", help="random configurations of the verifier (default 20)")
    parser.add_argument("--no-meshes", dest="meshes", action="store_false", help="do not compare mesh files")
    parser.add_argument(
        "--jobs", type=_count, default=os.cpu_count() or 1, metavar="N", help="files at a time (default: one per processor)"
    )
    parser.add_argument("--every", type=_count, default=1, metavar="N", help="take every N-th file only")
    parser.add_argument("--timeout", type=float, default=180.0, metavar="S", help="seconds that one process may take (default 180)")
    parser.add_argument(
        "--memory", type=float, default=5120.0, metavar="MB", help="memory of one process in MiB, with what is only reserved (default 5120)"
    )
    parser.add_argument("--resume", action="store_true", help="go on with the results that are there")
    parser.add_argument("--engine", choices=("local", "ray"), default="local", help="processes of this machine, or a running Ray cluster")
    parser.add_argument("--address", metavar="HOST:PORT", help="the Ray cluster (default: the one of this machine)")
    parser.add_argument(
        "-o", dest="output", default="corpus-run", metavar="DIR", help="where results go: a folder or fsspec URL (default corpus-run)"
    )


def run(chosen: argparse.Namespace) -> int:
    """Run what is left to do; print a summary. A file that fails is a row in the results and no failure of the run."""
    from hymeko_x.corpus import batch
    from hymeko_x.corpus.store import Store

    for variable in _THREADS:
        os.environ.setdefault(variable, "1")
    cases = _cases(chosen)
    if not cases:
        raise UsageError("there is no robot to read")
    plan = Plan(chosen.pairs, chosen.verify, chosen.samples, chosen.meshes, Limits(chosen.timeout, int(chosen.memory * 2**20)))
    store = Store(chosen.output)
    with _progress(len(cases), len(store.known()) if chosen.resume else 0) as watch:
        tables = batch.run(cases, plan, _engine(chosen), store, resume=chosen.resume, watch=watch)
    print("\n".join(_summary(tables)))
    return exits.DONE


def _cases(chosen: argparse.Namespace) -> tuple[Case, ...]:
    from hymeko_x.corpus.cases import from_catalogue, from_folder, own_robots

    if chosen.folders:
        if chosen.names:
            raise UsageError("either packages of the catalogue or --from, not both")
        return tuple(case for folder in chosen.folders for case in from_folder(folder))[:: chosen.every]
    packages = catalog.select(tuple(chosen.names))
    found = from_catalogue(packages, cache.cache_root(os.environ))
    return (*found, *(() if chosen.names else own_robots()))[:: chosen.every]


def _engine(chosen: argparse.Namespace) -> Engine:
    from hymeko_x.corpus.engines import Local, OnRay

    root = cache.cache_root(os.environ)
    return OnRay(chosen.address, root) if chosen.engine == "ray" else Local(chosen.jobs, root)


def _summary(tables: Tables) -> Iterator[str]:
    """How many files were read, and the answers of each pair."""
    robots = tables.robots
    yield f"{len(robots)} files, {len(robots.filter(robots['status'] == 'done'))} read"
    for (source, target), legs in sorted(tables.legs.group_by("source", "target")):
        done = legs.filter(legs["status"] == "done")
        verdicts = {word: len(done.filter(done["verdict"] == word)) for word in ("same", "different", "not comparable")}
        said = ", ".join(f"{count} {word}" for word, count in verdicts.items() if count)
        yield f"  {source} -> {target}: {len(done)} of {len(legs)} converted" + (f"; {said}" if said else "")
    for status in _ENDED:
        for row in tables.legs.filter(tables.legs["status"] == status).iter_rows(named=True):
            yield f"  {status}: {row['key']} -> {row['target']}: {row['reason']}"


@contextmanager
def _progress(total: int, before: int) -> Iterator[Callable[[Outcome], None]]:
    """A bar with rate and remaining time on a terminal, a line for every fiftieth file elsewhere."""
    if not sys.stderr.isatty():
        yield _Lines(total, before)
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    rate = TextColumn("{task.fields[rate]}")
    columns = (
        MofNCompleteColumn(),
        BarColumn(),
        TaskProgressColumn(),
        rate,
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=Console(stderr=True), speed_estimate_period=300) as bars:
        task = bars.add_task("", total=total, completed=before, rate="")

        def watch(outcome: Outcome) -> None:
            speed = bars.tasks[0].speed
            bars.update(task, advance=1, description=outcome.robot.key[-60:], rate=f"{speed:.2f} robots/s" if speed else "")

        yield watch


class _Lines:
    """Progress for a log file."""

    def __init__(self, total: int, done: int) -> None:
        self._total, self._done = total, done

    def __call__(self, outcome: Outcome) -> None:
        self._done += 1
        if self._done % 50 == 0 or self._done == self._total:
            print(f"{self._done}/{self._total} {outcome.robot.key}", file=sys.stderr, flush=True)


def _pairs(words: str) -> tuple[tuple[str, str], ...]:
    try:
        return pairs_of(words)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def _count(text: str) -> int:
    if not text.isascii() or not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a number of at least 1, found '{text}'")
    return int(text)
