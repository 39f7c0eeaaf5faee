"""What <gazebo> fragments hold is no loss in the ledger, in both directions; what they do not hold is one."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles
from tests.sdf.samples import AXIS, INERTIAL, model
from tests.sdf.test_fragments_written import BOX, EVERYTHING

TWO = (
    f'<link name="a">{INERTIAL}<collision name="c">{BOX}<surface><contact><ode><kp>1</kp></ode></contact></surface></collision>'
    f'<collision name="d">{BOX}<surface><contact><ode><kp>2</kp></ode></contact></surface></collision></link>'
)
SPRING = (
    f'<link name="a">{INERTIAL}</link><link name="b">{INERTIAL}</link><joint name="j" type="continuous"><parent>a</parent><child>b</child>'
    f"{AXIS.format('<dynamics><spring_stiffness>3</spring_stiffness><spring_reference>0.2</spring_reference></dynamics>')}</joint>"
)
LINK = """<link name="{}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision name="c"><geometry><sphere radius="1"/></geometry></collision></link>"""
ROBOT = f"""<robot name="r">{LINK.format("a")}{LINK.format("b")}
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>{{}}</robot>"""
OBEYED = """<gazebo reference="a"><mu1>0.5</mu1><mu2 value="0.6"/><kp>1e6</kp><gravity>true</gravity><dampingFactor>0.1</dampingFactor>
<collision><max_contacts>4</max_contacts></collision>
<sensor name="eye" type="camera"><camera><clip><near>0.1</near><far>9</far></clip></camera></sensor>
<sensor name="imu" type="imu"><always_on>1</always_on></sensor></gazebo>
<gazebo reference="j"><springStiffness>3</springStiffness><springReference>0.2</springReference><stopErp>0.3</stopErp></gazebo>
<gazebo><plugin name="p" filename="libp.so"><gain>2</gain></plugin></gazebo>"""


def lost(text: str, source: str, target: str, folder: Path, *, kept: bool = False) -> list[tuple[str, str]]:
    """The elements and fields that a conversion of a text loses, or keeps."""
    (folder / f"r.{source}").write_text(text, "utf-8")
    losses = hx.convert(folder / f"r.{source}", folder / f"made.{target}").losses
    assert losses is not None
    return [(loss.element, loss.field) for loss in losses if (loss.fate == "kept") is kept]


KEPT = [("joint 'j'", "dofs[0].stiffness"), ("joint 'j'", "dofs[0].spring_ref")]


@pytest.mark.parametrize("target", ["urdf", "xacro"])
@pytest.mark.parametrize(
    ("text", "kept"),
    [(EVERYTHING, [("shape 'a/collision'", "friction"), ("loop 'l'", "")]), (model(SPRING), KEPT)],
    ids=["everything", "spring"],
)
def test_what_urdf_holds_in_fragments_is_kept_or_no_loss(text: str, kept: list[tuple[str, str]], target: str, tmp_path: Path) -> None:
    """Other programs lack loops, springs and friction; all else is for Gazebo alone."""
    assert lost(text, "sdf", target, tmp_path) == []
    assert sorted(lost(text, "sdf", target, tmp_path, kept=True)) == sorted(kept)


def test_what_urdf_holds_in_fragments_is_no_loss_of_a_robot_with_a_part_from_mjcf() -> None:
    """The robot has no one format that it is from; its elements of SDF are as they were."""
    hand = hx.loads('<mujoco><worldbody><body name="hand"><geom type="box" size="1 1 1"/></body></worldbody></mujoco>', "mjcf")
    robot = hx.loads(model(SPRING), "sdf").attach(hand, at="b", prefix="h_")
    losses = pipeline.convert(robot.mechanism, formats.URDF, Options(), NoFiles(), Report()).losses
    assert losses is not None
    assert [(loss.element, loss.field) for loss in losses if loss.fate == "kept"] == KEPT


def test_a_value_that_the_collisions_of_a_link_do_not_share_is_lost(tmp_path: Path) -> None:
    found = lost(model(TWO), "sdf", "urdf", tmp_path)
    assert found == [("shape 'a/collision#2'", "sdf content"), ("shape 'a/collision'", "sdf content")]


def test_what_is_left_in_the_fragments_of_an_edited_file_is_lost(tmp_path: Path) -> None:
    (tmp_path / "m.sdf").write_text(EVERYTHING, "utf-8")
    hx.convert(tmp_path / "m.sdf", tmp_path / "m.urdf")
    text = (tmp_path / "m.urdf").read_text("utf-8")
    edited = (
        text.replace("<kd>10</kd>", "<kd>11</kd>")
        .replace("<update_rate>100</update_rate>", "")
        .replace('type="revolute">\n      <pose', 'type="ball">\n      <pose')
    )
    assert text.count("<kd>10</kd>") == edited.count("<kd>11</kd>") == 1
    judge = _held(tmp_path / "m.sdf", edited)
    sensor = [("sensor 'imu'", ""), ("mount 'imu'", "")]
    assert sorted(judge) == sorted([("shape 'a/collision'", "sdf surface"), *sensor, ("loop 'l'", "")])


def _held(source: Path, edited: str) -> list[tuple[str, str]]:
    from hymeko_x.compare.ledger import losses_between
    from hymeko_x.formats import URDF

    losses = losses_between(hx.load(source).mechanism, hx.loads(edited, "urdf").mechanism, (), URDF)
    return [(loss.element, loss.field) for loss in losses if loss.fate != "kept"]


def test_fragments_that_sdf_obeys_are_no_loss(tmp_path: Path) -> None:
    assert lost(ROBOT.format(OBEYED), "urdf", "sdf", tmp_path) == lost(ROBOT.format(""), "urdf", "sdf", tmp_path)


@pytest.mark.parametrize(
    "fragment",
    [
        '<gazebo reference="a"><mu2>0.6</mu2><flavour>1</flavour></gazebo>',
        '<gazebo reference="b"><kp>much</kp></gazebo>',
        '<gazebo reference="nowhere"><kp>1</kp></gazebo>',
        "<gazebo><canonicalBody>a</canonicalBody></gazebo>",
    ],
)
def test_fragments_that_sdf_does_not_obey_are_lost(fragment: str, tmp_path: Path) -> None:
    assert ("mechanism", "urdf content") in lost(ROBOT.format(fragment), "urdf", "sdf", tmp_path)
