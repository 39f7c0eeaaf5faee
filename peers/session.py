"""A driver that stays: it is asked one job at a time, so that several programs can be timed in turns."""

from __future__ import annotations

import contextlib
import json
import queue
import subprocess
import tempfile
import threading
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from collections.abc import Mapping

    from peers import Peer


class Session:
    """One process of a peer's driver; it starts with the first job, and again after one at which it died or was stopped."""

    def __init__(self, peer: Peer) -> None:
        self._peer = peer
        self._process: subprocess.Popen[str] | None = None
        self._answers: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._stderr = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115 - as long as the session

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()
        self._stderr.close()

    def ask(self, job: Mapping[str, Any], seconds: float) -> dict[str, Any]:
        """The answer to a job, or an ``error`` when it fails, kills the process or takes longer than these seconds."""
        if not self._peer.is_installed():
            return {"error": "it is not installed"}
        if self._process is None:
            self._start()
        assert self._process is not None
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(job) + "\n")
            self._process.stdin.flush()
            answer = self._answers.get(timeout=seconds)
        except queue.Empty:
            self._stop()
            return {"error": f"no answer within {seconds:g} s"}
        except BrokenPipeError:
            answer = None
        if answer is None:
            return {"error": self._died()}
        decoded: dict[str, Any] = json.loads(answer)
        return decoded

    def _start(self) -> None:
        pipe = subprocess.PIPE
        self._answers = queue.SimpleQueue()
        self._process = subprocess.Popen(self._peer.command(), stdin=pipe, stdout=pipe, stderr=self._stderr, text=True)
        threading.Thread(target=_listen, args=(self._process, self._answers), daemon=True).start()

    def _stop(self) -> int:
        """End the process and return how it ended."""
        if self._process is None:
            return 0
        self._process.kill()
        ended = self._process.wait()
        if self._process.stdin is not None:
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
        self._process = None
        return ended

    def _died(self) -> str:
        assert self._process is not None
        ended = self._process.wait()
        self._stop()
        self._stderr.seek(0)
        reason = self._stderr.read().strip().splitlines()[-1:] or ["without a message"]
        how = f"signal {-ended}" if ended < 0 else f"exit {ended}"
        return f"the process died ({how}): {reason[0][:200]}"


def _listen(process: subprocess.Popen[str], answers: queue.SimpleQueue[str | None]) -> None:
    """Pass on what stands behind "> "; programs print other things too. None is the end."""
    assert process.stdout is not None
    with process.stdout as lines:
        for line in lines:
            if line.startswith("> "):
                answers.put(line[2:])
    answers.put(None)
