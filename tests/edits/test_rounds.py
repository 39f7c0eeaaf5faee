"""What an edit brings with it comes home with it: a second update finds nothing more, or reports the same."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
from PIL import Image

import hymeko_x as hx

LEG = """<mujoco model="r">
  <default>
    <geom friction="1.5 0.1 0.1" rgba="0.8 0.6 0.4 1" density="5"/>
  </default>
  <worldbody>
    <body name="leg">
      <geom name="shin" type="capsule" fromto="0 0 0 0 0 1" size="0.1"/>
      <body name="foot" pos="0 0 1">
        <joint name="foot"/>
        <geom name="sole" size="0.1"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor joint="foot" gear="3"/>
  </actuator>
</mujoco>
"""


def brought_home(folder: Path, name: str, *changes: tuple[str, str], text: str = LEG) -> tuple[str, list[str]]:
    """The text after the converted file was changed so, and what both updates report of it; the second one has no edits."""
    original, there = folder / "r.xml", folder / name
    original.write_text(text)
    hx.convert(original, there)
    text = there.read_text()
    for old, new in changes:
        assert old in text, text
        text = text.replace(old, new)
    there.write_text(text)
    first = [str(row) for row in hx.update(original, there).report if row.code.id == "HX118"]
    after = original.read_text()
    again = hx.update(original, there)
    assert (again.edits, original.read_text()) == ((), after)
    assert [str(row) for row in again.report if row.code.id == "HX118"] == first
    return after, [message.partition("note[HX118]: ")[2].partition("\n")[0] for message in first]


JOINT_JSON = (('"joint","id":"foot"', '"joint","id":"ankle"'), ('["joint","foot"]', '["joint","ankle"]'))


@pytest.mark.parametrize(
    ("name", "changes", "motor"),
    [
        ("r.usda", (('Joint "foot"', 'Joint "ankle"'), ("joints/foot>", "joints/ankle>")), 'name="foot_motor" '),
        ("r.hymeko", (("@foot { [0 0 1] + leg }", "@ankle { [0 0 1] + leg - foot }"), ("[3] - foot", "[3] - ankle")), ""),
        ("r.json", JOINT_JSON, ""),
    ],
)
@pytest.mark.unread("HX101")
def test_an_actuator_is_called_as_in_the_edited_file_when_its_joint_is_renamed(
    name: str, changes: tuple[tuple[str, str], ...], motor: str, tmp_path: Path
) -> None:
    renamed = LEG.replace('joint name="foot"', 'joint name="ankle"')
    assert brought_home(tmp_path, name, *changes) == (renamed.replace('motor joint="foot"', f'motor {motor}joint="ankle"'), [])


@pytest.mark.unread("HX101", "HX023")
def test_a_joint_that_a_format_calls_apart_from_its_link_keeps_its_name_when_that_is_renamed(tmp_path: Path) -> None:
    changes = (("<child>foot<", "<child>sole<"), ('link name="foot"', 'link name="sole"'))
    after, notes = brought_home(tmp_path, "r.sdf", *changes)
    assert after == LEG.replace('body name="foot"', 'body name="sole"')
    assert notes == ["the edit did not arrive: joint 'foot' is called 'foot_joint'"]


@pytest.mark.unread("HX101")
def test_the_name_of_a_joint_that_mjcf_has_no_element_for_is_noted_each_time(tmp_path: Path) -> None:
    tool = '<link name="tool"/><joint name="mount" type="fixed"><parent link="foot"/><child link="tool"/></joint></robot>'
    after, notes = brought_home(tmp_path, "r.urdf", ("</robot>", tool))
    assert '        <body name="tool"/>\n' in after
    assert notes == ["the edit did not arrive: joint 'tool' is called 'mount'"]


def test_a_shape_that_is_new_has_mujoco_s_values_where_a_class_would_give_others(tmp_path: Path) -> None:
    ball = "ball { [0 0.2 0] + foot shape { sphere 0.1 } }\n"
    after, notes = brought_home(tmp_path, "r.hymeko", ("  @foot", f"  {ball}  @foot"))
    assert '<geom type="sphere" size="0.1" rgba="0.5 0.5 0.5 1" density="1000" friction="1 0.005 0.0001"/>' in after
    assert notes == []
    there = hx.loads((tmp_path / "r.hymeko").read_text(), "hymeko").mechanism
    models = [mujoco.MjModel.from_xml_string(text) for text in (after, hx.dumps(there, "mjcf"))]
    masses, frictions = ([list(getattr(model, field).flat) for model in models] for field in ("body_mass", "geom_friction"))
    assert masses[0] == pytest.approx(masses[1])
    assert frictions[0] == frictions[1]


TORSO = """<mujoco model="r">
  <worldbody>
    <body name="torso">
      <inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>
      <joint name="j"/>
      <geom name="trunk" type="capsule" fromto="-.5 0 0 .5 0 0" size="0.05"/>
      <geom name="head" type="sphere" pos=".6 0 .1" size="0.1"/>
      <body name="hat" pos="0 0 .5">
        <inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX101")
