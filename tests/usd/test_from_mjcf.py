"""What only MJCF says, as a stage that is still the same robot."""

from __future__ import annotations

from pathlib import Path

import pytest
from pxr import Gf, Usd, UsdGeom

import hymeko_x as hx

CUBE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def stage_of(worldbody: str, folder: Path, assets: str = "") -> tuple[Path, Path]:
    """The model as a file, and as the stage that it becomes."""
    source, stage = folder / "robot.xml", folder / "robot.usda"
    source.write_text(f"<mujoco><asset>{assets}</asset><worldbody>{worldbody}</worldbody></mujoco>")
    hx.convert(source, stage, keep="inside")
    return source, stage


def different(source: Path, stage: Path) -> list[str]:
    verdict = hx.verify(source, stage)
    assert verdict.checks
    return [f"{check.quantity} at {check.at}" for check in verdict.failed]


def test_dofs_stand_in_the_order_in_which_usd_physics_lists_joints(tmp_path: Path) -> None:
    """Newton takes that order for the order of the dofs; it is alphabetical."""
    hips = '<joint name="z" axis="0 0 1"/><joint name="x" axis="1 0 0"/><joint name="y" axis="0 1 0"/><geom size="0.1"/>'
    knees = '<joint name="a" axis="0 0 1"/><joint name="b" axis="1 0 0"/><geom size="0.1"/>'
    source, stage = stage_of(f'<body name="hip">{hips}<body name="knee">{knees}</body></body>', tmp_path)
    opened = Usd.Stage.Open(str(stage))
    joints = {str(prim.GetName()): prim.GetDisplayName() for prim in opened.GetPrimAtPath("/robot/joints").GetChildren()}
    assert sorted(joints.items()) == [
        ("a", ""),
        ("b", ""),
        ("hip_1", "z"),
        ("hip_2", "x"),
        ("hip_3", "y"),
    ]
    assert different(source, stage) == []
    assert hx.load(stage).mechanism == hx.load(source).mechanism


def test_coordinates_that_count_from_a_reference_mean_the_same(tmp_path: Path) -> None:
    """The slide comes before the hinge of the same body, so that the hinge stands where the slide's reference puts it."""
    joints = '<joint name="up" type="slide" axis="0 0 1" ref="1.25" range="0 2" limited="true"/><joint name="turn" axis="0 1 0"/>'
    source, stage = stage_of(f'<body name="b" pos="0 0 1.25">{joints}<geom size="0.1"/></body>', tmp_path)
    assert different(source, stage) == []
    opened = Usd.Stage.Open(str(stage))
    up = opened.GetPrimAtPath("/robot/joints/b_1")
    assert [up.GetAttribute(name).Get() for name in ("mjc:ref", "physics:lowerLimit", "physics:upperLimit")] == [1.25, 0.0, 2.0]


def test_a_shape_that_mujoco_fits_to_a_mesh_is_that_shape(tmp_path: Path) -> None:
    (tmp_path / "cube.obj").write_text(CUBE)
    body = '<body name="b"><joint/><geom type="capsule" mesh="cube"/></body>'
    source, stage = stage_of(body, tmp_path, '<mesh name="cube" file="cube.obj"/>')
    assert different(source, stage) == []
    opened = Usd.Stage.Open(str(stage))
    assert "Capsule" in [str(prim.GetTypeName()) for prim in opened.Traverse()]


def test_a_camera_sees_what_it_sees_in_mujoco(tmp_path: Path) -> None:
    """45 degrees where nothing is written, which in USD would mean 17."""
    geom = '<geom size="0.1"/>'
    source, stage = stage_of(f'<body name="b">{geom}<camera name="usual"/><camera name="narrow" fovy="20"/></body>', tmp_path)
    opened = Usd.Stage.Open(str(stage))
    seen = {
        str(prim.GetName()): UsdGeom.Camera(prim).GetCamera().GetFieldOfView(Gf.Camera.FOVVertical)
        for prim in opened.Traverse()
        if prim.IsA(UsdGeom.Camera)
    }
    assert seen == {"usual": pytest.approx(45.0), "narrow": pytest.approx(20.0)}
    assert hx.load(stage).mechanism == hx.load(source).mechanism


def test_sites_and_cameras_are_no_more_than_that(tmp_path: Path) -> None:
    """What we write of them is read, so that a stage without a residue has nothing more to tell."""
    things = '<site name="tip" pos="0.1 0 0" size="0.005"/><camera name="eye" fovy="45" pos="0 0 1"/>'
    robot = hx.loads(f'<mujoco><worldbody><body name="b"><geom size="0.1"/>{things}</body></worldbody></mujoco>', "mjcf").mechanism
    again = hx.loads(hx.dumps(robot, "usd"), "usd").mechanism
    assert {key.kind: again.extras.get(key, ()) for key in robot.graph.vertices if key.kind in ("frame", "camera")} == {
        "frame": (),
        "camera": (),
    }
