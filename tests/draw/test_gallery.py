"""The pictures of docs/gallery.md are what its commands draw. `python tests/draw/test_gallery.py` draws them anew."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from hymeko_x.cli import main

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "gallery.md").read_text("utf-8")
LISTINGS = dict(re.findall(r"```hymeko (\S+)\n(.*?)```\n", PAGE, re.DOTALL))
COMMANDS = re.findall(r"^\$ hymeko-x (.+)$", PAGE, re.MULTILINE)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_picture_of_the_gallery_is_what_its_command_draws(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert draw(command) == (DOCS / "pictures" / shlex.split(command)[3]).read_bytes()


def test_the_gallery_shows_every_picture_that_it_draws() -> None:
    assert re.findall(r"\]\(pictures/(\S+)\)", PAGE) == [shlex.split(command)[3] for command in COMMANDS]
    assert {name.partition(".")[0] for name in LISTINGS} == {f"figure{number}" for number in (1, 2, 3, 5, 7, 8, 9, 12)}


def draw(command: str) -> bytes:
    words = shlex.split(command)
    Path(words[1]).write_text(LISTINGS[words[1]], "utf-8")
    assert main(words) == 0
    return Path(words[3]).read_bytes()


if __name__ == "__main__":
    import os
    import tempfile

    os.chdir(tempfile.mkdtemp())
    for each in COMMANDS:
        (DOCS / "pictures" / shlex.split(each)[3]).write_bytes(draw(each))
