"""Reference readers in a process of their own: an engine that crashes ends that process, and its user gets a diagnostic.

One process serves all files of a reader. It starts with the first file, and again with the next one after a crash.
"""

from __future__ import annotations

import atexit
import contextlib
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import traceback
from functools import cache
from typing import TYPE_CHECKING, NamedTuple, NoReturn

from hymeko_x import codes, formats
from hymeko_x.diagnostics import Diagnostic, Origin, Refusal, refuse

if TYPE_CHECKING:
    from pathlib import Path
    from types import FrameType

    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.readers.lookup import Lookup

_CHILD = "from hymeko_x.verify.readers.apart import serve; serve()"


def read(reader: str, engine: str, path: Path, lookup: Lookup) -> KinematicModel:
    """The robot that a reader's module reads, in the reader's process.

    A process that :mod:`multiprocessing` started for one robot of many reads it itself, as its parent reports how it ended.
    Raises: what the reader raises, and Refusal HX302 where the engine crashes.
    """
    if multiprocessing.parent_process() is not None:
        found: KinematicModel = formats.loaded(reader).read(path, lookup)
        return found
    return _process(reader, engine).read(path, lookup)


class _Job(NamedTuple):
    """A file to read, and what a reader sees of the program beside it: the current folder and the environment."""

    path: Path
    lookup: Lookup
    folder: str
    environment: dict[str, str]


# ---- the program -----------------------------------------------------------------------------------------------------------


@cache
def _process(reader: str, engine: str) -> _Process:
    return _Process(reader, engine)


class _Process:
    """The process of one reader, started when a file is to be read."""

    def __init__(self, reader: str, engine: str) -> None:
        self._reader = reader
        self._engine = engine
        self._lock = threading.Lock()
        self._running: subprocess.Popen[bytes] | None = None
        atexit.register(self._end)

    def read(self, path: Path, lookup: Lookup) -> KinematicModel:
        """The robot in a file. Raises: as :func:`read`."""
        with self._lock:
            try:
                found = self._answer(_Job(path, lookup, os.getcwd(), dict(os.environ)))
            except (EOFError, BrokenPipeError) as error:
                message = f"{self._engine} {_ending(self._end())} while it read {path.name}"
                raise refuse(codes.ENGINE_REFUSED, message, Origin(str(path))) from error
            except BaseException:
                self._end(at_once=True)  # half an answer would be taken for the next one
                raise
        if isinstance(found, Diagnostic):
            raise Refusal(found)
        if isinstance(found, BaseException):
            raise found
        return found

    def _answer(self, job: _Job) -> KinematicModel | Diagnostic | BaseException:
        running = self._running = self._running or _started(self._reader)
        assert running.stdin is not None
        assert running.stdout is not None
        pickle.dump(job, running.stdin)
        running.stdin.flush()
        found: KinematicModel | Diagnostic | BaseException = pickle.load(running.stdout)
        return found

    def _end(self, *, at_once: bool = False) -> int:
        """End the process, which may be at a file; how it ended: the exit code, or the number of a signal below zero."""
        running, self._running = self._running, None
        if running is None:
            return 0
        if at_once:
            running.kill()
        with running, contextlib.suppress(BrokenPipeError):
            assert running.stdin is not None
            running.stdin.close()
        return running.returncode


def _started(reader: str) -> subprocess.Popen[bytes]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
    command = [sys.executable, "-P", "-c", _CHILD, reader]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)


def _ending(code: int) -> str:
    if code >= 0:
        return f"ended with exit code {code}"
    known = {member.value: f" ({member.name})" for member in signal.Signals}
    return f"ended with signal {-code}{known.get(-code, '')}"


# ---- the reader's process ----------------------------------------------------------------------------------------------------


def serve() -> NoReturn:
    """Read files until the program closes the pipe. What libraries print goes to standard error."""
    with os.fdopen(os.dup(1), "wb") as answers:
        os.dup2(2, 1)
        signal.signal(signal.SIGINT, _wait_for_the_program)
        with contextlib.suppress(EOFError, BrokenPipeError):
            while True:
                pickle.dump(_result(pickle.load(sys.stdin.buffer)), answers)
                answers.flush()
    os._exit(0)  # what native libraries do when a process ends is not of interest


def _wait_for_the_program(number: int, frame: FrameType | None) -> None:
    """Ctrl-C reaches both processes; the program decides, and closes the pipe."""


def _result(job: _Job) -> KinematicModel | Diagnostic | Exception:
    os.chdir(job.folder)
    for name in os.environ.keys() - job.environment.keys():
        del os.environ[name]
    os.environ.update(job.environment)
    try:
        found: KinematicModel = formats.loaded(sys.argv[1]).read(job.path, job.lookup)
    except Refusal as refusal:
        return refusal.diagnostic
    except Exception as error:  # noqa: BLE001 - the program raises it
        error.add_note(traceback.format_exc())
        return error
    return found
