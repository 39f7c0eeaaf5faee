"""Loading URDF: `hymeko_x.load` against `yourdfpy.URDF.load` without meshes, on all development URDFs.

python -m benchmarks.load
"""

from __future__ import annotations

import logging
import statistics
import sys

import yourdfpy

import hymeko_x as hx
from benchmarks.robots import robots
from benchmarks.yardstick import best_of, verdict


def main() -> int:
    """Load every file with both, in turns; the bound is on the median ratio."""
    logging.disable(logging.CRITICAL)
    ratios = []
    for path in robots("urdf"):
        hx.load(path)
        ours, theirs = best_of(lambda: hx.load(path), lambda: _yourdfpy(str(path)), 3)  # noqa: B023
        ratios.append(ours / theirs)
        print(f"{ours * 1e3:8.1f} ms, yourdfpy {theirs * 1e3:8.1f} ms  {path.name}")
    return 0 if verdict("loading URDF, ours / yourdfpy, median", statistics.median(ratios), 1.0, at_least=False) else 1


def _yourdfpy(path: str) -> yourdfpy.URDF:
    return yourdfpy.URDF.load(path, load_meshes=False, build_scene_graph=False, build_collision_scene_graph=False)


if __name__ == "__main__":
    sys.exit(main())
