"""A Ray cluster of two nodes on this machine, one of which dies during the run: the facts are those of a local run."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchmarks.cluster import cluster, end
from tests.corpus.folder import fill

pytest.importorskip("ray")

ROOT = Path(__file__).parents[2]
PAIRS = "urdf:hymeko,urdf:mjcf,mjcf:urdf,hymeko:urdf"


@pytest.mark.full
def test_a_node_that_dies_changes_nothing(tmp_path: Path) -> None:
    robots = fill(tmp_path / "toys", robots=8)
    words = [sys.executable, "-m", "hymeko_x", "corpus", "run", "--from", str(robots), "--pairs", PAIRS, "--verify"]
    results = tmp_path / "ray"
    with cluster(nodes=2) as ray:
        distributed = [*words, "--engine", "ray", "--address", ray.address, "-o", str(results)]
        with subprocess.Popen(distributed, cwd=ROOT, stderr=subprocess.PIPE, text=True, stdout=subprocess.DEVNULL) as run:
            while len(list(results.glob("parts/*/*.json"))) < 2 and run.poll() is None:
                time.sleep(0.05)
            assert run.poll() is None, "the run was over before a node could die"
            end(ray.nodes[1])
            printed = run.communicate(timeout=300)[1]
        assert run.returncode == 0, printed
    local = tmp_path / "local"
    subprocess.run([*words, "--jobs", "1", "-o", str(local)], cwd=ROOT, check=True, capture_output=True)
    for name in ("robots.parquet", "legs.parquet"):
        assert (results / name).read_bytes() == (local / name).read_bytes()


def test_a_cluster_that_is_not_there_is_reported_in_one_line(tmp_path: Path) -> None:
    robots = fill(tmp_path / "toys", robots=1)
    where = ["--engine", "ray", "--address", "127.0.0.1:1", "-o", str(tmp_path / "o")]
    words = ["corpus", "run", "--from", str(robots), "--pairs", "urdf:hymeko", *where]
    run = subprocess.run([sys.executable, "-m", "hymeko_x", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 1, run.stderr
    assert "no Ray cluster answers at '127.0.0.1:1'" in run.stderr
