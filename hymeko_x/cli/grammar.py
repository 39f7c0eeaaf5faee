"""`hymeko-x grammar`: the grammar of the language for the programs that hold language models to one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.language.models.printing import PRINTERS

if TYPE_CHECKING:
    import argparse


def grammar_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `grammar`."""
    what = "the program that it is for (default: lark, the grammar of the language itself)"
    parser.add_argument("--to", choices=tuple(PRINTERS), default="lark", help=what)


def run_grammar(chosen: argparse.Namespace) -> int:
    """Print the grammar."""
    print(PRINTERS[chosen.to](), end="")
    return exits.DONE
