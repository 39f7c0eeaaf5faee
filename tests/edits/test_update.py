"""Edits of a converted file become edits of the text that it was converted from, and of nothing else in it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

import pytest

import hymeko_x as hx
from hymeko_x.cli import main
from hymeko_x.diagnostics import Report
from hymeko_x.source import Source
from tests.residue.samples import MJCF

ARM = """<?xml version="1.0"?>
<!-- made by hand -->
<robot name="arm">
  <material name="steel"><color rgba="0.7 0.70 0.7 1.0"/></material>
  <link name="base"><visual name="plate">
    <geometry><box size="0.20 0.2 0.05"/></geometry><material name="steel"/></visual></link>
  <link name='upper'>   <!-- the upper arm -->
    <inertial>
      <mass value="1.50"/> <!-- weighed -->
      <origin rpy="0 0.1 0" xyz="0 0 0.150"/>
      <inertia ixx="0.010" ixy="0" ixz="0" iyy="0.011" iyz="0" izz="0.002"/>
    </inertial>
    <visual><geometry><cylinder radius="0.04" length="0.30"/></geometry></visual>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="upper"/>
    <origin xyz="0 0 0.050" rpy="0 0 1.570"/>
    <axis xyz="0 0 2"/>
    <limit lower="-1.5" upper="1.50" effort="20" velocity="3.14"/>
  </joint>
  <link name="tool"/>
  <joint name="mount" type="fixed">
    <parent link="upper"/> <child link="tool"/>
  </joint>
