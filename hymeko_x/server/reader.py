"""Texts read in a process of their own: an editor's questions are answered meanwhile, and a text that ends a reader ends only that."""

from __future__ import annotations

import multiprocessing
import os
import pickle
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Diagnostic, Origin, Refusal, Report
from hymeko_x.source import Source
from hymeko_x.validation import validate

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection
    from multiprocessing.context import SpawnProcess

    from hymeko_x.ir.mechanism import Mechanism


class TextReading(Struct):
    """What a text says: the name of its format, its diagnostics and its robot; None where it has none."""

    format: str | None
    diagnostics: list[Diagnostic]
    robot: Mechanism | None


def read(path: str, text: str) -> TextReading:
    """The text of the document at a path, whose own files are on the disk."""
    report = Report()
    found = TextReading(None, report.diagnostics, None)
    try:
        data = text.encode("utf-8", "surrogatepass")
        row = formats.of_input(path, data)
        found.format = row.name
        source = Source(path, data, DiskFiles(Path(path).parent))
        found.robot = pipeline.read_anyway(source, row, report)
        if row is not formats.OWN:
            validate(found.robot, source.files, report)
    except Refusal as refusal:
        report.extend(refusal.diagnostics)
    except RecursionError:
        report.error(codes.TOO_LARGE, "the text is nested too deep to be looked at", Origin(path))
    return found


class ReaderProcess:
    """The process that reads. It starts with the first text, and again with the next one after it has ended."""

    def __init__(self) -> None:
        self._running: tuple[SpawnProcess, Connection] | None = None

    def read(self, path: str, text: str, show: Callable[[TextReading], None]) -> bytes:
        """Have a text read as :func:`read` reads it, and show what it says without its robot; then that, pickled, or nothing.

        The diagnostics are there before the robot is handed over. One error is shown where reading ends the process, which writes why to
        standard error.
        """
        process, connection = self._running = self._running or _started()
        try:
            connection.send((path, text))
            show(connection.recv())
            return connection.recv_bytes()
        except (EOFError, OSError):
            process.join()
            self._running = None
            report = Report()
            report.error(codes.BUG, f"the process that read the text ended with exit code {process.exitcode}", Origin(path))
            show(TextReading(None, report.diagnostics, None))
            return b""

    def end(self) -> None:
        """End the process, which may be at a text."""
        if self._running is not None:
            self._running[0].terminate()


def _started() -> tuple[SpawnProcess, Connection]:
    context = multiprocessing.get_context("spawn")
    ours, its = context.Pipe()
    process = context.Process(target=_serve, args=(its,), daemon=True)
    process.start()
    its.close()
    return process, ours


def _serve(texts: Connection) -> None:
    """Read texts until the program closes the pipe, or ends. What libraries print goes to standard error."""
    os.dup2(2, 1)
    while True:
        try:
            path, text = texts.recv()
        except EOFError:
            return
        found = read(path, text)
        robot, found.robot = found.robot, None
        texts.send(found)
        texts.send_bytes(b"" if robot is None else pickle.dumps(robot))
