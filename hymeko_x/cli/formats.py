"""`hymeko-x formats`: the table of formats."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.formats import FORMATS

if TYPE_CHECKING:
    import argparse


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(chosen: argparse.Namespace) -> int:
    """Print one line per format."""
    rows = [
        {"name": row.name, "title": row.title, "suffixes": row.suffixes, "read": row.frontend is not None, "write": row.backend is not None}
        for row in FORMATS
    ]
    if chosen.json:
        print(json.dumps(rows, indent=2))
        return exits.DONE
    print(f"{'format':<8} {'read':<5} {'write':<6} {'suffixes':<18} title")
    for row in FORMATS:
        can_read, can_write = ("yes" if module else "no" for module in (row.frontend, row.backend))
        print(f"{row.name:<8} {can_read:<5} {can_write:<6} {' '.join(row.suffixes):<18} {row.title}")
    return exits.DONE
