"""What one format represents in another way is the same robot; what it represents wrongly is not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.formats.mjcf.schema import schema
from hymeko_x.verify.readers.mjcf.constraints import SENSOR_KINDS

Write = Callable[[str, str], Path]

BALL_MJCF = """<mujoco>
  <worldbody>
    <body name="leg">
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <geom name="bone" type="capsule" size="0.05 0.1" group="3"/>
      <body name="foot" pos="0 0 -0.3" quat="0.9 0.1 0.3 0.2">
        <joint name="ankle" type="ball" pos="0 0 0.01"/>
        <inertial pos="0.03 0 0" mass="0.3" diaginertia="0.0004 0.0006 0.0007"/>
        <body name="toe" pos="0.1 0 0">
          <joint name="toe_joint" axis="0 1 0"/>
          <inertial pos="0.03 0 0" mass="0.1" diaginertia="0.0004 0.0006 0.0007"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>"""
BALL = '<joint name="ankle" type="ball" pos="0 0 0.01"/>'
LEG = """<mujoco>
  <worldbody>
    <geom name="a" type="sphere" size="0.1"/>
    <body name="leg"><joint name="knee" axis="0 1 0"/><geom name="b" type="sphere" size="0.1"/></body>
  </worldbody>
  <actuator><motor name="m" joint="knee"/></actuator>
  <sensor><distance geom1="a" geom2="b"/><jointactuatorfrc name="push" joint="knee"/></sensor>
</mujoco>"""
HINGES = "".join(f'<joint name="ankle_{k}" axis="{axis}" pos="0 0 0.01"/>' for k, axis in enumerate(("1 0 0", "0 1 0", "0 0 1")))


def as_urdf(written: Write, tmp_path: Path, text: str) -> Path:
    target = tmp_path / "robot.urdf"
    hx.convert(written("mjcf", text), target)
    return target


def test_a_ball_is_three_hinges_in_urdf_and_a_capsule_is_three_shapes(written: Write, tmp_path: Path) -> None:
    original = written("mjcf", BALL_MJCF)
    verdict = hx.verify(original, as_urdf(written, tmp_path, BALL_MJCF))
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    assert verdict.is_same


def test_a_ball_elsewhere_is_found_through_its_hinges(written: Write, tmp_path: Path) -> None:
    moved = BALL_MJCF.replace('pos="0 0 0.01"', 'pos="0 0 0.011"')
    verdict = hx.verify(written("mjcf", BALL_MJCF), as_urdf(written, tmp_path, moved))
    assert [check.quantity for check in verdict.failed] == ["forward kinematics, position"]


def test_a_shorter_capsule_is_found_through_its_parts(written: Write, tmp_path: Path) -> None:
    shorter = BALL_MJCF.replace('size="0.05 0.1"', 'size="0.05 0.09"')
    verdict = hx.verify(written("mjcf", BALL_MJCF), as_urdf(written, tmp_path, shorter))
    assert "collision shapes, size and pose" in {check.quantity for check in verdict.failed}


def test_every_element_of_sensor_is_a_kind_that_mjcf_has() -> None:
    """MuJoCo's own list of kinds calls some of them otherwise."""
    elements = {path.split("/")[1] for path in schema().elements if path.startswith("sensor/")}
    assert len(elements) > 40
    assert elements - SENSOR_KINDS == set()


def test_sensors_that_mujocos_list_calls_otherwise_are_the_same_in_hymeko(written: Write, tmp_path: Path) -> None:
    original = written("mjcf", LEG)
    hx.convert(original, tmp_path / "leg.hymeko")
    verdict = hx.verify(original, tmp_path / "leg.hymeko")
    assert verdict.is_same
    assert verdict.gaps == ()


def test_three_hinges_are_no_ball_where_both_formats_have_balls(written: Write) -> None:
    verdict = hx.verify(written("mjcf", BALL_MJCF), written("mjcf", BALL_MJCF.replace(BALL, HINGES)))
    assert {check.quantity for check in verdict.failed} >= {"joints"}


def test_three_hinges_on_one_body_are_a_chain_in_urdf(written: Write, tmp_path: Path) -> None:
    text = BALL_MJCF.replace(BALL, HINGES)
    verdict = hx.verify(written("mjcf", text), as_urdf(written, tmp_path, text))
    assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == []
    assert any(note.startswith("bodies that only carry dofs: ") for note in verdict.not_compared)


FLOATING = """r : robot {
  base { mass 1 inertia [1 1 1] }
  boat { mass 1 inertia [0.1 0.2 0.3] }
  @held : fixed { + world - base }
  @floats : floating { [[0 0 0.3] [0 30 0]] + base - boat }
}"""


def test_what_floats_below_another_body_has_three_slides_and_a_ball_in_mjcf(written: Write, tmp_path: Path) -> None:
    target = tmp_path / "robot.xml"
    hx.convert(written("hymeko", FLOATING), target)
    assert hx.verify(written("hymeko", FLOATING), target).is_same
    damped = target.with_name("damped.xml")
    damped.write_text(target.read_text().replace('type="ball"', 'type="ball" damping="1"'))
    assert damped.read_text() != target.read_text()
    assert "joints" in {check.quantity for check in hx.verify(written("hymeko", FLOATING), damped).failed}


