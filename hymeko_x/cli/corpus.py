"""`hymeko-x corpus fetch|list`: real robots from published packages."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.cli import exits
from hymeko_x.cli.terminal import show
from hymeko_x.corpus import cache, catalog
from hymeko_x.diagnostics import Refusal

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator
    from pathlib import Path

    from hymeko_x.corpus.catalog import WheelPackage


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    fetch = actions.add_parser("fetch", help="download and unpack packages; print their folders")
    fetch.add_argument("names", nargs="*", metavar="NAME", help="packages of the catalogue (default: all of them)")
    actions.add_parser("list", help="the packages of the catalogue, and which are here")


def run(chosen: argparse.Namespace) -> int:
    """Fetch packages, or list them."""
    root = cache.cache_root(os.environ)
    if chosen.action == "list":
        return _list(root)
    return _fetch(catalog.select(tuple(chosen.names)), root)


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