</robot>
"""
SUFFIXES = {"urdf": ".urdf", "mjcf": ".xml", "usd": ".usda", "hymeko": ".hymeko", "xacro": ".xacro", "sdf": ".sdf"}


def edited(text: str, target: str, edit: tuple[str, str], folder: Path, source: str = "urdf", **options: object) -> str:
    """The text after its conversion to the target was edited by a substitution, and that was brought home."""
    original, there = folder / f"arm{SUFFIXES[source]}", folder / f"there{SUFFIXES[target]}"
    original.write_bytes(text.encode())
    hx.convert(original, there, **options)  # type: ignore[arg-type]
    pattern, new = edit
    content, count = re.subn(pattern, new, there.read_text(), count=1, flags=re.DOTALL)
    assert count == 1, there.read_text()
    there.write_text(content)
    found = hx.update(original, there)
    assert [str(diagnostic) for diagnostic in found.report if diagnostic.code.id == "HX108"] == []
    return original.read_bytes().decode()


def changed_lines(before: str, after: str) -> list[tuple[str, str]]:
    """The lines that differ between two texts of as many lines."""
    rows = list(zip(before.split("\n"), after.split("\n"), strict=True))
    return [(a.strip(), b.strip()) for a, b in rows if a != b]


MASS = {
    "mjcf": ('mass="1.5"', 'mass="2.25"'),
    "hymeko": (r"mass 1\.5", "mass 2.25"),
    "usd": (r"physics:mass = 1\.5", "physics:mass = 2.25"),
    "xacro": ('<mass value="1.5"/>', '<mass value="2.25"/>'),
}


@pytest.mark.parametrize("target", MASS)
def test_a_mass_changes_one_number_of_one_line(target: str, tmp_path: Path) -> None:
    after = edited(ARM, target, MASS[target], tmp_path)
    assert changed_lines(ARM, after) == [('<mass value="1.50"/> <!-- weighed -->', '<mass value="2.25"/> <!-- weighed -->')]


@pytest.mark.parametrize("target", MASS)
def test_what_was_not_edited_changes_nothing(target: str, tmp_path: Path) -> None:
    original, there = tmp_path / "arm.urdf", tmp_path / f"there{SUFFIXES[target]}"
    original.write_text(ARM)
    hx.convert(original, there)
    found = hx.update(original, there)
    assert (found.edits, found.changed, original.read_text()) == ((), {}, ARM)


def test_of_a_row_of_numbers_only_those_that_were_edited_change(tmp_path: Path) -> None:
    after = edited(ARM, "mjcf", (r'(name="upper" pos=)"0 0 0.05"', r'\1"0 0.1 0.05"'), tmp_path)
    assert changed_lines(ARM, after) == [('<origin xyz="0 0 0.050" rpy="0 0 1.570"/>', '<origin xyz="0 0.1 0.050" rpy="0 0 1.570"/>')]


def test_a_renamed_link_is_renamed_where_it_is_named(tmp_path: Path) -> None:
    after = edited(ARM, "mjcf", ('body name="upper"', 'body name="humerus"'), tmp_path)
    assert after == ARM.replace("'upper'", "'humerus'").replace('"upper"', '"humerus"')


def test_line_ends_stay_what_they_are(tmp_path: Path) -> None:
    text = ARM.replace("\n", "\r\n")
    new = '<body name="upper"\\1<body name="pen" pos="0 0 0.3"><geom type="sphere" size="0.01" mass="0.1"/></body></body>'
    after = edited(text, "mjcf", (r'<body name="upper"(.*?)</body>', new), tmp_path)
    assert "\n" not in after.replace("\r\n", "")
    assert after.startswith(text[: text.index('  <link name="tool"/>')])


def test_a_body_that_is_added_is_inserted_with_the_indentation_around_it(tmp_path: Path) -> None:
    body = '<body name="pen" pos="0 0 0.3"><geom name="tip" type="sphere" size="0.01" mass="0.1"/></body>'
    after = edited(ARM, "mjcf", (r'(<body name="tool".*?>)', rf"\1{body}"), tmp_path)
    assert all(line in after for line in ARM.splitlines())
    assert '  <link name="pen">\n    <inertial>\n' in after
    assert '  <joint name="pen" type="fixed">\n' in after


def test_a_body_that_is_removed_leaves_nothing_behind(tmp_path: Path) -> None:
    after = edited(ARM, "mjcf", (r'\s*<body name="tool"/>', ""), tmp_path)
    assert after == ARM.replace('  <link name="tool"/>\n', "").replace(
        '  <joint name="mount" type="fixed">\n    <parent link="upper"/> <child link="tool"/>\n  </joint>\n', ""
    )


@pytest.mark.unread("HX104")
def test_a_value_of_a_default_class_becomes_one_of_the_joint(tmp_path: Path) -> None:
    pattern = r'(<joint name="left_hip_y".*?upper=)"[^"]*"'
    after = edited(MJCF, "urdf", (pattern, r'\1"1.5"'), tmp_path, "mjcf")
    rows = changed_lines(MJCF, after)
    assert rows == [
        (
            '<joint name="left_hip_y" axis="0 1 0" range="-20 110" ref="10"/>',
            '<joint name="left_hip_y" axis="0 1 0" range="-20 85.94366926962348" ref="10"/>',
        )
    ]


def test_a_body_moves_with_the_text_of_its_author(tmp_path: Path) -> None:
    text = """<mujoco model="m">
  <worldbody>
    <body name="a">
      <geom type="box" size="0.10 0.1 0.1"/>
      <body name="b" pos="0 0 1.0">  <!-- stays with it -->
        <geom type="sphere" size="0.050"/>
      </body>
    </body>
    <body name="c">
      <geom type="box" size="0.10 0.1 0.1"/>
      <body name="d"><geom type="sphere" size="0.1"/></body>
    </body>
  </worldbody>
</mujoco>
"""
    after = edited(text, "urdf", (r'(<joint name="b".*?<parent link=)"a"', r'\1"c"'), tmp_path, "mjcf")
    inner = """      <body name="b" pos="0 0 1.0">  <!-- stays with it -->
        <geom type="sphere" size="0.050"/>
      </body>
