"""Warnings and errors that a test neither looks at nor expects: the diagnostics of reports that stay unread."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hymeko_x import cli, diagnostics
from hymeko_x.diagnostics import Report, Severity, Stopped

if TYPE_CHECKING:
    from types import FrameType

    from hymeko_x.diagnostics import Diagnostic

_READERS = (str(Path(__file__).parent), str(Path(cli.__file__).parent))
"""Folders of modules that read a report for a person; all others only pass it on."""
_SLOT: Any = Report.__dict__["diagnostics"]


class Unread:
    """The reports of one test that have diagnostics, as long as nothing has read them."""

    def __init__(self) -> None:
        self._reports: dict[int, Report] = {}
        self._is_read: set[int] = set()

    def watch(self, report: Report) -> list[Diagnostic]:
        """Stands for the field ``diagnostics`` of every report."""
        self._reports[id(report)] = report
        if _is_read_by(sys._getframe(1)):
            self._is_read.add(id(report))
        found: list[Diagnostic] = _SLOT.__get__(report, Report)
        return found

    def take(self) -> list[Diagnostic]:
        """The warnings and errors of all reports that stayed unread; from now on there are none."""
        unread = [report for key, report in self._reports.items() if key not in self._is_read]
        found = [item for report in unread for item in _SLOT.__get__(report, Report) if item.severity is not Severity.NOTE]
        self._reports.clear()
        self._is_read.clear()
        return found

    def install(self) -> None:
        """Watch every report from now on."""
        field = property(self.watch, _SLOT.__set__)
        type.__setattr__(Report, "diagnostics", field)


def _is_read_by(frame: FrameType | None) -> bool:
    """Whether a report is read for a person, or raised: a test that catches the exception expects what it carries."""
    while frame is not None and frame.f_code.co_filename == diagnostics.__file__:
        if frame.f_code is Stopped.__init__.__code__:
            return True
        frame = frame.f_back
    return frame is not None and frame.f_code.co_filename.startswith(_READERS)


UNREAD = Unread()
"""The one for all tests: a module of tests may be imported under two names, this one is not."""
