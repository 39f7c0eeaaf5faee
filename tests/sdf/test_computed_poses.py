"""Poses that reading an SDF file computes, from those of links in the model, are as a person would write them."""

from __future__ import annotations

from pathlib import Path

import hymeko_x as hx
from hymeko_x.ir.values import Pose, Written

_LINK = '<link name="{name}"><pose>{pose}</pose><inertial><mass>1</mass></inertial></link>'


def _joint_pose(folder: Path, parent: str, child: str) -> Pose:
    """The pose of the child of a robot with two links, in its parent."""
    links = _LINK.format(name="a", pose=parent) + _LINK.format(name="b", pose=child)
    joint = '<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>'
    file = folder / "r.sdf"
    file.write_text(f'<sdf version="1.9"><model name="r">{links}{joint}</model></sdf>', "utf-8")
    return hx.load(file).joints["j"].pose


def test_a_difference_of_lengths_has_the_digits_of_the_lengths(tmp_path: Path) -> None:
    assert _joint_pose(tmp_path, "0 0 0.3 0 0 0", "0 0.1 0.1 0 0 0").xyz == (0.0, 0.1, -0.2)


def test_equal_rotations_leave_none_between_the_links(tmp_path: Path) -> None:
    pose = _joint_pose(tmp_path, "0.1 0.2 0.3 0.4 -0.7 1.1", "0.1 0.2 0.3 0.4 -0.7 1.1")
    assert (pose.xyz, pose.quat) == ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))


def test_a_pose_of_the_file_keeps_all_its_digits(tmp_path: Path) -> None:
    pose = _joint_pose(tmp_path, "0 0 0 0 0 0", "0.12345678901234567 0 0.30000000000000004 0 0 0")
    assert pose.xyz == (0.12345678901234567, 0.0, 0.30000000000000004)


def test_angles_of_the_file_stay_where_only_the_place_is_computed(tmp_path: Path) -> None:
    pose = _joint_pose(tmp_path, "0 0 0.3 0 0 0", "0 0 0.21 0 1.5708 0")
    assert pose.written == Written("rpy", (0.0, 1.5708, 0.0))
    hx.convert(tmp_path / "r.sdf", tmp_path / "r.urdf")
    assert '<origin xyz="0 0 -0.09" rpy="0 1.5708 0"/>' in (tmp_path / "r.urdf").read_text("utf-8")


def test_a_turned_axis_has_no_noise(tmp_path: Path) -> None:
    text = """<sdf version="1.9"><model name="r"><link name="a"/><link name="b"/>
    <joint name="j" type="revolute"><parent>a</parent><child>b</child>
    <axis><xyz expressed_in="f">1 0 0</xyz></axis></joint><frame name="f"><pose>0 0 0 0 0 1.5707963267948966</pose></frame></model></sdf>"""
    (tmp_path / "r.sdf").write_text(text, "utf-8")
    assert hx.load(tmp_path / "r.sdf").joints["j"].axis == (0.0, 1.0, 0.0)


def test_the_usual_text_of_a_pose_is_no_part_of_the_robot(tmp_path: Path) -> None:
    """Another text for the same place is, so that it comes back."""
    places = ("0 0 -0.0425 0 0 0", "0 0 -.05 0 0 0", "0 0 0.1 0 0.5 0")
    balls = "".join(
        f'<visual name="v{number}"><pose>{place}</pose><geometry><sphere><radius>0.1</radius></sphere></geometry></visual>'
        for number, place in enumerate(places)
    )
    file, text = tmp_path / "r.sdf", tmp_path / "r.hymeko"
    file.write_text(f'<sdf version="1.9"><model name="r"><link name="a">{balls}</link></model></sdf>', "utf-8")
    hx.convert(file, text)
    assert text.read_text("utf-8").count("`sdf.pose`") == 2
    hx.convert(text, tmp_path / "back.sdf")
    assert all(f"<pose>{place}</pose>" in (tmp_path / "back.sdf").read_text("utf-8") for place in places)
