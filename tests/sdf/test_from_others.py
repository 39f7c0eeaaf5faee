# ruff: noqa: E501 - files as they stand
"""What only other formats have, as SDF: Drake accepts the file and sees the same robot, as far as SDF can represent it."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from tests.sdf.samples import AXIS, model

BALL = '<geom type="sphere" size=".1"/>'
UNNAMED_BODIES = f"""<mujoco model="m"><worldbody><body><joint type="slide"/>{BALL}<body pos="1 0 0"><joint type="hinge"/>{BALL}</body></body>
<body pos="3 0 0">{BALL}</body></worldbody></mujoco>"""
SAME_NAMES = f"""<mujoco model="m"><worldbody><body name="weight"><joint name="weight" type="slide"/>{BALL}
<site name="weight"/></body></worldbody></mujoco>"""
BALL_JOINT = f"""<mujoco model="m"><worldbody><body name="a">{BALL}<body name="b" pos="1 0 0"><joint name="j" type="ball" damping="0.5" range="0 30"/>
{BALL}</body></body></worldbody></mujoco>"""
TWO_BASES = f"""<mujoco model="m"><worldbody><body><freejoint/>{BALL}</body><body pos="4 0 0"><freejoint/>{BALL}
<body pos="1 0 0"><joint type="slide"/>{BALL}</body></body></worldbody></mujoco>"""
SLIDE_AND_BALL = f"""<mujoco model="m"><worldbody><body name="a"><joint name="s" type="slide" axis=".6 0 .8"/><joint name="j" type="ball"/>{BALL}
</body></worldbody></mujoco>"""
CLOSURES = f"""<mujoco model="m"><worldbody><site name="here" pos="0 0 1"/><body name="hung" pos="0 0 1"><freejoint/>{BALL}<site name="there"/></body>
<body name="base" pos="2 0 0"><joint name="turn"/>{BALL}<body name="tip" pos="1 0 0"><joint name="bend"/>{BALL}</body></body>
<body name="late" pos="5 0 0"><freejoint/>{BALL}</body><body name="led" pos="7 0 0"><joint name="led"/>{BALL}</body></worldbody>
<equality><connect name="hook" site1="here" site2="there"/><connect name="again" body1="base" body2="tip" anchor="1 0 0"/>
<weld name="stuck" body1="tip" body2="late"/><joint name="law" joint1="led" joint2="turn" polycoef="0 1 2 0 0"/></equality></mujoco>"""
HELD_CHAIN = f"""<mujoco model="m"><worldbody><body name="hand"><joint name="h"/>{BALL}</body><body name="peg" pos="1 0 0"><joint name="s" type="slide"/>{BALL}
<body name="tip" pos="0 0 1"><joint name="x" axis="1 0 0"/><joint name="y" axis="0 1 0"/>{BALL}</body></body></worldbody>
<equality><weld name="hold" body1="hand" body2="tip"/></equality></mujoco>"""
CROSSED = """<robot name="m"><link name="a"/><link name="b"/><joint name="j" type="prismatic"><parent link="a"/><child link="b"/>
<axis xyz="1 0 0"/><limit lower="2" upper="1" effort="1" velocity="1"/></joint></robot>"""
PUSHED = (
    f"""<mujoco model="m"><worldbody><body name="a"><joint name="j" damping="-0.01" stiffness="-2"/>{BALL}</body></worldbody></mujoco>"""
)
BRIGHT = f"""<mujoco model="m"><asset><material name="hot" rgba="2 0 0 1"/></asset><worldbody><light diffuse="3 1 1"/>
<body name="a">{BALL[:-2]} material="hot"/></body><body name="b">{BALL[:-2]} rgba="255 -1 0 1"/></body></worldbody></mujoco>"""
TWICE = """<robot name="m"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<gazebo reference="a"><sensor name="eye" type="camera"><camera/></sensor><sensor name="eye" type="imu"/></gazebo></robot>"""
ANCHOR = """<robot name="m"><link name="a"/><link name="a_anchor"/><joint name="j" type="fixed"><parent link="a"/><child link="a_anchor"/></joint></robot>"""
INNER_FREE = "m : robot { a { mass 1 } b { mass 1 } @j : floating { [1 2 3] + a - b } }"
MARKUP = "m : robot { a { mass 1 } `<b> & c` { mass 1 } @j : fixed { [1 2 3] + a - `<b> & c` } }"
CYCLE = """m : robot { a { mass 1 } b { mass 1 } c { mass 1 } @j : continuous { [1 0 0] + a - b } @k : continuous { [0 1 0] + b - c }
@l : connect { [0 0 1] ~ c [1 1 1] ~ a } }"""

SAME, LIMITED = "same", "same as far as sdf can say"
CASES = {
    "bodies without names": ("m.xml", UNNAMED_BODIES, SAME),
    "a body, a joint and a site of one name": ("m.xml", SAME_NAMES, SAME),
    "a ball with damping and limits": ("m.xml", BALL_JOINT, LIMITED),
    "two free bases, one of them at the origin": ("m.xml", TWO_BASES, SAME),
    "a slide and a ball above one body": ("m.xml", SLIDE_AND_BALL, SAME),
    "closures that hold free bodies, or join what is joined": ("m.xml", CLOSURES, LIMITED),
    "a closure that holds the end of a chain": ("m.xml", HELD_CHAIN, SAME),
    "limits that are crossed": ("m.urdf", CROSSED, SAME),
    "negative damping and stiffness": ("m.xml", PUSHED, LIMITED),
    "colours brighter than 1": ("m.xml", BRIGHT, SAME),
    "two sensors of one name": ("m.urdf", TWICE, SAME),
    "a link whose name ends as ours do": ("m.urdf", ANCHOR, SAME),
    "a free joint below a body": ("m.hymeko", INNER_FREE, SAME),
    "names with markup": ("m.hymeko", MARKUP, SAME),
    "a cycle whose closure leads to its root": ("m.hymeko", CYCLE, SAME),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.unread("HX028", "HX101")
def test_drake_sees_the_same_robot(case: str, tmp_path: Path) -> None:
    pytest.importorskip("pydrake")
    name, text, expected = CASES[case]
    (tmp_path / name).write_text(text, "utf-8")
    hx.convert(str(tmp_path / name), str(tmp_path / "out.sdf"))
    verdict = hx.verify(str(tmp_path / name), str(tmp_path / "out.sdf"), samples=20)
    assert verdict.verdict == expected, [*verdict.failed, *verdict.limits, verdict.reason]


@pytest.mark.unread("HX028", "HX101", "HX103")
@pytest.mark.parametrize("target", ["back.xml", "back.usda", "back.urdf"])
def test_the_link_of_a_closure_stays_in_sdf(target: str, tmp_path: Path) -> None:
    """`again_anchor`, of which SDF needs one: it was a body of the other formats, and `verify` called them another robot."""
    (tmp_path / "m.xml").write_text(CLOSURES, "utf-8")
    hx.convert(tmp_path / "m.xml", tmp_path / "m.sdf")
    assert "again_anchor" in (tmp_path / "m.sdf").read_text("utf-8")
    hx.convert(tmp_path / "m.sdf", tmp_path / target)
    assert "again_anchor" not in (tmp_path / target).read_text("utf-8")
    pytest.importorskip("pydrake")
    assert hx.verify(tmp_path / "m.sdf", tmp_path / target, samples=5).is_same


@pytest.mark.unread("HX045")
@pytest.mark.parametrize("changed", ["<mass>1</mass>", '<visual name="v"/>'])
def test_a_link_that_is_more_than_the_end_of_a_closure_stays(changed: str, tmp_path: Path) -> None:
    link = "<link name='{}'><inertial><mass>{}</mass></inertial>{}</link>"
    mass, inside = ("1", "") if "mass" in changed else ("1e-10", changed)
    ends = "<joint name='{}' type='{}'><parent>{}</parent><child>{}</child>{}</joint>"
    joints = [
        ("j", "revolute", "a", "b", AXIS.format("")),
        ("l_anchor_joint", "fixed", "a", "l_anchor", ""),
        ("l", "ball", "l_anchor", "b", ""),
    ]
    text = "".join(
        [link.format("a", 1, ""), link.format("b", 1, ""), link.format("l_anchor", mass, inside), *(ends.format(*each) for each in joints)]
    )
    (tmp_path / "m.sdf").write_text(model(text), "utf-8")
    hx.convert(tmp_path / "m.sdf", tmp_path / "m.xml", lenient=True)
    assert 'name="l_anchor"' in (tmp_path / "m.xml").read_text("utf-8")


@pytest.mark.unread("HX101")
def test_a_size_of_zero_is_very_small() -> None:
    """Source: libsdformat, Sphere.cc: a radius that is not above zero becomes 1."""
    point = '<robot name="m"><link name="a"><visual><geometry><sphere radius="0"/></geometry></visual></link></robot>'
    assert hx.dumps(hx.loads(point, "urdf"), "sdf").count("<radius>1e-6</radius>") == 1


@pytest.mark.unread("HX101")
def test_a_camera_is_as_wide_as_libsdformat_demands() -> None:
    """Source: libsdformat, camera.sdf: the least horizontal field of view is 0.1 rad."""
    text = f'<mujoco model="m"><worldbody><body name="a">{BALL}<camera name="eye" fovy="4"/></body></worldbody></mujoco>'
    written = hx.dumps(hx.loads(text, "mjcf").mechanism, "sdf")
    assert 0.1 <= float(written.partition("<horizontal_fov>")[2].partition("<")[0]) < 0.1 + 1e-8
