"""The listings of the tutorial do what it shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import hymeko_x as hx
from examples.listings import LISTING, run
from hymeko_x.cli import main

PAGE = Path(__file__).parents[2] / "docs/robot.md"


def test_every_listing_prints_what_the_page_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shown = [content for language, name, content in LISTING.findall(PAGE.read_text("utf-8")) if language == "text" and not name]
    assert run(PAGE) == shown
    assert len(shown) == 6


def test_a_station_takes_at_most_sixty_lines_in_either_language() -> None:
    listings = [(language, name, content.splitlines()) for language, name, content in LISTING.findall(PAGE.read_text("utf-8"))]
    python = [line for language, name, lines in listings if language == "python" for line in lines]
    (text,) = [lines for language, name, lines in listings if name == "station.hymeko"]
    assert (len(python) <= 60, len(text) <= 60) == (True, True)


def test_both_stations_are_one_robot_on_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second arm of the listing in Python is a mirror image, so that its claw is on the other side, as it is in the text."""
    monkeypatch.chdir(tmp_path)
    run(PAGE)
    ours, theirs = hx.load("station.hymeko"), hx.load("station.xml")
    assert (ours.dofs, ours.mass, len(ours.shapes)) == (theirs.dofs, pytest.approx(theirs.mass), len(theirs.shapes))
    places = {name.replace("_", "/"): pose.xyz for name, pose in ours.fk().items()}
    for name, pose in theirs.fk().items():
        assert places[name] == pytest.approx(pose.xyz, abs=1e-12), name


def test_the_station_of_the_text_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run(PAGE)
    assert main(["render", "station.hymeko", "--size", "320x240", "-o", "station.png"]) == 0
    pixels = np.asarray(Image.open("station.png").convert("RGB")).reshape(-1, 3).astype(int)
    red, green, blue = pixels.T
    assert ((red > 100) & (red > 2 * green) & (red > 2 * blue)).sum() > 100, "the claws"
    assert ((blue > 100) & (blue > 1.5 * green) & (blue > 2 * red)).sum() > 100, "the cube"
