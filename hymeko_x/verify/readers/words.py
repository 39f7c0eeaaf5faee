"""What a native library says on the terminal while it refuses a file: the reason that its exception leaves out."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@contextlib.contextmanager
def overheard() -> Iterator[Callable[[], str]]:
    """Catches what native code writes to standard output and standard error; yields a function that tells what was said.

    Python's own streams are flushed before and after, so that nothing else is lost.
    """
    with tempfile.TemporaryFile() as file, contextlib.ExitStack() as stack:
        sys.stdout.flush()
        sys.stderr.flush()
        for descriptor in (1, 2):
            kept = os.dup(descriptor)
            stack.callback(os.close, kept)
            stack.callback(os.dup2, kept, descriptor)
            os.dup2(file.fileno(), descriptor)

        def said() -> str:
            file.seek(0)
            return " ".join(file.read().decode("utf-8", "replace").split())

        yield said
