"""URDF to USD against the other converters, each in its own environment: processor time of warm processes, in turns.

python -m benchmarks.usd [NAME ...]     (after `make peers`)

Without meshes: the development URDFs with every visual and collision that is a mesh taken out, for all alike. With meshes: a
few of them as they are, written as a crate, in which the fastest converter keeps its meshes too. The bound is on the median,
over the robots, of our time over that of the fastest converter: without meshes at most a half, with meshes at most a third.
Both are reading and writing alone. `convert` also reads its result back to measure what got lost, which no other converter
does; its time is printed in brackets.
"""

from __future__ import annotations

import gc
import re
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree

import hymeko_x as hx
from benchmarks.robots import robots
from benchmarks.yardstick import verdict
from hymeko_x import disk, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options
from peers import CONVERTERS, Peer

if TYPE_CHECKING:
    from collections.abc import Callable

ROUNDS = 3
WITH_MESHES = ("xarm7.urdf", "romeo.urdf", "anymal_c.urdf", "upkie.urdf", "racecar.urdf", "panda.urdf")


def main(names: tuple[str, ...]) -> int:
    """Both comparisons; the exit code is 1 when a bound is missed."""
    peers = [peer for peer in CONVERTERS["urdf"] if peer.is_installed()]
    if not peers:
        print("no other converter is installed: run `make peers` first", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        bare = [without_meshes(path, Path(folder)) for path in robots("urdf", names)]
        plain = _compare(bare, peers, Path(folder), meshes=False)
        full = _compare(robots("urdf", names or WITH_MESHES), peers, Path(folder), meshes=True)
    kept = verdict("URDF to USD without meshes, ours / fastest, median", plain, 0.5, at_least=False)
    return 0 if verdict("URDF to USD with meshes, ours / fastest, median", full, 1 / 3, at_least=False) and kept else 1


def without_meshes(path: Path, folder: Path) -> Path:
    """A copy of a URDF without the visuals and collisions that are meshes."""
    tree = etree.parse(str(path), etree.XMLParser(recover=True, remove_comments=True))
    for mesh in list(tree.iter("mesh")):
        shape = mesh.getparent().getparent()
        if shape is not None and shape.getparent() is not None:
            shape.getparent().remove(shape)
    copy = folder / f"{len(list(folder.glob('*.urdf'))):02d}_{path.name}"
    copy.write_bytes(etree.tostring(tree))
    return copy


def _compare(paths: list[Path], peers: list[Peer], folder: Path, *, meshes: bool) -> float:
    """The median ratio; each robot is converted by everybody before the next, so that a busy machine disturbs all alike."""
    ratios = []
    for path in paths:
        theirs: dict[str, float] = {}
        for peer in peers:
            job = {"source": str(path), "folder": str(folder / peer.name / path.stem), "meshes": meshes, "repeat": ROUNDS + 1}
            job["packages"] = _packages(path)
            answer = peer.run([job])[0]
            if "seconds" in answer:
                theirs[peer.name] = answer["seconds"]
        out = folder / f"{path.stem}.{'usdc' if meshes else 'usda'}"
        ours = _best(lambda: _converted(path, out))  # noqa: B023
        measured = _best(lambda: hx.convert(path, out))  # noqa: B023
        if not theirs:
            print(f"{path.name}: no other converter accepts it")
            continue
        fastest = min(theirs, key=lambda name: theirs[name])
        ratios.append(ours / theirs[fastest])
        print(f"{ours * 1e3:8.1f} ms ({measured * 1e3:8.1f} measured), {fastest} {theirs[fastest] * 1e3:8.1f} ms  {path.name}", flush=True)
    return statistics.median(ratios)


def _packages(path: Path) -> dict[str, str]:
    """Where the ROS packages are whose meshes a URDF names: who is not told finds none of them, and has nothing to convert."""
    files, found = DiskFiles(path.parent), {}
    for name, rest in re.findall(r"""package://([^/"']+)/([^"']+)""", path.read_text(errors="replace")):
        mesh = files.find(f"package://{name}/{rest}") if name not in found else None
        if mesh is not None:
            found[name] = mesh.removesuffix(f"/{rest}")
    return found


def _converted(path: Path, out: Path) -> None:
    """Read and write, without measuring."""
    files = DiskFiles(path.parent)
    place = pipeline.OutputPlace(str(out.parent))
    package = pipeline.write(hx.load(path).mechanism, formats.of_output(str(out)), Options(), files, Report(), place)
    disk.write_package(package, str(out), files)


def _best(work: Callable[[], object]) -> float:
    """The least processor time in s, after one run to warm up."""
    work()
    times = []
    for _ in range(ROUNDS):
        gc.collect()
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


if __name__ == "__main__":
    sys.exit(main(tuple(sys.argv[1:])))
