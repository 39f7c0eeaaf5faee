"""The effort limits of joints in other formats are what MuJoCo's actuators can exert on them."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x import codes, formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles

MODEL = """
<mujoco>
  <default><default class="strong"><position forcerange="-87 87"/></default></default>
  <worldbody>
    <body>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <joint name="{first}" axis="0 1 0" range="-1 1"{own}/>
      <body pos="0 0 1">
        <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
        <joint name="b" type="slide" axis="0 0 1" range="0 1"/>
      </body>
    </body>
  </worldbody>
  {rest}
</mujoco>
"""


def model(rest: str, own: str = "") -> str:
    return MODEL.format(first="a", own=own, rest=rest)


def actuators(text: str) -> str:
    return f"<actuator>{text}</actuator>"


def efforts(text: str, target: str = "urdf") -> dict[str, float | None]:
    """The effort limits of the joints in the converted robot, by name."""
    robot = hx.loads(hx.dumps(hx.loads(text, "mjcf"), target), target).mechanism
    return {view.id.name: view.joint.dofs[0].limits.effort for view in robot.joints.values() if view.joint.dofs}


SPLIT = '<tendon><fixed name="split"><joint joint="a" coef="0.5"/><joint joint="b" coef="-2"/></fixed></tendon>'
CASES = {
    "the force range of its class": (actuators('<position class="strong" joint="a" kp="9"/>'), {"a": 87.0, "b": None}),
    "the greater end of a force range": (actuators('<velocity joint="a" forcerange="-3 5"/>'), {"a": 5.0, "b": None}),
    "the control range of a motor times its gear": (actuators('<motor joint="a" ctrlrange="-2 2" gear="-40"/>'), {"a": 80.0, "b": None}),
    "the gain of a general motor": (actuators('<general joint="b" ctrlrange="-1 1" gainprm="7" gear="3"/>'), {"a": None, "b": 21.0}),
    "the tighter of both ranges": (actuators('<motor joint="a" ctrlrange="-9 9" forcerange="-4 4"/>'), {"a": 4.0, "b": None}),
    "the sum of several": (
        actuators('<motor joint="a" ctrlrange="-2 2"/><position joint="a" forcerange="-5 5" gear="2"/>'),
        {"a": 12.0, "b": None},
    ),
    "the force of a tendon times the coefficient": (
        SPLIT + actuators('<motor tendon="split" ctrlrange="-10 10"/><motor joint="a" ctrlrange="-1 1"/>'),
        {"a": 6.0, "b": 20.0},
    ),
    "none where one of several has none": (
        actuators('<motor joint="a" ctrlrange="-2 2"/><position joint="a" kp="5"/>'),
        {"a": None, "b": None},
    ),
    "none where a range does not hold": (
        actuators('<motor joint="a" ctrlrange="-2 2" ctrllimited="false"/><motor joint="b" forcerange="-1 1" forcelimited="false"/>'),
        {"a": None, "b": None},
    ),
    "none of a servo without a force range": (actuators('<position joint="a" kp="5" ctrlrange="-1 1"/>'), {"a": None, "b": None}),
    "none of an integrator": (
        actuators('<general joint="a" dyntype="integrator" ctrlrange="-1 1" actlimited="false"/>'),
        {"a": None, "b": None},
    ),
}


@pytest.mark.parametrize("target", ["urdf", "sdf"])
@pytest.mark.parametrize("case", CASES)
def test_the_effort_limit_of_a_joint_is(case: str, target: str) -> None:
    rest, wanted = CASES[case]
    assert efforts(model(rest), target) == wanted


def test_a_joint_keeps_its_own_limit() -> None:
    text = model(actuators('<motor joint="a" ctrlrange="-2 2"/>'), ' actuatorfrcrange="-1 1"')
    assert efforts(text)["a"] == 1.0


@pytest.mark.parametrize("case", CASES)
def test_no_control_and_no_state_makes_mujoco_exceed_the_limit(case: str) -> None:
    """Wild controls and coordinates: the forces stay within the limits, and come up to one that a motor has."""
    rest, wanted = CASES[case]
    compiled = mujoco.MjModel.from_xml_string(model(rest))
    data, random = mujoco.MjData(compiled), np.random.default_rng(0)
    greatest = np.zeros(compiled.nv)
    for _ in range(300):
        data.qpos[:], data.qvel[:] = random.normal(scale=100.0, size=compiled.nq), random.normal(scale=100.0, size=compiled.nv)
        data.ctrl[:] = random.normal(scale=100.0, size=compiled.nu)
        mujoco.mj_forward(compiled, data)
        greatest = np.maximum(greatest, np.abs(data.qfrc_actuator))
    for name, found in zip("ab", greatest, strict=True):
        limit = wanted[name]
        assert limit is None or found == pytest.approx(limit, rel=1e-12)


def test_the_limits_are_a_note_and_no_loss() -> None:
    report = Report()
    source = hx.loads(model(CASES["the sum of several"][0]), "mjcf").mechanism
    result = pipeline.convert(source, formats.by_name("urdf"), Options(), NoFiles(), report)
    notes = [diagnostic.message for diagnostic in report if diagnostic.code == codes.REWRITTEN]
    assert notes == [
        "effort limits are what the actuators can exert: 'a' 12",
        "URDF requires limits that are not given: effort of 1 joint and velocity of 2 joints; 1e9 is written, which is read as none",
    ]
    assert [loss for loss in result.losses or () if "effort" in loss.field] == []


def test_a_limit_that_the_actuators_do_not_explain_is_a_loss() -> None:
    """The rule gives what the actuators can exert; another number in the output would be a fault, and is listed."""
    from hymeko_x.compare.ledger import losses_between

    source = hx.loads(model(CASES["the sum of several"][0]), "mjcf").mechanism
    image = hx.loads(model(CASES["the sum of several"][0], ' actuatorfrcrange="-13 13"'), "mjcf").mechanism
    losses = losses_between(source, image, (), formats.by_name("urdf"))
    assert [(loss.element, loss.field, loss.after) for loss in losses] == [("joint 'a'", "dofs[0].limits.effort", "13")]


def test_what_is_kept_takes_the_limits_away_again() -> None:
    source = hx.loads(model(CASES["the sum of several"][0]), "mjcf").mechanism
    assert hx.loads(hx.dumps(source, "urdf", keep="inside"), "urdf").mechanism == source
