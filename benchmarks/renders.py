"""The bar of pictures: a robot fills its picture, and its conversion into every other format has the same one.

    python benchmarks/renders.py                      # every tenth development robot of the catalogue
    python benchmarks/renders.py --every 1 -o renders.json --pictures DIR
    python benchmarks/renders.py robot.urdf ...
    python benchmarks/renders.py -o renders.json --resume      # go on where a run ended

One line for each robot: how much of the picture it fills, and by target the part of the pixels that differ. Each robot has a process of
its own.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from hymeko_x import api, formats
from hymeko_x.assets.pack import is_of_package
from hymeko_x.corpus import cache, catalog
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.draw.files import grid, png
from hymeko_x.draw.pair import compared
from hymeko_x.draw.render import PictureOptions, Studio, choose_backend, is_drawn, open_studio
from hymeko_x.rewrite.context import Context
from hymeko_x.rewrite.roots import leave_scenery_out
from hymeko_x.robot import Robot
from hymeko_x.source import Files, ManyFiles

SIZE = (480, 360)
FILLED = (0.3, 0.8)
"""The part of the width or height of the picture, whichever is larger, that a robot takes."""
CHANGED = 0.005
"""The part of the pixels that may differ after a conversion."""
_DARK = 40
"""A picture whose robot is nowhere brighter than this is black."""
_CRASHED = "exit"
"""How the reason begins when a robot ended its process."""
_SECONDS = 300.0
"""The time that a robot has, unless the command line gives another."""

WITHOUT_TENDONS = frozenset({"urdf", "xacro", "sdf"})
"""The formats that have no tendons. MuJoCo draws those along a path: both pictures are drawn without them, and the rest is compared."""
KNOWN: dict[str, str | tuple[str, ...]] = {
    "manipulate_block": "",  # an image with all six sides of a cube; other formats show all of it on each side
    "manipulate_egg": "",  # the same
    "soccer_ball": "",  # a cube of six images; other formats have their mean colour
    "tests/assets/constraints": "sdf",  # loops that start open: a joint of SDF holds two links as they start, so that they start closed
}
"""Faults that are known: a part of the path of robots, and the beginnings of the formats in which they differ."""


class Drawn(msgspec.Struct):
    """One robot: the part of the picture that it fills, its brightest pixel, and by target the part that differs, or why there is none.

    ``seconds``: how long all of this took.
    """

    path: str
    filled: float = 0.0
    brightest: int = 0
    reason: str = ""
    changed: dict[str, float] = {}
    failed: dict[str, str] = {}
    seconds: float = 0.0

    @property
    def faults(self) -> list[str]:
        """In what the robot misses the bar."""
        if self.reason:
            return [self.reason] if self.reason.startswith(_CRASHED) else []
        found = [f"fills {self.filled:.2f}"] if not FILLED[0] <= self.filled <= FILLED[1] else []
        found += ["is black"] if self.brightest < _DARK else []
        found += [f"{target} differs by {100.0 * part:.2f} %" for target, part in self.changed.items() if part >= CHANGED]
        return found + [f"{target} has no picture, {reason}" for target, reason in self.failed.items()]


def unknown(found: Drawn) -> list[str]:
    """The faults of a robot that are not known."""
    known = [targets for part, targets in KNOWN.items() if part in found.path]
    return [fault for fault in found.faults if not any(fault.startswith(targets) for targets in known)]


class _Packages(NamedTuple):
    """The files of packages around a robot, which stay where they are; others go along with a conversion."""

    files: Files

    def find(self, uri: str) -> str | None:
        """The path of a file of a package."""
        return self.files.find(uri) if is_of_package(uri) else None

    def read(self, path: str) -> bytes:
        """The content of such a path. Raises: OSError."""
        return self.files.read(path)


def drawn(path: str, pictures: Path | None = None, targets: tuple[formats.Format, ...] = formats.FORMATS) -> Drawn:
    """The robot in a file, and its conversions into every other one of these formats, by one camera."""
    row = formats.of_input(path, Path(path).read_bytes())
    wanted = PictureOptions(SIZE, is_authored=True)
    try:
        robot = api.load(path, lenient=True)
        studio = open_studio(robot, path if is_drawn(row) else None, wanted)
        before = dict.fromkeys((True, False), studio.still())
        if studio.model.ntendon:
            before[False] = studio.still(tendons=False)
        covered = studio.covered()
    except Refusal as refusal:
        return Drawn(path, reason=f"{refusal.diagnostic.code.id}: {refusal.diagnostic.message}"[:200])
    robot = Robot(leave_scenery_out(robot.mechanism, Context(Report())), robot.files)  # URDF makes boxes of floors
    rows, columns = np.flatnonzero(covered.any(axis=1)), np.flatnonzero(covered.any(axis=0))
    filled = max(np.ptp(rows) / SIZE[1], np.ptp(columns) / SIZE[0]) if covered.any() else 0.0
    found = Drawn(path, float(filled), int(before[True][covered].max(initial=0)), changed={}, failed={})
    for target in targets:
        if target.backend is None or target.frontend is None or (target is row and not is_drawn(row)):
            continue
        try:
            tendons = target.name not in WITHOUT_TENDONS
            pair = compared(before[tendons], _converted(robot, target, wanted, studio).still(tendons=tendons))
        except Refusal as refusal:
            found.failed[target.name] = f"{refusal.diagnostic.code.id}: {refusal.diagnostic.message}"[:200]
            continue
        found.changed[target.name] = pair.changed
        if pictures is not None and pair.changed >= CHANGED:
            name = f"{Path(path).parent.name}-{Path(path).stem}-{target.name}.png"
            (pictures / name).write_bytes(png(grid([pair.before, pair.after, pair.difference])))
    return found


def _converted(robot: Robot, target: formats.Format, wanted: PictureOptions, studio: Studio) -> Studio:
    """A robot as its conversion into a format has it, read from that file alone."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"robot{target.suffixes[0]}"
        api.dump(robot, file, target.name, assets=None if target.holds_files else "copy", lenient=True)
        again = api.load(file, target.name, lenient=True)
        again = Robot(again.mechanism, ManyFiles((again.files, _Packages(robot.files))))
        return open_studio(again, str(file) if is_drawn(target) else None, wanted, studio)


