"""Every command that a page shows is one that the command line understands."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from hymeko_x.cli import parser_of

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
COMMAND = re.compile(r"^    hymeko-x (?P<verb>[a-z]+) ?(?P<rest>.*)$", re.MULTILINE)
SYNOPSIS = re.compile(r"\[--|\]\.\.\.")


def commands() -> list[str]:
    """The commands in indented blocks, without comments and redirections; the lines that show what a verb takes are left out."""
    found = [line for page in PAGES for line in COMMAND.findall(page.read_text("utf-8")) if not SYNOPSIS.search(line[1])]
    return [f"{verb} {re.split(r'\s#\s|\s>\s|\s\|\s', rest)[0]}".strip() for verb, rest in found]


@pytest.mark.parametrize("command", sorted(set(commands())))
def test_a_command_in_a_page_is_understood(command: str) -> None:
    verb, *words = shlex.split(command, comments=True)
    assert parser_of(verb).parse_args(words)


def test_the_pages_have_commands() -> None:
    assert len(set(commands())) > 20
