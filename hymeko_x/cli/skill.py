"""`hymeko-x skill`: what a language model has to know of this program, and of the language."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from hymeko_x.cli import exits

if TYPE_CHECKING:
    import argparse


def skill_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `skill`."""
    parser.add_argument("--card", action="store_true", help="HyMeKo text on one page instead")


def run_skill(chosen: argparse.Namespace) -> int:
    """Print the page."""
    page = "card.md" if chosen.card else "SKILL.md"
    print(files("hymeko_x.language.models").joinpath(page).read_text("utf-8"), end="")
    return exits.DONE
