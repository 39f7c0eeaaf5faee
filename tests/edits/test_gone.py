"""What is gone from a converted file: the only actuator, and inertials that the original computes from shapes."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
from lxml import etree

import hymeko_x as hx

LEG = """<mujoco model="leg">
  <worldbody>
    <body name="thigh">
      <joint name="hip" type="slide" axis="0 0 1" range="0 1" damping="1"/>
      <joint name="turn" axis="1 0 0" range="0 90"/>
      <geom name="bone" type="box" size="0.1 0.1 0.1"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="push" joint="hip"/>
  </actuator>
</mujoco>
"""


def updated(folder: Path, name: str, change: tuple[str, str]) -> tuple[list[str], list[str]]:
    """The edits, and the warnings and notes, when a converted file was changed so."""
    (folder / "leg.xml").write_text(LEG)
    hx.convert(folder / "leg.xml", folder / name)
    text, number = re.subn(*change, (folder / name).read_text(), count=1, flags=re.DOTALL)
    assert number == 1
    (folder / name).write_text(text)
    found = hx.update(folder / "leg.xml", folder / name)
    return [str(edit) for edit in found.edits], [row.message for row in found.report if row.code.id in ("HX109", "HX118")]


def test_the_only_actuator_is_removed(tmp_path: Path) -> None:
    edits, notes = updated(tmp_path, "there.hymeko", (r"\n[^\n]*motor[^\n]*", ""))
    assert edits == [
        "actuator 'push': removed actuator(kind 'motor', parameters [])",
        "drive 'push': removed drive(kind '', parameters []) {+ actuator 'push', - joint 'thigh' as 'hip'}",
    ]
    assert notes == []
    assert "motor" not in (tmp_path / "leg.xml").read_text()


@pytest.mark.unread("HX101")
def test_an_inertial_that_the_original_computes_and_the_converted_file_lost_is_reported(tmp_path: Path) -> None:
    edits, notes = updated(tmp_path, "there.urdf", (r'(<link name="thigh">\s*)<inertial>.*?</inertial>', r"\1"))
    assert edits == []
    assert [note.partition(": inertial(")[0] for note in notes] == ["the edit did not arrive: body 'thigh' inertial"]
    assert (tmp_path / "leg.xml").read_text() == LEG


SHAPE = '<collision name="more"><geometry><sphere radius="0.2"/></geometry></collision>'


@pytest.mark.unread("HX101", "HX105")
def test_a_mass_that_a_new_shape_gives_a_body_without_one_is_reported(tmp_path: Path) -> None:
    edits, notes = updated(tmp_path, "there.urdf", (r'<link name="hip_link"/>', f'<link name="hip_link">{SHAPE}</link>'))
    assert edits
    assert [note.partition(" is inertial(")[0] for note in notes] == ["it changed with the edits: body 'hip_link' inertial"]


WRAP = """<mujoco model="arm">
  <worldbody>
    <site name="a" pos="0 0 1"/>
    <body name="arm">
      <joint/>
      <geom name="roll" type="cylinder" size="0.1 0.2"/>
      <geom type="sphere" size="0.1" pos="1 0 0"/>
      <site name="b" pos="1 0 1"/>
    </body>
  </worldbody>
  <tendon>
    <spatial>
      <site site="a"/>
      <geom geom="roll"/>
      <site site="b"/>
    </spatial>
  </tendon>
</mujoco>
"""


@pytest.mark.unread("HX101", "HX104")
def test_a_geom_whose_visual_half_is_removed_still_guides_its_tendon(tmp_path: Path) -> None:
    original, there = tmp_path / "arm.xml", tmp_path / "arm.sdf"
    original.write_text(WRAP)
    hx.convert(original, there)
    tree = etree.parse(there)
    visual = tree.getroot().find(".//visual[@name='roll']")
    visual.getparent().remove(visual)
    tree.write(there)
    hx.update(original, there)
    model = mujoco.MjModel.from_xml_path(str(original))
    assert (model.ntendon, model.nwrap, model.ngeom) == (1, 3, 2)
    assert [model.geom(number).group[0] for number in range(2)] == [3, 0]
    assert not model.geom(1).name
    assert hx.update(original, there).edits == ()
