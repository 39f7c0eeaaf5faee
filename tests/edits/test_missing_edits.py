"""An edit that has no place in the original is reported, whatever else was edited."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
from PIL import Image

import hymeko_x as hx

LEG = """<mujoco model="r">
  <worldbody>
    <body name="leg">
      <geom name="shin" type="capsule" fromto="0 0 0 0 0 1" size="0.1"/>
      <body name="foot" pos="0 0 1">
        <joint name="ankle"/>
        <geom name="sole" size="0.1"/>
        <body name="toe">
          <geom size="0.1"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def updated(folder: Path, name: str, *changes: tuple[str, str]) -> tuple[list[str], list[str]]:
    """The edits, and the warnings, when a converted file was changed so."""
    (folder / "r.xml").write_text(LEG)
    hx.convert(folder / "r.xml", folder / name)
    text = (folder / name).read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / name).write_text(text)
    found = hx.update(folder / "r.xml", folder / name, dry_run=True)
    return [str(edit) for edit in found.edits], [row.message for row in found.report if row.code.id == "HX118"]


@pytest.mark.parametrize(
    ("name", "old", "words"),
    [
        ("r.sdf", "toe_joint", "joint 'toe_joint' is called 'other'"),
        ("r.urdf", '"world"', "body 'world' is called 'other'"),
        ("r.urdf", '"shin"', "shape 'leg/visual' name: 'shin' -> 'other'"),
    ],
)
@pytest.mark.unread("HX101")
def test_a_new_name_of_what_only_the_converted_file_has_is_reported(name: str, old: str, words: str, tmp_path: Path) -> None:
    new = '"other"' if old.startswith('"') else "other"
    edits, warnings = updated(tmp_path, name, (old, new))
    assert edits == []
    assert warnings[0] == f"the edit did not arrive: {words}"


@pytest.mark.unread("HX101")
def test_it_is_reported_beside_an_edit_that_arrives(tmp_path: Path) -> None:
    edits, warnings = updated(tmp_path, "r.urdf", ('"world"', '"other"'), ('"ankle"', '"heel"'))
    assert [edit for edit in edits if "heel" in edit]
    assert warnings == ["the edit did not arrive: body 'world' is called 'other'"]


def test_an_edit_that_arrives_is_not_reported(tmp_path: Path) -> None:
    assert updated(tmp_path, "r.urdf", ('"ankle"', '"heel"'), ('"toe"', '"tip"'))[1] == []


TOOL = """<link name="tool"><inertial><mass value="1.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
<visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual><collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision></link>
<joint name="tool" type="fixed"><parent link="toe"/><child link="tool"/></joint></robot>"""


@pytest.mark.unread("HX101")
def test_a_visual_that_is_added_to_mjcf_touches_nothing(tmp_path: Path) -> None:
    assert updated(tmp_path, "r.urdf", ("</robot>", TOOL))[1] == []
    hx.update(tmp_path / "r.xml", tmp_path / "r.urdf")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml"))
    geoms = range(model.ngeom - 2, model.ngeom)
    assert [(model.geom_contype[geom], model.geom_conaffinity[geom], model.geom_group[geom]) for geom in geoms] == [(0, 0, 2), (1, 1, 3)]
    assert hx.update(tmp_path / "r.xml", tmp_path / "r.urdf", dry_run=True).edits == ()


@pytest.mark.unread("HX101")
def test_a_mass_counts_where_the_engine_passed_over_inertials(tmp_path: Path) -> None:
    passed_over = '<compiler inertiafromgeom="true"/><worldbody>'
    geom = '<inertial pos="0 0 0" mass="9" diaginertia="1 1 1"/>\n      <geom name="shin"'
    (tmp_path / "r.xml").write_text(LEG.replace("<worldbody>", passed_over).replace('<geom name="shin"', geom))
    before = mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml"))
    hx.convert(tmp_path / "r.xml", tmp_path / "r.urdf")
    (tmp_path / "r.urdf").write_text((tmp_path / "r.urdf").read_text().replace("</robot>", TOOL))
    notes = [row.message for row in hx.update(tmp_path / "r.xml", tmp_path / "r.urdf").report]
    assert notes == ['inertiafromgeom becomes "auto": bodies that have an inertial keep it, all others get theirs from geoms as before']
    assert list(hx.update(tmp_path / "r.xml", tmp_path / "r.urdf").report) == []
    after = mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml"))
    assert list(after.body_mass) == [*before.body_mass, 1.5]
    assert (tmp_path / "r.xml").read_text().count("<inertial") == 1  # of the tool: MuJoCo passed over the other one


