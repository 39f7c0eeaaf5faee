"""What USD's own code warns of, as diagnostics of the file."""

from __future__ import annotations

import os
import re
from contextlib import contextmanager
from typing import TYPE_CHECKING

from pxr import UsdUtils

from hymeko_x import codes
from hymeko_x.diagnostics import Origin

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source

_MOST_LETTERS = 300
_NAME = re.compile(r"[@<(](/[^@>)]*)[@>)]")
"""A path of a file or a prim, which USD puts between signs."""
_ADVICE = re.compile(r" Disable this warning by .*")


@contextmanager
def warnings_reported(source: Source, main: str, report: Report) -> Iterator[None]:
    """In the block, USD's warnings are diagnostics of the source, and not printed; ``main`` is the copy of it that USD reads."""
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield
    finally:
        for warning in delegate.TakeUncoalescedDiagnostics():
            text = _NAME.sub(r"'\1'", _ADVICE.sub("", " ".join(warning.commentary.split())))
            text = text.replace(main, source.name).replace(f"{os.path.dirname(main)}/", "")
            report.warn(codes.LIBRARY_MESSAGE, f"USD: {text[:_MOST_LETTERS]}", Origin(source.name))
