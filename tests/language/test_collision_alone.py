"""`collision` alone: what a body shows is what it collides with."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.unread("HX201")

TWO = """robot : robot {{
  steel : material {{ rgba [0.5 0.5 0.5] }}
  base {{ mass 1 {0} }}
}}
"""
SEEN = 'visual { box [1 2 3] at [0 0 1] material=steel } visual "a.stl"'


def printed(shapes: str) -> str:
    return hx.dumps(hx.loads(TWO.format(shapes).encode(), "hymeko").mechanism, "hymeko")


def test_it_is_each_of_the_visuals_before_it() -> None:
    short = hx.loads(TWO.format(f"{SEEN} collision").encode(), "hymeko").mechanism
    long = hx.loads(TWO.format(f"{SEEN} collision {{ box [1 2 3] at [0 0 1] }} collision=a").encode(), "hymeko").mechanism
    assert short.graph == long.graph
    assert hx.dumps(long, "hymeko") == hx.dumps(short, "hymeko")
    assert hx.dumps(short, "hymeko").count("collision") == 1


@pytest.mark.parametrize(
    "shapes",
    [
        f"{SEEN} collision {{ box [1 2 3] at [0 0 1] }}",
        f"{SEEN} collision {{ box [1 2 3] at [0 0 2] }} collision=a",
        "visual { sphere 1 } collision { sphere 1 friction [1] }",
        'visual { sphere 1 } collision { sphere 1 name "hull" }',
        "collision { sphere 1 } visual { sphere 1 }",
        'visual { sphere 1 } collision { sphere 1 id "ball" }',
        "visual { sphere 1 } collision { sphere 1 sdf { max_contacts 3 } }",
    ],
)
def test_other_shapes_are_written_in_full(shapes: str) -> None:
    text = printed(shapes)
    assert all(word != "collision" or following in ("{", "=") for word, following in _after(text))
    assert hx.loads(text.encode(), "hymeko").mechanism.graph == hx.loads(TWO.format(shapes).encode(), "hymeko").mechanism.graph


def _after(text: str) -> list[tuple[str, str]]:
    words = text.replace("collision=", "collision = ").split()
    return list(pairwise(words))


def test_runs_of_visuals_have_each_their_own() -> None:
    text = printed("visual { sphere 1 } collision { sphere 1 } visual { sphere 2 } collision { sphere 2 }")
    assert "base { mass 1 visual { sphere 1 } collision visual { sphere 2 } collision }" in text


def test_without_a_visual_it_is_refused() -> None:
    with pytest.raises(Refusal, match="'collision' alone means the visuals directly before it, and there is none"):
        printed("collision")


@pytest.mark.parametrize(
    ("place", "shapes"),
    [(0, "visual { box [4 2 3] } collision { box [1 2 3] }"), (1, "visual { box [1 2 3] } collision { box [4 2 3] }")],
)
@pytest.mark.unread("HX108")
def test_an_edit_of_one_of_both_arrives(place: int, shapes: str, tmp_path: Path) -> None:
    """Where one of both changes, the other one stays; the rest of the text is the author's."""
    text = TWO.format("inertia [1 1 1]\n    visual { box [1 2 3] } collision\n  ").replace("0.5 0.5 0.5", "0.50 0.5 0.5")
    (tmp_path / "a.hymeko").write_text(text)
    hx.convert(tmp_path / "a.hymeko", tmp_path / "a.urdf")
    parts = (tmp_path / "a.urdf").read_text().split('size="1 2 3"')
    assert len(parts) == 3
    parts[place] += 'size="4 2 3"'
    parts[1 - place] += 'size="1 2 3"'
    (tmp_path / "b.urdf").write_text("".join(parts))
    hx.update(tmp_path / "a.hymeko", tmp_path / "b.urdf", output=tmp_path / "c.hymeko")
    found = (tmp_path / "c.hymeko").read_text()
    assert "[0.50 0.5 0.5]" in found
    assert shapes in " ".join(found.split())
