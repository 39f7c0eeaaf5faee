"""Shapes that a format shows in several parts: an edit of one part arrives, and so does what is beside it."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx

LEG = """<mujoco model="leg">
  <worldbody>
    <body name="leg">
      <joint name="knee"/>
      <geom type="capsule" size="0.1 0.5" group="3"/>
      <geom type="capsule" size="0.2 0.5" pos="1 0 0" group="3"/>
    </body>
  </worldbody>
</mujoco>
"""
OTHER = '      <geom type="capsule" size="0.2 0.5" pos="1 0 0" group="3"/>\n'
BALL = '<origin xyz="0 0 0.5" rpy="0 0 0"/>\n      <geometry>\n        <sphere radius="0.1"/>'
BAR = '<cylinder radius="0.1" length="1"/>'


@pytest.mark.parametrize(
    ("old", "new", "shapes"),
    [
        (BALL, BALL.replace('"0.1"', '"0.3"'), ["cylinder 0.1", "sphere 0.3", "sphere 0.1"]),
        (BALL, BALL.replace("0 0 0.5", "0 0.4 0.5"), ["cylinder 0.1", "sphere 0.1", "sphere 0.1"]),
        (BAR, BAR.replace('"0.1"', '"0.3"'), ["cylinder 0.3", "sphere 0.1", "sphere 0.1"]),
        (BAR, '<box size="0.6 1 1"/>', ["box 0.3", "sphere 0.1", "sphere 0.1"]),
        (f"<collision>\n      <geometry>\n        {BAR}\n      </geometry>\n    </collision>\n", "", ["sphere 0.1", "sphere 0.1"]),
    ],
    ids=["size", "place", "first", "geometry", "removed"],
)
@pytest.mark.unread("HX101", "HX108")
def test_an_edit_of_one_part_of_a_capsule_arrives(old: str, new: str, shapes: list[str], tmp_path: Path) -> None:
    original, there = tmp_path / "leg.xml", tmp_path / "leg.urdf"
    original.write_text(LEG)
    hx.convert(original, there)
    text = there.read_text()
    assert text.count(old) == 1
    there.write_text(text.replace(old, new))
    hx.update(original, there)
    model = mujoco.MjModel.from_xml_path(str(original))
    kinds = [mujoco.mjtGeom(kind).name.removeprefix("mjGEOM_").lower() for kind in model.geom_type]
    found = [f"{kind} {size[0]:g}" for kind, size in zip(kinds, model.geom_size, strict=True)]
    assert sorted(found) == sorted([*shapes, "capsule 0.2"])
    assert OTHER in original.read_text()
    again = hx.update(original, there)
    assert (again.edits, [row for row in again.report if row.code.id == "HX118"]) == ((), [])


@pytest.mark.unread("HX101")
def test_a_part_without_the_noise_of_its_place_is_the_same(tmp_path: Path) -> None:
    original, there = tmp_path / "leg.xml", tmp_path / "leg.urdf"
    original.write_text(LEG.replace('size="0.1 0.5"', 'size="0.1 0.5" pos="2e-17 0 0.5"'))
    hx.convert(original, there)
    text, noise = there.read_text(), '<origin xyz="2e-17 0 0" rpy="0 0 0"/>'
    assert text.count(noise) == 1
    there.write_text(text.replace(noise, ""))
    assert hx.update(original, there).edits == ()


@pytest.mark.unread("HX101")
def test_the_ends_of_a_geom_that_an_edit_adds_are_short_numbers(tmp_path: Path) -> None:
    original, there = tmp_path / "leg.xml", tmp_path / "leg.urdf"
    rod = '<default><default class="rod"><geom type="capsule" size="0.065" fromto="0 0 0 .25 0 -.25"/></default></default>'
    body = '<body name="leg" childclass="rod"><joint name="knee"/><geom name="rod"/></body>'
    original.write_text(f'<mujoco model="leg">{rod}<worldbody>{body}</worldbody></mujoco>')
    hx.convert(original, there)
    part = '<visual name="rod">\n      <origin xyz="0.125 0 -0.125"'
    assert there.read_text().count(part) == 1
    there.write_text(there.read_text().replace(part, part.replace("0.125", "0.5", 1)))
    hx.update(original, there)
    assert original.read_text().count('fromto="0.375 0 0 0.625 0 -0.25"') == 1
    assert original.read_text().count('fromto="0 0 0 0.25 0 -0.25"') == 1


@pytest.mark.unread("HX101")
def test_a_capsule_whose_parts_change_together_stays_one(tmp_path: Path) -> None:
    original, there = tmp_path / "leg.xml", tmp_path / "leg.urdf"
    original.write_text(LEG.replace('group="3"', 'contype="0" conaffinity="0"'))
    hx.convert(original, there)
    text = there.read_text()
    colour = "<material name='red'><color rgba='1 0 0 1'/></material>"
    for part in [part for part in re.findall(r"<visual>.*?</visual>", text, flags=re.DOTALL) if 'radius="0.1"' in part]:
        text = text.replace(part, part.replace("</visual>", f"{colour}</visual>"))
    assert text.count(colour) == 3
    there.write_text(text.replace('"0 0 0.5"', '"0 0.25 0.5"').replace('"0 0 -0.5"', '"0 0.25 -0.5"'))
    there.write_text(there.read_text().replace("<visual>", '<visual><origin xyz="0 0.25 0"/>', 1))
    hx.update(original, there)
    assert original.read_text().count('type="capsule"') == 2
    model = mujoco.MjModel.from_xml_path(str(original))
    assert [list(place) for place in model.geom_pos] == [[0, 0.25, 0], [1, 0, 0]]
    assert hx.update(original, there).edits == ()


@pytest.mark.unread("HX101")
def test_an_end_of_a_capsule_that_is_a_geom_now_has_its_name(tmp_path: Path) -> None:
    original, there = tmp_path / "leg.xml", tmp_path / "leg.urdf"
    original.write_text(LEG.replace('<geom type="capsule" size="0.1', '<geom name="shin" type="capsule" size="0.1'))
    hx.convert(original, there)
    there.write_text(there.read_text().replace(BALL, BALL.replace('"0.1"', '"0.3"')))
    assert [str(row) for row in hx.update(original, there).report if row.code.id == "HX118"] == []
    model = mujoco.MjModel.from_xml_path(str(original))
    assert {model.geom(number).name for number in range(model.ngeom)} == {"shin", "shin_top", "shin_bottom", ""}


BLACK = """<mujoco model="r">
  <asset>
    <material name="black" rgba="0.15 0.15 0.15 1"/>
  </asset>
  <worldbody>
    <body name="b">
      <joint name="j"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <geom type="box" size="1 2 3" quat="1 0 0 1" material="black" contype="0" conaffinity="0" group="2"/>
      <geom type="box" size="1 2 3" quat="1 0 0 1"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX101")
