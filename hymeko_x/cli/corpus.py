"""`hymeko-x corpus fetch|list|run|stats`: real robots from published packages, and what becomes of them in every format."""

from __future__ import annotations

import argparse
import os
import sys
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import codes, disk
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.parser import count
from hymeko_x.cli.terminal import show
from hymeko_x.corpus import cache, catalog
from hymeko_x.corpus.names import matching
from hymeko_x.corpus.plan import Plan, ProcessLimits, pairs_of
from hymeko_x.corpus.rows import CRASHED, FAILED, OUT_OF_MEMORY, TIMED_OUT
from hymeko_x.diagnostics import Refusal, refuse
from hymeko_x.extras import install_command
from hymeko_x.source import NoFiles, Package

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.corpus.cases import Case
    from hymeko_x.corpus.catalog import WheelPackage
    from hymeko_x.corpus.engines import Engine
    from hymeko_x.corpus.rows import Outcome, Tables

EXTRA = ("fsspec", "matplotlib", "pebble", "polars")
"""The libraries that only batch runs need."""

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
"""Each file has one processor; libraries that would take all of them are limited, unless the user set these variables."""

_ENDED = (CRASHED, TIMED_OUT, OUT_OF_MEMORY, FAILED)


def corpus_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `corpus`."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    fetch = actions.add_parser("fetch", help="download and unpack packages; print their folders")
    fetch.add_argument("names", nargs="*", metavar="NAME", help="packages of the catalogue (default: all of them)")
    actions.add_parser("list", help="the packages of the catalogue, and which are here")
    search = actions.add_parser("search", help="the robots whose name contains a word; the names stand for files in every verb")
    search.add_argument("word", metavar="WORD", help="a part of the name of a robot or of a package, such as panda")
    _run_arguments(actions.add_parser("run", help="every robot through every format, measured"))
    _stats_arguments(actions.add_parser("stats", help="tables and figures of a run"))


def run_corpus(chosen: argparse.Namespace) -> int:
    """Fetch packages, list them, run them through the formats, or count what came out."""
    if chosen.action in ("run", "stats"):
        _needs_extra()
        return _run(chosen) if chosen.action == "run" else _stats(chosen)
    if chosen.action == "search":
        return _search(chosen.word)
    root = cache.cache_root(os.environ)
    if chosen.action == "list":
        return _list(root)
    return _fetch(catalog.select(tuple(chosen.names)), root)


def _needs_extra() -> None:
    """Raises: Refusal HX301 when the libraries of the extra `corpus` are not installed."""
    missing = [name for name in EXTRA if find_spec(name) is None]
    if missing:
        raise refuse(codes.ENGINE_MISSING, f"{', '.join(missing)} is not installed", hint=install_command("corpus"))


def _list(root: Path) -> int:
    print(f"{'package':<20} {'version':<8} {'MB':>5}  {'here':<4} {'licence':<13} carries")
    for package in catalog.load():
        here = "yes" if cache.is_fetched(package, root) else "no"
        size = f"{package.bytes / 1e6:.1f}"
        print(f"{package.name:<20} {package.version:<8} {size:>5}  {here:<4} {package.licence:<13} {package.carries}")
    return exits.DONE


def _search(word: str) -> int:
    """Print the robots with this word in their name; exit 1 when there is none."""
    found = list(matching(word))
    if not found:
        print(f"no robot has '{word}' in its name", file=sys.stderr)
        return exits.FAILED
    width = max(len(name) for name, _, _ in found)
    print(f"{'name':<{width}}  {'format':<7} here")
    for name, format, here in found:
        print(f"{name:<{width}}  {format:<7} {here}")
    return exits.DONE


def _fetch(packages: tuple[WheelPackage, ...], root: Path) -> int:
    """Fetch one after the other, printing folders; one that fails does not stop the others, being offline does."""
    failed = False
    with _download_progress(packages) as watch:
        for package in packages:
            try:
                print(cache.fetch(package, root, watch=watch), flush=True)
            except Refusal as refusal:
                failed = True
                show([refusal.diagnostic])
                if refusal.diagnostic.code == codes.OFFLINE:
                    break
    return exits.FAILED if failed else exits.DONE


@contextmanager
def _download_progress(packages: tuple[WheelPackage, ...]) -> Iterator[cache.DownloadProgress]:
    """A bar on standard error if that is a terminal, else silence."""
    if not sys.stderr.isatty():
        yield _silent
        return
    from rich.console import Console
    from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn, TransferSpeedColumn

    columns = (TextColumn("{task.description:<20}"), BarColumn(), DownloadColumn(), TransferSpeedColumn())
    with Progress(*columns, console=Console(stderr=True)) as bars:
        tasks = {package.name: bars.add_task(package.name, total=package.bytes, visible=False) for package in packages}
        yield lambda package, received: bars.update(tasks[package.name], completed=min(received, package.bytes), visible=True)


