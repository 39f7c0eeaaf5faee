"""Robots per second with one worker and with two, in local processes and on a Ray cluster that this program starts.

python -m benchmarks.pace [COUNT]   (default 24 robots, drawn from the whole catalogue with a fixed seed; every pair, verified)

Writes `corpus/results/pace.csv`, from which `hymeko-x corpus stats --page docs/scale.md` takes the table.
"""

from __future__ import annotations

import os
import random
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.cluster import cluster
from hymeko_x.corpus import cache, catalog, engines
from hymeko_x.corpus.cases import from_catalogue
from hymeko_x.corpus.engines import Local, OnRay
from hymeko_x.corpus.plan import Plan, pairs_of
from hymeko_x.corpus.store import Store

if TYPE_CHECKING:
    from hymeko_x.corpus.cases import Case
    from hymeko_x.corpus.engines import Engine
    from hymeko_x.corpus.rows import Outcome

ROOT = Path(__file__).parents[1]
SEED = 8
WORKERS = (1, 2)


def main() -> int:
    """Measure, print and keep."""
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    root = cache.cache_root(os.environ)
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 24
    cases = tuple(random.Random(SEED).sample(from_catalogue(catalog.select(()), root), count))
    rows = ["engine,workers,files,seconds,robots_per_second"]
    for workers in WORKERS:
        rows.append(_row("local", workers, len(cases), _seconds(cases, Local(workers, root))))
    for workers in WORKERS:
        with cluster(workers) as ray:
            rows.append(_row("ray", workers, len(cases), _seconds(cases, OnRay(ray.address, root))))
    (ROOT / "corpus/results/pace.csv").write_text("\n".join(rows) + "\n")
    return 0


def _row(engine: str, workers: int, files: int, seconds: float) -> str:
    print(f"{engine:6} {workers} workers  {files} files  {seconds:8.1f} s  {files / seconds:.3f} robots/s", flush=True)
    return f"{engine},{workers},{files},{seconds:.1f},{files / seconds:.4f}"


def _seconds(cases: tuple[Case, ...], engine: Engine) -> float:
    """The time of a run, with the start of its processes."""
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        engines.run(cases, Plan(pairs_of("all")), engine, Store(f"{folder}/run"), watch=_silent)
        return time.perf_counter() - start


def _silent(outcome: Outcome) -> None:
    """Nobody watches."""


if __name__ == "__main__":
    sys.exit(main())