def test_of_the_shapes_of_a_body_only_the_one_that_was_moved_changes(tmp_path: Path) -> None:
    """The visual of the head moves, and leaves its collision behind; the trunk stays, whatever its place among the shapes."""
    visual = '<visual name="head">\n        <pose>'
    after, _ = brought_home(tmp_path, "r.sdf", (f"{visual}0.6", f"{visual}0.7"), text=TORSO)
    gone, new = (set(a.splitlines()) - set(b.splitlines()) for a, b in ((TORSO, after), (after, TORSO)))
    assert [line.strip() for line in gone] == ['<geom name="head" type="sphere" pos=".6 0 .1" size="0.1"/>']
    assert sorted(line.strip() for line in new) == [
        '<geom name="head" type="sphere" pos="0.7 0 .1" contype="0" conaffinity="0" group="2" size="0.1"/>',
        '<geom name="head_collision" type="sphere" size="0.1" pos="0.6 0 0.1" group="3"/>',
    ]


@pytest.mark.unread("HX101")
def test_a_link_that_is_moved_in_its_joint_is_moved_in_mjcf_which_has_no_such_place(tmp_path: Path) -> None:
    moved = ('<pose relative_to="hat_joint">0 0 0 0 0 0</pose>', '<pose relative_to="hat_joint">0 0.2 0 0 0 0</pose>')
    after, notes = brought_home(tmp_path, "r.sdf", moved, text=TORSO)
    assert (after, notes) == (TORSO.replace('pos="0 0 .5"', 'pos="0 0.2 .5"'), [])


@pytest.mark.unread("HX101")
def test_a_link_that_is_moved_in_its_joint_is_no_edit_that_is_left_where_it_becomes_two_joints(tmp_path: Path) -> None:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    links = f'<link name="base"/><link name="arm">{inertial}</link>'
    joint = '<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="1 0 0"/></joint>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{links}{joint}</robot>')
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.sdf")
    text = (tmp_path / "r.sdf").read_text()
    moved = text.replace('relative_to="j">0 0 0', 'relative_to="j">0 0.5 0')
    assert moved != text
    (tmp_path / "r.sdf").write_text(moved)
    assert hx.update(tmp_path / "r.urdf", tmp_path / "r.sdf").changed
    again = hx.update(tmp_path / "r.urdf", tmp_path / "r.sdf")
    assert (again.edits, [str(row) for row in again.report if row.code.id == "HX118"]) == ((), [])


WALLS = """<mujoco model="r">
  <asset>
    <texture name="t_floor" type="2d" file="floor.png"/>
    <texture name="t_wood" type="2d" file="wood.png"/>
    <texture name="t_wall" type="2d" file="wall.png"/>
    <material name="floor" texture="t_floor" specular="0.1"/>
    <material name="wood" texture="t_wood" specular="0.3"/>
    <material name="wall" texture="t_wall" specular="0.7"/>
  </asset>
  <worldbody>
    <geom type="plane" size="2 2 1" material="floor"/>
    <body name="table">
      <geom name="top" type="box" size="1 1 0.1" material="wood"/>
      <geom name="leg" type="box" size="0.1 0.1 1" material="wood"/>
    </body>
    <body name="wall">
      <geom type="box" size="1 0.1 1" material="wall"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX101", "HX023")
def test_what_is_left_keeps_its_materials_when_a_body_is_removed_from_a_format_where_materials_have_no_names(tmp_path: Path) -> None:
    for name in ("floor", "wood", "wall"):
        Image.new("RGB", (2, 2)).save(tmp_path / f"{name}.png")
    (tmp_path / "r.xml").write_text(WALLS)
    hx.convert(tmp_path / "r.xml", tmp_path / "r.sdf")
    text = (tmp_path / "r.sdf").read_text()
    for element in ('<joint name="wall_joint".*?</joint>', '<link name="wall">.*?</link>'):
        text = re.sub(element, "", text, flags=re.DOTALL)
    (tmp_path / "r.sdf").write_text(text)
    hx.update(tmp_path / "r.xml", tmp_path / "r.sdf")
    after = (tmp_path / "r.xml").read_text().splitlines()
    gone = [line.strip() for line in WALLS.splitlines() if line not in after]
    assert [line.partition(" ")[2] for line in gone] == [
        'name="t_wall" type="2d" file="wall.png"/>',
        'name="wall" texture="t_wall" specular="0.7"/>',
        'name="wall">',
        'type="box" size="1 0.1 1" material="wall"/>',
    ]


PENDULUM = """<mujoco model="r">
  <worldbody>
    <body name="ball">
      <joint name="x" axis="1 0 0"/>
      <joint name="y" axis="0 1 0"/>
      <geom name="bob" pos="0 0 -0.5" size="0.1"/>
    </body>
  </worldbody>
  <actuator>
    <position joint="x" gear="10"/>
    <position joint="y" gear="10"/>
  </actuator>
