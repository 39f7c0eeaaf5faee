"""Killed before any single change of the disk, a run leaves the old output or the new one, whole: never a main file with other meshes."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from typing import Literal

import pytest
from msgspec import Struct

import hymeko_x as hx
from hymeko_x import disk, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.delivery import Delivery
from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options
from hymeko_x.source import Files, Package, PlacedFiles, Source
from tests.turns import cases

CHANGES = ("os.rename", "os.remove", "os.rmdir", "os.mkdir", "os.chmod", "os.link", "os.symlink", "os.truncate")
"""What Python announces before it changes the disk; files that are opened for writing come on top."""

URDF = """<robot name="r"><material name="m"><texture filename="t.png"/></material>
<link name="a"><inertial><mass value="{mass}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
<visual><geometry><mesh filename="a.obj"/></geometry><material name="m"/></visual>
<collision><geometry><mesh filename="sub/b.obj"/></geometry></collision></link>
<link name="b"><inertial><mass value="{mass}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
OBJ = "v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\n" + "v 9 9 9\n" * 70 + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
INLINE = (
    '<mujoco><asset><mesh name="m" vertex="0 0 0 {0} 0 0 0 {0} 0 0 0 {0}"/></asset><worldbody><body name="a">'
    '<inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>'
)
PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000c49444154789c63f8ff{0}0005fe02fea7c98d5e0000000049454e44ae426082"
    .replace("{0}", "ff3f")
)  # fmt: skip


class Way(Struct, frozen=True):
    """A source, and how it is written."""

    source: str
    target: str
    layout: Literal["layered"] | None = None
    split: bool = False


WAYS = {
    "urdf": Way("r.urdf", "o.urdf"),
    "urdf with points of its own": Way("m.xml", "o.urdf"),
    "xacro in two files": Way("r.urdf", "o.xacro", split=True),
    "mjcf": Way("r.urdf", "o.xml"),
    "mjcf from mjcf": Way("n.xml", "o.xml"),
    "usda": Way("r.urdf", "o.usda"),
    "usda in layers": Way("r.urdf", "o.usda", "layered"),
    "hymeko": Way("r.urdf", "o.hymeko"),
}


def lay_out(folder: Path, size: int) -> Path:
    """The same robot with another size is a robot with other masses, meshes and textures."""
    (folder / "sub").mkdir(parents=True)
    (folder / "r.urdf").write_text(URDF.format(mass=size))
    (folder / "m.xml").write_text(INLINE.format(size, mass=size))
    (folder / "n.xml").write_text(NATIVE.format(mass=size))
    (folder / "a.obj").write_text(OBJ.format(size))
    (folder / "sub/b.obj").write_text(OBJ.format(size / 2))
    (folder / "t.png").write_bytes(PIXEL + bytes([size]))
    return folder


NATIVE = (
    '<mujoco><compiler meshdir="sub"/><asset><mesh name="m" file="b.obj"/></asset><worldbody><body name="a">'
    '<inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>'
)


class Written(Struct, frozen=True):
    """What is to be written, and the same with its files below a folder."""

    package: Package
    within: Callable[[str], Package]
    files: DiskFiles


def written(way: Way, source: Path) -> Written:
    robot, files = hx.load(source / way.source).mechanism, DiskFiles(source)
    format = formats.of_output(way.target)
    options = Options(layout=way.layout, split=way.split, beside="o")
    place = pipeline.OutputPlace(assets="copy")
    delivery = Delivery(robot, format, options, files, place, path="")
    package = delivery.convert(Report()).package
    draws = len(package.files) + len(package.copies) + 1  # the names of what is staged
    below = delivery.below(f".{way.target}-{draws.to_bytes(6).hex()}.part/")
    return Written(package, lambda folder: below, files)


