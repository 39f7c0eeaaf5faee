"""An update reads and converts each mesh once, however often it converts the original again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.memory import remembered, remembered_reader, remembering
from hymeko_x.meshes import reader

ROBOT = """<robot name="stand">
  <link name="foot">
    <visual><geometry><mesh filename="foot.ply"/></geometry></visual>
    <collision><geometry><mesh filename="foot.ply"/></geometry></collision>
    <inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
</robot>
"""
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
"""


@pytest.mark.unread("HX204")
def test_an_update_reads_a_mesh_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    original, there = tmp_path / "stand.urdf", tmp_path / "stand.xml"
    original.write_text(ROBOT)
    (tmp_path / "foot.ply").write_text(PLY)
    hx.convert(original, there)
    there.write_text(there.read_text().replace('mass="2"', 'mass="3"'))
    read: list[str] = []
    scene = reader.read_scene

    def counted(data: bytes, suffix: str, *args: Callable[[str], bytes], **options: bool) -> object:
        read.append(suffix)
        return scene(data, suffix, *args, **options)

    monkeypatch.setattr(reader, "read_scene", counted)
    assert [str(edit) for edit in hx.update(original, there).edits] == ["body 'foot' inertial.mass: 2 -> 3"]
    assert read == [".ply"]


def test_a_result_is_remembered_within_a_task_alone() -> None:
    calls: list[int] = []
    double = remembered(lambda number: calls.append(number) or 2 * number)
    with remembering():
        assert [double(1), double(1), double(2)] == [2, 2, 4]
    assert double(1) == 2
    assert calls == [1, 2, 1]


def test_a_file_is_read_again_where_what_it_refers_to_is_another() -> None:
    beside = {"colours": b"red"}

    def fetch(name: str) -> bytes:
        try:
            return beside[name]
        except KeyError as error:
            raise FileNotFoundError(name) from error

    read = remembered_reader(lambda data, _, fetch: (data, fetch("colours")))
    with remembering():
        assert read(b"mesh", ".obj", fetch) == (b"mesh", b"red")
        beside["colours"] = b"blue"
        assert read(b"mesh", ".obj", fetch) == (b"mesh", b"blue")
        del beside["colours"]
        with pytest.raises(FileNotFoundError):
            read(b"mesh", ".obj", fetch)