def _silent(package: WheelPackage, received: int) -> None:
    """Progress without a bar: nothing."""


# ---- run ---------------------------------------------------------------------------------------------------------------


def _run_arguments(parser: argparse.ArgumentParser) -> None:
    """The words of `corpus run`."""
    parser.add_argument("names", nargs="*", metavar="NAME", help="packages of the catalogue (default: all, and this project's own robots)")
    where = "take the files of this folder or fsspec URL instead of the catalogue's (repeatable)"
    parser.add_argument("--from", dest="folders", action="append", default=[], metavar="DIR", help=where)
    parser.add_argument(
        "--pairs", default="all", type=_pairs, metavar="A:B,...", help="the conversions, such as urdf:mjcf,mjcf:usd (default: all)"
    )
    parser.add_argument("--verify", action="store_true", help="have every result compared with its source by the formats' own engines")
    parser.add_argument("--samples", type=count, default=20, metavar="N", help="random configurations of the verifier (default 20)")
    parser.add_argument("--no-meshes", dest="meshes", action="store_false", help="do not compare mesh files")
    parser.add_argument("--jobs", type=count, default=os.cpu_count() or 1, metavar="N", help="files at a time (default: one per processor)")
    parser.add_argument("--every", type=count, default=1, metavar="N", help="take every N-th file only")
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


def _run(chosen: argparse.Namespace) -> int:
    """Run what is left to do; print a summary. A file that fails is a row in the results and no failure of the run."""
    from hymeko_x.corpus.engines import run
    from hymeko_x.corpus.store import Store

    for variable in _THREADS:
        os.environ.setdefault(variable, "1")
    cases = _cases(chosen)
    if not cases:
        raise UsageError("there is no robot to read")
    plan = Plan(chosen.pairs, chosen.verify, chosen.samples, chosen.meshes, ProcessLimits(chosen.timeout, int(chosen.memory * 2**20)))
    store = Store(chosen.output)
    with _run_progress(len(cases), len(store.known()) if chosen.resume else 0) as watch:
        tables = run(cases, plan, _engine(chosen), store, resume=chosen.resume, watch=watch)
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
        verdicts = {word: len(done.filter(done["verdict"].str.starts_with(word))) for word in ("same", "different", "not comparable")}
        counts = ", ".join(f"{count} {word}" for word, count in verdicts.items() if count)
        yield f"  {source} -> {target}: {len(done)} of {len(legs)} converted" + (f"; {counts}" if counts else "")
    for status in _ENDED:
        for row in tables.legs.filter(tables.legs["status"] == status).iter_rows(named=True):
            yield f"  {status}: {row['key']} -> {row['target']}: {row['reason']}"


@contextmanager
def _run_progress(total: int, before: int) -> Iterator[Callable[[Outcome], None]]:
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


# ---- stats -------------------------------------------------------------------------------------------------------------


def _stats_arguments(parser: argparse.ArgumentParser) -> None:
    """The words of `corpus stats`."""
    parser.add_argument("results", nargs="?", default="corpus-run", metavar="DIR", help="the results of a run (default corpus-run)")
    where = "where tables and figures go (default: beside the results)"
    parser.add_argument("-o", dest="output", metavar="DIR", help=where)
    parser.add_argument("--page", action="append", default=[], metavar="FILE.md", help="renew the numbers in this page (repeatable)")


def _stats(chosen: argparse.Namespace) -> int:
    """Write tables and figures, and the tables of the run where they go elsewhere."""
    from hymeko_x.corpus.pages import renewed
    from hymeko_x.corpus.report import costs_page, files_of
    from hymeko_x.corpus.store import Store, load, load_pace, save

    store = Store(chosen.results)
    tables = load(store)
    target = Store(chosen.output or chosen.results)
    if chosen.output:
        save(tables, target)
    for name, data in files_of(tables):
        target.put(name, data)
    target.put("costs.md", costs_page(tables).encode())
    pace = load_pace(target)
    for page in chosen.page:
        try:
            text = renewed(Path(page).read_text("utf-8"), tables, pace)
        except (OSError, ValueError) as error:
            raise UsageError(f"{page}: {error}") from error
        disk.write_package(Package(text.encode()), page, NoFiles())
    print(target.place)
    return exits.DONE