</mujoco>
"""


@pytest.mark.unread("HX101", "HX023", "HX103")
def test_a_link_that_is_moved_behind_several_joints_keeps_its_actuators(tmp_path: Path) -> None:
    moved = ('<pose relative_to="y">0 0 0 0 0 0</pose>', '<pose relative_to="y">0 0.2 0 0 0 0</pose>')
    after, notes = brought_home(tmp_path, "r.sdf", moved, text=PENDULUM)
    assert [after.count(text) for text in (' pos="0 -0.2 0"', '<body name="ball" pos="0 0.2 0">', "<position")] == [2, 1, 2], after
    assert notes == []


PEN = """<mujoco model="r">
  <worldbody>
    <body name="pen">
      <joint name="j"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <geom name="stem" type="cylinder" size="0.01 0.1"/>
      <geom name="top" type="cylinder" size="0.02 0.02" pos="0 0 0.1" contype="0" conaffinity="0"/>
      <geom name="clip" type="box" size="0.01 0.01 0.03" pos="0.02 0 0" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX101")
def test_one_of_several_visuals_with_names_is_moved(tmp_path: Path) -> None:
    """Where the first shape is two in the converted file, the numbers of the others there are not those of the original."""
    after, notes = brought_home(tmp_path, "r.sdf", ("<pose>0.02 0 0 0 0 0</pose>", "<pose>0.5 0 0 0 0 0</pose>"), text=PEN)
    assert (after, notes) == (PEN.replace('pos="0.02 0 0"', 'pos="0.5 0 0"'), [])


PAIR = """<mujoco model="pair">
  <worldbody>
    <body name="a"><joint name="j"/><geom size="0.1"/></body>
    <body name="b"><joint name="k"/><geom size="0.1"/></body>
  </worldbody>
  <!-- left -->
  <actuator>
    <motor gear="40"  joint="j"/>
  </actuator>
  <!-- right -->
  <actuator>
    <motor gear="80"  joint="k"/>
    <motor gear="20"  joint="j"/>
  </actuator>
</mujoco>
"""


@pytest.mark.parametrize(
    ("change", "wanted"),
    [
        (("[80]", "[90]"), ('"80"', '"90"')),
        (("  k_motor : motor { [80] - k unnamed }\n", ""), ('    <motor gear="80"  joint="k"/>\n', "")),
    ],
)
def test_an_element_without_a_name_is_edited_in_its_own_group(change: tuple[str, str], wanted: tuple[str, str], tmp_path: Path) -> None:
    """A group that stands several times in the text, as <actuator> may, stands once in a print."""
    assert brought_home(tmp_path, "there.hymeko", change, text=PAIR) == (PAIR.replace(*wanted), [])


CARRIER = """<robot name="carrier">
  <link name="base"/>
  <joint name="slide" type="prismatic">
    <parent link="base"/>
    <child link="carrier"/>
    <axis xyz="1 0 0"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/>
  </joint>
  <link name="carrier">
    <inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>
  </link>
</robot>
"""


@pytest.mark.unread("HX103")
def test_a_least_mass_that_a_new_body_makes_needless_is_no_edit(tmp_path: Path) -> None:
    tool = '<body name="tool" pos="0 0 1"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>'
    least = '<inertial pos="0 0 0" mass="1e-10" diaginertia="1e-10 1e-10 1e-10"/>'
    text, notes = brought_home(tmp_path, "there.mjcf", (least, f"{least}{tool}"), text=CARRIER)
    assert '<mass value="0"/>' in text
    assert '<link name="tool">' in text
    assert notes == []
