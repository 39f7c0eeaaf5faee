"""Bodies without names come home as themselves: what is removed or renamed is the one, and not another one that gets its number."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import hymeko_x as hx

BALLS = """<mujoco model="r">
  <worldbody>
    <body pos="1 0 0">
      <freejoint/>
      <geom size="0.1"/>
    </body>
    <body pos="2 0 0">
      <freejoint/>
      <geom size="0.1"/>
    </body>
    <body pos="3 0 0">
      <freejoint/>
      <geom size="0.1"/>
    </body>
    <body pos="4 0 0">
      <freejoint/>
      <geom size="0.1"/>
    </body>
  </worldbody>
</mujoco>
"""
SECOND = '    <body pos="2 0 0">\n      <freejoint/>\n      <geom size="0.1"/>\n    </body>\n'


def converted(folder: Path) -> tuple[Path, Path, str]:
    """The original, what it was converted into, and the text of that."""
    original, there = folder / "r.xml", folder / "r.urdf"
    original.write_text(BALLS)
    hx.convert(original, there)
    return original, there, there.read_text()


@pytest.mark.unread("HX101")
def test_a_body_that_is_removed_is_removed_once(tmp_path: Path) -> None:
    original, there, text = converted(tmp_path)
    (name,) = re.findall(r'<joint name="([^"]*)" type="floating">\s*<origin xyz="2 0 0"', text)
    for tag in ("link", "joint"):
        text = re.sub(rf'<{tag} name="{name}".*?</{tag}>', "", text, flags=re.DOTALL)
    there.write_text(text)
    edits = [str(edit).partition(":")[0] for edit in hx.update(original, there).edits]
    assert original.read_text() == BALLS.replace(SECOND, "")
    assert edits == [f"body '{name}'", f"joint '{name}'", f"shape '{name}/shape'"]
    again = hx.update(original, there)
    assert (again.edits, [str(row) for row in again.report]) == ((), [])


@pytest.mark.unread("HX101")
def test_a_body_that_is_renamed_gets_the_name_and_no_other_one_does(tmp_path: Path) -> None:
    original, there, text = converted(tmp_path)
    (name,) = re.findall(r'<joint name="([^"]*)" type="floating">\s*<origin xyz="2 0 0"', text)
    there.write_text(text.replace(f'link name="{name}"', 'link name="ball"').replace(f'link="{name}"', 'link="ball"'))
    hx.update(original, there)
    named = BALLS.replace('<body pos="2 0 0">', '<body name="ball" pos="2 0 0">')
    assert original.read_text() == named
    assert hx.update(original, there).edits == ()
    assert original.read_text() == named
