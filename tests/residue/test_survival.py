"""What is kept survives what other programs do to a file: the way home has everything that they did not touch."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import mujoco
import pytest
import yourdfpy
from lxml import etree
from pxr import Usd

import hymeko_x as hx
from hymeko_x.compare.diff import Tolerance
from hymeko_x.diagnostics import Report
from hymeko_x.ir.parts import Tendon
from tests.residue.samples import PLAIN_MJCF, URDF
from tests.residue.test_truth import GRIPPER

ARM = """<mujoco model="arm"><worldbody><body name="link"><joint name="j"/><geom size=".1"/><site name="flange" pos="0 0 1"/>
<body name="tip"><joint name="k"/><geom size=".1"/><site name="end"/></body></body></worldbody></mujoco>"""


CAPSULES = """<mujoco model="walker">
  <default><geom rgba="0.1 0.2 0.3 1" friction="0.7"/></default>
  <asset><material name="skin" rgba="0.123456789 0.2 0.3 1"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 1"/>
    <body name="torso" pos="0 0 1.2345678901">
      <freejoint/>
      <site name="chin" pos="0 0 0.1"/>
      <geom name="chest" type="capsule" fromto="0.1 0.2 0.3 0.4 0.5 0.7123456789" size="0.05" material="skin"/>
      <geom type="capsule" fromto="0 0 0 0 0.1 0" size="0.02" group="3"/>
      <body name="leg" pos="0 0 -0.3" euler="10 20 30">
        <joint name="hip" range="-40 50" armature="0.0123456789" damping="0.1"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.04"/>
        <site name="ankle" pos="0 0 -0.3"/>
      </body>
    </body>
  </worldbody>
  <tendon><spatial name="t"><site site="chin"/><site site="ankle"/></spatial></tendon>
  <actuator><position name="hip" joint="hip" kp="12"/></actuator>
</mujoco>"""


@pytest.mark.parametrize("keep", ["beside", "inside"])
@pytest.mark.parametrize("text", [GRIPPER, URDF], ids=["gripper", "arm"])
def test_mujoco_loads_and_saves(keep: str, text: str, tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(text)
    hx.convert(tmp_path / "a.urdf", tmp_path / "b.xml", keep=keep, base="fixed")  # type: ignore[arg-type]
    before = hx.load(tmp_path / "b.xml").mechanism
    spec = mujoco.MjSpec.from_file(str(tmp_path / "b.xml"))
    spec.compile()
    (tmp_path / "b.xml").write_text(spec.to_xml())
    report = Report()
    after = hx.load(tmp_path / "b.xml", report=report).mechanism
    assert "HX112" in [diagnostic.code.id for diagnostic in report]
    velocities = [[dof.limits.velocity for view in robot.joints.values() for dof in view.joint.dofs] for robot in (before, after)]
    assert velocities[0] == velocities[1]
    assert any(velocities[0])
    assert after.source.format == "urdf"


@pytest.mark.parametrize("prefixes", [("left_",), ("left_", "right_"), ('a"b ',)])
def test_mujoco_attaches_it_with_a_prefix(prefixes: tuple[str, ...], tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(GRIPPER)
    hx.convert(tmp_path / "a.urdf", tmp_path / "b.xml", keep="inside", base="fixed")
    arm = mujoco.MjSpec.from_string(ARM)
    for prefix, name in zip(prefixes, ("flange", "end"), strict=False):
        site = next(site for site in arm.sites if site.name == name)
        arm.attach(mujoco.MjSpec.from_file(str(tmp_path / "b.xml")), site=site, prefix=prefix)
    arm.compile()
    (tmp_path / "joined.xml").write_text(arm.to_xml())
    robot = hx.load(tmp_path / "joined.xml").mechanism
    found = {view.id.name: dof.limits.velocity for view in robot.joints.values() for dof in view.joint.dofs}
    assert {name: speed for name, speed in found.items() if speed} == {f"{prefix}close": 0.1 for prefix in prefixes}


def test_yourdfpy_writes_it_anew(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(PLAIN_MJCF)
    hx.convert(tmp_path / "a.xml", tmp_path / "b.urdf", keep="beside")
    urdf = yourdfpy.URDF.load(str(tmp_path / "b.urdf"), load_meshes=False, build_scene_graph=False)
    (tmp_path / "b.urdf").write_bytes(urdf.write_xml_string())
    source, home = hx.load(tmp_path / "a.xml").mechanism, hx.load(tmp_path / "b.urdf").mechanism
    missing = [found.element for found in hx.diff(source, home) if found.after is None and found.field == ""]
    assert {key.kind for key in missing} <= {"shape"}  # it makes a material of the colour of a shape
    assert any(home.edges(Tendon))


def written_by_urdfdom(text: str) -> str:
    """A URDF as urdfdom's `exportURDF` writes it (4.0.1): elements by their names, numbers with six digits, and only what urdfdom reads."""
    root = etree.fromstring(text.encode(), etree.XMLParser(remove_comments=True))
    for node in [node for node in root if node.tag not in ("link", "joint", "material")]:
        root.remove(node)
    root[:] = sorted(root, key=lambda node: (("material", "link", "joint").index(node.tag), node.get("name") or ""))
    for shape in (*root.iter("visual"), *root.iter("collision")):
        shape.attrib.pop("name", None)
    for material in [*root.iter("material")]:
        shape = material.getparent()
        if shape is not None and shape.tag == "collision":
            shape.remove(material)
        elif material.find("texture") is None:
            material.insert(0, etree.Element("texture"))
    for joint in root.iter("joint"):
        if joint.get("type") in ("fixed", "floating") and joint.find("axis") is None:
            etree.SubElement(joint, "axis", xyz="0 0 0")
    for node in root.iter():
        for name, value in node.attrib.items():
            with suppress(ValueError):
                node.set(name, " ".join(f"{float(word):g}" for word in value.split()))
    return etree.tostring(root, encoding="unicode")


@pytest.mark.unread("HX101")
def test_urdfdom_writes_it_anew(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(CAPSULES)
    hx.convert(tmp_path / "a.xml", tmp_path / "b.urdf", keep="beside")
    (tmp_path / "b.urdf").write_text(written_by_urdfdom((tmp_path / "b.urdf").read_text()))
    report = Report()
    source, home = hx.load(tmp_path / "a.xml").mechanism, hx.load(tmp_path / "b.urdf", report=report).mechanism
    found = [str(each) for each in hx.diff(source, home, Tolerance(1e-5, 1e-5)) if each.field != "name"]
    colour = "shape 'torso/collision' rgba: [0.1 0.2 0.3 1] -> none"
    axis = """joint 'torso' urdf content: added <axis xyz="0 0 0"/>"""
    texture = "material 'skin' urdf content: added <texture/>"
    assert found == [colour, texture, axis]  # it has no colours of collision shapes; every material gets a texture, every joint an axis
    assert [row.code.id for row in report] == ["HX112"]


@pytest.mark.parametrize("keep", ["beside", "inside"])
def test_usd_core_exports_it(keep: str, tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(URDF)
    hx.convert(tmp_path / "a.urdf", tmp_path / "b.usda", keep=keep)  # type: ignore[arg-type]
    before = hx.load(tmp_path / "b.usda").mechanism
    stage = Usd.Stage.Open(str(tmp_path / "b.usda"))
    assert stage.GetRootLayer().Export(str(tmp_path / "c.usda"))
    (tmp_path / "b.usda").write_bytes((tmp_path / "c.usda").read_bytes())
    assert hx.diff(before, hx.load(tmp_path / "b.usda").mechanism) == ()
