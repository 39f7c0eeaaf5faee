"""`hymeko-x explain CODE`: what a code means."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.cli.guard import UsageError
from hymeko_x.codes import CODES

if TYPE_CHECKING:
    import argparse


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    parser.add_argument("code", nargs="?", metavar="CODE", help="a code such as HX044; without it all codes are listed")


def run(chosen: argparse.Namespace) -> int:
    """Print the explanation of one code, or the titles of all."""
    if chosen.code is None:
        for code in sorted(CODES.values(), key=lambda code: code.id):
            print(f"{code.id}  {code.title}")
        return exits.DONE
    found = CODES.get(_canonical(chosen.code))
    if found is None:
        raise UsageError(f"there is no code '{chosen.code}'; `hymeko-x explain` lists all")
    print(f"{found.id}: {found.title}\n\n{textwrap.fill(found.explanation, 100)}")
    return exits.DONE


def _canonical(text: str) -> str:
    """`hx44`, `44` and `HX044` are the same code."""
    digits = text.strip().upper().removeprefix("HX")
    return f"HX{digits.zfill(3)}"
