"""Loading MJCF: `hymeko_x.load` against `mujoco.MjSpec.from_file`, which parses without meshes, on all development MJCFs.

python -m benchmarks.load_mjcf
"""

from __future__ import annotations

import statistics
import sys

import mujoco

import hymeko_x as hx
from benchmarks.robots import robots
from benchmarks.yardstick import best_of, verdict

BOUND = 15.0
"""MuJoCo's parser is C++ and keeps no places, no notations and no typed values."""


def main() -> int:
    """Load every file with both, in turns; the bound is on the median ratio."""
    ratios = []
    for path in robots("mjcf"):
        hx.load(path)
        ours, theirs = best_of(lambda: hx.load(path), lambda: mujoco.MjSpec.from_file(str(path)), 5)  # noqa: B023
        ratios.append(ours / theirs)
        print(f"{ours * 1e3:8.1f} ms, MjSpec {theirs * 1e3:8.1f} ms, ratio {ours / theirs:5.1f}  {path.name}")
    return 0 if verdict("loading MJCF, ours / MjSpec, median", statistics.median(ratios), BOUND, at_least=False) else 1


if __name__ == "__main__":
    sys.exit(main())
