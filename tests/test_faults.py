"""Disks that fill up, folders that vanish, runs that are killed or meet each other: old output or new output, never half of one."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from hymeko_x import codes, disk, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Package, Source
from tests.pace import skip_if_recorded

SIZE = 300_000


def package(letter: str, within: str = "") -> Package:
    """A main file, whose first line is the folder of its three assets, all of one letter."""
    data = letter.encode() * SIZE
    return Package(f"{within}\n".encode() + data, {f"{within}meshes/{name}.obj": data for name in ("a", "b", "c")})


def contents(folder: Path) -> dict[str, str]:
    """The letters in the main file and in the assets that it refers to."""
    within, _, letters = (folder / "robot.xml").read_bytes().partition(b"\n")
    found = {"robot.xml": letters}
    found |= {f"meshes/{name}.obj": (folder / within.decode() / f"meshes/{name}.obj").read_bytes() for name in ("a", "b", "c")}
    return {name: "".join(sorted({chr(byte) for byte in data})) if len(data) == SIZE else "half" for name, data in found.items()}


def leftovers(folder: Path) -> list[Path]:
    return list(folder.rglob("*.part"))


def in_child(work: Callable[[], None]) -> int:
    """Fork, do the work there, and return the child's process id."""
    child = os.fork()
    if child:
        return child
    try:
        work()
        os._exit(0)
    finally:  # whatever happened, nothing of the parent may run here
        os._exit(1)


def exit_code(child: int) -> int:
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def write(folder: Path, letter: str) -> None:
    disk.write_package(package(letter), str(folder / "robot.xml"), NoFiles(), lambda within: package(letter, within))


def test_killed_at_any_moment_the_output_is_the_old_one_or_the_new_one_whole(tmp_path: Path) -> None:
    skip_if_recorded()
    write(tmp_path, "o")
    chance = random.Random(0)
    seen: set[str] = set()
    tries = 0
    while tries < 30 or (len(seen) < 2 and tries < 500):
        tries += 1
        child = in_child(lambda: [write(tmp_path, letter) for letter in "nonono" * 50] and None)
        time.sleep(chance.uniform(0.0, 0.05 if tries <= 30 else 0.5))  # a slow machine needs more than 0.05 s to begin
        os.kill(child, signal.SIGKILL)
        assert exit_code(child) == -signal.SIGKILL
        found = contents(tmp_path)
        assert set(found.values()) in ({"n"}, {"o"})
        seen.add(found["robot.xml"])
    assert seen == {"n", "o"}
    temporary = sorted(place for place in leftovers(tmp_path) if not place.is_dir())  # the folders stood in, and go
    write(tmp_path, "x")
    assert set(contents(tmp_path).values()) == {"x"}
    assert sorted(leftovers(tmp_path)) == temporary


def test_runs_that_write_the_same_output_do_not_mix(tmp_path: Path) -> None:
    children = [in_child(lambda letter=letter: [write(tmp_path, letter) for _ in range(15)] and None) for letter in "abcd"]  # type: ignore[misc]
    assert [exit_code(child) for child in children] == [0] * 4
    assert len(set(contents(tmp_path).values())) == 1
    assert leftovers(tmp_path) == []


@pytest.mark.parametrize("room", [0, SIZE // 2])
def test_a_full_disk_leaves_the_old_output_and_nothing_else(room: int, tmp_path: Path) -> None:
    write(tmp_path, "o")

    def fill() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
        try:
            write(tmp_path, "n")
        except Refusal as refusal:
            os._exit(7 if refusal.diagnostic.code == codes.CANNOT_WRITE else 8)

    assert exit_code(in_child(fill)) == 7
    assert set(contents(tmp_path).values()) == {"o"}
    assert leftovers(tmp_path) == []


@pytest.mark.skipif(sys.platform != "linux", reason="/sys is read-only, even for root, on Linux only")
def test_a_folder_that_may_not_be_written_is_a_diagnostic() -> None:
    with pytest.raises(Refusal) as refusal:
        disk.write_package(Package(b"x"), "/sys/robot.xml", NoFiles())
    assert refusal.value.diagnostic.code == codes.CANNOT_WRITE


def test_an_output_folder_that_vanishes_while_writing_is_a_diagnostic(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    right = disk._stage

    def stage(final: Path, data: bytes) -> tuple[Path, Path]:
        staged = right(final, data)
        if final.name == "robot.xml":
            shutil.rmtree(folder)
        return staged

    monkeypatch.setattr(disk, "_stage", stage)
    with pytest.raises(Refusal) as refusal:
        write(folder, "n")
    assert refusal.value.diagnostic.code == codes.CANNOT_WRITE


class Vanishing(DiskFiles):
    """Files that are there when somebody looks for them, and gone when somebody reads them."""

    def read(self, path: str) -> bytes:
        raise FileNotFoundError(2, "No such file or directory", path)


SOURCES = {
    "urdf": '<robot name="r"><material name="m"><texture filename="t.png"/></material><link name="a"><visual><geometry>'
    '<mesh filename="a.stl"/></geometry><material name="m"/></visual></link></robot>',
    "mjcf": "<mujoco><asset><mesh name='a' file='a.stl'/><texture name='t' type='2d' file='t.png'/></asset>"
    "<worldbody><body><geom type='mesh' mesh='a'/></body></worldbody></mujoco>",
    "usd": '#usda 1.0\n(\n    subLayers = [@b.usda@]\n)\ndef Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {}\n',
    "xacro": '<robot name="r" xmlns:xacro="x"><xacro:include filename="b.xacro"/><link name="a"/></robot>',
    "hymeko": 'r import "b.hymeko" as b\na : link { visual { mesh "a.stl" } }',
}


@pytest.mark.parametrize("target", ["urdf", "mjcf", "usd", "hymeko", "xacro"])
@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.unread("HX201", "HX302")
def test_files_that_vanish_between_finding_and_reading_are_a_diagnostic(source: str, target: str, tmp_path: Path) -> None:
    for name in ("a.stl", "t.png", "b.usda", "b.xacro", "b.hymeko"):
        (tmp_path / name).write_bytes(b"x")
    code = _code_of(source, target, tmp_path)
    assert code in (None, "HX001", "HX002", "HX040", "HX053", "HX201", "HX302")
    assert (tmp_path / f"out.{target}").exists() == (code is None)
    assert leftovers(tmp_path) == []


def _code_of(source: str, target: str, folder: Path) -> str | None:
    """The code with which a conversion is refused, or None."""
    files = Vanishing(folder)
    try:
        robot = pipeline.read(Source(f"{folder}/r.{source}", SOURCES[source].encode(), files), formats.by_name(source), Report())
        result = pipeline.convert(robot, formats.by_name(target), Options(), files, Report())
        disk.write_package(result.package, str(folder / f"out.{target}"), files)
    except Refusal as refusal:
        return refusal.diagnostic.code.id
    return None
