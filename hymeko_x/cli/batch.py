"""Many robots in one go: each in a process of its own, so that a native library that aborts ends one robot and not the others."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import tempfile
from collections import Counter
from contextlib import contextmanager
from multiprocessing.connection import wait
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import formats
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.terminal import is_coloured, paint
from hymeko_x.reporting.summary import counted

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator, Sequence
    from multiprocessing.context import BaseContext, ForkServerProcess, SpawnProcess

    from hymeko_x.formats import Format

    Convert = Callable[[argparse.Namespace, str, str], int]


class Job(NamedTuple):
    """One robot: the file to read, and where its output goes."""

    source: str
    target: str


class Ended(NamedTuple):
    """How the process of a job ended: its exit code (negative: the signal), and the lines that it printed."""

    job: Job
    code: int
    lines: tuple[str, ...]


def jobs_into(folder: str, sources: Sequence[str], format: Format, suffix: str = "") -> list[Job]:
    """A job for each source, into this folder: by the file's name, or by its path below their common folder where names are equal.

    Raises: UsageError where two of them would still be one file.
    """
    suffix = suffix or format.suffixes[0]
    names = [PurePath(source).name for source in sources]
    if max(Counter(PurePath(name).stem for name in names).values()) > 1:
        common = os.path.commonpath([os.path.dirname(os.path.abspath(source)) for source in sources])
        names = [os.path.relpath(os.path.abspath(source), common) for source in sources]
    targets = [str(Path(folder, name).with_suffix(suffix)) for name in names]
    doubled = next((target for target, count in Counter(targets).items() if count > 1), None)
    if doubled:
        both = [source for source, target in zip(sources, targets, strict=True) if target == doubled]
        raise UsageError(f"{' and '.join(both)} would both be written to {doubled}")
    return [Job(source, target) for source, target in zip(sources, targets, strict=True)]


def run_batch(convert: Convert, jobs: Sequence[Job], chosen: argparse.Namespace, format: Format) -> int:
    """Convert all, with one line for each on standard error; exit 1 when one failed."""
    for job in jobs:
        Path(job.target).parent.mkdir(parents=True, exist_ok=True)
    codes = []
    with _progress(len(jobs)) as (count, say):
        for ended in _in_order(_all_ended(convert, jobs, chosen, format, count), len(jobs)):
            codes.append(ended.code)
            if ended.code or not chosen.quiet:
                say(_line(ended))
            if chosen.verbose:
                say("\n".join(f"  {line}" for line in ended.lines))
    failed = sum(code != exits.DONE for code in codes)
    if not chosen.quiet:
        print(f"{counted(len(jobs) - failed, 'robot')} converted" + (f", {failed} failed" if failed else ""), file=sys.stderr)
    own = {code for code in codes if code in (exits.FAIL_ON, exits.DIFFERENT)}
    return exits.FAILED if failed > sum(code in own for code in codes) else max(own, default=exits.DONE)


# ---- processes -----------------------------------------------------------------------------------------------------------


def _all_ended(
    convert: Convert, jobs: Sequence[Job], chosen: argparse.Namespace, format: Format, count: Callable[[], None]
) -> Iterator[tuple[int, Ended]]:
    """Run all jobs, `--jobs` at a time; each as it ends, with its number."""
    context = _context(jobs, format)
    running: dict[int, tuple[int, ForkServerProcess | SpawnProcess, Path]] = {}
    left = iter(enumerate(jobs))
    with tempfile.TemporaryDirectory(prefix="hymeko-x-") as scratch:
        try:
            while True:
                while len(running) < chosen.jobs and (following := next(left, None)) is not None:
                    number, job = following
                    words = Path(scratch, str(number))
                    process = context.Process(target=_work, args=(convert, job, chosen, str(words)))  # type: ignore[attr-defined]
                    process.start()
                    running[process.sentinel] = number, process, words
                if not running:
                    return
                for sentinel in wait(list(running)):
                    assert isinstance(sentinel, int)
                    number, process, words = running.pop(sentinel)
                    process.join()
                    count()
                    lines = words.read_text("utf-8", "replace").splitlines() if words.exists() else ()
                    yield number, Ended(jobs[number], process.exitcode or 0, tuple(lines))
        finally:
            for _, process, _ in running.values():
                process.terminate()
                process.join()


def _work(convert: Convert, job: Job, chosen: argparse.Namespace, words: str) -> None:
    """In the process of one job: convert, with everything that is printed, by native libraries too, in a file."""
    stream = os.open(words, os.O_WRONLY | os.O_CREAT, 0o600)
    os.dup2(stream, 1)
    os.dup2(stream, 2)
    sys.stdout = sys.stderr = os.fdopen(stream, "w", encoding="utf-8")
    code = exits.guarded("convert", lambda: convert(chosen, job.source, job.target))
    sys.stdout.flush()
    os._exit(code)  # what native libraries do when a process ends is not of interest


def _context(jobs: Sequence[Job], format: Format) -> BaseContext:
    """How processes are started: forked from a server that has loaded what they need, where the system can do that."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    rows = [format, *(row for row in formats.FORMATS if any(job.source.lower().endswith(row.suffixes) for job in jobs))]
    needed = [name for row in rows for name in (row.frontend, row.backend, row.rules) if name]
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["hymeko_x.cli.convert", *dict.fromkeys(needed)])
    return context


# ---- lines ---------------------------------------------------------------------------------------------------------------


def _in_order(ended: Iterator[tuple[int, Ended]], total: int) -> Iterator[Ended]:
    """Results in the order of their jobs, each as soon as those before it are there."""
    there: dict[int, Ended] = {}
    shown = 0
    for number, result in ended:
        there[number] = result
        while shown in there:
            yield there.pop(shown)
            shown += 1
    assert shown == total


def _line(ended: Ended) -> str:
    """What became of one robot."""
    if ended.code == exits.DONE:
        return "; ".join(ended.lines[:1] if len(ended.lines) > 2 else ended.lines)
    word = paint("31", "failed") if is_coloured(sys.stderr) else "failed"
    errors = [line for line in ended.lines if "error[" in line or "FAIL " in line]
    if ended.code < 0:
        reason = f"its process was ended by {signal.Signals(-ended.code).name}"
    else:
        reason = next(iter([*errors, *ended.lines]), f"exit code {ended.code}").strip()
    more = f" ({counted(len(errors) - 1, 'more error')})" if len(errors) > 1 else ""
    place = "" if reason.startswith(ended.job.source) else f"{ended.job.source}: "
    return f"{word} {place}{reason}{more}"


@contextmanager
def _progress(total: int) -> Iterator[tuple[Callable[[], None], Callable[[str], None]]]:
    """What counts a robot and what prints a line: above a bar, on a terminal where the library for it is installed."""
    from importlib.util import find_spec

    if not sys.stderr.isatty() or find_spec("rich") is None:
        yield (lambda: None), (lambda line: print(line, file=sys.stderr, flush=True))
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn
    from rich.text import Text

    with Progress(MofNCompleteColumn(), BarColumn(), TimeRemainingColumn(), console=Console(stderr=True), transient=True) as bars:
        task = bars.add_task("", total=total)
        yield (lambda: bars.advance(task)), (lambda line: bars.console.print(Text.from_ansi(line), soft_wrap=True))
