"""Default classes of what is written from other formats: named by role, and MuJoCo compiles the same model as without them."""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x.backends.mjcf import classes
from hymeko_x.corpus.catalog import development_files
from tests.mjcf.mjmodels import differences

LEG = """<link name="{0}_leg"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><box size="0.1125 0.2125 0.7125"/></geometry><material name="red"><color rgba="1 0 0 1"/></material></visual>
<collision><geometry><box size="0.1125 0.2125 0.7125"/></geometry></collision></link>
<joint name="{0}_hip" type="revolute"><origin xyz="0 0 {1}"/><parent link="base"/><child link="{0}_leg"/><axis xyz="0 1 0"/>
<limit lower="-1.0625" upper="1.0625" effort="40" velocity="10"/><dynamics damping="0.125"/></joint>
<link name="{0}_foot"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><sphere radius="0.0625"/></geometry></collision></link>
<joint name="{0}_ankle" type="revolute"><origin xyz="0 0 1"/><parent link="{0}_leg"/><child link="{0}_foot"/><axis xyz="1 0 0"/>
<limit lower="-0.03125" upper="0.03125" effort="40" velocity="10"/><dynamics damping="0.125"/></joint>"""
QUADRUPED = (
    '<robot name="q"><link name="base"/>'
    + "".join(LEG.format(*leg) for leg in zip(("lf", "rf", "lh", "rh"), "1234", strict=True))
    + "</robot>"
)


def test_what_legs_share_is_in_classes_called_after_their_parts() -> None:
    text = hx.dumps(hx.loads(QUADRUPED, "urdf"), "mjcf")
    head = text[text.index("  <default>") : text.index("  <asset>")]
    assert (
        head
        == """\
  <default>
    <joint damping="0.125" actuatorfrcrange="-40 40"/>
    <default class="visual">
      <geom contype="0" conaffinity="0" group="2"/>
    </default>
    <default class="collision">
      <geom group="3"/>
      <default class="collision_leg">
        <geom type="box" size="0.05625 0.10625 0.35625"/>
      </default>
    </default>
    <default class="hip">
      <joint axis="0 1 0" range="-1.0625 1.0625"/>
    </default>
    <default class="ankle">
      <joint axis="1 0 0" range="-0.03125 0.03125"/>
    </default>
  </default>

"""
    )
    assert '<joint name="lf_hip" class="hip"/>' in text
    assert '<geom class="collision" type="sphere" size="0.0625"/>' in text


def test_parts_of_a_limb_that_share_the_same_are_one_class() -> None:
    """Four hips and four ankles, which had a class each with the same attributes."""
    joint = '<joint name="{0}_{1}" type="revolute"><parent link="base"/><child link="{0}_{1}"/><axis xyz="0 1 0"/>{2}</joint>'
    limit = '<limit lower="-1.0625" upper="1.0625" effort="40" velocity="10"/><dynamics damping="0.125"/>'
    other = '<limit lower="0" upper="1" effort="7" velocity="10"/>'
    parts = [(side, part, limit) for side in ("lf", "rf", "lh", "rh") for part in ("hip", "ankle")]
    parts += [(side, part, other) for side in ("lf", "rf", "lh", "rh") for part in ("lid", "cap", "horn")]
    mass = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    links = "".join(f'<link name="{side}_{part}">{mass}</link>{joint.format(side, part, inside)}' for side, part, inside in parts)
    text = hx.dumps(hx.loads(f'<robot name="q"><link name="base"/>{links}</robot>', "urdf"), "mjcf")
    assert '<default class="leg">\n      <joint range="-1.0625 1.0625" damping="0.125" actuatorfrcrange="-40 40"/>' in text
    assert '<joint name="rh_ankle" class="leg"/>' in text
    assert 'class="hip"' not in text


def test_actuators_share_a_class_as_well() -> None:
    text = hx.dumps(hx.loads(QUADRUPED, "urdf"), "mjcf", actuators="position")
    assert '<position kp="400" kv="40" ctrlrange="-0.03125 0.03125"/>\n' in text[: text.index("<asset>")]
    assert '<position name="rh_ankle" class="ankle" joint="rh_ankle"/>' in text


def test_joints_and_motors_share_a_name_inside_of_one_class_only() -> None:
    """A class that stood in two others would be defined twice."""
    found = classes.Defaults()
    wanted = (("joint", "main"), ("joint", "arm"), ("position", "main"), ("position", "main"))
    assert [found.free("arm", tag, around) for tag, around in wanted] == ["arm", "arm_2", "arm", "arm_3"]


def test_the_classes_of_roles_give_no_type_and_no_size() -> None:
    box = '<visual><geometry><box size="1 2 3"/></geometry></visual>'
    ball = '<visual><geometry><sphere radius="1"/></geometry></visual>'
    text = hx.dumps(hx.loads(f'<robot name="r"><link name="a">{box * 3}{ball}</link></robot>', "urdf"), "mjcf")
    assert '<geom contype="0" conaffinity="0" group="2"/>' in text  # a shape that a person adds is no box
    assert text.count('<geom class="visual" type="box" size="0.5 1 1.5"/>') == 3
    assert '<geom class="visual" type="sphere" size="1"/>' in text


def test_an_edit_in_a_class_comes_home_and_the_class_does_not(tmp_path: Path) -> None:
    (tmp_path / "q.urdf").write_text(QUADRUPED)
    hx.convert(tmp_path / "q.urdf", tmp_path / "q.xml")
    text = (tmp_path / "q.xml").read_text()
    (tmp_path / "q.xml").write_text(text.replace('range="-1.0625 1.0625"/>', 'range="-1.0625 1.5"/>'))
    hx.convert(tmp_path / "q.xml", tmp_path / "home.urdf")
    home = (tmp_path / "home.urdf").read_text()
    assert [home.count('upper="1.5"'), home.count('upper="1.0625"'), home.count("residue")] == [4, 0, 0]


