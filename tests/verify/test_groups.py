"""`verify --match joints`: two authors' files of one robot, with other links, frames and names, are compared by how it moves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hymeko_x.cli import exits, main
from hymeko_x.verify import model_of, verify
from hymeko_x.verify.groups import grouped
from hymeko_x.verify.renaming import renamed

OURS = """<robot name="arm">
  <link name="a_base"><inertial><mass value="3"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="a_upper">
    <inertial><origin xyz="0 0 0.1"/><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.002"/></inertial>
  </link>
  <link name="a_flange">
    <inertial><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>
  </link>
  <link name="a_fore">
    <inertial><origin xyz="0.02 0 0.1"/><mass value="0.4"/><inertia ixx="0.004" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.001"/></inertial>
  </link>
  <link name="a_camera"/>
  <joint name="a_turn" type="revolute">
    <parent link="a_base"/><child link="a_upper"/><origin xyz="0 0 0.1" rpy="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="20" velocity="2"/>
  </joint>
  <joint name="a_mount" type="fixed"><parent link="a_upper"/><child link="a_flange"/><origin xyz="0 0 0.2"/></joint>
  <joint name="a_bend" type="revolute">
    <parent link="a_flange"/><child link="a_fore"/><origin xyz="0.05 0.01 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="2"/>
  </joint>
  <joint name="a_eye" type="fixed"><parent link="a_fore"/><child link="a_camera"/><origin xyz="0 0 0.3"/></joint>
</robot>
"""

_COM = 0.4 / 1.5 / 2  # of link and flange, in m above the link's joint
_ACROSS = 0.011 + 1.0 * (_COM - 0.1) ** 2 + 0.5 * (0.2 - _COM) ** 2

THEIRS = f"""<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="pedestal">
      <inertial pos="0 0 0" mass="3" diaginertia="0.1 0.1 0.1"/>
      <body name="l1" pos="0 0 {{high}}" euler="0 0 0.5">
        <joint name="turn" pos="0 0 -0.2" axis="0 0 1" range="-2 2" actuatorfrcrange="-20 20"/>
        <inertial pos="0 0 {_COM - 0.2}" mass="1.5" diaginertia="{_ACROSS} {_ACROSS} 0.003"/>
        <body name="l2" pos="0.05 0.51 0">
          <joint name="bend" pos="0 -0.3 0" axis="0 1 0" range="-1 1" actuatorfrcrange="-10 10"/>
          <inertial pos="0.02 -0.5 0.1" mass="{{mass}}" diaginertia="0.004 0.004 0.001"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def files(folder: Path, *, high: float = 0.3, mass: float = 0.4) -> tuple[Path, Path]:
    ours, theirs = folder / "ours.urdf", folder / "theirs.xml"
    ours.write_text(OURS)
    theirs.write_text(THEIRS.format(high=high, mass=mass))
    return ours, theirs


def test_other_links_frames_and_names_are_the_same_robot(tmp_path: Path) -> None:
    ours, theirs = files(tmp_path)
    assert not verify(ours, theirs).is_same
    verdict = verify(ours, theirs, joints=True, rename={"a_*": "*"})
    assert verdict.is_same, verdict.failed
    compared = {check.quantity for check in verdict.checks}
    assert {"forward kinematics, position", "mass", "centre of mass", "inertia tensor", "position limits", "mass matrix"} <= compared


@pytest.mark.parametrize(
    ("change", "quantity", "at", "size"),
    [({"high": 0.301}, "forward kinematics, position", "bend", 0.001), ({"mass": 0.45}, "mass", "body 'bend'", 0.05)],
)
def test_a_difference_is_found_at_its_joint(tmp_path: Path, change: dict[str, float], quantity: str, at: str, size: float) -> None:
    verdict = verify(*files(tmp_path, **change), joints=True, rename={"a_*": "*"})
    failed = {check.quantity: check for check in verdict.failed}
    assert failed[quantity].worst == pytest.approx(size)
    assert at in failed[quantity].at


def test_joints_of_other_names_have_no_counterpart(tmp_path: Path) -> None:
    verdict = verify(*files(tmp_path), joints=True, rename={"a_t*": "t*"})
    assert {check.quantity for check in verdict.failed} >= {"bodies"}
    assert "a_bend" in next(check.at for check in verdict.failed if check.quantity == "bodies")


def test_grouping_keeps_mass_and_motion(tmp_path: Path) -> None:
    ours, _ = files(tmp_path)
    model = model_of(ours)
    found = grouped(model)
    assert [body.name for body in found.bodies[1:]] == ["base", "a_turn", "a_bend"]
    assert sum(body.mass for body in found.bodies) == pytest.approx(sum(body.mass for body in model.bodies))
    assert np.allclose(found.bodies[2].com, [0, 0, 0.1 + _COM])  # in the frame of the base: the axis is next to it in its origin


def test_words_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ours, theirs = map(str, files(tmp_path))
    assert main(["verify", ours, theirs, "--match", "joints", "--rename", "a_*=*"]) == exits.DONE
    assert capsys.readouterr().out.startswith("same as far as")
    assert main(["verify", ours, theirs, "--match", "joints", "--rename", "a_**=*"]) == exits.USAGE
    assert "expected OLD=NEW with at most one *" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "rename", "expected"),
    [
        ("panda_joint1", {"panda_*": "*"}, "joint1"),
        ("left_hip", {"*_hip": "hip_*"}, "hip_left"),
        ("elbow", {"el.ow": "x", "elbow": "fold"}, "fold"),
        ("panda_joint1", {"panda_joint1": "first", "panda_*": "*"}, "first"),
        ("other", {"panda_*": "*"}, "other"),
    ],
)
def test_renaming(name: str, rename: dict[str, str], expected: str) -> None:
    assert renamed(name, rename) == expected
