"""<gazebo> elements of URDF in the words of older programs: prefixes, noise of an IMU, elements that SDF does not have."""

from __future__ import annotations

from pathlib import Path

import pytest
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.rewrite import legalize
from tests.pace import assert_at_most

ROBOT = """<robot name="r"{}><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>{}</robot>"""
MANAGER = '<gazebo><controller:manager name="m"><rate>100</rate></controller:manager></gazebo>'
IMU = """<gazebo reference="b"><sensor name="imu" type="imu"><imu>
<noise><type>gaussian</type><rate><mean>0.0</mean><stddev>2e-4</stddev></rate><accel><stddev>1.7e-2</stddev></accel></noise></imu></sensor></gazebo>"""


def sdf(text: str) -> str:
    return hx.dumps(hx.loads(text, "urdf"), "sdf")


def test_a_prefix_is_declared_as_the_source_declares_it() -> None:
    text = sdf(ROBOT.format(' xmlns:controller="http://example.org/controller"', MANAGER))
    assert '<controller:manager xmlns:controller="http://example.org/controller" name="m">' in text
    assert len(hx.loads(text, "sdf").mechanism.graph.vertices) == 1


def test_an_undeclared_prefix_is_reported_and_left_out() -> None:
    robot = hx.loads(ROBOT.format(' xmlns:controller="http://example.org/controller"', MANAGER), "urdf").mechanism
    extras = tuple(extra for extra in robot.extras[ROOT] if not extra.path.startswith("@xmlns"))
    report = Report()
    text = hx.dumps(replace(robot, extras={ROOT: extras}), "sdf", report=report)
    assert "controller" not in text
    assert "does not declare the prefix 'controller'" in "\n".join(map(str, report))


def test_a_link_of_a_fragment_does_not_take_the_name_of_one_of_the_robot() -> None:
    text = sdf(ROBOT.format("", '<gazebo><link name="b"/><link name="c"/></gazebo>'))
    assert (text.count('<link name="b"'), text.count('<link name="c"')) == (1, 1)


def test_what_fragments_add_stands_behind_what_sdf_has_itself() -> None:
    """It stood before the pose and the inertial, and in the opposite order."""
    inside = '<gravity>false</gravity><selfCollide>true</selfCollide><sensor name="s" type="imu"/>'
    text = sdf(ROBOT.format("", f'<gazebo reference="b">{inside}</gazebo><gazebo><plugin name="p" filename="f"/></gazebo>'))
    order = ["</inertial>", "<gravity>", "<self_collide>", "<sensor", "</link>", "<plugin"]
    assert sorted(order, key=text.index) == order


def test_elements_of_older_programs_are_no_children_of_a_model() -> None:
    assert "canonicalBody" not in sdf(ROBOT.format("", "<gazebo><canonicalBody>b</canonicalBody><static>true</static></gazebo>"))


@pytest.mark.filterwarnings("ignore")
def test_the_noise_of_an_imu_is_that_of_each_axis(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROBOT.format("", IMU))
    hx.convert(tmp_path / "r.urdf", tmp_path / "r.sdf")
    text = "".join((tmp_path / "r.sdf").read_text().split())
    assert text.count('<noisetype="gaussian"><mean>0.0</mean><stddev>2e-4</stddev></noise>') == 3
    assert text.count('<noisetype="gaussian"><stddev>1.7e-2</stddev></noise>') == 3
    assert "<angular_velocity><x>" in text
    assert "<linear_acceleration><x>" in text
    assert hx.verify(tmp_path / "r.urdf", tmp_path / "r.sdf").verdict == "same"


@pytest.mark.full
@pytest.mark.parametrize(
    "fragment", ['<gazebo><plugin name="{0}" filename="p.so"/></gazebo>', IMU.replace('name="imu"', 'name="{0}"')], ids=["model", "link"]
)
def test_ten_times_as_many_fragments_take_about_ten_times_as_long(fragment: str) -> None:
    few, many = (hx.loads(ROBOT.format("", "".join(fragment.format(n) for n in range(count))), "urdf").mechanism for count in (300, 3000))
    assert_at_most(2.0, lambda: legalize(many, "sdf", Report()), lambda: legalize(few, "sdf", Report()), 10)
