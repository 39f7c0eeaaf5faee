"""Files on their way to the disk: all are there under temporary names before any of them replaces another one."""

from __future__ import annotations

import errno
import filecmp
import os
import stat
from contextlib import suppress
from typing import TYPE_CHECKING

from msgspec import Struct, field

if TYPE_CHECKING:
    from pathlib import Path

Move = tuple["Path", "Path"]
"""A temporary file, and the place for which it is meant."""


class Staging(Struct):
    """Temporary siblings of some files, and the folders that were made for them."""

    moves: list[Move] = field(default_factory=list)
    folders: list[Path] = field(default_factory=list)

    def make_folders(self, folder: Path) -> None:
        """Make the folders of an asset below the output's own folder, which must exist; those that are new are noted. Raises: OSError."""
        missing = [place for place in (folder, *folder.parents) if not place.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        self.folders += missing

    def add(self, final: Path, data: bytes) -> None:
        """Put the data beside its place, with the permissions of the file that it will replace, or of a new file. Raises: OSError."""
        self.moves.append(_stage(final, data))

    def replace_others(self) -> bool:
        """Whether a file with another content is in the place of one of these. Raises: OSError."""
        return any(final.exists() and not filecmp.cmp(temporary, final, shallow=False) for temporary, final in self.moves)

    def put(self) -> None:
        """Rename all into place, in their order. Raises: OSError."""
        for temporary, final in self.moves:
            temporary.replace(final)

    def clean(self) -> None:
        """Remove what a failed run left: temporary files, and folders of its own that stayed empty."""
        for temporary, _ in self.moves:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)
        for folder in self.folders:
            with suppress(OSError):
                folder.rmdir()


def _stage(final: Path, data: bytes) -> Move:
    real = final.resolve() if final.is_symlink() else final
    if real.is_dir():
        raise IsADirectoryError(errno.EISDIR, f"'{final}' is a folder")
    temporary = real.with_name(f".{real.name[:100]}.{os.urandom(6).hex()}.part")
    try:
        with temporary.open("xb") as file:
            file.write(data)
        if real.exists():
            temporary.chmod(stat.S_IMODE(real.stat().st_mode))
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return temporary, real
