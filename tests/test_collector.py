"""The collector of cyclic garbage rests while a robot is read or written."""

from __future__ import annotations

import gc

import pytest

import hymeko_x as hx
from hymeko_x.collector import uncollected
from hymeko_x.diagnostics import Refusal

ROBOT = """<robot name="r"><link name="base"/><link name="tip"><visual><geometry><box size="1 1 1"/></geometry>
<material name="red"><color rgba="1 0 0 1"/></material></visual><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="hip" type="continuous"><parent link="base"/>
<child link="tip"/><axis xyz="0 0 1"/></joint></robot>"""


def test_it_rests_inside_and_runs_again_outside() -> None:
    assert gc.isenabled()
    with uncollected():
        assert not gc.isenabled()
        with uncollected():
            assert not gc.isenabled()
        assert not gc.isenabled()
    assert gc.isenabled()


def test_it_runs_again_after_a_refusal() -> None:
    with pytest.raises(Refusal):
        hx.loads("<sdf/>", "mjcf")
    assert gc.isenabled()


def test_who_switched_it_off_finds_it_off() -> None:
    gc.disable()
    try:
        hx.dumps(hx.loads('<robot name="r"><link name="l"/></robot>', "urdf"), "mjcf")
        assert not gc.isenabled()
    finally:
        gc.enable()


@pytest.mark.parametrize("format", ["urdf", "xacro", "mjcf", "usd", "sdf", "hymeko", "json"])
def test_no_text_and_no_mechanism_waits_for_it(format: str) -> None:
    """Objects that refer to each other would stay, with all that they refer to, until the next collection of the oldest ones."""
    robot = hx.loads(ROBOT, "urdf")
    hx.loads(hx.dumps(robot, format), format)
    with uncollected():
        gc.collect()
        hx.loads(hx.dumps(robot, format), format)
        assert gc.collect() == 0
