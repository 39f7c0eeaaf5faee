"""SDF -> URDF and URDF -> SDF against URDF -> URDF of the same robot, in processor time.

python -m benchmarks.sdf [NAME ...]

All three run in turns. ``write`` is reading and writing alone, ``measured`` is all that `convert` does, with the ledger. The bound is on
the medians over the robots.
"""

from __future__ import annotations

import statistics
import sys
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.robots import robots
from benchmarks.yardstick import least_in_turns, verdict
from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source

if TYPE_CHECKING:
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism

BOUND = 1.3
EVERY = 5
"""Every so many robots are measured, unless they are named."""
ANYWAY = Options(lenient=True)
HERE = pipeline.OutputPlace(assets="reference")
WAYS = ((formats.SDF, formats.URDF), (formats.URDF, formats.SDF))


def main(names: tuple[str, ...]) -> int:
    """Every robot in both directions; the exit code is 1 when a bound is missed."""
    paths = robots("urdf", names)
    rows = [_ratios(path.name, path.read_bytes()) for path in (paths if names else paths[::EVERY])]
    kept = []
    for (own, target), column in zip(WAYS, range(2), strict=True):
        for step, place in (("reading and writing", column), ("with the ledger", column + 2)):
            name = f"{own.name} -> {target.name} / urdf -> urdf, median of {len(rows)}, {step}"
            kept.append(verdict(name, statistics.median(row[place] for row in rows), BOUND, at_least=False))
    return 0 if all(kept) else 1


def _ratios(name: str, urdf: bytes) -> tuple[float, ...]:
    """The ratios of both ways without and with the ledger."""
    sdf = pipeline.write(_read(urdf, formats.URDF), formats.SDF, ANYWAY, NoFiles(), Report(), HERE).main
    found: list[float] = []
    for work in (_write, _measure):
        texts = {formats.URDF.name: urdf, formats.SDF.name: sdf}
        runs = [partial(work, texts[own.name], own, target) for own, target in ((formats.URDF, formats.URDF), *WAYS)]
        usual, *others = least_in_turns(*runs)
        found += [other / usual for other in others]
    print(f"write {found[0]:5.2f} {found[1]:5.2f}, measured {found[2]:5.2f} {found[3]:5.2f}  {name}", flush=True)
    return tuple(found)


def _read(data: bytes, own: Format) -> Mechanism:
    return pipeline.read(Source("robot", data, NoFiles()), own, Report(), lenient=True)


def _write(data: bytes, own: Format, target: Format) -> object:
    return pipeline.write(_read(data, own), target, ANYWAY, NoFiles(), Report(), HERE)


def _measure(data: bytes, own: Format, target: Format) -> object:
    return pipeline.convert(_read(data, own), target, ANYWAY, NoFiles(), Report(), HERE)


if __name__ == "__main__":
    sys.exit(main(tuple(sys.argv[1:])))