"""
    d = '      <body name="d"><geom type="sphere" size="0.1"/></body>\n'
    assert after in (text.replace(inner, "").replace(d, d + inner), text.replace(inner, "").replace(d, inner + d))


def test_an_included_file_gets_the_edits_of_what_stands_in_it(tmp_path: Path) -> None:
    main_text = '<mujoco model="m">\n  <include file="parts/arm.xml"/>\n</mujoco>\n'
    part = """<mujoco>
  <worldbody>
    <body name="a">
      <inertial pos="0 0 0" mass="2.0" diaginertia="0.01 0.01 0.01"/>
    </body>
  </worldbody>
</mujoco>
"""
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/arm.xml").write_text(part)
    assert edited(main_text, "urdf", ('<mass value="2"/>', '<mass value="3"/>'), tmp_path, "mjcf") == main_text
    assert (tmp_path / "parts/arm.xml").read_text() == part.replace('"2.0"', '"3"')


@pytest.mark.unread("HX103")
def test_options_of_the_conversion_are_found_out(tmp_path: Path) -> None:
    original, there = tmp_path / "arm.urdf", tmp_path / "there.xml"
    original.write_text(ARM)
    hx.convert(original, there, base="free", actuators="position")
    there.write_text(there.read_text().replace('mass="1.5"', 'mass="2.25"'))
    found = hx.update(original, there, dry_run=True)
    assert list(map(str, found.edits)) == ["body 'upper' inertial.mass: 1.5 -> 2.25"]
    assert [str(diagnostic) for diagnostic in found.report] == [
        "note[HX109]: the file was converted with --base free --actuators position, as far as can be seen"
    ]


def test_a_rehearsal_prints_the_difference_and_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    original, there = tmp_path / "arm.urdf", tmp_path / "there.xml"
    original.write_text(ARM)
    hx.convert(original, there)
    there.write_text(there.read_text().replace('mass="1.5"', 'mass="2.25"'))
    capsys.readouterr()
    assert main(["update", str(original), str(there), "--dry-run"]) == 0
    printed = capsys.readouterr()
    assert [line for line in printed.out.splitlines() if line[:1] in "+-"][2:] == [
        '-      <mass value="1.50"/> <!-- weighed -->',
        '+      <mass value="2.25"/> <!-- weighed -->',
    ]
    assert printed.err == f"{original}:7: edit: body 'upper' inertial.mass: 1.5 -> 2.25\n"
    assert original.read_text() == ARM


def test_another_output_leaves_the_original_alone(tmp_path: Path) -> None:
    original, there, out = tmp_path / "arm.urdf", tmp_path / "there.xml", tmp_path / "out.urdf"
    original.write_text(ARM)
    hx.convert(original, there)
    there.write_text(there.read_text().replace('mass="1.5"', 'mass="2.25"'))
    hx.update(original, there, out)
    assert (original.read_text(), out.read_text()) == (ARM, ARM.replace('"1.50"/> <!', '"2.25"/> <!'))


HYMEKO = """// An arm of one joint.
arm : robot {
  heavy(m) : link { mass ${m} com [0 0 0.2] }
  base { mass 2.0 inertia [0.01 0.01 0.01] shape { cylinder [0.1 0.2] } }   // the base
  link : heavy(m=1) { inertia [0.02 0.02 0.001] shape { box [5cm 5cm 40cm] at [0 0 0.2] } }
  @shoulder : revolute { [0 0 0.10] + base - link axis=Y limit [-90 90] effort 20 velocity 120deg/s }
}
"""


@pytest.mark.parametrize(
    ("edit", "old", "new"),
    [
        (('mass value="2"', 'mass value="2.5"'), "base { mass 2.0 ", "base { mass 2.5 "),
        (('mass value="1"', 'mass value="1.5"'), "link : heavy(m=1) { inertia", "link : heavy(m=1) { mass 1.5 inertia"),
        (('xyz="0 0 0.1"', 'xyz="0 0.02 0.1"'), "[0 0 0.10] + base", "[0 0.02 0.10] + base"),
        (('upper="[^"]*"', 'upper="1.2"'), "limit [-90 90]", "limit [-90 1.2rad]"),
        (('joint name="shoulder"', 'joint name="hip"'), "@shoulder", "@hip"),
    ],
)
def test_hymeko_keeps_its_author_s_text(edit: tuple[str, str], old: str, new: str, tmp_path: Path) -> None:
    """Of an instance of a template its own block gets the value."""
    assert edited(HYMEKO, "urdf", edit, tmp_path, "hymeko") == HYMEKO.replace(old, new)


def test_a_value_of_an_element_in_a_template_is_an_override(tmp_path: Path) -> None:
    text = "r : robot {\n  pair() : assembly {\n    a { mass 1 inertia [1 1 1] }\n  }\n  left : pair {}\n}\n"
    after = edited(text, "urdf", ('mass value="1"', 'mass value="3"'), tmp_path, "hymeko")
    assert after == text.replace("left : pair {}\n", "left : pair {}\n  left.a { mass 3 }\n")


def test_what_a_text_cannot_hold_is_printed_anew_and_reported(tmp_path: Path) -> None:
    text = "r : robot {\n  pair() : assembly {\n    a { collision { box [1 1 1] } }\n  }\n  // kept if possible\n  left : pair {}\n}\n"
    original, there = tmp_path / "r.hymeko", tmp_path / "r.urdf"
    original.write_text(text)
    hx.convert(original, there)
    there.write_text(there.read_text().replace('box size="1 1 1"', 'box size="3 1 1"'))
    found = hx.update(original, there)
    assert [str(diagnostic) for diagnostic in found.report] == [
        f"warning[HX108]: the edits could not be placed in the text of '{original}', which is printed anew as a whole"
    ]
    assert list(map(str, found.edits)) == ["shape 'left_a/collision' geometry.size: [1 1 1] -> [3 1 1]"]
    assert list(map(str, hx.diff(hx.load(there).mechanism, hx.load(original).mechanism))) == []


XACRO = """<?xml version="1.0"?>
<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="r" value="0.10"/>
  <xacro:include filename="wheel.xacro"/>
  <link name="base">
    <inertial><mass value="5.0"/> <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual><geometry><sphere radius="${2 * r}"/></geometry></visual>
  </link>
  <xacro:wheel name="left"/>
  <xacro:wheel name="right"/>
