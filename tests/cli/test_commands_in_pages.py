"""Every command that a page shows is one that the command line understands."""

from __future__ import annotations

import re
import shlex
from itertools import takewhile
from pathlib import Path

import pytest

from hymeko_x.cli import parser_of

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
COMMAND = re.compile(r"^    hymeko-x ([a-z].*)$", re.MULTILINE)
SYNOPSIS = re.compile(r"\[--|\]\.\.\.")
COMMANDS = sorted({line for page in PAGES for line in COMMAND.findall(page.read_text("utf-8")) if not SYNOPSIS.search(line)})


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_in_a_page_is_understood(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    verb, *words = takewhile(lambda word: word not in (">", "|"), shlex.split(command, comments=True))
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for word in words:  # options that name a folder want it to be there
        Path(word.partition("=")[2] or word).resolve().mkdir(parents=True, exist_ok=True)
    assert parser_of(verb).parse_args(words)


def test_the_pages_have_commands() -> None:
    assert len(COMMANDS) > 20