BOUNDED = """<mujoco><compiler autolimits="{0}"/><default>{1}</default>
<worldbody><body><joint name="j" range="-1 1" limited="{2}"/><geom size=".1" mass="1"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("default", "limited", "span"),
    [
        ('<general ctrllimited="true"/>', "false", [0, 0]),
        ('<general ctrlrange="-2 2" forcerange="-3 3"/>', "false", [0, 0]),
        ('<general ctrlrange="-2 2" forcerange="-3 3"/>', "true", [-1, 1]),
        ('<position inheritrange="1"/>', "false", [0, 0]),
        ("", "true", [-1, 1]),
    ],
)
@pytest.mark.parametrize("autolimits", ["true", "false"])
@pytest.mark.unread("HX114")
def test_actuators_that_are_asked_for_have_no_limits_of_the_author_s_classes(
    default: str, limited: str, span: list[float], autolimits: str, tmp_path: Path
) -> None:
    (tmp_path / "a.xml").write_text(BOUNDED.format(autolimits, default, limited))
    losses = hx.convert(tmp_path / "a.xml", tmp_path / "b.xml", actuators="position").losses or ()
    assert [str(loss) for loss in losses] == []
    hx.convert(tmp_path / "b.xml", tmp_path / "c.xml")
    for name in ("b.xml", "c.xml"):
        model = mujoco.MjModel.from_xml_path(str(tmp_path / name))
        assert model.actuator_ctrlrange[0] * 180 / math.pi == pytest.approx(span)
        assert bool(model.actuator_ctrllimited[0]) is any(span)
        assert not model.actuator_forcelimited[0]


def models(robot: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, **how: object) -> tuple[mujoco.MjModel, mujoco.MjModel]:
    """The compiled models with and without classes."""
    with_classes, without = folder / "with.xml", folder / "without.xml"
    hx.convert(robot, with_classes, **how)  # type: ignore[arg-type]
    monkeypatch.setattr(classes, "shared_attributes", lambda leaves: classes.Defaults())
    hx.convert(robot, without, **how)  # type: ignore[arg-type]
    return mujoco.MjModel.from_xml_path(str(with_classes)), mujoco.MjModel.from_xml_path(str(without))


@pytest.mark.parametrize("actuators", ["none", "motor", "position", "velocity"])
def test_mujoco_compiles_the_same_model_as_without_classes(actuators: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "q.urdf").write_text(QUADRUPED)
    assert differences(*models(tmp_path / "q.urdf", tmp_path, monkeypatch, actuators=actuators)) == []


FILES = development_files("urdf")
FEW = [file for file in FILES if file.path.endswith(("minitaur.urdf", "allegro_hand_right_fsr_simple.urdf", "al5d_robot.urdf"))]


@pytest.mark.corpus
@pytest.mark.parametrize("robot", FEW, ids=lambda file: file.id, indirect=True)
def test_a_real_robot_compiles_to_the_same_model(robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert differences(*models(robot, tmp_path, monkeypatch, actuators="position")) == []
    assert (tmp_path / "with.xml").read_text() != (tmp_path / "without.xml").read_text()


@pytest.mark.corpus
@pytest.mark.full
@pytest.mark.parametrize("robot", FILES, ids=lambda file: file.id, indirect=True)
def test_every_real_robot_compiles_to_the_same_model(robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert differences(*models(robot, tmp_path, monkeypatch)) == []


BEAM = """<mujoco model="m">
  <default>
    <default class="beam">
      <geom type="box" size="0.2" fromto="0 0 0 0 -2 0" rgba="0.4 0.7 0.6 0.3" contype="0" density="500"/>
    </default>
  </default>
  <worldbody>
    <body name="a" childclass="beam">
      <freejoint/>
      <inertial pos="0 -1 0" mass="1" diaginertia="1 1 1"/>
      <geom name="g"/>
      <geom name="h" rgba="1 0 0 1"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.unread("HX105")
@pytest.mark.parametrize("place", [0, 1])
def test_a_box_that_is_wider_than_deep_leaves_a_class_that_gives_two_points(place: int, tmp_path: Path) -> None:
    """No position undoes the points of a class, and a box between two points is square."""
    (tmp_path / "a.xml").write_text(BEAM)
    hx.convert(tmp_path / "a.xml", tmp_path / "a.usda")
    parts = (tmp_path / "a.usda").read_text().split("(0.4, 0.4, 2)")
    parts[place : place + 2] = ["(0.4, 0.6, 2)".join(parts[place : place + 2])]
    (tmp_path / "a.usda").write_text("(0.4, 0.4, 2)".join(parts))
    hx.update(tmp_path / "a.xml", tmp_path / "a.usda")
    turned = 'size="0.2 0.3 1" pos="0 -1 0" quat="0.7071067811865476 -0.7071067811865476 0 0"'
    old, name, rgba = [('<geom name="g"/>', "g", "0.4 0.7 0.6 0.3"), ('<geom name="h" rgba="1 0 0 1"/>', "h", "1 0 0 1")][place]
    new = f'<geom name="{name}" class="main" type="box" {turned} rgba="{rgba}" density="500" contype="0"/>'
    assert (tmp_path / "a.xml").read_text() == BEAM.replace(old, new)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "a.xml"))
    assert (model.geom_size[place].tolist(), model.geom_contype.tolist()) == ([0.2, 0.3, 1.0], [0, 0])
