"""500 meshes of real robots have the same solid, as MuJoCo computes it, after a way through another format without the source's files.

`python -m tests.meshes.test_real_solids` counts them.
"""

from __future__ import annotations

import os
import random
import shutil
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.corpus import cache, catalog
from tests.conftest import RealRobots

MODEL = """<mujoco model="r"><asset><mesh name="m" file="{}"/></asset>
  <worldbody><body name="b"><freejoint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""
SUFFIXES = (".stl", ".obj", ".msh")
MOST_BYTES = 3_000_000
PACKAGES = [package.name for package in catalog.load()]
MOST_OF_A_PACKAGE = 45
"""So many meshes that MuJoCo reads; the packages that are published have more than 500 of them then."""
LEAST_MOMENT = 1e-13
"""In kg m^2: MuJoCo reads tensors with products only above about this, so that smaller ones are written without, and this is reported."""


class Solid(NamedTuple):
    """What MuJoCo computes of the mesh of the one geom of a model."""

    counts: tuple[int, ...]
    """Points, triangles, and points and faces of the hull."""
    mass: float
    centre: np.ndarray
    tensor: np.ndarray
    box: np.ndarray

    def is_same(self, other: Solid) -> bool:
        """Whether another one is the same to float32."""
        size = max(float(np.abs(self.box).max()), 1e-3)
        away = max(float(np.abs(self.centre).max()), size)  # of which a stage has float32 too
        lengths = np.allclose(self.centre, other.centre, rtol=0, atol=2e-6 * away) and np.allclose(
            self.box, other.box, rtol=0, atol=2e-6 * size
        )
        least = float(np.abs(self.tensor).max())
        moments = least < LEAST_MOMENT or np.allclose(self.tensor, other.tensor, rtol=1e-5, atol=1e-5 * least)
        return self.counts == other.counts and lengths and moments and bool(np.isclose(self.mass, other.mass, rtol=1e-5))


def solid(path: Path) -> Solid:
    """Raises: ValueError where MuJoCo refuses the mesh."""
    model = mujoco.MjModel.from_xml_path(str(path))
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[1])
    axes = turn.reshape(3, 3)
    start = model.mesh_graphadr[0]
    hull = tuple(int(count) for count in model.mesh_graph[start : start + 2]) if start >= 0 else ()
    tensor = axes @ np.diag(model.body_inertia[1]) @ axes.T
    counts = (model.nmeshvert, model.nmeshface, *hull)
    return Solid(counts, float(model.body_mass[1]), model.body_ipos[1].copy(), tensor, model.geom_aabb[0].copy())


@pytest.mark.full
@pytest.mark.parametrize("name", PACKAGES)
def test_real_meshes_are_the_same_solids(name: str, real_robot: RealRobots, tmp_path: Path) -> None:
    folder = real_robot.package(next(package for package in catalog.load() if package.name == name))
    assert [str(path) for path, is_same in compared(name, folder, tmp_path) if not is_same] == []


def compared(name: str, folder: Path, place: Path) -> Iterator[tuple[Path, bool]]:
    """Meshes of a package that MuJoCo reads, in an order that is always the same, and whether each comes back."""
    found = sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES and path.stat().st_size < MOST_BYTES)
    random.Random(name).shuffle(found)
    results = ((path, comes_back(path, place / str(number))) for number, path in enumerate(found))
    yield from islice(((path, is_same) for path, is_same in results if is_same is not None), MOST_OF_A_PACKAGE)


def comes_back(mesh: Path, place: Path) -> bool | None:
    """Whether the mesh is the same solid after a stage and after URDF; None where MuJoCo refuses it from the start."""
    source = place / "source"
    source.mkdir(parents=True)
    shutil.copy(mesh, source / f"m{mesh.suffix}")
    (source / "r.xml").write_text(MODEL.format(f"m{mesh.suffix}"))
    try:
        expected = solid(source / "r.xml")
    except ValueError:
        return None
    for output in ("r.usda", "r.urdf"):
        (place / output).mkdir()
        hx.convert(source / "r.xml", place / output / output)
    shutil.rmtree(source)
    for output in ("r.usda", "r.urdf"):
        hx.convert(place / output / output, place / output / "back.xml", base="free")
    same = all(expected.is_same(solid(place / output / "back.xml")) for output in ("r.usda", "r.urdf"))
    shutil.rmtree(place)
    return same


if __name__ == "__main__":
    import tempfile

    whole, good = 0, 0
    for package in catalog.load():
        with tempfile.TemporaryDirectory() as there:
            here = list(compared(package.name, cache.package_path(package, cache.cache_root(os.environ)), Path(there)))
        whole, good = whole + len(here), good + sum(is_same for _, is_same in here)
        print(package.name, len(here), [str(path) for path, is_same in here if not is_same], flush=True)  # noqa: T201
    print(f"{good} of {whole} meshes are the same solids")  # noqa: T201
