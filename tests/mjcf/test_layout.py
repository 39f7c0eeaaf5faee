"""The layout of MJCF for robots from elsewhere: what is written once, and what is left out."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx

SHELVES = """<robot name="r"><link name="a"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>{}</link><link name="b">{}</link>
<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>"""
SHELL = '<visual><geometry><mesh filename="{}.obj"/></geometry></visual>'


@pytest.mark.parametrize(("count", "folder"), [(2, ""), (3, 'meshdir="meshes"')])
def test_the_folder_of_three_files_is_named_once(count: int, folder: str, tmp_path: Path) -> None:
    for number in range(count):
        (tmp_path / f"m{number}.obj").write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 {number + 1}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    (tmp_path / "r.urdf").write_text(SHELVES.format("".join(SHELL.format(f"m{number}") for number in range(count)), ""))
    (tmp_path / "out").mkdir()
    hx.convert(tmp_path / "r.urdf", tmp_path / "out" / "r.xml", base="fixed")
    text = (tmp_path / "out" / "r.xml").read_text()
    assert ('file="m0.obj"' if folder else 'file="meshes/m0.obj"') in text
    assert folder in text
    assert ("meshdir" in text) == bool(folder)
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "r.xml")).nmesh == count


@pytest.mark.parametrize(("inner", "is_massless"), [("", False), ('<visual><geometry><sphere radius="0.1"/></geometry></visual>', True)])
def test_geoms_are_without_mass_where_a_body_has_nothing_else_to_weigh(inner: str, is_massless: bool) -> None:
    ball = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
    text = hx.dumps(hx.loads(SHELVES.format(ball, inner), "urdf"), "mjcf")
    assert ('<geom density="0"/>' in text) == is_massless
    assert ('<body name="b"/>' in text) != is_massless
    assert mujoco.MjModel.from_xml_string(text).body("b").mass[0] == 0.0