@pytest.mark.unread("HX101")
def test_a_mesh_that_no_shape_has_any_more_is_no_edit(tmp_path: Path) -> None:
    """The converted file still lists the mesh of a body that was removed."""
    facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet"
    Image.new("RGB", (2, 2)).save(tmp_path / "white.png")
    (tmp_path / "tip.stl").write_text(f"solid tip\n{facet}\nendsolid\n")
    white = '<material name="white"><color rgba="1 1 1 1"/><texture filename="white.png"/></material>'
    mesh = f'<visual><geometry><mesh filename="tip.stl"/></geometry>{white}</visual>'
    tip = f'<link name="tip">{mesh}</link><joint name="j" type="fixed"><parent link="base"/><child link="tip"/></joint>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="base"/>{tip}</robot>')
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.xml")
    (tmp_path / "r.xml").write_text(re.sub('<body name="tip".*?</body>', "", (tmp_path / "r.xml").read_text(), flags=re.DOTALL))
    hx.update(tmp_path / "r.urdf", tmp_path / "r.xml")
    assert "tip" not in (tmp_path / "r.urdf").read_text()
    again = hx.update(tmp_path / "r.urdf", tmp_path / "r.xml")
    assert ([str(edit) for edit in again.edits], [row.message for row in again.report]) == ([], [])


@pytest.mark.unread("HX101")
def test_a_body_that_something_of_mjcf_s_own_refers_to_is_not_removed(tmp_path: Path) -> None:
    eye = '<camera name="eye" mode="targetbody" target="toe" pos="1 0 0"/></worldbody>'
    (tmp_path / "r.xml").write_text(LEG.replace("</worldbody>", eye))
    hx.convert(tmp_path / "r.xml", tmp_path / "r.urdf")
    text = re.sub('<link name="toe">.*?</link>', "", (tmp_path / "r.urdf").read_text(), flags=re.DOTALL)
    (tmp_path / "r.urdf").write_text(re.sub('<joint name="toe".*?</joint>', "", text, flags=re.DOTALL))
    with pytest.raises(
        hx.Refusal, match="with the edits the original cannot be used: .*<camera> refers to the body 'toe', which is not there"
    ):
        hx.update(tmp_path / "r.xml", tmp_path / "r.urdf")
    assert "toe" in (tmp_path / "r.xml").read_text()


PAD = """<mujoco model="pad">
  <worldbody>
    <geom name="floor" type="box" size="1 1 0.1"{}/>
  </worldbody>
</mujoco>
"""
BLUE = '<material name="{}"><color rgba="0 0 1 1"/></material>'


@pytest.mark.unread("HX101")
@pytest.mark.parametrize(
    ("own", "material", "words"),
    [
        ("", "blue", "has the colour 0 0 1 1"),
        (' rgba="1 0 0 1"', "blue", "has the colour 0 0 1 1"),
        (' rgba="1 0 0 1"', "", "has the colour 0 0 1 1"),
    ],
)
def test_a_colour_of_the_collision_alone_of_a_geom_that_is_both_is_reported(own: str, material: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "pad.xml").write_text(PAD.format(own))
    hx.convert(tmp_path / "pad.xml", tmp_path / "pad.urdf")
    start, collision, rest = (tmp_path / "pad.urdf").read_text().partition("<collision")
    rest = re.sub(r"(?s)</geometry>(\s*<material.*?</material>)?", f"</geometry>{BLUE.format(material)}", rest, count=1)
    (tmp_path / "pad.urdf").write_text(start + collision + rest)
    found = hx.update(tmp_path / "pad.xml", tmp_path / "pad.urdf", dry_run=True)
    assert [row.message for row in found.report if row.code.id == "HX118"] == [f"the edit did not arrive: shape 'world/collision' {words}"]


TWO = """<mujoco model="r">
  <worldbody>
    <body name="a">
      <freejoint/>
      <geom name="one" size="0.1"/>
      <geom name="two" size="0.2" pos="1 0 0"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX101", "HX102", "HX104", "HX105")
def test_a_collision_that_becomes_a_geom_of_its_own_and_the_first_one_arrives(tmp_path: Path) -> None:
    """The collision of the geom before it stands behind it then."""
    (tmp_path / "r.xml").write_text(TWO)
    hx.convert(tmp_path / "r.xml", tmp_path / "r.sdf")
    start, collision, rest = (tmp_path / "r.sdf").read_text().partition('<collision name="two_collision">')
    (tmp_path / "r.sdf").write_text(start + collision + rest.replace("<radius>0.2", "<radius>0.3", 1))
    report = hx.update(tmp_path / "r.xml", tmp_path / "r.sdf").report
    assert [row.message for row in report if row.code.id == "HX118"] == []
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml"))
    assert sorted(float(size) for size in model.geom_size[:, 0]) == [0.1, 0.2, 0.3]


@pytest.mark.unread("HX101", "HX102", "HX104", "HX105")
def test_a_painted_visual_of_a_geom_that_is_both_paints_it_and_leaves_its_mass_alone(tmp_path: Path) -> None:
    text = TWO.replace('size="0.1"', 'size="0.1" rgba="1 0 0 1"')
    (tmp_path / "r.xml").write_text(text)
    hx.convert(tmp_path / "r.xml", tmp_path / "r.urdf")
    (tmp_path / "r.urdf").write_text((tmp_path / "r.urdf").read_text().replace("1 0 0 1", "0 1 0 1", 1))
    report = hx.update(tmp_path / "r.xml", tmp_path / "r.urdf").report
    assert [row.message for row in report if row.code.id == "HX118"] == []
    assert (tmp_path / "r.xml").read_text() == text.replace("1 0 0 1", "0 1 0 1")


ROD = """<robot name="rod">
  <link name="rod">
    <inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <visual><geometry><cylinder radius="0.1" length="0.5"/></geometry></visual>
  </link>
