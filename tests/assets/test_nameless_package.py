"""``package:///part.stl``, as onshape-to-robot writes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import trimesh

import hymeko_x as hx
from hymeko_x.cli import main

if TYPE_CHECKING:
    from pathlib import Path

URDF = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="package:///part.stl"/></geometry></visual>
<collision><geometry><mesh filename="package:///part.stl"/></geometry></collision></link></robot>"""


def robot(folder: Path) -> Path:
    """A robot whose mesh is in no package."""
    folder.mkdir()
    (folder / "robot.urdf").write_text(URDF)
    return folder / "robot.urdf"


@pytest.mark.parametrize("target", ["urdf", "xml", "usda"])
def test_its_meshes_arrive(target: str, tmp_path: Path) -> None:
    source = robot(tmp_path / "home")
    trimesh.creation.box((0.1, 0.2, 0.3)).export(tmp_path / "home" / "part.stl")
    (tmp_path / "away").mkdir()
    result = hx.convert(source, tmp_path / "away" / f"robot.{target}")
    assert [diagnostic for diagnostic in result.report if diagnostic.code.id.startswith("HX2")] == []
    verdict = hx.verify(source, tmp_path / "away" / f"robot.{target}")
    assert (verdict.is_same, [note for note in verdict.not_compared if "mesh" in note]) == (True, [])


def test_the_hint_works_when_it_is_followed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = robot(tmp_path / "home")
    (tmp_path / "parts").mkdir()
    trimesh.creation.box((0.1, 0.2, 0.3)).export(tmp_path / "parts" / "part.stl")
    assert main(["convert", str(source), str(tmp_path / "robot.xml")]) == 0
    assert "--package =DIR adds one" in capsys.readouterr().err
    assert main(["convert", str(source), str(tmp_path / "robot.xml"), "--package", f"={tmp_path / 'parts'}"]) == 0
    assert "HX201" not in capsys.readouterr().err
    assert (tmp_path / "meshes" / "part.stl").read_bytes() == (tmp_path / "parts" / "part.stl").read_bytes()
