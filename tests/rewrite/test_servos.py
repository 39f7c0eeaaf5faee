"""What servos carry is what MuJoCo finds in its mass matrix and in its forces of gravity, and their gains follow from it."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.ir.parts import Limits
from hymeko_x.ir.values import Z
from hymeko_x.rewrite.rotors import articulated_inertias
from hymeko_x.rewrite.servos import Load, gains, home, loads
from tests.robots import hinge

ARM = Path(__file__).parents[2] / "corpus" / "robots" / "arm6.hymeko"
SLIDING = """<mujoco><worldbody><body pos="0 0 1"><joint name="lift" type="slide" axis="0 0.6 0.8" range="0.2 1"/>
  <inertial pos="0.1 0 0" mass="2" diaginertia="0.1 0.2 0.25"/>
  <body pos="0.3 0.1 0" quat="0.8 0 0.6 0"><joint name="a" axis="0 1 0" pos="0.1 0 0.2" range="0.3 2" armature="0.2"/>
    <joint name="b" axis="1 0 0"/><inertial pos="0 0.2 0.1" mass="1" fullinertia="0.1 0.2 0.25 0.01 0.02 0.03"/>
  </body></body></worldbody></mujoco>"""


def test_loads_are_those_of_the_mass_matrix_and_of_gravity(tmp_path: Path) -> None:
    for robot in (hx.load(ARM).mechanism, hx.loads(SLIDING, "mjcf").mechanism):
        path = tmp_path / "robot.xml"
        hx.dump(robot, path, base="fixed", target="mujoco")
        model = mujoco.MjModel.from_xml_path(str(path))
        found, free = loads(robot), articulated_inertias(robot)
        assert len(found) == len(free) == model.nv
        for (joint, number), load in found.items():
            dof = robot.joints[joint].joint.dofs[number]
            assert_as_in_mujoco(load, free[joint, number], model, model.joint(dof.name or joint.name).dofadr[0])


def assert_as_in_mujoco(load: Load, free: float, model: mujoco.MjModel, dof: int) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    forces = []
    for direction in np.eye(3):
        model.opt.gravity[:] = 9.81 * direction
        mujoco.mj_forward(model, data)
        forces.append(data.qfrc_bias[dof])
    matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, matrix)
    behind = [other for other in range(dof, model.nv) if dof in above(model, other)]
    assert free == pytest.approx(1.0 / np.linalg.inv(matrix[np.ix_(behind, behind)])[0, 0], rel=1e-8, abs=1e-12)
    expected = Load(matrix[dof, dof], float(np.linalg.norm(forces)), abs(forces[2]))
    assert load == pytest.approx(expected, rel=1e-8, abs=1e-12)


def above(model: mujoco.MjModel, dof: int) -> list[int]:
    found = [dof]
    while (dof := model.dof_parentid[dof]) >= 0:
        found.append(dof)
    return found


def test_a_servo_sags_by_a_hundredth_and_is_damped_critically() -> None:
    stiffness, damping = gains(Load(0.5, 8.0, 8.0), None)
    assert (stiffness, damping) == (800.0, 2.0 * (800.0 * 0.5) ** 0.5)


def test_a_servo_without_load_is_not_slower_than_twenty_radians_per_second() -> None:
    assert gains(Load(2.0, 0.0, 0.0), None) == (800.0, 80.0)


def test_a_servo_asks_for_all_effort_at_a_hundredth_at_the_soonest() -> None:
    assert gains(Load(0.5, 8.0, 8.0), 4.0)[0] == 400.0


def test_home_is_the_reference_or_the_limit_next_to_it() -> None:
    dofs = [hinge(axis=Z, limits=Limits(*span)).dofs[0] for span in ((-1.0, 1.0), (0.5, 1.0), (-2.0, -0.5), (None, None), (1.0, -1.0))]
    assert [home(dof) for dof in dofs] == [0.0, 0.5, -0.5, 0.0, 0.0]


MEASURED = """<mujoco model="s">
  <worldbody>
    <body name="a"><joint name="j"/><geom size="0.1"/></body>
    <body name="b"><joint name="k"/><geom size="0.1"/></body>
  </worldbody>
  <tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>
  <actuator>
    <general name="A_j" joint="j" gainprm="3"/>
    <motor name="A_t" tendon="t"/>
  </actuator>
  <sensor>
    <actuatorfrc name="of_j" actuator="A_j"/>
    <actuatorpos name="of_t" actuator="A_t"/>
    <jointpos name="place" joint="j"/>
  </sensor>
</mujoco>
"""


@pytest.mark.unread("HX101", "HX114")
@pytest.mark.parametrize(("kind", "left"), [("position", ["of_j", "place"]), ("motor", ["of_j", "place"]), ("none", ["place"])])
def test_sensors_measure_the_actuators_that_are_asked_for(kind: str, left: list[str], tmp_path: Path) -> None:
    (tmp_path / "s.xml").write_text(MEASURED)
    report = hx.convert(tmp_path / "s.xml", tmp_path / "t.xml", actuators=kind).report  # type: ignore[arg-type]
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "t.xml"))
    assert [model.sensor(number).name for number in range(model.nsensor)] == left
    if kind != "none":
        assert model.actuator(model.sensor("of_j").objid[0]).name == "j"
    lost = [name for name in ("of_j", "of_t") if name not in left]
    assert [row.message for row in report if "measure:" in row.message] == [
        f"{len(lost)} sensor{'s' if len(lost) > 1 else ''} left out with the actuators that they measure: {', '.join(map(repr, lost))}"
    ]
    assert hx.convert(tmp_path / "s.xml", tmp_path / "t.hymeko", actuators=kind)  # type: ignore[arg-type]


@pytest.mark.unread("HX101", "HX104", "HX114", "HX025")
def test_a_sensor_of_an_actuator_that_mjcf_does_not_have_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "s.hymeko").write_text(
        "s : robot {\n  a { mass 1 inertia [1 1 1] }\n  @j { + world - a }\n  n : motor { }\n  f : sensor.actuatorfrc { + n }\n}\n"
    )
    hx.convert(tmp_path / "s.hymeko", tmp_path / "s.xml")
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "s.xml")).nsensor == 0


NAMELESS = """<mujoco><worldbody>
  <body name="arm"><joint type="slide"/><geom size="0.1"/></body>
  <body><joint/><geom size="0.1"/></body>
  <body name="cart"><joint type="slide"/><joint type="slide" axis="0 1 0"/><joint name="cart_TZ" axis="1 0 0"/><geom size="0.1"/></body>
  <body><freejoint/><geom size="0.1"/></body>
</worldbody></mujoco>
"""


@pytest.mark.parametrize("kind", ["motor", "position", "velocity"])
def test_joints_without_names_get_names_for_the_actuators_that_are_asked_for(
    kind: Literal["motor", "position", "velocity"], tmp_path: Path
) -> None:
    (tmp_path / "a.xml").write_text(NAMELESS)
    hx.convert(tmp_path / "a.xml", tmp_path / "b.xml", actuators=kind)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "b.xml"))
    joints = [model.joint(number).name for number in range(model.njnt)]
    assert joints == ["arm", "world_body", "cart_TZ#2", "cart_TY", "cart_TZ", ""]
    assert [joints[number] for number in model.actuator_trnid[:, 0]] == joints[:-1]
    hx.convert(tmp_path / "b.xml", tmp_path / "c.xml")
    assert (tmp_path / "c.xml").read_bytes() == (tmp_path / "b.xml").read_bytes()
