# ruff: noqa: E501 - files as they stand
"""What SDF alone represents goes into a URDF file as <gazebo> fragments, and comes back from them."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

import hymeko_x as hx
from tests.sdf.samples import AXIS, INERTIAL, model

BOX = "<geometry><box><size>1 1 1</size></box></geometry>"
SURFACE = (
    "<max_contacts>3</max_contacts><surface><friction><ode><mu>0.5</mu><mu2>0.6</mu2><fdir1>1 0 0</fdir1></ode></friction><contact><ode><kp>1e5</kp>"
    "<kd>10</kd><min_depth>0.001</min_depth><max_vel>0.1</max_vel></ode></contact></surface>"
)
EVERYTHING = model(
    '<plugin name="p" filename="libp.so"><gain>2</gain></plugin>'
    f'<link name="a">{INERTIAL}<visual name="visual">{BOX}<material><script><uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Red'
    f'</name></script></material></visual><collision name="collision">{BOX}{SURFACE}</collision><gravity>false</gravity><self_collide>true</self_collide>'
    '<enable_wind>true</enable_wind><sensor name="eye" type="camera"><pose>0 0 1 0 0 0</pose><camera><horizontal_fov>1.2</horizontal_fov><image>'
    "<width>640</width><height>480</height></image></camera></sensor>"
    '<sensor name="imu" type="imu"><update_rate>100</update_rate></sensor></link>'
    f'<link name="b">{INERTIAL}</link><link name="c">{INERTIAL}</link>'
    f'<joint name="j" type="continuous"><parent>a</parent><child>b</child>{AXIS.format("")}<physics><provide_feedback>true</provide_feedback><ode>'
    "<implicit_spring_damper>1</implicit_spring_damper><cfm_damping>1</cfm_damping><fudge_factor>0.5</fudge_factor></ode></physics>"
    '<sensor name="ft" type="force_torque"><update_rate>10</update_rate></sensor></joint>'
    '<joint name="k" type="fixed"><parent>b</parent><child>c</child></joint>'
    f'<joint name="l" type="revolute"><pose>0 0 1 0 0 0</pose><parent>a</parent><child>c</child>{AXIS.format("")}</joint>'
)


def _content(path: Path) -> list[str]:
    """Every element with text or attributes, with the names above it, in alphabetical order."""
    found = []
    stack = [("", ElementTree.parse(path).getroot())]
    while stack:
        above, node = stack.pop()
        name = f"{above}/{node.tag}{sorted(node.attrib.items())}"
        found.append(f"{name} {(node.text or '').strip()}")
        stack += [(name, child) for child in node if child.tag != "pose"]
    return sorted(found)


def _tags(path: Path) -> set[str]:
    return {node.tag for node in ElementTree.parse(path).iter()}


def test_links_joints_and_the_model_have_their_fragments(tmp_path: Path) -> None:
    (tmp_path / "m.sdf").write_text(EVERYTHING, "utf-8")
    hx.convert(tmp_path / "m.sdf", tmp_path / "m.urdf")
    root = ElementTree.parse(tmp_path / "m.urdf").getroot()
    found = {
        (fragment.get("reference"), child.tag, child.get("name") or (child.text or "").strip())
        for fragment in root.findall("gazebo")
        for child in fragment
    }
    link = {
        *(
            ("a", "mu1", "0.5"),
            ("a", "mu2", "0.6"),
            ("a", "fdir1", "1 0 0"),
            ("a", "kp", "1e5"),
            ("a", "kd", "10"),
            ("a", "minDepth", "0.001"),
        ),
        *(("a", "maxVel", "0.1"), ("a", "maxContacts", "3"), ("a", "material", "Gazebo/Red"), ("a", "gravity", "false")),
        *(("a", "selfCollide", "true"), ("a", "enable_wind", "true"), ("a", "sensor", "eye"), ("a", "sensor", "imu")),
    }
    joint = {("j", "provideFeedback", "true"), ("j", "implicitSpringDamper", "1"), ("j", "cfmDamping", "1"), ("j", "fudgeFactor", "0.5")}
    rest = {("j", "sensor", "ft"), ("k", "preserveFixedJoint", "true"), (None, "plugin", "p"), (None, "joint", "l")}
    assert found == link | joint | rest


def test_fragments_bring_it_back(tmp_path: Path) -> None:
    (tmp_path / "m.sdf").write_text(EVERYTHING, "utf-8")
    hx.convert(tmp_path / "m.sdf", tmp_path / "first.urdf")
    hx.convert(tmp_path / "first.urdf", tmp_path / "once.sdf")
    hx.convert(tmp_path / "once.sdf", tmp_path / "second.urdf")
    hx.convert(tmp_path / "second.urdf", tmp_path / "twice.sdf")
    assert _content(tmp_path / "twice.sdf") == _content(tmp_path / "once.sdf")
    assert _tags(tmp_path / "m.sdf") <= _tags(tmp_path / "once.sdf")
    pytest.importorskip("pydrake")
    assert hx.verify(tmp_path / "m.sdf", tmp_path / "twice.sdf", samples=5).is_same


def test_a_robot_of_another_format_has_none(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text(
        '<mujoco><worldbody><body name="a"><geom size="1" friction="0.4"/></body></worldbody></mujoco>', "utf-8"
    )
    hx.convert(tmp_path / "m.xml", tmp_path / "m.urdf")
    assert b"<gazebo" not in (tmp_path / "m.urdf").read_bytes()


@pytest.mark.parametrize("target", ["r.urdf", "r.xacro"])
def test_prefixes_that_the_root_of_sdf_declares_are_declared_in_fragments(target: str, tmp_path: Path) -> None:
    sensor = '<sensor name="eye" type="camera" my:test="1"><camera><clip my:test="2"><near>0.1</near><far>9</far></clip></camera></sensor>'
    (tmp_path / "r.sdf").write_text(
        f'<sdf version="1.9" xmlns:my="urn:my"><model name="r"><link name="a"><my:note>x</my:note>{sensor}</link></model></sdf>'
    )
    hx.convert(tmp_path / "r.sdf", tmp_path / target)
    (fragment,) = re.findall(r"<gazebo.*?</gazebo>", (tmp_path / target).read_text("utf-8"), re.DOTALL)
    assert fragment.startswith('<gazebo xmlns:my="urn:my" reference="a">')
    assert '<sensor name="eye" type="camera" my:test="1">' in fragment


def test_what_is_in_a_fragment_has_a_line_for_each_element_at_its_depth() -> None:
    urdf = hx.dumps(hx.loads(EVERYTHING, "sdf"), "urdf")
    assert '  <gazebo>\n    <plugin name="p" filename="libp.so">\n      <gain>2</gain>\n    </plugin>\n  </gazebo>\n' in urdf
    sdf = hx.dumps(hx.loads(urdf, "urdf"), "sdf")
    assert '    <plugin name="p" filename="libp.so">\n      <gain>2</gain>\n    </plugin>\n' in sdf
    imu = '<sensor name="imu" type="imu">\n        <update_rate>100</update_rate>\n      </sensor>\n'
    assert f"      {imu}" in sdf
    foreign = '<foo:bar xmlns:foo="urn:foo">\n        <a>1</a>\n      </foo:bar>'
    assert f"      {foreign}\n" in hx.dumps(hx.loads(model(f'<link name="a">{INERTIAL}{foreign}</link>'), "sdf"), "sdf")
