"""Output that is there whole or not at all, and input that cannot be read."""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from pathlib import Path

import pytest

from hymeko_x import codes, disk
from hymeko_x.diagnostics import Refusal
from hymeko_x.source import NoFiles, Package


class Shelf:
    """Files in a dictionary."""

    def __init__(self, files: Mapping[str, bytes]) -> None:
        self.files = files
        self.was_read: list[str] = []

    def find(self, uri: str) -> str | None:
        return uri if uri in self.files else None

    def read(self, path: str) -> bytes:
        if path not in self.files:
            raise FileNotFoundError(2, "No such file or directory", path)
        self.was_read.append(path)
        return self.files[path]


def tree(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def refusal_of(package: Package, path: Path | str, files: Shelf | NoFiles | None = None) -> str:
    with pytest.raises(Refusal) as refusal:
        disk.write_package(package, str(path), files or NoFiles())
    assert refusal.value.diagnostic.code == codes.CANNOT_WRITE
    return refusal.value.diagnostic.message


# ---- writing -------------------------------------------------------------------------------------------------------------


def test_main_file_new_files_and_copies_arrive_together(tmp_path: Path) -> None:
    package = Package(b"<robot/>", {"meshes/new.obj": b"new"}, {"meshes/a/old.stl": "/source/old.stl"})
    disk.write_package(package, str(tmp_path / "robot.urdf"), Shelf({"/source/old.stl": b"old"}))
    assert tree(tmp_path) == {"meshes/a/old.stl": b"old", "meshes/new.obj": b"new", "robot.urdf": b"<robot/>"}


def test_a_failure_leaves_old_files_as_they_were_and_nothing_new(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_bytes(b"before")
    package = Package(b"after", {"meshes/new.obj": b"new"}, {"meshes/gone.stl": "/source/gone.stl"})
    assert refusal_of(package, tmp_path / "robot.urdf", Shelf({})) == "cannot be written: No such file or directory"
    assert tree(tmp_path) == {"robot.urdf": b"before"}
    assert not (tmp_path / "meshes").exists()


def test_an_output_folder_that_does_not_exist_is_not_made_up(tmp_path: Path) -> None:
    for package in (Package(b"x"), Package(b"x", {"a.obj": b"y"})):
        assert refusal_of(package, tmp_path / "typo/robot.urdf") == f"cannot be written: there is no folder '{tmp_path / 'typo'}'"
    assert list(tmp_path.iterdir()) == []


def test_a_folder_is_not_replaced_by_a_file(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").mkdir()
    assert "is a folder" in refusal_of(Package(b"x"), tmp_path / "robot.urdf")


@pytest.mark.parametrize("name", ["../out.obj", "/tmp/out.obj", "a/../../out.obj", "a\\..\\out.obj"])
def test_an_asset_cannot_leave_the_output_folder(name: str, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    assert "leads out of the output folder" in refusal_of(Package(b"x", {name: b"y"}), tmp_path / "out/robot.urdf")
    assert tree(tmp_path) == {}


def test_a_mesh_that_already_is_where_it_belongs_is_not_touched(tmp_path: Path) -> None:
    mesh = tmp_path / "arm.stl"
    mesh.write_bytes(b"mesh")
    before = mesh.stat().st_ino
    disk.write_package(Package(b"x", {}, {"arm.stl": str(mesh)}), str(tmp_path / "robot.urdf"), NoFiles())
    assert mesh.stat().st_ino == before


def test_a_new_file_has_the_permissions_that_the_user_asks_for_and_an_old_one_keeps_its_own(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        disk.write_package(Package(b"x"), str(tmp_path / "new.urdf"), NoFiles())
    finally:
        os.umask(before)
    (tmp_path / "old.urdf").write_bytes(b"")
    (tmp_path / "old.urdf").chmod(0o604)
    disk.write_package(Package(b"x"), str(tmp_path / "old.urdf"), NoFiles())
    assert [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("new.urdf", "old.urdf")] == [0o640, 0o604]


def test_a_link_is_written_through_and_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "real/robot.urdf").write_bytes(b"before")
    (tmp_path / "link.urdf").symlink_to(tmp_path / "real/robot.urdf")
    disk.write_package(Package(b"after"), str(tmp_path / "link.urdf"), NoFiles())
    assert (tmp_path / "link.urdf").is_symlink()
    assert (tmp_path / "real/robot.urdf").read_bytes() == b"after"


def test_a_pipe_is_written_into_and_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    try:
        disk.write_package(Package(b"through"), str(tmp_path / "pipe"), NoFiles())
        assert os.read(reader, 100) == b"through"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_only_what_may_stand_in_the_way_is_read_and_compared(tmp_path: Path) -> None:
    files = Shelf({"/source/a.stl": b"mesh a", "/source/b.stl": b"mesh b"})
    package = Package(b"x", {}, {"a.stl": "/source/a.stl", "b.stl": "/source/b.stl"})

    def found() -> tuple[str | None, list[str]]:
        files.was_read.clear()
        return disk.in_the_way(package, str(tmp_path / "robot.urdf"), "robot/", files), list(files.was_read)

    assert found() == (None, [])
    (tmp_path / "b.stl").write_bytes(b"other mesh")
    assert found() == ("b.stl", ["/source/b.stl"])
    (tmp_path / "b.stl").write_bytes(b"mesh b")
    assert found() == (None, ["/source/b.stl"])
    (tmp_path / "b.stl").write_bytes(b"other mesh")
    (tmp_path / "robot.urdf").write_bytes(b"before")
    assert found() == (None, [])
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot/b.stl").write_bytes(b"mesh b")
    assert found() == ("b.stl", ["/source/b.stl"])


# ---- reading -------------------------------------------------------------------------------------------------------------


def test_a_file_is_read_with_the_files_around_it(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_bytes(b"<robot/>")
    (tmp_path / "arm.stl").write_bytes(b"mesh")
    source = disk.open_source(str(tmp_path / "robot.urdf"))
    assert source.data == b"<robot/>"
    assert source.files.find("arm.stl") == str(tmp_path / "arm.stl")


def test_what_cannot_be_read_is_refused_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_bytes(b"<robot/>")
    (tmp_path / "inside").mkdir()
    (tmp_path / "inside/link.urdf").symlink_to(tmp_path / "robot.urdf")
    cases = {
        tmp_path / "gone.urdf": "cannot be read: No such file or directory",
        tmp_path: "this is a folder, and a file was expected",
        tmp_path / "inside/link.urdf": f"the file is outside '{tmp_path / 'inside'}', to which reading is confined",
        tmp_path / "a\0b": "cannot be read: embedded null byte",
    }
    for path, message in cases.items():
        with pytest.raises(Refusal) as refusal:
            disk.open_source(str(path), confine=tmp_path / "inside" if path.name == "link.urdf" else None)
        assert refusal.value.diagnostic.message == message
        assert refusal.value.diagnostic.code == codes.CANNOT_READ


def test_a_file_above_the_limit_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk, "MOST_BYTES", 4)
    (tmp_path / "robot.urdf").write_bytes(b"<robot/>")
    with pytest.raises(Refusal, match="the file has 8 bytes; at most 4 are read") as refusal:
        disk.open_source(str(tmp_path / "robot.urdf"))
    assert refusal.value.diagnostic.code == codes.TOO_LARGE
