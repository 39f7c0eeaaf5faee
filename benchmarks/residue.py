"""Reading a file back with its residue, against the conversion that wrote it: URDF to MJCF and MJCF to URDF, meshes left where they are.

python -m benchmarks.residue
"""

from __future__ import annotations

import statistics
import sys
from typing import TYPE_CHECKING

from benchmarks.robots import robots
from benchmarks.yardstick import best_of, verdict
from hymeko_x import formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options
from hymeko_x.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.formats import Format

REFERENCE = pipeline.OutputPlace(assets="reference")


def main() -> int:
    """Convert every fourth robot and read the result, in turns; the bound is on the median ratio."""
    ratios = []
    for own, target in ((formats.URDF, formats.MJCF), (formats.MJCF, formats.URDF)):
        for path in robots(own.name)[::4]:
            ratio = _ratio(path, own, target)
            ratios.append(ratio)
            print(f"{ratio:6.2f}  {own.name} -> {target.name}  {path.name}")
    return 0 if verdict("reading back with residue / conversion, median", statistics.median(ratios), 1.0, at_least=False) else 1


def _ratio(path: Path, own: Format, target: Format) -> float:
    files = DiskFiles(path.parent)
    source = Source(path.name, path.read_bytes(), files)

    def convert() -> bytes:
        robot = pipeline.read(source, own, Report())
        return pipeline.convert(robot, target, Options(keep="inside"), files, Report(), REFERENCE).package.main

    text = convert()
    back, there = best_of(lambda: pipeline.read(Source("back", text, files), target, Report()), convert, 2)
    return back / there


if __name__ == "__main__":
    sys.exit(main())
