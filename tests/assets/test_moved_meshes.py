"""Robots that leave for another format and another folder, and come home without the files of their source."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import mujoco
import numpy as np
import pytest
import trimesh

import hymeko_x as hx
from tests.meshes.test_mesh import dae

if TYPE_CHECKING:
    from pathlib import Path

TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.2 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
PLACED = """<mujoco><asset><mesh name="tet" file="tet.obj" scale="1 2 1" refpos="0.01 0.02 0.03" refquat="1 1 0 0"/></asset>
<worldbody><body><freejoint/><geom type="mesh" mesh="tet"/></body></worldbody></mujoco>"""


def sent_home(folder: Path, name: str, text: str, through: str) -> Path:
    """The source's format again, from another one, when the source's folder is gone; its files must be in ``folder`` / "home"."""
    home, away, back = (folder / part for part in ("home", "away", "back"))
    (home / name).write_text(text)
    for place in (away, back):
        place.mkdir()
    hx.convert(home / name, away / f"robot.{through}", keep="inside")
    home.rename(folder / "gone")
    hx.convert(away / f"robot.{through}", back / name)
    shutil.rmtree(away)
    return back / name


@pytest.mark.parametrize("through", ["urdf", "usda", "usdc"])
def test_the_place_of_a_mesh_in_its_frame_counts_once(through: str, tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "tet.obj").write_text(TETRAHEDRON)
    back = sent_home(tmp_path, "robot.xml", PLACED, through)
    before, after = (mujoco.MjModel.from_xml_path(str(path)) for path in (tmp_path / "gone" / "robot.xml", back))
    for name in ("body_mass", "body_ipos", "body_inertia"):
        assert getattr(after, name) == pytest.approx(getattr(before, name), rel=1e-6, abs=1e-7), name


URDF = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="a.dae"/></geometry></visual>
<collision><geometry><mesh filename="a.dae"/></geometry></collision></link></robot>"""


@pytest.mark.parametrize("through", ["xml", "usda"])
def test_a_converted_file_is_not_given_the_name_of_the_file_that_it_was_made_of(through: str, tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "a.dae").write_bytes(dae())
    back = sent_home(tmp_path, "robot.urdf", URDF, through)
    (mesh,) = [path for path in back.parent.rglob("*") if path.suffix in (".dae", ".obj")]
    assert mesh.suffix == ".obj"
    assert np.ptp(trimesh.load(mesh, force="mesh").vertices, axis=0).tolist() == [1.0, 1.0, 0.5]
    assert f'filename="{mesh.relative_to(back.parent)}"' in back.read_text()
    assert (hx.verify(tmp_path / "gone" / "robot.urdf", back)).is_same


@pytest.mark.parametrize("target", ["urdf", "sdf", "hymeko", "xml"])
def test_a_path_through_a_folder_that_holds_no_file_is_found_in_the_output(target: str, tmp_path: Path) -> None:
    for folder in ("home/assets", "home/meshes", "away"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "home" / "meshes" / "tet.obj").write_text(TETRAHEDRON)
    (tmp_path / "home" / "r.xml").write_text(PLACED.replace("tet.obj", "assets/../meshes/tet.obj").replace(' refpos="0.01 0.02 0.03"', ""))
    hx.convert(tmp_path / "home" / "r.xml", tmp_path / "away" / f"r.{target}", assets="copy")
    (tmp_path / "home").rename(tmp_path / "gone")
    (mesh,) = [part.uri for _, part in hx.load(tmp_path / "away" / f"r.{target}").mechanism.assets()]
    assert mesh is not None
    assert (tmp_path / "away" / mesh).is_file()