def tree(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def seen(main: Path) -> list[object]:
    """What is there for somebody who opens the main file: for any reader, and for ours, which heeds what the file carries."""
    source = disk.open_source(str(main))
    format = formats.of_output(main.name)
    return [_seen(read(source, format), source.files) for read in (_bare, _whole)]


def _bare(source: Source, format: formats.Format) -> Mechanism:
    return pipeline.reader(format)(source, Report()).mechanism


def _whole(source: Source, format: formats.Format) -> Mechanism:
    return pipeline.read(source, format, Report())


def _seen(robot: Mechanism, files: Files) -> tuple[object, ...]:
    """Masses, the points or the file of each mesh, the file of each texture."""
    files = PlacedFiles(robot.places, files)
    masses = [body.inertial.mass for _, body in robot.vertices(parts.Body) if body.inertial]
    meshes = [mesh.vertices or _content(mesh.uri, files) for _, mesh in robot.vertices(parts.Mesh)]
    return tuple(masses), tuple(meshes), tuple(_content(texture.uri, files) for _, texture in robot.vertices(parts.Texture))


def _content(uri: str | None, files: Files) -> bytes | None:
    place = files.find(uri or "")
    return files.read(place) if place else None


def killed(work: Callable[[], None], at: int) -> bool:
    """Do the work in a child that dies before its change of the disk with this number; whether it lived to its end."""
    child = os.fork()
    if not child:
        try:
            numbers = count()
            os.urandom = lambda size: next(numbers).to_bytes(size)  # names of temporary files that the parent knows
            sys.addaudithook(_killer(at))
            work()
            os._exit(0)
        finally:
            os._exit(1)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert code in (0, 9)
    return code == 0


def _killer(at: int) -> Callable[[str, tuple[object, ...]], None]:
    changes = count()

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        is_change = event in CHANGES or (
            event == "open" and isinstance(arguments[2], int) and bool(arguments[2] & (os.O_WRONLY | os.O_RDWR))
        )
        if is_change and next(changes) == at:
            os._exit(9)

    return hook


def fixed(folder: Path) -> tuple[tuple[str, bytes], ...]:
    """The files but for temporary siblings."""
    return tuple((name, data) for name, data in tree(folder).items() if not name.endswith(".part"))


def states(way: Way, folder: Path) -> Iterator[tuple[list[object], bool]]:
    """What is seen after a death at each change in turn, and whether it was the last one, to which the run lived."""
    old, new = (written(way, lay_out(folder / name, size)) for name, size in (("old", 1), ("new", 2)))
    (folder / "before").mkdir()
    disk.write_package(old.package, str(folder / "before" / way.target), old.files, old.within)
    known: dict[tuple[tuple[str, bytes], ...], list[object]] = {}
    for at in count():
        place = shutil.copytree(folder / "before", folder / f"out{at}")
        lived = killed(lambda place=place: disk.write_package(new.package, str(place / way.target), new.files, new.within), at)  # type: ignore[misc]
        files = fixed(place)
        known[files] = known.get(files) or seen(place / way.target)
        yield known[files], lived
        if lived:
            return


LATER = ("urdf with points of its own", "mjcf from mjcf", "usda", "hymeko", "xacro in two files", "usda in layers")
"""Ways whose deaths are like those of others: they have their turn in `make test-full`."""


@pytest.mark.parametrize("way", cases(WAYS, LATER))
def test_killed_before_any_change_the_output_is_the_old_one_or_the_new_one(way: Way, tmp_path: Path) -> None:
    found = list(states(way, tmp_path))
    old, new = found[0][0], found[-1][0]
    assert old != new
    assert [state for state, _ in found if state not in (old, new)] == []
    assert [state for state, _ in found].index(new) < len(found) - 3, "the new output is there before the run ends"


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_what_replaces_an_older_output_is_what_a_first_run_writes(way: Way, tmp_path: Path) -> None:
    old, new = (lay_out(tmp_path / name, size) for name, size in (("old", 1), ("new", 2)))
    over, fresh = tmp_path / "over", tmp_path / "fresh"
    over.mkdir()
    fresh.mkdir()
    for source, place in ((old, over), (new, over), (new, fresh)):
        hx.convert(source / way.source, place / way.target, layout=way.layout, assets="copy")
    assert tree(over) == tree(fresh)


@pytest.mark.full
def test_a_later_run_removes_what_a_killed_one_left_but_for_temporary_siblings(tmp_path: Path) -> None:
    way = WAYS["mjcf"]
    states_seen = len(list(states(way, tmp_path)))
    new = written(way, tmp_path / "new")
    left = [place for at in range(states_seen) for place in (tmp_path / f"out{at}").glob("*.part") if place.is_dir()]
    assert left, "no run was killed while a main file stood in"
    for folder in {place.parent for place in left}:
        disk.write_package(new.package, str(folder / way.target), new.files, new.within)
        assert [place for place in folder.glob("*.part") if place.is_dir()] == []
        assert seen(folder / way.target) == seen(tmp_path / f"out{states_seen - 1}" / way.target)
