"""<gazebo> fragments of URDF files are obeyed in SDF."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

ROBOT = """<robot name="r"><link name="a">
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><sphere radius="1"/></geometry></visual><collision><geometry><sphere radius="1"/></geometry></collision></link>
<link name="b"/><joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>
<link name="c"/><joint name="k" type="continuous"><parent link="a"/><child link="c"/></joint>{}</robot>"""


def written(fragment: str, folder: Path) -> str:
    """The robot with a fragment as SDF, on one line."""
    (folder / "r.urdf").write_text(ROBOT.format(fragment), "utf-8")
    hx.convert(str(folder / "r.urdf"), str(folder / "r.sdf"))
    return "".join(line.strip() for line in (folder / "r.sdf").read_text("utf-8").splitlines())


@pytest.mark.parametrize(
    ("fragment", "expected"),
    [
        ('<gazebo reference="a"><mu1>0.5</mu1></gazebo>', "<surface><friction><ode><mu>0.5</mu></ode></friction></surface>"),
        ('<gazebo reference="a"><kp>1e6</kp></gazebo>', "<surface><contact><ode><kp>1e6</kp></ode></contact></surface>"),
        ('<gazebo reference="a"><selfCollide>true</selfCollide></gazebo>', "<self_collide>true</self_collide>"),
        ('<gazebo reference="a"><turnGravityOff>true</turnGravityOff></gazebo>', "<gravity>false</gravity>"),
        ('<gazebo reference="a"><material>Gazebo/Red</material></gazebo>', "<name>Gazebo/Red</name>"),
        ('<gazebo reference="a"><sensor name="i" type="imu"><always_on>1</always_on></sensor></gazebo>', '<sensor name="i" type="imu">'),
        ('<gazebo reference="j"><provideFeedback>true</provideFeedback></gazebo>', "<provide_feedback>true</provide_feedback>"),
        ('<gazebo reference="a"><mu2 value="0.5"/></gazebo>', "<surface><friction><ode><mu2>0.5</mu2></ode></friction></surface>"),
        ('<gazebo reference="a"><self_collide>true</self_collide></gazebo>', "<self_collide>true</self_collide>"),
        ('<gazebo reference="a"><selfCollide>Yes</selfCollide></gazebo>', "<self_collide>true</self_collide>"),
        ('<gazebo reference="a"><turnGravityOff value="TRUE"/></gazebo>', "<gravity>false</gravity>"),
        ('<gazebo reference="a"><laserRetro>3</laserRetro></gazebo>', "<laser_retro>3</laser_retro>"),
        (
            '<gazebo reference="a"><dampingFactor>0.1</dampingFactor></gazebo>',
            "<velocity_decay><linear>0.1</linear><angular>0.1</angular></velocity_decay>",
        ),
        (
            '<gazebo reference="a"><collision><surface><friction><ode><mu>7</mu></ode></friction></surface></collision></gazebo>',
            "<surface><friction><ode><mu>7</mu></ode></friction></surface>",
        ),
        (
            '<gazebo reference="a"><visual><material><diffuse>0 0 1 1</diffuse></material><cast_shadows>0</cast_shadows></visual></gazebo>',
            "<material><ambient>0 0 1 1</ambient><diffuse>0 0 1 1</diffuse></material><cast_shadows>0</cast_shadows>",
        ),
        ('<gazebo reference="j"><stopErp>0.3</stopErp></gazebo>', "<physics><ode><limit><erp>0.3</erp></limit></ode></physics>"),
        ('<gazebo reference="k"><springStiffness>3</springStiffness></gazebo>', "<spring_stiffness>3</spring_stiffness>"),
        (
            '<gazebo><plugin name="p" filename="libp.so"><gain>2</gain></plugin></gazebo>',
            '<plugin name="p" filename="libp.so"><gain>2</gain>',
        ),
    ],
)
def test_a_fragment_becomes_what_sdf_says(fragment: str, expected: str, tmp_path: Path) -> None:
    assert expected not in written("", tmp_path)
    assert expected in written(fragment, tmp_path)


@pytest.mark.parametrize("fragment", ["<mu2>much</mu2>", "<kp/>", "<mu1/>", "<dampingFactor>x</dampingFactor>", "<fdir1/>"])
def test_what_is_no_value_is_left_out(fragment: str, tmp_path: Path) -> None:
    assert written(f'<gazebo reference="a">{fragment}</gazebo>', tmp_path) == written("", tmp_path)


def test_fixed_joints_stay_whatever_a_fragment_asks_for(tmp_path: Path) -> None:
    fragment = '<gazebo reference="j"><preserveFixedJoint>false</preserveFixedJoint></gazebo>'
    assert '<joint name="j" type="fixed">' in written(fragment, tmp_path)
    assert "preserveFixedJoint" not in written(fragment, tmp_path)


def test_what_is_carried_brings_the_fragments_back(tmp_path: Path) -> None:
    text = ROBOT.format(
        '<gazebo reference="a"><mu1>0.5</mu1><kp>1e6</kp><sensor name="i" type="imu"/></gazebo><gazebo><plugin name="p"/></gazebo>'
    )
    (tmp_path / "r.urdf").write_text(text, "utf-8")
    hx.convert(str(tmp_path / "r.urdf"), str(tmp_path / "r.sdf"), keep="inside")
    hx.convert(str(tmp_path / "r.sdf"), str(tmp_path / "back.urdf"), keep="inside")
    assert hx.load(str(tmp_path / "back.urdf")).mechanism == hx.load(str(tmp_path / "r.urdf")).mechanism