def test_of_two_shapes_at_one_place_the_one_of_the_removed_colour_goes(tmp_path: Path) -> None:
    original, there = tmp_path / "r.xml", tmp_path / "r.sdf"
    original.write_text(BLACK)
    hx.convert(original, there)
    text, count = re.subn(r'<visual name="visual_2">.*?</visual>', "", there.read_text(), flags=re.DOTALL)
    assert count == 1
    there.write_text(text)
    hx.update(original, there)
    assert 'material="black" contype="0" conaffinity="0" group="2"/>' in original.read_text()
    model = mujoco.MjModel.from_xml_path(str(original))
    assert (list(model.geom_group), list(model.geom_contype)) == ([2, 3], [0, 1])


def test_a_name_for_a_joint_that_has_none_is_noted(tmp_path: Path) -> None:
    original, there = tmp_path / "r.xml", tmp_path / "r.json"
    original.write_text(BLACK.replace('<joint name="j"/>', "<joint/>"))
    hx.convert(original, there)
    text = there.read_text()
    assert '"joint","id":"b"' in text
    there.write_text(text.replace('"joint","id":"b"', '"joint","id":"hip"').replace('["joint","b"]', '["joint","hip"]'))
    found = hx.update(original, there)
    assert found.edits == ()
    note = f"{original}: note[HX118]: the edit did not arrive: joint 'b' is called 'hip'\n  hint: mjcf has no name for it there"
    assert [str(row) for row in found.report] == [note]


@pytest.mark.unread("HX101", "HX105")
@pytest.mark.parametrize("part", ["cylinder", "sphere"])
@pytest.mark.parametrize("place", [0, 1])
def test_an_edit_of_one_part_leaves_the_other_capsules_of_the_body(part: str, place: int, tmp_path: Path) -> None:
    """The geoms are seen and touched, so that each is six shapes of URDF, none of which has a name."""
    original, there = tmp_path / "leg.xml", tmp_path / "leg.urdf"
    whole = LEG.replace(' group="3"', "").replace("<joint", '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>\n      <joint')
    original.write_text(whole)
    hx.convert(original, there)
    pieces = re.split(f'({part} radius="0.2")', there.read_text())
    number = 1 + 2 * place  # of the two cylinders, or the first two of four balls
    pieces[number] = pieces[number].replace("0.2", "0.25")
    there.write_text("".join(pieces))
    hx.update(original, there)
    before, after = whole.splitlines(), original.read_text().splitlines()
    kept = [line for line in before if 'size="0.2 ' not in line]
    assert [line for line in after if line in kept] == kept
    geoms = [line for line in after if "<geom" in line and line not in kept]
    assert (len(geoms), sum("0.25" in line for line in geoms)) == (6, 1)


