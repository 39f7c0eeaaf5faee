"""What other programs need of a stage, each found by letting them read ours."""

from __future__ import annotations

import re
from pathlib import Path

from pxr import Usd

import hymeko_x as hx
from hymeko_x import codes
from hymeko_x.compare.diff import diff
from hymeko_x.diagnostics import Report, Severity
from hymeko_x.frontends import urdf
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.source import Source
from tests.usd.stages import again, opened, written

HAND = """<robot name="hand">
  <link name="palm"/>
  <link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="0"/></inertial></link>
  <link name="b"/>
  <link name="c"/>
  <joint name="first" type="revolute"><parent link="palm"/><child link="a"/><limit lower="0" upper="1" effort="0" velocity="0"/></joint>
  <joint name="second" type="revolute"><parent link="a"/><child link="b"/><limit lower="0" upper="1" effort="1" velocity="1"/>
    <mimic joint="first" multiplier="2" offset="0.5"/></joint>
  <joint name="third" type="revolute"><parent link="b"/><child link="c"/><limit lower="0" upper="1" effort="1" velocity="1"/>
    <mimic joint="second" multiplier="3" offset="0.25"/></joint>
  <transmission name="alone"><type>simple</type></transmission>
</robot>"""


def hand() -> Mechanism:
    report = Report()
    mechanism = urdf.read(Source("hand.urdf", HAND.encode()), report).mechanism
    assert [item.code for item in report if item.code != codes.MISSING_PART] == []
    return mechanism


def test_a_mimic_is_led_by_the_first_of_its_leaders_and_comes_back_as_it_was(tmp_path: Path) -> None:
    """Newton refuses a leader that follows another joint: 0.25 + 3 (0.5 + 2 x) = 1.75 + 6 x, the constant in degrees."""
    stage = opened(written(hand()), tmp_path)
    third = stage.GetPrimAtPath("/hand/joints/third")
    assert [str(path) for path in third.GetRelationship("newton:mimicJoint").GetTargets()] == ["/hand/joints/first"]
    assert round(third.GetAttribute("newton:mimicCoef0").Get(), 3) == 100.268
    assert third.GetAttribute("newton:mimicCoef1").Get() == 6.0
    assert diff(hand(), again(hand())) == ()


def test_a_speed_limit_of_zero_is_reported(tmp_path: Path) -> None:
    stage = opened(written(hand()), tmp_path)
    first = stage.GetPrimAtPath("/hand/joints/first")
    assert first.GetAttribute("newton:velocityLimit").Get() == 0.0


def test_a_rod_has_its_moments_and_newtons_tensor(tmp_path: Path) -> None:
    """UsdPhysics ignores moments that are all zero; its rules demand that every other one is more than 0."""
    stage = opened(written(hand()), tmp_path)
    body = stage.GetPrimAtPath("/hand/a")
    moments = sorted(body.GetAttribute("physics:diagonalInertia").Get())
    assert moments[1:] == [1.0, 1.0]
    assert 0.0 < moments[0] < 1e-11
    assert list(body.GetAttribute("newton:inertia").Get()) == [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]


def test_moments_that_contradict_newtons_tensor_are_reported(tmp_path: Path) -> None:
    text = hx.dumps(hand(), "usd")
    assert text.count("float3 physics:diagonalInertia = (") >= 1
    edited = re.sub(r"physics:diagonalInertia = \([^)]*\)", "physics:diagonalInertia = (7, 8, 9)", text, count=1)
    report = Report()
    robot = hx.loads(edited, "usd", report=report).mechanism
    found = [str(item) for item in report if item.severity is Severity.WARNING]
    assert [line for line in found if "HX029" not in line] == []
    assert len(found) == 1
    assert "newton:inertia is not the tensor of physics:diagonalInertia and physics:principalAxes; newton:inertia counts" in found[0]
    assert diff(hx.loads(text, "usd").mechanism, robot) == ()


def test_every_prim_has_a_type(tmp_path: Path) -> None:
    stage: Usd.Stage = opened(written(hand()), tmp_path)
    assert [str(prim.GetPath()) for prim in stage.Traverse() if not prim.GetTypeName()] == []