</robot>
"""


@pytest.mark.unread("HX105")
@pytest.mark.parametrize("group", ["", '    def Scope "mine"\n    {\n    }\n\n'])
def test_what_holds_nothing_in_a_stage_is_no_lost_edit(group: str, tmp_path: Path) -> None:
    """The extent of a cylinder is that of its old height; a group has nothing in it."""
    (tmp_path / "rod.urdf").write_text(ROD)
    hx.convert(tmp_path / "rod.urdf", tmp_path / "rod.usda")
    stage = (tmp_path / "rod.usda").read_text().replace("height = 0.5", "height = 0.7")
    if group:
        stage = stage.replace("0.25)", "0.35)").replace('    def Xform "rod"', f'{group}    def Xform "rod"', 1)
    (tmp_path / "rod.usda").write_text(stage)
    report = hx.update(tmp_path / "rod.urdf", tmp_path / "rod.usda").report
    assert [str(row) for row in report if row.code.id == "HX118"] == []
    assert (tmp_path / "rod.urdf").read_text() == ROD.replace("0.5", "0.7")


LIFT = """<robot name="lift">
  <link name="base"><inertial><mass value="4"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="arm">
    <inertial><origin xyz="1 0 0"/><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <joint name="j" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="90" velocity="1"/>
  </joint>
  <transmission name="t">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="j"><hardwareInterface>hardware_interface/PositionJointInterface</hardwareInterface></joint>
    <actuator name="m"/>
  </transmission>
</robot>
"""


@pytest.mark.unread("HX101", "HX105", "HX114")
@pytest.mark.parametrize(
    ("name", "old", "new"), [("lift.xml", 'mass="1"', 'mass="2"'), ("lift.usda", "physics:mass = 1\n", "physics:mass = 2\n")]
)
def test_gains_that_follow_from_an_edited_mass_are_a_note(name: str, old: str, new: str, tmp_path: Path) -> None:
    (tmp_path / "lift.urdf").write_text(LIFT)
    hx.convert(tmp_path / "lift.urdf", tmp_path / name)
    text = (tmp_path / name).read_text()
    assert text.count(old) == 1
    (tmp_path / name).write_text(text.replace(old, new))
    report = hx.update(tmp_path / "lift.urdf", tmp_path / name).report
    called = "m" if name == "lift.xml" else "j"
    words = f"the gains of actuator '{called}' follow from masses, and are old in the edited file"
    assert [(row.severity.name, row.message) for row in report if row.code.id == "HX118"] == [("NOTE", words)]
    assert (tmp_path / "lift.urdf").read_text() == LIFT.replace('mass value="1"', 'mass value="2"')
    hx.convert(tmp_path / "lift.urdf", tmp_path / name)
    assert [row for row in hx.update(tmp_path / "lift.urdf", tmp_path / name).report if row.code.id == "HX118"] == []


FLAP = """<mujoco>
  <default><joint springdamper="0.1 0.5" stiffness="3"/></default>
  <worldbody>
    <body name="box"><freejoint/><geom name="g" size="0.1" mass="3"/>
      <body name="flap" pos="0.2 0 0">
        <joint name="hinge" axis="0 1 0"/>
        <inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
"""A spring of which MuJoCo computes stiffness and damping from masses, whatever stiffness is stated."""


@pytest.mark.unread("HX105", "HX106", "HX114")
def test_springs_that_follow_from_an_edited_mass_are_a_note(tmp_path: Path) -> None:
    original, converted = tmp_path / "flap.xml", tmp_path / "flap.sdf"
    original.write_text(FLAP)
    hx.convert(original, converted)
    converted.write_text(converted.read_text().replace("<mass>1</mass>", "<mass>2</mass>"))
    report = hx.update(original, converted).report
    words = "stiffness and damping of joint 'hinge' follow from masses, and are old in the edited file"
    assert [(row.severity.name, row.message, row.origin and row.origin.line) for row in report if row.code.id == "HX118"] == [
        ("NOTE", words, 6)
    ]
    after = FLAP.replace('mass="1"', 'mass="2"')
    assert original.read_text() == after
    again = hx.update(original, converted)
    assert again.edits == ()
    told = [row.message for row in again.report if row.code.id == "HX118"]
    assert len(told) == 2
    assert all(message.endswith("which follows from masses in the original") for message in told)
    assert original.read_text() == after
    hx.convert(original, converted)
    assert [row for row in hx.update(original, converted).report if row.code.id == "HX118"] == []