</robot>
"""
WHEEL = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="axle"/>
  <joint name="suspension" type="fixed"><parent link="base"/><child link="axle"/><origin xyz="0 0 0.20"/></joint>
  <xacro:macro name="wheel" params="name">
    <link name="${name}"/>
    <joint name="${name}_spin" type="continuous"><parent link="axle"/><child link="${name}"/><axis xyz="0 1 0"/></joint>
  </xacro:macro>
</robot>
"""


@pytest.mark.unread("HX103")
def test_a_literal_of_xacro_is_edited_in_the_file_where_it_stands(tmp_path: Path) -> None:
    wheel = tmp_path / "wheel.xacro"
    wheel.write_text(WHEEL)
    assert edited(XACRO, "mjcf", ('mass="5"', 'mass="6"'), tmp_path, "xacro") == XACRO.replace('"5.0"', '"6"')
    assert edited(XACRO, "mjcf", ('(name="axle" pos=)"0 0 0.2"', r'\1"0 0 0.3"'), tmp_path, "xacro") == XACRO
    assert wheel.read_text() == WHEEL.replace("0 0 0.20", "0 0 0.3")


SDF = """<?xml version="1.0"?>
<sdf version="1.9">
  <model name="arm">
    <link name="base"/>
    <link name="upper">   <!-- the upper arm -->
      <pose relative_to="shoulder">0 0 0.10 0 0 0</pose>
      <inertial>
        <mass>1.50</mass> <!-- weighed -->
        <pose>0 0 0.150 0 0.1 0</pose>
        <inertia><ixx>0.010</ixx><iyy>0.011</iyy><izz>0.002</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia>
      </inertial>
      <visual name="v"><geometry><cylinder><radius>0.04</radius><length>0.30</length></cylinder></geometry></visual>
    </link>
    <joint name="shoulder" type="revolute">
      <pose relative_to="base">0 0 0.050 0 0 1.570</pose>
      <parent>base</parent>
      <child>upper</child>
      <axis><xyz>0 0 2</xyz>
        <limit><lower>-1.5</lower><upper>1.50</upper><effort>20</effort><velocity>3.14</velocity></limit>
      </axis>
    </joint>
  </model>
</sdf>
"""


