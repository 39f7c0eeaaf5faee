"""Meshes of robots from elsewhere are called after their files, and after what they are for where two files are called alike."""

from __future__ import annotations

import re
from pathlib import Path

import trimesh

import hymeko_x as hx


def _robot(folder: Path, *shapes: tuple[str, str, float]) -> str:
    """The MJCF of a body with shapes: the tag, the file and the size of the box in it."""
    tags = ""
    for tag, file, size in shapes:
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        trimesh.creation.box((size, size, size)).export(path)
        tags += f'<{tag}><geometry><mesh filename="{file}"/></geometry></{tag}>'
    (folder / "r.urdf").write_text(f'<robot name="r"><link name="hand">{tags}</link></robot>')
    hx.convert(folder / "r.urdf", folder / "out" / "r.xml", to_format="mjcf")
    return (folder / "out" / "r.xml").read_text()


def _meshes(text: str) -> list[tuple[str, ...]]:
    return re.findall(r'<mesh name="([^"]*)" file="([^"]*)"', text)


def test_a_second_file_of_one_name_is_called_after_what_it_is_for(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    text = _robot(tmp_path, ("visual", "seen/hand.stl", 0.1), ("collision", "felt/hand.stl", 0.2))
    assert [name for name, _ in _meshes(text)] == ["hand", "hand_collision"]
    assert '<geom class="collision" type="mesh" mesh="hand_collision"/>' in text


def test_a_number_is_the_last_resort(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    text = _robot(tmp_path, ("visual", "a/hand.stl", 0.1), ("visual", "b/hand.stl", 0.2), ("visual", "c/hand.stl", 0.3))
    assert [name for name, _ in _meshes(text)] == ["hand", "hand_visual", "hand_2"]


def test_equal_files_of_two_names_are_two_files(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    text = _robot(tmp_path, ("visual", "left_knee.stl", 0.1), ("visual", "right_knee.stl", 0.1))
    assert _meshes(text) == [("left_knee", "meshes/left_knee.stl"), ("right_knee", "meshes/right_knee.stl")]
