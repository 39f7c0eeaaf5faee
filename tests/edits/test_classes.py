"""Default classes of a converted file are none of the original's, which has what they give in its elements."""

from __future__ import annotations

import re
from pathlib import Path

import hymeko_x as hx

ARM = """arm : robot {
  base { mass 1 inertia [1 1 1] visual { box [0.4 0.4 0.03] } }
  upper { mass 1 inertia [1 1 1] visual { box [0.1 0.1 0.5] } }
  @shoulder : revolute { + base - upper axis=Z }
}
"""


def updated(folder: Path, *change: str) -> tuple[str, list[str]]:
    """The arm's text after one change of its MJCF, and the warnings."""
    original, there = folder / "arm.hymeko", folder / "arm.xml"
    original.write_text(ARM)
    hx.convert(original, there)
    assert change[0] in there.read_text()
    there.write_text(there.read_text().replace(*change))
    found = hx.update(original, there)
    return original.read_text(), [row.message for row in found.report if row.code.id == "HX118"]


def test_a_geom_that_makes_other_classes_of_the_original_is_added(tmp_path: Path) -> None:
    pen = '<body name="pen"><geom type="sphere" size="0.1" mass="1"/><geom class="visual" type="box" size="1 2 3"/></body>'
    text, warnings = updated(tmp_path, '<body name="upper"', f'{pen}<body name="upper"')
    assert (text.count("pen"), warnings) == (1, [])
    assert all(line in text for line in ARM.splitlines())


def test_what_a_class_gives_beyond_the_fields_of_its_elements_is_reported(tmp_path: Path) -> None:
    text, warnings = updated(tmp_path, 'group="2"', 'group="4"')
    given = '<default class="visual"><geom contype="0" conaffinity="0" group="4"/></default>'
    assert (text, warnings) == (ARM, [f"the edit did not arrive: mjcf classes: <default>{given}</default>"])


HAND = """<mujoco model="hand">
  <default> <geom type="box" size="0.1 0.1 0.1" pos="1 0 0" euler="0 0 90"/> </default>
  <worldbody>
    <body name="palm"> <geom name="skin"/> </body>
  </worldbody>
</mujoco>
"""


def test_a_geom_whose_class_gives_a_pose_is_moved_to_its_body(tmp_path: Path) -> None:
    original, there = tmp_path / "hand.xml", tmp_path / "hand.json"
    original.write_text(HAND)
    hx.convert(original, there)
    text, number = re.subn(r',"weight":\{.*?\}', "", there.read_text())
    assert number == 1
    there.write_text(text)
    hx.update(original, there)
    assert original.read_text() == HAND.replace('"skin"', '"skin" pos="0 0 0" euler="0 0 0"')
    assert hx.update(original, there).edits == ()
