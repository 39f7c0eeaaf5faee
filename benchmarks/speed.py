"""URDF -> MJCF and MJCF -> URDF in process, against MuJoCo's own parse + compile + write of the same robot without meshes.

python -m benchmarks.speed [NAME ...]

Both run in turns, and every figure is a ratio of processor times. ``write`` is reading and writing alone, ``measured`` is all
that `convert` does: the ledger and the residue too. The bounds are on the medians over the robots. Robots that come as URDF go both
ways, and MuJoCo always gets the URDF; robots that come as MJCF have capsules, classes and joints of several dofs as well, and MuJoCo
gets the MJCF.
"""

from __future__ import annotations

import statistics
import sys
from typing import TYPE_CHECKING, NamedTuple

import mujoco
from lxml import etree

import hymeko_x as hx
from benchmarks.robots import robots
from benchmarks.yardstick import in_turns, verdict
from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.formats import Format


class Way(NamedTuple):
    """The format that robots come in, a direction, and how many times MuJoCo's time it may take to write, and to measure as well."""

    robots: Format
    own: Format
    target: Format
    every: int
    write: float
    measured: float | None

    @property
    def name(self) -> str:
        """What goes where."""
        return f"{self.own.name} -> {self.target.name} of {self.robots.name} robots"


WAYS = (
    Way(formats.URDF, formats.URDF, formats.MJCF, 3, 2.0, 4.0),
    Way(formats.URDF, formats.MJCF, formats.URDF, 3, 4.0, 4.0),
    Way(formats.MJCF, formats.MJCF, formats.URDF, 4, 4.0, None),
)


def main(names: tuple[str, ...]) -> int:
    """Both directions; the exit code is 1 when a bound is missed."""
    print(f"Python {sys.version}")
    kept = [_compare(way, names) for way in WAYS]
    return 0 if all(kept) else 1


def _compare(way: Way, names: tuple[str, ...]) -> bool:
    writes, measures = [], []
    paths = robots(way.robots.name, names)
    for path in paths if names else paths[:: way.every]:
        text = without_meshes(path)
        if text is None or not _mujoco_takes(text):
            print(f"{path.name}: MuJoCo does not take it without meshes")
            continue
        own = text if way.own is way.robots else hx.dumps(hx.loads(text, way.robots.name).mechanism, way.own.name)
        theirs, write, measured = in_turns(lambda: _mujoco(text), lambda: _write(own, way), lambda: _measure(own, way))  # noqa: B023
        writes.append(write / theirs)
        measures.append(measured / theirs)
        print(f"{theirs * 1e3:8.2f} ms, write {write / theirs:5.2f}, measured {measured / theirs:5.2f}  {path.name}", flush=True)
    if not writes:
        return True
    name = f"{way.name} / MuJoCo, median of {len(writes)}"
    written = verdict(f"{name}, reading and writing", statistics.median(writes), way.write, at_least=False)
    if way.measured is None:
        print(f"{name}, with ledger and residue: ratio {statistics.median(measures):.2f}")
        return written
    return verdict(f"{name}, with ledger and residue", statistics.median(measures), way.measured, at_least=False) and written


def without_meshes(path: Path) -> str | None:
    """The text of a URDF or MJCF file without its meshes and pictures and what uses them; None when it is of several files."""
    tree = etree.parse(str(path), etree.XMLParser(recover=True, remove_comments=True))
    root = tree.getroot()
    if root is None or root.find(".//include") is not None:
        return None
    _drop([mesh.getparent().getparent() for mesh in root.iterfind(".//geometry/mesh")])
    _drop([geom for geom in root.iter("geom") if geom.get("mesh") or geom.get("hfield")])
    _drop([*root.iterfind("asset/mesh"), *root.iterfind("asset/hfield"), *root.iterfind("asset/texture"), *root.iterfind("asset/skin")])
    for material in root.iterfind("asset/material"):
        material.attrib.pop("texture", None)
    return str(etree.tostring(root, encoding="unicode"))


def _drop(elements: list[etree._Element]) -> None:
    for element in elements:
        above = element.getparent()
        if above is not None:
            above.remove(element)


def _mujoco(text: str) -> str:
    spec = mujoco.MjSpec.from_string(text)
    spec.compile()
    return str(spec.to_xml())


def _mujoco_takes(text: str) -> bool:
    try:
        _mujoco(text)
    except (ValueError, mujoco.FatalError):
        return False
    return True


def _write(text: str, way: Way) -> object:
    robot = pipeline.read(Source("robot", text.encode(), NoFiles()), way.own, Report())
    return pipeline.write(robot, way.target, Options(), NoFiles(), Report())


def _measure(text: str, way: Way) -> object:
    robot = pipeline.read(Source("robot", text.encode(), NoFiles()), way.own, Report())
    return pipeline.convert(robot, way.target, Options(keep="beside"), NoFiles(), Report())


if __name__ == "__main__":
    sys.exit(main(tuple(sys.argv[1:])))