@pytest.mark.parametrize(
    ("target", "edit", "old", "new"),
    [
        ("urdf", ('mass value="1.5"', 'mass value="2.25"'), "<mass>1.50</mass>", "<mass>2.25</mass>"),
        ("mjcf", ('mass="1.5"', 'mass="2.25"'), "<mass>1.50</mass>", "<mass>2.25</mass>"),
        ("usd", (r"physics:mass = 1\.5", "physics:mass = 2.25"), "<mass>1.50</mass>", "<mass>2.25</mass>"),
        ("urdf", ('upper="1.5"', 'upper="1.2"'), "<upper>1.50</upper>", "<upper>1.2</upper>"),
        ("urdf", ('origin xyz="0 0 0.05"', 'origin xyz="0 0.1 0.05"'), '"base">0 0 0.050', '"base">0 0.1 0.050'),
        ("urdf", ('rpy="0 0.1 0"', 'rpy="0 0.2 0"'), "0 0 0.150 0 0.1 0", "0 0 0.150 0 0.2 0"),
    ],
)
def test_sdf_keeps_its_author_s_text(target: str, edit: tuple[str, str], old: str, new: str, tmp_path: Path) -> None:
    """A pose stays in the frame in which its author gives it."""
    assert edited(SDF, target, edit, tmp_path, "sdf") == SDF.replace(old, new)


ADDED = {
    "mjcf": (
        r'(<body name="upper".*?>)',
        r'\1<body name="pen" pos="0 0 0.3"><geom name="tip" type="sphere" size="0.01" mass="0.1"/></body>',
    ),
    "sdf": (
        "</model>",
        '<link name="pen"><pose relative_to="upper">0 0 0.3 0 0 0</pose><inertial><mass>0.1</mass></inertial>'
        '</link><joint name="pen_joint" type="fixed"><parent>upper</parent><child>pen</child></joint></model>',
    ),
    "xacro": ("</robot>", '<link name="pen"/><joint name="p" type="fixed"><parent link="upper"/><child link="pen"/></joint></robot>'),
    "hymeko": (r"\n}\s*$", "\n  pen { mass 0.1 inertia [1e-6 1e-6 1e-6] }\n  @p : fixed { [0 0 0.3] + upper - pen }\n}\n"),
}


HYMEKO_OF_UPPER = HYMEKO.replace("  link :", "  upper :").replace("- link", "- upper")


@pytest.mark.parametrize("target", ADDED)
@pytest.mark.parametrize(("source", "text"), [("urdf", ARM), ("sdf", SDF), ("hymeko", HYMEKO_OF_UPPER), ("usd", "")])
def test_after_an_update_with_an_addition_there_is_nothing_to_update(source: str, text: str, target: str, tmp_path: Path) -> None:
    if source == target:
        pytest.skip("the same format")
    text = text or USD
    after = edited(text, target, ADDED[target], tmp_path, source)
    assert "pen" in after
    found = hx.update(tmp_path / f"arm{SUFFIXES[source]}", tmp_path / f"there{SUFFIXES[target]}")
    notes = [str(diagnostic) for diagnostic in found.report if diagnostic.code.id != "HX025"]  # the axis of two metres
    assert (list(map(str, found.edits)), notes, found.changed) == ([], [], {})


