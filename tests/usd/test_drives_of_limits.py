"""Effort limits are the greatest forces of drives, for programs that know them only from there, and no actuators."""

from __future__ import annotations

import pytest
from pxr import Usd, UsdPhysics

import hymeko_x as hx
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.parts import Actuator

URDF = """<robot name="arm">
  <link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="c"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="turn" type="revolute"><parent link="a"/><child link="b"/><limit lower="-1" upper="1" effort="200" velocity="2"/></joint>
  <joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><limit lower="0" upper="1" effort="30.5" velocity="2"/></joint>
</robot>"""


def drives(text: str) -> dict[str, dict[str, float]]:
    """What each joint's drive has authored, by the joint's name."""
    stage = Usd.Stage.CreateInMemory()
    stage.GetRootLayer().ImportFromString(text)
    found = {}
    for prim in stage.Traverse():
        for instance in ("angular", "linear"):
            if prim.HasAPI(UsdPhysics.DriveAPI, instance):
                drive = UsdPhysics.DriveAPI(prim, instance)
                values = {"force": drive.GetMaxForceAttr(), "kp": drive.GetStiffnessAttr(), "kd": drive.GetDampingAttr()}
                found[prim.GetName()] = {name: value.Get() for name, value in values.items() if value.HasAuthoredValue()}
    return found


def actuators(robot: Mechanism) -> list[Actuator]:
    return [part for _, part in robot.vertices(Actuator)]


def test_an_effort_limit_is_the_greatest_force_of_a_drive_and_no_actuator() -> None:
    text = hx.dumps(hx.loads(URDF, "urdf"), "usd")
    assert drives(text) == {"turn": {"force": 200.0}, "slide": {"force": 30.5}}
    robot = hx.loads(text, "usd").mechanism
    assert actuators(robot) == []
    assert [view.joint.dofs[0].limits.effort for view in robot.joints.values() if view.id.name in ("turn", "slide")] == [200.0, 30.5]


@pytest.mark.parametrize(("kind", "gains"), [("position", {"kp", "kd"}), ("velocity", {"kd"}), ("motor", set())])
def test_actuators_that_are_asked_for_can_drive_the_stage(kind: str, gains: set[str]) -> None:
    text = hx.dumps(hx.loads(URDF, "urdf"), "usd", actuators=kind)
    found = drives(text)
    assert {name: drive["force"] for name, drive in found.items()} == {"turn": 200.0, "slide": 30.5}
    assert [drive.keys() - {"force"} for drive in found.values()] == [gains, gains]
    assert [part.kind for part in actuators(hx.loads(text, "usd").mechanism)] == [kind, kind]
    assert not any("forcerange" in dict(part.parameters) for part in actuators(hx.loads(text, "usd").mechanism))


def test_a_greatest_force_that_is_edited_is_another_one() -> None:
    text = hx.dumps(hx.loads(URDF, "urdf"), "usd").replace("maxForce = 200", "maxForce = 50")
    assert [dict(part.parameters)["forcerange"] for part in actuators(hx.loads(text, "usd").mechanism)] == [(-50.0, 50.0)]
