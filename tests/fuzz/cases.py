"""One fuzz case: what it is, what a reader makes of it, and whether that is an outcome that may be."""

from __future__ import annotations

import gc
import random
import resource
import signal
import time
import traceback
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes, formats, pipeline
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from hymeko_x.testing.mutations import mutated
from tests.fuzz.seeds import seeds, small_seeds

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import FrameType

    from hymeko_x.ir.mechanism import Mechanism

SECONDS = 2.0
MEMORY = 500 * 2**20
"""What one case may take: processor time, so that a busy machine does not matter, and bytes beyond what the libraries have."""

SMALL = 0.9
"""How many of the cases start from a small text."""


class Finding(NamedTuple):
    """Something that should not have happened: ``where`` tells one kind of it from another."""

    where: str
    text: str


class TooSlow(BaseException):
    """The case took longer than it may. No handler of ours catches it."""


def data_of(format: str, number: int) -> bytes:
    """The text of a case; the same for the same number, on every machine. Most are small, which is what a million of them allow."""
    chance = random.Random(number)
    few, many = small_seeds(format), seeds(format)
    start = few[chance.randrange(len(few))] if chance.random() < SMALL else many[chance.randrange(len(many))]
    return mutated(start, chance, many)


def warm_up(format: str) -> None:
    """Load whatever readers load on first use, so that it counts for no case: also what explains a wrong residue."""
    for data in (*small_seeds(format), data_of(format, 0), b"{", b"<"):
        with suppress(Refusal):
            _read(format, data)
    with suppress(Refusal):
        _read("hymeko", b"{")
    gc.collect()
    gc.freeze()


def run(format: str, data: bytes, through: str = "") -> Finding | None:
    """Read the data, and write it as the format ``through`` if there is one. A mechanism or a refusal is how it should end."""
    start = time.process_time()
    try:
        with _limited():
            mechanism = _read(format, data)
            if through and mechanism is not None:
                _write(mechanism, through)
    except Refusal as refusal:
        return Finding(_place(refusal), str(refusal)) if refusal.diagnostic.code == codes.BUG else None
    except TooSlow as error:
        return Finding("slow", f"{time.process_time() - start:.1f} s\n{_trace(error)}")
    except Exception as error:  # noqa: BLE001 - that is what is looked for
        return Finding(_place(error), _trace(error))
    return None


def _read(format: str, data: bytes) -> Mechanism | None:
    name = "case.xml" if format == "xml" else f"case.{format}"
    try:
        found = formats.of_input(name, data) if format == "xml" else formats.by_name(format)
        return pipeline.read(Source(name, data, NoFiles()), found, Report())
    except Refusal as refusal:
        if refusal.diagnostic.code == codes.BUG:
            raise
        return None


def _write(mechanism: Mechanism, through: str) -> None:
    """Write it, and read it back; what HyMeKo says has to come back the same."""
    format = formats.by_name(through)
    package = pipeline.write(mechanism, format, Options(), NoFiles(), Report())
    back = pipeline.read(Source(f"back.{through}", package.main), format, Report())
    if through == "hymeko" and back != mechanism:
        raise AssertionError("HyMeKo text does not say the same")


@contextmanager
def _limited() -> Iterator[None]:
    """No more than the time of one case. What hangs in C code, where no signal is heard, the parent ends."""
    old = signal.signal(signal.SIGPROF, _stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, old)


def _stop(signum: int, frame: FrameType | None) -> None:
    raise TooSlow


def limit_memory(more: int = MEMORY) -> None:
    """From now on this process gets no more than so many bytes beyond what it has. What is only reserved does not count."""
    with open("/proc/self/status", encoding="ascii") as file:
        has = next(int(line.split()[1]) * 1024 for line in file if line.startswith("VmData"))
    resource.setrlimit(resource.RLIMIT_DATA, (has + more, has + more))


def _place(error: BaseException) -> str:
    """The kind of an error and the line of ours that it came from."""
    while isinstance(error, Refusal) and error.__cause__ is not None:
        error = error.__cause__
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "hymeko_x" in frame.filename]
    line = f"{frames[-1].filename.rpartition('hymeko_x/')[2]}:{frames[-1].lineno}" if frames else "?"
    return f"{type(error).__name__} {line}"


def _trace(error: BaseException) -> str:
    return "".join(traceback.format_exception(error))[-3000:]