def test_an_edit_that_the_original_s_format_cannot_represent_is_reported(tmp_path: Path) -> None:
    original, there = tmp_path / "arm.urdf", tmp_path / "there.xml"
    original.write_text(ARM)
    hx.convert(original, there)
    there.write_text(there.read_text().replace('joint name="shoulder"', 'joint name="shoulder" armature="0.3"'))
    found = hx.update(original, there)
    assert [str(diagnostic) for diagnostic in found.report] == [
        f"{original}:15: warning[HX118]: the edit has no place in urdf: joint 'shoulder' dofs[0].armature: 0 -> 0.3"
    ]
    assert (found.edits, original.read_text()) == ((), ARM)


def test_a_body_of_mjcf_that_had_no_name_gets_one(tmp_path: Path) -> None:
    text = """<mujoco>
  <worldbody>
    <body>
      <geom type="sphere" size="0.050"/>
      <joint type="slide" axis="1 0 0"/>
      <body pos="1.0 0 0">
        <geom type="sphere" size="0.05"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
    (tmp_path / "kept").mkdir()
    edit = r'(link name=)"world_body#2"(.*child link=)"world_body#2"', r'\1"fore"\2"fore"'
    after = edited(text, "urdf", edit, tmp_path, "mjcf")
    assert after == text.replace('<body pos="1.0', '<body name="fore" pos="1.0')
    there = tmp_path / "kept" / "there.urdf"
    hx.convert(tmp_path / "arm.xml", there, keep="beside")
    there.write_text(there.read_text().replace('"fore"', '"hand"'))
    hx.convert(there, tmp_path / "kept" / "home.xml")
    assert '<body name="hand" pos="1 0 0">' in (tmp_path / "kept" / "home.xml").read_text()


@pytest.mark.parametrize("target", ["there.urdf", "there.sdf", "there.xml", "there.usda"])
@pytest.mark.parametrize("base", ["fixed", "free"])
@pytest.mark.unread("HX103")
def test_a_base_that_was_asked_for_is_no_edit(target: str, base: Literal["fixed", "free"], tmp_path: Path) -> None:
    original = tmp_path / "arm.urdf"
    original.write_text(ARM)
    hx.convert(original, tmp_path / target, base=base)
    found = hx.update(original, tmp_path / target)
    assert (list(map(str, found.edits)), original.read_text()) == ([], ARM)


USD = '''#usda 1.0
(
    defaultPrim = "arm"
    doc = """A leg, "weighed"
