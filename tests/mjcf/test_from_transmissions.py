"""Transmissions of ROS and joints of ros2_control as actuators of MuJoCo, UsdPhysics and Gazebo, and back."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x.cli import main

ROOT = Path(__file__).parents[2]
INERTIA = '<inertia ixx="0.03" iyy="0.03" izz="0.002" ixy="0" ixz="0" iyz="0"/>'
LINK = f'<inertial><origin xyz="0 0 0.2"/><mass value="2"/>{INERTIA}</inertial>'


def transmission(joint: str, interface: str, reduction: str = "", kind: str = "transmission_interface/SimpleTransmission") -> str:
    """A transmission of one joint; ``interface`` may have several names."""
    names = "".join(f"<hardwareInterface>{name}</hardwareInterface>" for name in interface.split())
    reduced = f"<mechanicalReduction>{reduction}</mechanicalReduction>" if reduction else ""
    ends = f'<joint name="{joint}">{names}</joint><actuator name="{joint}_motor">{reduced}</actuator>'
    return f'<transmission name="{joint}_trans"><type>{kind}</type>{ends}</transmission>'


def arm(*parts: str, mimic: str = "") -> str:
    """Two joints in a chain, both limited to 2 rad, 3 rad/s and 60 Nm."""
    limit = '<limit lower="-1" upper="2" effort="60" velocity="3"/>'
    joints = "".join(
        f'<joint name="{name}" type="revolute"><parent link="{above}"/><child link="{below}"/><axis xyz="0 1 0"/>{limit}{more}</joint>'
        for name, above, below, more in (("j", "a", "b", ""), ("k", "b", "c", mimic))
    )
    return f'<robot name="r"><link name="a"/><link name="b">{LINK}</link><link name="c">{LINK}</link>{joints}{"".join(parts)}</robot>'


def model_of(text: str, folder: Path, **options: str) -> mujoco.MjModel:
    (folder / "r.urdf").write_text(text, "utf-8")
    hx.convert(folder / "r.urdf", folder / "r.xml", base="fixed", **options)  # type: ignore[arg-type]
    return mujoco.MjModel.from_xml_path(str(folder / "r.xml"))


def drives(model: mujoco.MjModel) -> dict[str, tuple[str, float, list[float]]]:
    """What each actuator is, its gear, and the range of its command."""
    found = {}
    for i in range(model.nu):
        _, stiffness, damping = model.actuator_biasprm[i, :3]
        kind = "position" if stiffness else "velocity" if damping else "motor"
        found[model.actuator(i).name] = (kind, model.actuator_gear[i, 0], [round(x, 12) for x in model.actuator_ctrlrange[i]])
    return found


@pytest.mark.parametrize(
    ("interface", "reduction", "expected"),
    [
        ("hardware_interface/PositionJointInterface", "", ("position", 1.0, [-1.0, 2.0])),
        ("hardware_interface/PositionJointInterface", "50", ("position", 50.0, [-50.0, 100.0])),
        ("PositionJointInterface", "-50", ("position", -50.0, [-100.0, 50.0])),
        ("hardware_interface/VelocityJointInterface", "10", ("velocity", 10.0, [-30.0, 30.0])),
        ("hardware_interface/EffortJointInterface", "20", ("motor", 20.0, [-3.0, 3.0])),
        ("JointStateInterface hardware_interface/VelocityJointInterface EffortJointInterface", "", ("velocity", 1.0, [-3.0, 3.0])),
        ("", "20", ("motor", 20.0, [-3.0, 3.0])),
    ],
)
def test_a_hardware_interface_is_an_actuator_with_the_reduction_as_gear(
    interface: str, reduction: str, expected: tuple[str, float, list[float]], tmp_path: Path
) -> None:
    model = model_of(arm(transmission("j", interface, reduction)), tmp_path)
    assert drives(model) == {"j_motor": expected}
    assert list(model.jnt_actfrcrange[model.joint("j").id]) == [-60.0, 60.0]


def test_a_geared_servo_holds_its_joint_as_one_without_a_gear_does(tmp_path: Path) -> None:
    angles = []
    for reduction in ("", "50"):
        model = model_of(arm(transmission("j", "PositionJointInterface", reduction)), tmp_path)
        data = mujoco.MjData(model)
        data.ctrl[0] = 0.5 * model.actuator_gear[0, 0]
        mujoco.mj_step(model, data, 1000)
        angles.append(data.joint("j").qpos[0])
    assert angles[0] == pytest.approx(angles[1], abs=1e-3)
    assert angles[0] == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize(
    "text",
    [
        arm(transmission("j", "hardware_interface/JointStateInterface")),
        arm(transmission("k", "PositionJointInterface"), mimic='<mimic joint="j"/>'),
        arm(transmission("j", "PositionJointInterface").replace("</joint>", '</joint><joint name="k"/>')),
    ],
    ids=["a state is no command", "a follower is driven by its leader", "a differential"],
)
def test_other_transmissions_are_no_actuators(text: str, tmp_path: Path) -> None:
    assert drives(model_of(text, tmp_path)) == {}


def differential(kind: str, interface: str) -> str:
    """Two motors with the reductions 10 and -5 that move `j` with the reduction 2 and `k` with the reduction 4."""
    ends = [
        f'<{tag} name="{name}"><role>{tag}{number}</role><mechanicalReduction>{reduction}</mechanicalReduction>{more}</{tag}>'
        for tag, number, name, reduction, more in (
            ("actuator", 1, "left", 10, ""),
            ("actuator", 2, "right", -5, ""),
            ("joint", 1, "j", 2, f"<hardwareInterface>{interface}</hardwareInterface>"),
            ("joint", 2, "k", 4, f"<offset>0.5</offset><hardwareInterface>{interface}</hardwareInterface>"),
        )
    ]
    return f'<transmission name="wrist"><type>transmission_interface/{kind}</type>{"".join(ends)}</transmission>'


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("DifferentialTransmission", (2 * (10 * 0.25 - 5 * -0.5), 4 * (10 * 0.25 + 5 * -0.5))),
        ("FourBarLinkageTransmission", (2 * 10 * 0.25 - 5 * -0.5, 4 * -5 * -0.5)),
    ],
)
def test_two_motors_of_two_joints_act_on_combinations_of_them(kind: str, expected: tuple[float, float], tmp_path: Path) -> None:
    """The torques are those of which the work is that of the motors, whose positions ros_control computes from the joints."""
    model = model_of(arm(differential(kind, "EffortJointInterface")), tmp_path)
    data = mujoco.MjData(model)
    data.actuator("left").ctrl, data.actuator("right").ctrl = 0.25, -0.5
    mujoco.mj_forward(model, data)
    torques = [data.joint(name).qfrc_actuator[0] for name in "jk"]
    assert torques == pytest.approx(expected)


def test_servos_of_a_differential_hold_both_joints(tmp_path: Path) -> None:
    model = model_of(arm(differential("DifferentialTransmission", "PositionJointInterface")), tmp_path)
    data = mujoco.MjData(model)
    wanted = (0.5, -0.25)
    data.actuator("left").ctrl = 10 * (2 * wanted[0] + 4 * wanted[1])
    data.actuator("right").ctrl = -5 * (2 * wanted[0] - 4 * wanted[1])
    mujoco.mj_step(model, data, 2000)
    assert [data.joint(name).qpos[0] for name in "jk"] == pytest.approx(wanted, abs=0.02)
    assert [round(x) for x in model.actuator("left").ctrlrange] == [10 * (-2 - 4), 10 * (4 + 8)]


def test_a_differential_comes_back_from_mjcf(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "r.urdf").write_text(arm(differential("DifferentialTransmission", "EffortJointInterface")), "utf-8")
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.xml", keep="beside")
    hx.convert(tmp_path / "r.xml", tmp_path / "back.urdf")
    assert main(["diff", str(tmp_path / "r.urdf"), str(tmp_path / "back.urdf")]) == 0
    assert "differ" not in capsys.readouterr().out


def test_actuators_that_the_user_asks_for_stand_in_for_transmissions(tmp_path: Path) -> None:
    text = arm(transmission("j", "PositionJointInterface", "50"))
    assert {kind for kind, *_ in drives(model_of(text, tmp_path, actuators="motor")).values()} == {"motor"}
    assert drives(model_of(text, tmp_path, actuators="none")) == {}


CONTROL = """<ros2_control name="s" type="system"><hardware><plugin>p/P</plugin></hardware>
<joint name="j"><command_interface name="position"><param name="min">-0.5</param><param name="max">0.5</param></command_interface>
<command_interface name="velocity"/><state_interface name="position"/></joint>
<joint name="k"><command_interface name="effort"/></joint>
<transmission name="t"><plugin>transmission_interface/SimpleTransmission</plugin><actuator name="m" role="actuator1"/>
<joint name="k" role="joint1"><mechanical_reduction>20.0</mechanical_reduction></joint></transmission></ros2_control>"""


def test_the_first_command_of_ros2_control_counts_with_its_own_range_before_older_transmissions(tmp_path: Path) -> None:
    model = model_of(arm(transmission("j", "EffortJointInterface"), CONTROL), tmp_path)
    assert drives(model) == {"j": ("position", 1.0, [-0.5, 0.5]), "m": ("motor", 20.0, [-3.0, 3.0])}


def test_the_way_back_has_the_transmissions_as_they_were(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = arm(transmission("j", "PositionJointInterface", "50"), transmission("k", "EffortJointInterface"), CONTROL)
    (tmp_path / "r.urdf").write_text(text, "utf-8")
    for target in ("r.xml", "r.usda"):
        hx.convert(tmp_path / "r.urdf", tmp_path / target, keep="beside")
        hx.convert(tmp_path / target, tmp_path / "back.urdf")
        assert main(["diff", str(tmp_path / "r.urdf"), str(tmp_path / "back.urdf")]) == 0
    assert "differ" not in capsys.readouterr().out


def test_servos_are_drives_of_usd_and_plugins_of_gazebo(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(
        arm(transmission("j", "PositionJointInterface"), transmission("k", "EffortJointInterface", "20")), "utf-8"
    )
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.usda")
    assert (tmp_path / "r.usda").read_text("utf-8").count("drive:angular:physics:stiffness") == 1
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.sdf", target="gazebo")
    plugins = (tmp_path / "r.sdf").read_text("utf-8")
    assert ("JointPositionController" in plugins, "ApplyJointForce" in plugins) == (True, True)


def test_update_leaves_transmissions_as_they_are_where_gains_were_edited(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, edited = tmp_path / "r.urdf", tmp_path / "r.xml"
    path.write_text(arm(transmission("j", "PositionJointInterface")), "utf-8")
    hx.convert(path, edited)
    text = edited.read_text("utf-8")
    edited.write_text(text.replace('kp="', 'kp="1'), "utf-8")
    before = path.read_text("utf-8")
    assert main(["update", str(path), str(edited)]) == 0
    assert path.read_text("utf-8") == before
    assert "the edit did not arrive: actuator 'j_motor' parameters.kp" in capsys.readouterr().err


def test_the_verifier_finds_the_actuators_of_transmissions_in_the_text(tmp_path: Path) -> None:
    text = (ROOT / "corpus/robots/transmission.hymeko").read_text()
    (tmp_path / "a.hymeko").write_text(text)
    hx.convert(tmp_path / "a.hymeko", tmp_path / "a.xml")
    found = hx.verify(tmp_path / "a.hymeko", tmp_path / "a.xml", samples=3)
    assert found.verdict == "same as far as mjcf can say"
    assert "actuators" in [check.quantity for check in found.checks]
    (tmp_path / "a.xml").write_text((tmp_path / "a.xml").read_text().replace("lift_motor", "lost_motor"))
    assert hx.verify(tmp_path / "a.hymeko", tmp_path / "a.xml", samples=3).verdict == "different"
