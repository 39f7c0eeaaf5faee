"""`hymeko-x corpus stats`: tables and figures of a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import disk
from hymeko_x.cli import exits
from hymeko_x.cli.guard import UsageError
from hymeko_x.source import NoFiles, Package

if TYPE_CHECKING:
    import argparse


def arguments(parser: argparse.ArgumentParser) -> None:
    """The words of `corpus stats`."""
    parser.add_argument("results", nargs="?", default="corpus-run", metavar="DIR", help="the results of a run (default corpus-run)")
    where = "where tables and figures go (default: beside the results)"
    parser.add_argument("-o", dest="output", metavar="DIR", help=where)
    parser.add_argument("--page", action="append", default=[], metavar="FILE.md", help="renew the numbers in this page (repeatable)")


def run(chosen: argparse.Namespace) -> int:
    """Write tables and figures, and the tables of the run where they go elsewhere."""
    from hymeko_x.corpus.pages import renewed
    from hymeko_x.corpus.report import costs_page, files_of
    from hymeko_x.corpus.store import Store
    from hymeko_x.corpus.tables import load, load_pace, save

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