@pytest.mark.unread("HX106", "HX114")
def test_the_edit_of_a_spring_that_follows_from_masses_is_reported(tmp_path: Path) -> None:
    original, converted = tmp_path / "flap.xml", tmp_path / "flap.sdf"
    original.write_text(FLAP)
    hx.convert(original, converted)
    text = converted.read_text()
    stiffness = text.partition("<spring_stiffness>")[2].partition("<")[0]
    converted.write_text(text.replace(f"<spring_stiffness>{stiffness}", "<spring_stiffness>7"))
    report = hx.update(original, converted).report
    words = f"the edit did not arrive: joint 'hinge' dofs[0].stiffness: {stiffness} -> 7, which follows from masses in the original"
    assert [(row.severity.name, row.message) for row in report if row.code.id == "HX118"] == [("WARNING", words)]
    assert original.read_text() == FLAP


BASE = """<sdf version="1.9">
  <model name="m">
    <link name="base"/>
  </model>
</sdf>
"""


@pytest.mark.unread("HX103", "HX105")
def test_a_body_without_mass_that_is_added_to_sdf_weighs_nothing(tmp_path: Path) -> None:
    """SDF takes a link without an inertial for one of 1 kg, as the base is here."""
    (tmp_path / "r.sdf").write_text(BASE)
    hx.convert(tmp_path / "r.sdf", tmp_path / "r.urdf")
    tool = '<link name="tool"/><joint name="t" type="fixed"><parent link="base"/><child link="tool"/></joint></robot>'
    (tmp_path / "r.urdf").write_text((tmp_path / "r.urdf").read_text().replace("</robot>", tool))
    hx.update(tmp_path / "r.sdf", tmp_path / "r.urdf")
    assert '    <link name="base"/>\n' in (tmp_path / "r.sdf").read_text()
    assert [body.mass for body in hx.load(tmp_path / "r.sdf").bodies.values()] == [1.0, 1e-10]


SENSOR = """<robot name="r">
  <link name="base"/>
  <gazebo reference="base">
    <sensor name="imu" type="imu"><always_on>true</always_on></sensor>
  </gazebo>
</robot>
"""


def test_an_edit_of_what_a_fragment_of_the_original_describes_is_reported_where_nothing_else_was_edited(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(SENSOR)
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.sdf")
    (tmp_path / "r.sdf").write_text((tmp_path / "r.sdf").read_text().replace("true</always_on>", "false</always_on>"))
    found = hx.update(tmp_path / "r.urdf", tmp_path / "r.sdf")
    start = "the edit did not arrive: sensor 'imu' sdf content"
    assert [row.message for row in found.report if row.code.id == "HX118"] == [
        f"{start}: removed <always_on>true</always_on>",
        f"{start}: added <always_on>false</always_on>",
    ]


SLAB = """<robot name="r">
  <link name="base"/>
  <link name="slab">
    <inertial>
      <origin xyz="0 0 0.15"/>
      <mass value="1.2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.001"/>
    </inertial>
    <collision><origin xyz="0 0 0.15"/><geometry><box size="0.1 0.1 0.3"/></geometry></collision>
  </link>
  <joint name="j" type="continuous"><parent link="base"/><child link="slab"/><axis xyz="0 1 0"/></joint>
</robot>
"""


@pytest.mark.unread("HX101", "HX103")
def test_a_density_in_the_place_of_an_inertial_arrives_as_the_mass_that_the_engine_computes(tmp_path: Path) -> None:
    original, there = tmp_path / "r.urdf", tmp_path / "r.xml"
    original.write_text(SLAB)
    hx.convert(original, there)
    text = re.sub(r" *<inertial [^>]*>\n", "", there.read_text())
    there.write_text(text.replace("<geom class", '<geom density="300" class'))
    report = hx.update(original, there).report
    assert [str(row) for row in report if row.code.id == "HX118"] == []
    mass, tensor = '<mass value="0.9"/>', '<inertia ixx="0.0075" ixy="0" ixz="0" iyy="0.0075" iyz="0" izz="0.0015"/>'
    assert original.read_text() == re.sub("<inertia ixx.*/>", tensor, SLAB).replace('<mass value="1.2"/>', mass)
    again = hx.update(original, there)
    assert (again.edits, [row for row in again.report if row.code.id == "HX118"]) == ((), [])
