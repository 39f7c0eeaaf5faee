"""Bodies without mass: 0 is what UsdPhysics takes for absent."""

from __future__ import annotations

from pathlib import Path

import hymeko_x as hx
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Body

INERTIAL = '<inertial><mass value="{}"/><inertia ixx=".5" iyy=".5" izz=".5" ixy="0" ixz="0" iyz="0"/></inertial>'
JOINT = '<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><axis xyz="0 0 1"/></joint>'


def test_a_body_with_a_tensor_that_nothing_gives_a_mass_has_none(tmp_path: Path) -> None:
    """urdfdom refuses an inertial without a mass, and with it the whole inertia of the link."""
    source, stage, back = (tmp_path / name for name in ("a.urdf", "a.usda", "b.urdf"))
    links = "".join(f'<link name="{name}">{INERTIAL.format(mass)}</link>' for name, mass in (("a", 1), ("b", 2), ("c", 0)))
    joints = JOINT.format("j", "continuous", "a", "b") + JOINT.format("k", "fixed", "b", "c")
    source.write_text(f'<robot name="r">{links}{joints}</robot>')
    hx.convert(source, stage)
    hx.convert(stage, back)
    tip = Id("body", "c")
    assert hx.load(back).mechanism.vertex(tip, Body).inertial == hx.load(source).mechanism.vertex(tip, Body).inertial
    assert hx.verify(stage, back, samples=2).is_same
    assert hx.verify(source, back, samples=2).is_same
