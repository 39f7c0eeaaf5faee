"""What is kept survives what other programs do to a file: the way home has everything that they did not touch."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
import yourdfpy
from pxr import Usd

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.ir.parts import Tendon
from tests.residue.samples import PLAIN_MJCF, URDF
from tests.residue.test_truth import GRIPPER

ARM = """<mujoco model="arm"><worldbody><body name="link"><joint name="j"/><geom size=".1"/><site name="flange" pos="0 0 1"/>
<body name="tip"><joint name="k"/><geom size=".1"/><site name="end"/></body></body></worldbody></mujoco>"""


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
    assert "HX112" in [said.code.id for said in report]
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


@pytest.mark.parametrize("keep", ["beside", "inside"])
def test_usd_core_exports_it(keep: str, tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(URDF)
    hx.convert(tmp_path / "a.urdf", tmp_path / "b.usda", keep=keep)  # type: ignore[arg-type]
    before = hx.load(tmp_path / "b.usda").mechanism
    stage = Usd.Stage.Open(str(tmp_path / "b.usda"))
    assert stage.GetRootLayer().Export(str(tmp_path / "c.usda"))
    (tmp_path / "b.usda").write_bytes((tmp_path / "c.usda").read_bytes())
    assert hx.diff(before, hx.load(tmp_path / "b.usda").mechanism) == ()