CROSSED = """<mujoco model="finger">
  <worldbody>
    <body name="finger">
      <joint name="knuckle"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <geom type="capsule" size="0.007" fromto="0.009 0.006 0.0875 -0.009 0.009 0.0875" group="3"/>
      <geom type="capsule" size="0.007" fromto="0.009 0.009 0.0875 -0.009 0.006 0.0875" group="3"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX101", "HX105")
@pytest.mark.parametrize("number", range(4))
def test_balls_whose_distance_is_rounded_are_those_of_their_capsule(number: int, tmp_path: Path) -> None:
    """The length of a capsule, and the distance of its ends as they are written, differ in the last digit."""
    original, there = tmp_path / "finger.xml", tmp_path / "finger.urdf"
    original.write_text(CROSSED)
    hx.convert(original, there)
    pieces = there.read_text().split('sphere radius="0.007"')
    pieces[number : number + 2] = ['sphere radius="0.05"'.join(pieces[number : number + 2])]
    there.write_text('sphere radius="0.007"'.join(pieces))
    hx.update(original, there)
    model = mujoco.MjModel.from_xml_path(str(original))
    kinds = [mujoco.mjtGeom(kind).name for kind in model.geom_type]
    assert sorted(kinds) == ["mjGEOM_CAPSULE", "mjGEOM_CYLINDER", "mjGEOM_SPHERE", "mjGEOM_SPHERE"]
    assert sorted(model.geom_size[:, 0]) == [0.007, 0.007, 0.007, 0.05]


@pytest.mark.unread("HX101", "HX102", "HX105")
def test_the_parts_of_a_named_capsule_stand_where_it_stood(tmp_path: Path) -> None:
    """A print has them in another order, which is no reason to print the whole text anew; the other geoms are called as they were."""
    original, there = tmp_path / "leg.xml", tmp_path / "leg.urdf"
    geoms = ('"thigh" type="capsule" size="0.3 0.5"', '"shin" type="capsule" size="0.2 0.5"', '"foot" type="box" size="1 1 1"')
    lines = [f"      <geom name={geom}/>\n" for geom in geoms]
    whole = LEG[: LEG.index("      <geom")] + "".join(lines) + LEG[LEG.index("    </body>") :]
    whole = whole.replace("<joint", '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>\n      <joint')
    original.write_text(whole)
    hx.convert(original, there)
    there.write_text(there.read_text().replace('cylinder radius="0.2"', 'cylinder radius="0.25"', 1))
    report = hx.update(original, there).report
    before, after = whole.splitlines(), original.read_text().splitlines()
    kept = [line for line in before if "shin" not in line]
    assert [line for line in after if line in kept] == kept
    assert len(after) == len(before) + 5
    assert '      <geom name="shin" type="cylinder" size="0.25 0.5"' in original.read_text()
    called = {row.message.rpartition(" ")[2] for row in report if row.code.id == "HX118"}
    assert called <= {"'shin'", "'shin_top'", "'shin_bottom'"}


SLIPPERY = """<mujoco model="r">
  <worldbody>
    <body name="foot">
      <joint name="ankle"/>
      <geom name="sole" size="0.1" friction="0.9"/>
    </body>
  </worldbody>
</mujoco>
"""


def test_the_friction_of_the_collision_is_that_of_the_geom(tmp_path: Path) -> None:
    """SDF has the geom as a visual and a collision, of which the second one has the friction; it weighs nothing."""
    original, there = tmp_path / "r.xml", tmp_path / "r.sdf"
    original.write_text(SLIPPERY)
    assert not [loss for loss in hx.convert(original, there).losses if loss.field == "friction"]
    there.write_text(there.read_text().replace("<mu>0.9</mu>", "<mu>0.5</mu>"))
    report = hx.update(original, there).report
    assert (original.read_text(), [*report]) == (SLIPPERY.replace('friction="0.9"', 'friction="0.5"'), [])
