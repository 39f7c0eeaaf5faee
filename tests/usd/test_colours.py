"""Colours of mesh files in a stage: what a COLLADA file shows in several colours is one mesh with a subset for each."""

from __future__ import annotations

from pathlib import Path

from pxr import Usd, UsdShade

import hymeko_x as hx
from tests.meshes.test_mesh import dae

URDF = """<robot name="r"><link name="a">
<visual name="shell"><geometry><mesh filename="a.dae" scale="2 2 2"/></geometry>
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material></visual>
{collision}</link></robot>"""
COLLISION = '<collision><geometry><mesh filename="a.dae" scale="2 2 2"/></geometry></collision>'


def converted(folder: Path, data: bytes, collision: str = COLLISION) -> Usd.Stage:
    (folder / "a.dae").write_bytes(data)
    (folder / "r.urdf").write_text(URDF.format(collision=collision))
    hx.convert(folder / "r.urdf", folder / "r.usdc", keep="inside")
    return Usd.Stage.Open(str(folder / "r.usdc"))


def shown(stage: Usd.Stage) -> list[tuple[int, tuple[float, ...] | None]]:
    """How many triangles each mesh or subset that is drawn has, and in which colour."""
    found = []
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        if prim.GetTypeName() == "Mesh" and prim.GetAttribute("purpose").Get() != "guide":
            parts = [part.GetPrim() for part in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()]
            found += [(len(part.GetAttribute("indices").Get()), colour_of(part)) for part in parts]
            if not parts:
                found.append((len(prim.GetAttribute("faceVertexCounts").Get()), colour_of(prim)))
    return found


def colour_of(prim: Usd.Prim) -> tuple[float, ...] | None:
    material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
    surface = material.ComputeSurfaceSource()[0] if material else None
    colour = surface.GetInput("diffuseColor").Get() if surface else None
    return None if colour is None else tuple(colour)


def test_each_colour_of_a_collada_file_is_a_subset_with_that_material(tmp_path: Path) -> None:
    stage = converted(tmp_path, dae())
    assert [len(prim.GetAttribute("faceVertexCounts").Get()) for prim in stage.Traverse() if prim.GetTypeName() == "Mesh"] == [6, 6]
    assert shown(stage) == [(2, (1.0, 0.0, 0.0)), (2, (0.0, 1.0, 0.0)), (2, (0.0, 0.0, 1.0))]


def test_a_file_without_colours_is_shown_in_the_colour_of_its_shape(tmp_path: Path) -> None:
    assert shown(converted(tmp_path, dae(materials=0))) == [(6, (0.5, 0.5, 0.5))]


def test_the_robot_comes_back_with_the_one_visual_that_it_had(tmp_path: Path) -> None:
    for collision in (COLLISION, ""):
        converted(tmp_path, dae(), collision)
        hx.convert(tmp_path / "r.usdc", tmp_path / "back.urdf", keep="inside")
        assert hx.diff(hx.load(tmp_path / "r.urdf").mechanism, hx.load(tmp_path / "back.urdf").mechanism) == ()
        assert hx.verify(tmp_path / "r.urdf", tmp_path / "r.usdc").is_same


def test_the_colours_reach_mjcf_too(tmp_path: Path) -> None:
    converted(tmp_path, dae())
    hx.convert(tmp_path / "r.usdc", tmp_path / "r.xml")
    text = (tmp_path / "r.xml").read_text()
    assert all(f'rgba="{colour} 1"' in text for colour in ("1 0 0", "0 1 0", "0 0 1"))