@pytest.mark.unread("HX045")
@pytest.mark.parametrize("to", ["z.hymeko", "z.xml", "z.sdf"])
def test_a_mass_without_tensor_stays_at_the_origin_of_its_link(tmp_path: Path, to: str) -> None:
    shape = '<collision><origin xyz="1 0 0"/><geometry><box size="1 1 1"/></geometry></collision>'
    source, target = tmp_path / "z.urdf", tmp_path / to
    source.write_text(f'<robot name="z"><link name="a"><inertial><mass value="2"/></inertial>{shape}</link></robot>')
    hx.convert(source, target)
    assert hx.verify(source, target).verdict.startswith("same")


LOOPED = """r : robot {
  a { mass 1 inertia [1 1 1] } b { mass 1 inertia [1 1 1] }
  @j { + a - b axis=X }
  @k : loop.joint { [0 0 1] ~ a [0 0 1] ~ b dof : hinge { axis=X } }
  @l : loop.joint { [0 0 2] ~ a [0 0 2] ~ b dof : hinge { axis=X } }
}"""
SCREWED = "@s : loop.joint { ~ a ~ b dof : screw { axis=X pitch 0.1 } }\n}"


@pytest.mark.unread("HX101", "HX104")
@pytest.mark.parametrize("text", [LOOPED, LOOPED[:-1] + SCREWED], ids=["hinges", "and a screw"])
def test_hinges_that_close_loops_between_two_bodies_are_two_points_each(text: str, written: Write, tmp_path: Path) -> None:
    target = tmp_path / "robot.xml"
    hx.convert(written("hymeko", text), target)
    verdict = hx.verify(written("hymeko", text), target)
    assert verdict.is_same, verdict.failed
    moved = target.with_name("moved.xml")
    moved.write_text(target.read_text().replace('pos="0.1 0 2"', 'pos="0.1 0.1 2"', 1))
    assert moved.read_text() != target.read_text()
    assert {check.quantity for check in hx.verify(written("hymeko", text), moved).failed} == {"loop closure, rotation"}


SENSED = """r : robot {
  a { mass 1 inertia [1 1 1] } @j : fixed { + world - a }
  ray : sensor.gpu_lidar {} pose : sensor.imu {} @on : mount { + a - ray } @with : mount { + a - pose }
}"""


def test_sensors_that_mjcf_does_not_have_are_a_gap_and_an_imu_is_two(written: Write, tmp_path: Path) -> None:
    target = tmp_path / "robot.xml"
    hx.convert(written("hymeko", SENSED), target)
    for pair in ((written("hymeko", SENSED), target), (target, written("hymeko", SENSED))):
        verdict = hx.verify(*pair)
        assert verdict.is_same, verdict.failed
        assert [(gap.quantity, gap.names) for gap in verdict.gaps] == [("sensors", ("'ray'",))]
    less = target.with_name("less.xml")
    less.write_text(target.read_text().replace('<gyro name="pose_gyro" site="pose"/>', ""))
    assert less.read_text() != target.read_text()
    assert [check.quantity for check in hx.verify(written("hymeko", SENSED), less).failed] == ["sensors"]


TOUCHED = """<mujoco><worldbody><geom type="plane" size="1 1 1"/><body name="b"><freejoint/><geom size="0.1"/></body></worldbody>
<sensor><contact name="c" body1="b"/></sensor></mujoco>"""
BUMPER = """<sdf version="1.9"><model name="m"><link name="b"><inertial><mass>1</mass></inertial>
<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>
<sensor name="bump" type="contact"><contact><collision>c</collision></contact></sensor></link></model></sdf>"""


def test_a_contact_sensor_of_sdf_is_none_of_mujoco(written: Write, tmp_path: Path) -> None:
    """MuJoCo's names the elements between which it reports contacts, and is compared."""
    (tmp_path / "bump.sdf").write_text(BUMPER)
    hx.convert(tmp_path / "bump.sdf", tmp_path / "bump.hymeko")
    hx.convert(tmp_path / "bump.hymeko", tmp_path / "bump.xml")
    verdict = hx.verify(tmp_path / "bump.hymeko", tmp_path / "bump.xml")
    assert (verdict.is_same, [(gap.quantity, gap.names) for gap in verdict.gaps]) == (True, [("sensors", ("'bump'",))])
    source = written("mjcf", TOUCHED)
    hx.convert(source, tmp_path / "touch.hymeko")
    assert hx.verify(tmp_path / "touch.hymeko", source).is_same
    less = tmp_path / "less.xml"
    less.write_text(TOUCHED.replace('<contact name="c" body1="b"/>', ""))
    assert [check.quantity for check in hx.verify(tmp_path / "touch.hymeko", less).failed] == ["sensors"]


SCREW = f"{LOOPED[:-1]}{SCREWED}"


@pytest.mark.unread("HX104")
def test_a_stage_has_no_screw_that_closes_a_loop(written: Write, tmp_path: Path) -> None:
    report = hx.convert(written("hymeko", SCREW), tmp_path / "robot.usda").report
    assert "loop 's' closes a loop by a screw, for which there is no closure; it is left out" in [item.message for item in report]
    verdict = hx.verify(written("hymeko", SCREW), tmp_path / "robot.usda")
    assert verdict.is_same, verdict.failed
    assert [(gap.quantity, gap.count) for gap in verdict.gaps] == [("closures by a screw", 1)]
