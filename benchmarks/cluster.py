"""A Ray cluster of a few nodes on this machine, for tests and measurements."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Iterator

    Node = subprocess.Popen[bytes]

_ROOT = Path(__file__).parents[1]
_RAY = Path(sys.executable).with_name("ray")
_PATIENCE = 60.0  # s, for the first node


class Cluster(Struct, frozen=True):
    """Where it answers, and the process of each node; the first one is its head."""

    address: str
    nodes: tuple[Node, ...]


@contextmanager
def cluster(nodes: int) -> Iterator[Cluster]:
    """A cluster of nodes with one processor each on the loopback interface, until the block ends.

    Raises: TimeoutError when it does not come up.
    """
    port = _free_port()
    address = f"127.0.0.1:{port}"
    common = ["--num-cpus", "1", "--block", "--object-store-memory", "80000000", "--disable-usage-stats"]
    running: list[Node] = []
    with TemporaryDirectory(prefix="hx-ray-", dir="/tmp", ignore_cleanup_errors=True) as temporary:  # sockets have short paths
        head = ["--head", "--port", str(port), "--include-dashboard=false", "--temp-dir", temporary, "--node-ip-address", "127.0.0.1"]
        try:
            running.append(_start([*head, *common]))
            _wait_for(port)
            running += [_start(["--address", address, *common]) for _ in range(nodes - 1)]
            yield Cluster(address, tuple(running))
        finally:
            for node in reversed(running):
                end(node)


def end(node: Node) -> None:
    """Kill a node with everything that it started."""
    with suppress(ProcessLookupError):
        os.killpg(node.pid, signal.SIGKILL)
    node.wait()


def _start(words: list[str]) -> Node:
    environment = {**os.environ, "PYTHONPATH": str(_ROOT), "RAY_USAGE_STATS_ENABLED": "0", "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "1"}
    silent = subprocess.DEVNULL
    return subprocess.Popen([str(_RAY), "start", *words], env=environment, stdout=silent, stderr=silent, start_new_session=True)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def _wait_for(port: int) -> None:
    until = time.monotonic() + _PATIENCE
    while time.monotonic() < until:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.1)
    raise TimeoutError(f"no Ray cluster on port {port} after {_PATIENCE:g} s")