on a bench"""
    metersPerUnit = 1.0
    upAxis = "Z"
)

# made by hand
def Xform "arm" (prepend apiSchemas = ["PhysicsArticulationRootAPI"])
{
    def Xform "base" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    )
    {
        float physics:mass = 2.0
        float3 physics:diagonalInertia = (0.010, 0.01, 0.01)
    }

    def Xform "upper" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    )
    {
        float physics:mass = 1.50   # weighed
        point3f physics:centerOfMass = (0, 0, 0.150)
        float3 physics:diagonalInertia = (0.010, 0.011, 0.002)
        double3 xformOp:translate = (0, 0, 0.050)
        uniform token[] xformOpOrder = ["xformOp:translate"]

        def Cylinder "visual" { uniform token axis = "Z"
            double height = 0.30; double radius = 0.04
        }
    }

    def PhysicsRevoluteJoint "shoulder"
    {
        uniform token physics:axis = "Z"
        rel physics:body0 = </arm/base>
        rel physics:body1 = </arm/upper>
        point3f physics:localPos0 = (0, 0, 0.050)
        point3f physics:localPos1 = (0, 0, 0)
        quatf physics:localRot0 = (1, 0, 0, 0)
        quatf physics:localRot1 = (1, 0, 0, 0)
        float physics:lowerLimit = -85.0
        float physics:upperLimit = 85.0  # degrees
    }
}
'''


@pytest.mark.parametrize(
    ("target", "edit", "old", "new"),
    [
        ("urdf", ('mass value="1.5"', 'mass value="2.25"'), "mass = 1.50 ", "mass = 2.25 "),
        ("mjcf", ('mass="1.5"', 'mass="2.25"'), "mass = 1.50 ", "mass = 2.25 "),
        ("sdf", ("<mass>1.5<", "<mass>2.25<"), "mass = 1.50 ", "mass = 2.25 "),
        ("hymeko", (r"mass 1\.5", "mass 2.25"), "mass = 1.50 ", "mass = 2.25 "),
        ("urdf", ('radius="0.04"', 'radius="0.05"'), "radius = 0.04", "radius = 0.05"),
        ("urdf", ('upper="[^"]*"', 'upper="1.2"'), "Limit = 85.0 ", "Limit = 68.75494 "),
        ("urdf", ('xyz="0 0 0.15"', 'xyz="0 0.1 0.15"'), "Mass = (0, 0, 0.150)", "Mass = (0, 0.1, 0.150)"),
    ],
)
def test_usd_keeps_its_author_s_text(target: str, edit: tuple[str, str], old: str, new: str, tmp_path: Path) -> None:
    assert edited(USD, target, edit, tmp_path, "usd") == USD.replace(old, new)


def test_usd_gets_and_loses_prims_among_those_of_its_author(tmp_path: Path) -> None:
    more = edited(USD, "mjcf", ADDED["mjcf"], tmp_path, "usd")
    assert [line for line in USD.splitlines() if line not in more.splitlines()] == []
    assert '    def Xform "pen" (\n' in more
    (tmp_path / "again").mkdir()
    less = edited(more, "urdf", (r'  <joint name="pen".*?</joint>\n  <link name="pen">.*?</link>\n', ""), tmp_path / "again", "usd")
    assert [line for line in less.splitlines() if '"pen"' in line] == []


@pytest.mark.parametrize("text", ['#usda 1.0\ndef Xform "a"\n', "#usda 1.0\n)\n", '#usda 1.0\ndef "a" {\n float x = (1, 2\n}', "PXR-USDC"])
def test_a_layer_that_cannot_be_outlined_is_refused(text: str) -> None:
    from hymeko_x.frontends.usd.outline import outline

    with pytest.raises(hx.Refusal):
        outline(Source("a.usda", text.encode()), Report())


def test_variants_and_values_of_every_kind_have_their_places_in_the_outline() -> None:
    from hymeko_x.frontends.usd.outline import METADATA, NAME, outline

    text = """#usda 1.0
def Xform "a" (
    customData = { string note = "}" }
    variants = { string size = "big" }
    prepend variantSets = "size"
)
{
    asset file = @a(1).usda@</b> ( doc = "x" )
    double x.timeSamples = { 0: 1.5, 1: (2) }
    prepend rel to = [</a>, </b>]
    custom float bare
    variantSet "size" = {
        "big" ( doc = "b" ) {
            float x = 1
        }
        "small" { }
    }
}
over "b" { }
"""
    found = outline(Source("a.usda", text.encode()), Report()).root
    (a, b) = found.children
    metadata, variants = a.children
    assert (a.tag, a.name, b.tag, b.name, metadata.tag) == ("Xform", "a", "over", "b", METADATA)
    assert {name: field.text for name, field in a.fields.items()} == {
        NAME: "a", "file": "@a(1).usda@</b>", "x.timeSamples": "{ 0: 1.5, 1: (2) }", "to": "[</a>, </b>]", "bare": "",
    }  # fmt: skip
    assert {name: field.text for name, field in metadata.fields.items()} == {
        "customData": '{ string note = "}" }', "variants": '{ string size = "big" }', "variantSets": '"size"',
    }  # fmt: skip
    assert [(block.tag, block.name, block.fields.keys()) for block in variants.children] == [
        ("variant", "big", {"x": 0}.keys()), ("variant", "small", {}.keys()),
    ]  # fmt: skip
