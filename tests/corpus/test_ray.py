"""A Ray cluster of two nodes on this machine, one of which dies during the run: the facts are those of a local run."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from tests.corpus.folder import fill

pytest.importorskip("ray")

ROOT = Path(__file__).parents[2]
RAY = Path(sys.executable).with_name("ray")
PAIRS = "urdf:hymeko,urdf:mjcf,mjcf:urdf,hymeko:urdf"


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """The address of a cluster of two nodes with one processor each, and the process of the second node."""
    address = f"127.0.0.1:{free_port()}"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "RAY_USAGE_STATS_ENABLED": "0", "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "1"}
    common = ["--num-cpus", "1", "--block", "--object-store-memory", "80000000", "--disable-usage-stats"]
    temporary = Path("/tmp") / f"hx-ray-{os.getpid()}"  # sockets have short paths
    head = [str(RAY), "start", "--head", "--port", address.partition(":")[2], "--include-dashboard=false", "--temp-dir", str(temporary)]
    nodes = [start([*head, "--node-ip-address", "127.0.0.1", *common], environment)]
    try:
        wait_for(address)
        nodes.append(start([str(RAY), "start", "--address", address, *common], environment))
        yield address, nodes[1]
    finally:
        for node in reversed(nodes):
            end(node)


def start(words: list[str], environment: dict[str, str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(words, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)


def end(node: subprocess.Popen[bytes]) -> None:
    """Kill a node with everything that it started."""
    with suppress(ProcessLookupError):
        os.killpg(node.pid, signal.SIGKILL)
    node.wait()


def wait_for(address: str) -> None:
    host, _, port = address.partition(":")
    for _ in range(600):
        with socket.socket() as probe:
            if probe.connect_ex((host, int(port))) == 0:
                return
        time.sleep(0.1)
    raise TimeoutError(address)


@pytest.mark.full
def test_a_node_that_dies_changes_nothing(cluster: tuple[str, subprocess.Popen[bytes]], tmp_path: Path) -> None:
    address, victim = cluster
    robots = fill(tmp_path / "toys", robots=8)
    words = [sys.executable, "-m", "hymeko_x.cli", "corpus", "run", "--from", str(robots), "--pairs", PAIRS, "--verify"]
    results = tmp_path / "ray"
    distributed = [*words, "--engine", "ray", "--address", address, "-o", str(results)]
    with subprocess.Popen(distributed, cwd=ROOT, stderr=subprocess.PIPE, text=True, stdout=subprocess.DEVNULL) as run:
        while len(list(results.glob("parts/*/*.json"))) < 2 and run.poll() is None:
            time.sleep(0.05)
        end(victim)
        said = run.communicate(timeout=300)[1]
    assert run.returncode == 0, said
    local = tmp_path / "local"
    subprocess.run([*words, "--jobs", "1", "-o", str(local)], cwd=ROOT, check=True, capture_output=True)
    for name in ("robots.parquet", "legs.parquet"):
        assert (results / name).read_bytes() == (local / name).read_bytes()


def test_a_cluster_that_is_not_there_is_said_in_one_line(tmp_path: Path) -> None:
    robots = fill(tmp_path / "toys", robots=1)
    where = ["--engine", "ray", "--address", "127.0.0.1:1", "-o", str(tmp_path / "o")]
    words = ["corpus", "run", "--from", str(robots), "--pairs", "urdf:hymeko", *where]
    run = subprocess.run([sys.executable, "-m", "hymeko_x.cli", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 1, run.stderr
    assert "no Ray cluster answers at '127.0.0.1:1'" in run.stderr
