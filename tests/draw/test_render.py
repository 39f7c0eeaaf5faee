"""Pictures: the robot fills them, they are the same in every format, and a fault in a shape or a colour changes them."""

from __future__ import annotations

import functools
import io
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hymeko_x import api, codes
from hymeko_x.cli import main
from hymeko_x.diagnostics import Refusal
from hymeko_x.draw.files import film
from hymeko_x.draw.render import PictureOptions, choose_backend, open_studio

ARM = """<robot name="arm">
  <material name="red"><color rgba="0.8 0.2 0.1 1"/></material>
  <link name="base"><visual><geometry><cylinder radius="0.1" length="0.2"/></geometry></visual>
    <collision><geometry><box size="0.3 0.3 0.2"/></geometry></collision></link>
  <link name="arm"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.08 0.08"/></geometry><material name="red"/></visual></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.14"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""
SIZE = (320, 240)


@pytest.fixture(scope="module", autouse=True)
def _can_draw() -> None:
    choose_backend()
    try:
        picture(ARM)
    except Refusal as refusal:
        if refusal.diagnostic.code == codes.CANNOT_DRAW:
            pytest.skip(refusal.diagnostic.message)
        raise


@functools.cache
def picture(text: str, format: str = "urdf", **wanted: object) -> np.ndarray:
    robot = api.loads(text, format).mechanism
    return open_studio(robot, None, PictureOptions(**{"size": SIZE, **wanted})).still()  # type: ignore[arg-type]


@pytest.mark.parametrize("scale", [0.01, 50.0])
def test_the_ground_is_light_up_to_the_corners_of_the_picture(scale: float) -> None:
    text = f'<robot name="r"><link name="l"><visual><geometry><box size="{scale} {scale} {2 * scale}"/></geometry></visual></link></robot>'
    found = picture(text).astype(int)
    corners = [found[rows, columns].min() for rows in (slice(20), slice(-20, None)) for columns in (slice(20), slice(-20, None))]
    assert min(corners) > 150, corners


@pytest.mark.parametrize("view", ["front", "side", "top", "iso"])
@pytest.mark.parametrize("scale", [0.01, 50.0])
def test_the_robot_fills_the_picture(view: str, scale: float) -> None:
    red = f'<robot name="r"><link name="l"><visual><geometry><box size="{scale} {scale} {2 * scale}"/></geometry><material name="m">' + (
        '<color rgba="1 0 0 1"/></material></visual></link></robot>'
    )
    found = picture(red, view=view).astype(int)
    is_red = found[..., 0] - found[..., 1] > 60
    rows, columns = np.flatnonzero(is_red.any(axis=1)), np.flatnonzero(is_red.any(axis=0))
    filled = max(np.ptp(rows) / SIZE[1], np.ptp(columns) / SIZE[0])
    assert 0.5 < filled < 0.95
    assert rows[0] > 0
    assert rows[-1] < SIZE[1] - 1
    assert columns[0] > 0
    assert columns[-1] < SIZE[0] - 1


@pytest.mark.parametrize("format", ["mjcf", "hymeko", "usd", "xacro"])
def test_a_robot_has_the_same_picture_in_every_format(format: str) -> None:
    other = api.dumps(api.loads(ARM, "urdf").mechanism, format)
    assert np.mean(np.any(picture(ARM) != picture(other, format), axis=2)) < 0.005


def test_what_is_not_drawn_changes_nothing_in_the_picture() -> None:
    far = ARM.replace('<box size="0.3 0.3 0.2"/></geometry>', '<box size="3 3 0.2"/></geometry>')
    assert far != ARM
    assert (picture(ARM) == picture(far)).all()


def test_the_ground_has_no_colour_of_the_robots_defaults() -> None:
    body = '<worldbody><body><geom type="box" size="0.1 0.1 0.1" rgba="0.1 0.2 0.8 1"{}/></body></worldbody></mujoco>'
    plain = "<mujoco>" + body.format("")
    brown = '<mujoco><default><geom rgba="0.8 0.6 0.4 1" group="4"/></default>' + body.format(' group="0"')
    assert (picture(plain, "mjcf") == picture(brown, "mjcf")).all()


@pytest.mark.parametrize(
    "fault", [("0.8 0.2 0.1", "0.1 0.2 0.8"), ('xyz="0.3 0 0"', 'xyz="-0.3 0 0"'), ("0.6 0.08 0.08", "0.6 0.08 0.2"), ("0.14", "0.24")]
)
def test_a_fault_changes_the_picture(fault: tuple[str, str]) -> None:
    assert fault[0] in ARM
    assert np.mean(np.any(picture(ARM) != picture(ARM.replace(*fault)), axis=2)) > 0.01


def test_collision_shapes_and_poses_are_drawn(tmp_path: Path) -> None:
    pose = tmp_path / "q.json"
    pose.write_text(json.dumps({"turn": 0.8}))
    usual = picture(ARM)
    assert np.any(usual != picture(ARM, collision=True))
    assert np.any(usual != picture(ARM, pose=str(pose)))
    assert np.any(usual != picture(ARM, frames=True))
    assert np.any(usual != picture(ARM, inertia=True))


def test_what_cannot_be_drawn_is_refused(tmp_path: Path) -> None:
    with pytest.raises(Refusal) as caught:
        picture('<robot name="r"><link name="l"/></robot>')
    assert caught.value.diagnostic.code == codes.NOTHING_TO_DRAW
    for name in ("up", str(tmp_path / "none.json")):
        with pytest.raises(Refusal):
            picture(ARM, pose=name)


@pytest.mark.parametrize(("suffix", "magic"), [(".gif", b"GIF89a"), (".mp4", b"ftyp")])
def test_a_film_shows_the_joints_move(suffix: str, magic: bytes) -> None:
    pictures = [*open_studio(api.loads(ARM, "urdf").mechanism, None, PictureOptions(size=(64, 48))).sweep()]
    assert any(np.any(pictures[0] != later) for later in pictures[1:])
    assert magic in film(pictures, suffix)[:16]


def test_the_command_draws_several_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ARM)
    Path("arm.xml").write_text(api.dumps(api.loads(ARM, "urdf").mechanism, "mjcf"))
    assert main(["render", "arm.urdf", "arm.xml", "-o", "both.png", "--size", "320x240"]) == 0
    both = np.asarray(Image.open(io.BytesIO(Path("both.png").read_bytes())))
    assert both.shape == (240, 640, 3)
    assert np.mean(np.any(both[:, :320] != both[:, 320:], axis=2)) < 0.005
    assert main(["render", "arm.urdf", "-o", "both.jpg"]) == 2
    assert main(["render", "arm.urdf", "arm.xml", "--animate", "-o", "both.gif"]) == 2
