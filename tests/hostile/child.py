"""A process of its own for what may crash, hang or eat the memory: it runs one command line after the other, under limits."""

from __future__ import annotations

import io
import multiprocessing
import os
import resource
import sys
import time
from contextlib import redirect_stderr
from typing import Any, NamedTuple

SECONDS = 60.0
"""After how long the process is ended. How long a case may take is a bound of the test."""
MEMORY = 3 * 2**30


class Ending(NamedTuple):
    """How a command ended: its exit code (None: it died or had to be killed), what it printed, and how long it took in s."""

    code: int | None
    printed: str
    seconds: float


class Child:
    """Runs `hymeko-x` in a process that is started once, and anew after a death."""

    def __init__(self) -> None:
        self._process: Any = None
        self._pipe: Any = None

    def run(self, words: list[str], folder: str) -> Ending:
        """The ending of one command line in this folder."""
        if self._process is None or not self._process.is_alive():
            self._start()
        begin = time.monotonic()
        self._pipe.send((words, folder))
        if not self._pipe.poll(SECONDS):
            self.stop()
            return Ending(None, f"killed after {SECONDS} s", time.monotonic() - begin)
        try:
            code, printed = self._pipe.recv()
        except EOFError:
            self._process.join()
            return Ending(None, f"died with {self._process.exitcode}", time.monotonic() - begin)
        return Ending(code, printed, time.monotonic() - begin)

    def stop(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()


def _serve(pipe: Any) -> None:
    """The child: take a command line, run it, say how it ended."""
    from hymeko_x.cli import main

    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    silence = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(silence, stream)
    sys.stdin = open(os.devnull, encoding="utf-8")  # noqa: SIM115
    while True:
        try:
            words, folder = pipe.recv()
        except EOFError:
            return
        os.chdir(folder)
        printed = io.StringIO()
        with redirect_stderr(printed):
            try:
                code: int | str | None = main(words)
            except SystemExit as end:
                code = end.code
        pipe.send((code, printed.getvalue()))
