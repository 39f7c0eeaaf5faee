"""MuJoCo refuses OBJ files that have normals, but not for every corner: `check` names them, and a conversion writes one that loads."""

from __future__ import annotations

from contextlib import nullcontext
from typing import TYPE_CHECKING

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x.cli import main
from hymeko_x.meshes.normals import lacks_normals

if TYPE_CHECKING:
    from pathlib import Path

POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
NORMALS = "vn 0 0 -1\nvn 1 0 0\nvn 0 1 0\n"
REST = "f 1//2 2//2 4//2\nf 1//3 4//3 3//3\nf 2//3 3//3 4//3\n"
SECOND = "o second\nf 1 2 3\n"
CASES = {
    "none": POINTS + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    "all": POINTS + NORMALS + "f 1//1 3//1 2//-3\n" + REST,
    "numbers alone": POINTS + "f 1//1 3//1 2//1\n" + REST,
    "second object": POINTS + NORMALS + "f 1//1 3//1 2//1\n" + REST + SECOND,
    "one face": POINTS + NORMALS + "f 1 3 2\n" + REST,
    "one corner": POINTS + NORMALS + "f 1//1 3 2//1\n" + REST,
    "unused": POINTS + NORMALS + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    "beyond": POINTS + NORMALS + "f 1//4 3//1 2//1\n" + REST,
    "zero": POINTS + NORMALS + "f 1//0 3//1 2//1\n" + REST,
}
MODEL = '<mujoco><asset><mesh name="m" file="m.obj"/></asset><worldbody><body><geom type="mesh" mesh="m"/></body></worldbody></mujoco>'
ROBOT = '<robot name="r"><link name="b"><visual><geometry><mesh filename="m.obj"/></geometry></visual></link></robot>'


@pytest.mark.parametrize("case", CASES)
def test_files_are_known_that_mujoco_refuses(case: str) -> None:
    data = CASES[case].encode()
    with pytest.raises(ValueError, match="normal index") if lacks_normals(data) else nullcontext():
        mujoco.MjModel.from_xml_string(MODEL, {"m.obj": data})
    assert lacks_normals(data) == (case in ("one face", "one corner", "unused", "beyond", "zero"))


def test_the_mesh_of_a_robot_loads_without_its_normals(tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text(CASES["one face"], "utf-8")
    (tmp_path / "r.urdf").write_text(ROBOT, "utf-8")
    report = hx.convert(tmp_path / "r.urdf", tmp_path / "r.xml").report
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml")).mesh_facenum.tolist() == [4]
    assert [one.message for one in report if one.code.id == "HX202"] == [
        "mesh 'm' has normals, but not for every corner; MuJoCo reads all or none"
    ]


def test_check_names_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "m.obj").write_text(CASES["one face"], "utf-8")
    (tmp_path / "r.xml").write_text(MODEL, "utf-8")
    main(["check", str(tmp_path / "r.xml")])
    found = capsys.readouterr()
    messages = [line.partition("error[HX203]: ")[2] for line in (found.out + found.err).splitlines() if "HX203" in line]
    assert messages == ["the file 'm.obj' has normals, but not for every corner; MuJoCo reads all or none"]
