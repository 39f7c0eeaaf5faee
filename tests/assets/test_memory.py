"""A large set of meshes is converted in memory that its size bounds."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

BOUND = {"urdf": 1.0, "sdf": 1.0, "xml": 1.0, "mjz": 4.0, "usda": 4.0, "usdz": 4.0}
"""How many times the size of the set; a stage holds the points itself, and is read back and compared."""
CHILD = """
import resource, sys, hymeko_x as hx
hx.convert(*sys.argv[1:])
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""
MESHES = 20
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def surface(cells: int, seed: int) -> bytes:
    """Binary STL of a rough surface with 2 cells^2 triangles."""
    sides = np.meshgrid(np.linspace(0, 1, cells + 1), np.linspace(0, 1, cells + 1), indexing="ij")
    grid = np.stack([*sides, np.random.default_rng(seed).random((cells + 1, cells + 1))], -1)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    triangles = np.concatenate([np.stack(corners, -2).reshape(-1, 3, 3) for corners in ((a, b, c), (a, c, d))])
    rows = np.zeros(len(triangles), RECORD)
    rows["corners"] = triangles
    return b"\0" * 80 + np.uint32(len(rows)).tobytes() + rows.tobytes()


def robot(folder: Path, cells: int) -> int:
    """Writes a robot with meshes; returns their size in bytes."""
    folder.mkdir()
    for number in range(MESHES):
        (folder / f"m{number}.stl").write_bytes(surface(cells, number))
    shape = '<link name="l{0}"><visual><geometry><mesh filename="m{0}.stl"/></geometry></visual></link>'
    joint = '<joint name="j{0}" type="fixed"><parent link="l0"/><child link="l{0}"/></joint>'
    tags = [shape.format(number) for number in range(MESHES)] + [joint.format(number) for number in range(1, MESHES)]
    (folder / "r.urdf").write_text(f'<robot name="r">{"".join(tags)}</robot>')
    return sum(path.stat().st_size for path in folder.glob("*.stl"))


def peak(source: Path, output: Path) -> int:
    output.parent.mkdir()
    ended = subprocess.run([sys.executable, "-c", CHILD, source, output], capture_output=True, text=True, check=True)
    return int(ended.stdout)


@pytest.mark.full
@pytest.mark.parametrize("suffix", BOUND)
def test_100_megabytes_of_meshes_need_a_few_times_their_size(suffix: str, tmp_path: Path) -> None:
    robot(tmp_path / "small", 2)
    size = robot(tmp_path / "large", 223)
    assert size > 90e6
    usual = peak(tmp_path / "small" / "r.urdf", tmp_path / "a" / f"r.{suffix}")
    assert peak(tmp_path / "large" / "r.urdf", tmp_path / "b" / f"r.{suffix}") - usual < BOUND[suffix] * size
