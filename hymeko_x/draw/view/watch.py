"""Files that change on the disk."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    State = tuple[int, int] | None


class FileWatch:
    """The state of files when they were last looked at. A file that is not there has a state, too."""

    def __init__(self, paths: Iterable[str]) -> None:
        self._known = _states(paths)

    def has_changed(self) -> bool:
        """Whether a file has changed since the last look."""
        before, self._known = self._known, _states(self._known)
        return self._known != before


def _states(paths: Iterable[str]) -> Mapping[str, State]:
    return {path: _state(path) for path in paths}


def _state(path: str) -> State:
    """Time and size of a file."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size