def apart(path: str, pictures: Path | None, seconds: float = _SECONDS) -> Drawn:
    """As :func:`drawn`, in a process of its own, which may crash."""
    start = time.monotonic()
    words = [sys.executable, __file__, "--one", path, *(["--pictures", str(pictures)] if pictures else [])]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return Drawn(path, reason=f"took more than {seconds:.0f} s")
    if done.returncode:
        return Drawn(path, reason=f"{_CRASHED} {done.returncode}: {done.stderr.strip()[-200:]}")
    found = msgspec.json.decode(done.stdout.splitlines()[-1], type=Drawn)
    found.seconds = round(time.monotonic() - start, 1)
    return found


def development_robots(every: int) -> list[str]:
    """The development files of the catalogue that are here, each n-th."""
    root = cache.cache_root(os.environ)
    files = [file for row in formats.FORMATS for file in catalog.development_files(row.name)]
    return [str(cache.package_path(file.package, root) / file.path) for file in files if cache.is_fetched(file.package, root)][::every]


def line(found: Drawn) -> str:
    """A robot in one line."""
    if found.reason:
        return f"  {'FAIL' if found.faults else '--  '} {found.path}: {found.reason}"
    parts = " ".join(f"{target} {100.0 * part:.2f}" for target, part in found.changed.items())
    failed = "".join(f"; {target}: {reason}" for target, reason in found.failed.items())
    mark = "FAIL" if unknown(found) else "know" if found.faults else "ok  "
    return f"  {mark} {found.path}: fills {found.filled:.2f}, differs by % {parts}{failed}"


def run(robots: list[str], chosen: argparse.Namespace) -> list[Drawn]:
    """All robots, one after the other, with a line for each. The output is whole after each of them, so that a run can go on from there."""
    kept: dict[str, Drawn] = {}
    if chosen.resume and chosen.output.exists():
        kept = {one.path: one for one in msgspec.json.decode(chosen.output.read_bytes(), type=list[Drawn])}
    for path in robots:
        if path not in kept or kept[path].reason:
            kept[path] = apart(path, chosen.pictures, chosen.seconds)
        print(line(kept[path]), flush=True)
        if chosen.output:
            chosen.output.write_text(json.dumps([msgspec.to_builtins(one) for one in kept.values()], indent=1) + "\n")
    return [kept[path] for path in robots]


def main() -> int:
    """Draw them all; exit 1 when one misses the bar."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", help="robots (default: development robots of the catalogue)")
    parser.add_argument("--every", type=int, default=10, metavar="N", help="each n-th of them (default 10)")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="put the pictures of what differs here")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="the numbers as JSON")
    parser.add_argument("--resume", action="store_true", help="keep the numbers of robots that the output has")
    parser.add_argument("--seconds", type=float, default=_SECONDS, metavar="S", help=f"the time of a robot (default {_SECONDS:.0f})")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.resume and not chosen.output:
        parser.error("--resume goes on with the numbers of an output: give -o FILE.json")
    choose_backend()
    if chosen.pictures:
        chosen.pictures.mkdir(parents=True, exist_ok=True)
    if chosen.one:
        print(msgspec.json.encode(drawn(chosen.one, chosen.pictures)).decode())
        return 0
    results = run(chosen.files or development_robots(chosen.every), chosen)
    made = [found for found in results if not found.reason]
    faulty = [found for found in results if unknown(found)]
    known = sum(bool(found.faults) for found in results) - len(faulty)
    print(f"{len(results)} robots, {len(made)} drawn, {len(faulty)} with a fault that is not known, {known} with one that is known")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
