"""Skins in binary files, which name their bones: they stay the same skin when the bodies get other names."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np
import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

WORM = """<mujoco model="worm"><compiler meshdir="skins"/><asset><skin file="worm.skn" rgba="1 0 0 1"/></asset><worldbody>
<body name="head_left"><geom size=".1"/><joint name="a"/><body name="tail" pos="1 0 0"><geom size=".1"/><joint name="b"/></body></body>
</worldbody></mujoco>"""
POINTS = (0.1, -0.2, 1 / 3, 1.0, 0.0, 1e-7, 1.1, 0.5, -2.0)
WEIGHTS = {"head_left": ((0, 1), (1.0, 1 / 3)), "tail": ((1, 2), (2 / 3, 1.0))}


def skin() -> bytes:
    """Three points and a triangle on two bones."""
    data = struct.pack("<4i9f6f3i", 3, 3, 1, 2, *POINTS, *range(6), 0, 1, 2)
    for name, (indices, weights) in WEIGHTS.items():
        pose = struct.pack("<40s3f4f", name.encode(), 0.1 * len(name), -0.3, 0, 1, 0, 0, 0)
        data += pose + struct.pack(f"<i{len(indices)}i{len(weights)}f", len(indices), *indices, *weights)
    return data


@pytest.fixture
def worm(tmp_path: Path) -> hx.Robot:
    """A robot with such a skin."""
    (tmp_path / "skins").mkdir()
    (tmp_path / "skins/worm.skn").write_bytes(skin())
    (tmp_path / "worm.xml").write_text(WORM)
    return hx.load(tmp_path / "worm.xml")


def arrays(robot: hx.Robot) -> dict[str, np.ndarray]:
    """What MuJoCo has of the skin, without the path of its file."""
    model = robot.to_mujoco()
    assert model.nskin
    found = {name: getattr(model, name) for name in dir(model) if name.startswith("skin_") and name != "skin_pathadr"}
    return {name: array for name, array in found.items() if isinstance(array, np.ndarray)}


def renamed(robot: hx.Robot) -> hx.Robot:
    with robot.edit() as e:
        e.rename(e.bodies["tail"], "end")
    return e.robot


CHANGES: dict[str, Callable[[hx.Robot], hx.Robot]] = {
    "renamed": renamed,
    "mirrored": lambda robot: robot.mirrored(names=("left", "right")),
    "merged": hx.Robot.merge_fixed_joints,
    "subtree": lambda robot: robot.subtree("head_left"),
    "split": lambda robot: robot.split()[0],
    "composed": lambda robot: hx.compose((robot,)),
    "detached": lambda robot: hx.compose((robot, robot), ((0, 0, 0), (0, 1, 0)), names=("a", "b")).detach("b/")[1],
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_a_skin_is_on_bodies_with_other_names(worm: hx.Robot, change: Callable[[hx.Robot], hx.Robot]) -> None:
    before, after = arrays(worm), arrays(change(worm))
    assert len(before) > 10
    for name, array in before.items():
        assert np.array_equal(after[name], array), name


def test_two_robots_with_one_skin_have_two(worm: hx.Robot, tmp_path: Path) -> None:
    (tmp_path / "two.hymeko").write_text('import "worm.xml" as worm two : robot { a : worm {} b : worm { at [0 1 0] } }')
    for two in (hx.compose((worm, worm), names=("a", "b")), hx.load(tmp_path / "two.hymeko")):
        model = two.to_mujoco()
        bones = [model.body(body).name.replace("/", "_") for body in model.skin_bonebodyid]
        assert bones == ["a_head_left", "a_tail", "b_head_left", "b_tail"]


def test_a_skin_has_the_size_of_its_robot(worm: hx.Robot) -> None:
    before, after = arrays(worm), arrays(worm.scaled(2))
    assert np.array_equal(after["skin_vert"], 2 * before["skin_vert"])
    assert np.array_equal(after["skin_bonebindpos"], 2 * before["skin_bonebindpos"])
    assert np.array_equal(after["skin_face"], before["skin_face"])


def test_a_skin_stays_a_file_where_no_name_changes(worm: hx.Robot) -> None:
    with worm.edit() as e:
        e.bodies["tail"].mass = 2
    assert 'worm.skn"' in hx.dumps(e.robot, "mjcf")


def test_a_skin_goes_with_its_bones(worm: hx.Robot) -> None:
    with worm.edit() as e:
        e.remove("tail")
    assert e.robot.to_mujoco().nskin == 0


@pytest.mark.parametrize("data", [b"", skin()[:-1], skin() + b"\0", struct.pack("<4i", -1, 0, 0, 0)])
def test_a_file_that_is_no_skin_stays_named(worm: hx.Robot, tmp_path: Path, data: bytes) -> None:
    (tmp_path / "skins/worm.skn").write_bytes(data)
    with pytest.raises(hx.Refusal):
        worm.to_mujoco()
    assert 'worm.skn"' in hx.dumps(renamed(worm), "mjcf")
