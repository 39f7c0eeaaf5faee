"""The optimisations in meshes/ that a plainer library could replace: whole conversions to USD with each, and without.

python -m benchmarks.meshes [NAME ...]

One conversion of each robot by each variant in turns; the figures are the least processor times, and their ratios to ours. An
optimisation stays while some robots take a tenth longer without it.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

import numpy as np

import hymeko_x as hx
from benchmarks.robots import robots
from benchmarks.usd import WITH_MESHES
from benchmarks.yardstick import least_in_turns
from hymeko_x.meshes import collada, numerals, weld

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray


def first_by_unique(rows: NDArray[Any]) -> NDArray[np.intp]:
    """For each row the number of the first one that equals it, by numpy's sorting."""
    _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return np.asarray(first[inverse.ravel()])


PLAINER: dict[str, tuple[Any, str, Callable[..., Any]]] = {
    "points joined by np.unique": (weld, "_first_equal", first_by_unique),
    "COLLADA by trimesh": (collada, "collada_groups", lambda data, **_: None),
    "decimals by numpy": (numerals, "_decimals", lambda data: None),
}


def main(names: tuple[str, ...]) -> int:
    """Print one line for each robot and variant."""
    with tempfile.TemporaryDirectory() as folder:
        for path in robots("urdf", names or WITH_MESHES):
            out = Path(folder) / f"{path.stem}.usdc"
            works = [lambda path=path, out=out: hx.convert(path, out)]
            works += [lambda patch=patch, work=works[0]: _patched(work, *patch) for patch in PLAINER.values()]
            ours, *others = least_in_turns(*works)
            for name, seconds in zip(PLAINER, others, strict=True):
                print(f"{ours * 1e3:8.1f} ms, {seconds * 1e3:8.1f} ms ({seconds / ours:.2f}) with {name}  {path.name}", flush=True)
    return 0


def _patched(work: Callable[[], object], module: Any, name: str, plainer: Callable[..., Any]) -> None:
    with mock.patch.object(module, name, plainer):
        work()


if __name__ == "__main__":
    sys.exit(main(tuple(sys.argv[1:])))
