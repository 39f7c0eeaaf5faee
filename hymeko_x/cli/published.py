"""`hymeko-x grammar`, `skill`, `schema`: what other programs have to know of this one, printed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.cli import exits

if TYPE_CHECKING:
    import argparse


def grammar_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `grammar`."""
    from hymeko_x.language.models.printing import PRINTERS

    what = "the program that it is for (default: lark, the grammar of the language itself)"
    parser.add_argument("--to", choices=tuple(PRINTERS), default="lark", help=what)


def run_grammar(chosen: argparse.Namespace) -> int:
    """Print the grammar of the language for the programs that hold language models to one."""
    from hymeko_x.language.models.printing import PRINTERS

    print(PRINTERS[chosen.to](), end="")
    return exits.DONE


def skill_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `skill`."""
    parser.add_argument("--card", action="store_true", help="HyMeKo text on one page instead")


def run_skill(chosen: argparse.Namespace) -> int:
    """Print what a language model has to know of this program, or of the language."""
    from importlib.resources import files

    page = "card.md" if chosen.card else "SKILL.md"
    print(files("hymeko_x.language.models").joinpath(page).read_text("utf-8"), end="")
    return exits.DONE


def schema_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `schema`: none of its own."""


def run_schema(chosen: argparse.Namespace) -> int:
    """Print the JSON Schema of robots in JSON."""
    import json

    from hymeko_x import formats

    made = next(row.schema for row in formats.FORMATS if row.schema)
    print(json.dumps(formats.loaded(made)(), indent=2))
    return exits.DONE
