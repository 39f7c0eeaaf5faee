"""The folder to which the tools are confined: paths of the models, checked before anything is opened."""

from __future__ import annotations

import os
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Code

MOST_ENTRIES = 20_000
"""How many entries of a folder are looked at for links that lead out of it."""


class Folder(Struct, frozen=True):
    """The folder; ``root`` is its real path."""

    root: Path

    def input(self, path: str) -> str:
        """A file in the folder, as a word of a command line that runs there. Raises: Refusal HX001."""
        place = self._inside(path, codes.CANNOT_READ)
        if not place.is_file():
            raise refuse(codes.CANNOT_READ, f"there is no file '{path}' in the folder", Origin(path))
        return _word(path)

    def output(self, path: str) -> str:
        """A place for a file in the folder, and for files beside it. Raises: Refusal HX002."""
        place = self._inside(path, codes.CANNOT_WRITE)
        if not place.parent.is_dir():
            raise refuse(codes.CANNOT_WRITE, f"there is no folder for '{path}'", Origin(path))
        self._check_links(place.parent, path)
        return _word(path)

    def _inside(self, path: str, code: Code) -> Path:
        """The real path. Raises: Refusal for one that is absolute, goes up, or leads out by a link."""
        parts = {*PurePosixPath(path).parts, *PureWindowsPath(path).parts}
        is_absolute = path.startswith(("/", "\\", "~")) or PureWindowsPath(path).drive
        if not path or "\0" in path or is_absolute or ".." in parts:
            raise refuse(code, f"'{path}' is no path within the folder: absolute paths and '..' are not allowed", Origin(path))
        try:
            place = (self.root / path).resolve()
        except (OSError, RuntimeError) as error:
            raise refuse(code, f"'{path}' leads nowhere", Origin(path)) from error
        if not place.is_relative_to(self.root):
            raise refuse(code, f"'{path}' leads out of the folder by a link", Origin(path))
        return place

    def _check_links(self, folder: Path, path: str) -> None:
        """Raises: Refusal HX002 when the link of a folder beside an output leads out: meshes would be written through it.

        Links of files are replaced, never written through.
        """
        entries = 0
        for place, folders, files in os.walk(folder):
            entries += len(folders) + len(files)
            if entries > MOST_ENTRIES:
                raise refuse(codes.CANNOT_WRITE, f"there are more than {MOST_ENTRIES} files beside '{path}'", Origin(path))
            for name in folders:
                found = Path(place, name)
                if found.is_symlink() and not found.resolve().is_relative_to(self.root):
                    message = f"beside '{path}' the link '{name}' leads out of the folder"
                    raise refuse(codes.CANNOT_WRITE, message, Origin(path))


def _word(path: str) -> str:
    """A path that no command line takes for an option."""
    return f"./{path}" if path.startswith("-") else path
