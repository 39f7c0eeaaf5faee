"""The files of one output under construction: safe and unique relative names, equal content of one name stored once."""

from __future__ import annotations

import os
import posixpath
import re
from typing import TYPE_CHECKING

from hymeko_x.assets.archives import inside
from hymeko_x.ir.names import free_name
from hymeko_x.source import NO_FILES

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.formats import Assets
    from hymeko_x.source import Files

    Variant = Callable[[str | None], str]
    """What tells content at another place from the same bytes, by the source of the earlier copy of these, if there is one."""

_UNSAFE = re.compile(r"[^\w.+=@()-]+")
_MOST_LETTERS = 80
_DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)", re.IGNORECASE)


class Shelf:
    """Where packers put files. ``files`` and ``copies`` are what `source.Package` wants, in the order of arrival.

    With ``within``, which ends in a slash, all of them are below that folder. ``around`` are the files around the output. ``origin`` is
    the file of the robot: what lies with it in an archive is found from nowhere else.
    """

    def __init__(self, mode: Assets, out_dir: str | None, within: str = "", around: Files = NO_FILES, origin: str = "") -> None:
        self.mode = mode
        self.within = within
        self.around = around
        self.is_from_archive = inside(origin) is not None
        self.files: dict[str, bytes] = {}
        self.copies: dict[str, str] = {}
        self._out_dir = out_dir
        self._by_content: dict[tuple[str, str], str] = {}
        self._taken: set[str] = set()

    def place(self, folder: str, stem: str, suffix: str, data: bytes) -> str:
        """Store content as ``folder/stem.suffix`` (made safe and unique) and return the relative path."""
        path, new = self._name(folder, stem, suffix, data)
        if new:
            self.files[path] = data
        return path

    def copy(self, folder: str, stem: str, suffix: str, source: str, data: bytes, variant: Variant | None = None) -> str:
        """Let the file ``source`` be copied there; in reference mode just the way from the output to it.

        Equal content of one name is copied once for each text that ``variant`` gives.
        """
        if self.mode == "reference":
            return self.way_to(source)
        path, new = self._name(folder, stem, suffix, data, variant)
        if new:
            self.copies[path] = source
        return path

    def copy_as(self, path: str, source: str) -> bool:
        """Let ``source`` be copied to this very relative path; False when another file has the path already, or all go elsewhere."""
        if self.copies.get(path) == source:
            return True
        if self.within or path.lower() in self._taken:
            return False
        self._taken.add(path.lower())
        self.copies[path] = source
        return True

    def place_instead(self, path: str, suffix: str, data: bytes) -> str:
        """Store content in the place of a file that is copied to ``path``, or referred to there; returns its path, with its own suffix."""
        stem, old = os.path.splitext(path)
        if path not in self.copies or old.lower() != suffix:
            self.copies.pop(path, None)
            folder = "" if self.mode == "reference" else posixpath.dirname(stem).removeprefix(self.within)
            return self.place(folder or "assets", posixpath.basename(stem), suffix, data)
        del self.copies[path]
        self.files[path] = data
        return path

    def way_to(self, source: str, written: str = "") -> str:
        """The path of an existing file relative to the output's folder; absolute only where no relative one exists.

        ``written`` is how the author spelled it, which is kept where it leads there from the output's folder too.
        """
        if self._out_dir is None:
            return source
        if written and not os.path.isabs(written) and os.path.abspath(os.path.join(self._out_dir, written)) == os.path.abspath(source):
            return written
        try:
            return os.path.relpath(source, self._out_dir).replace(os.sep, "/")
        except ValueError:  # another drive
            return source

    def _name(self, folder: str, stem: str, suffix: str, data: bytes, variant: Variant | None = None) -> tuple[str, bool]:
        """The path for this content, and whether the content is new."""
        from hashlib import sha256

        name, digest = safe_name(stem) + suffix, sha256(data).hexdigest()
        earlier = self.copies.get(self._by_content.get((name, digest), ""))
        key = (name, digest if variant is None else digest + variant(earlier))
        if key in self._by_content:
            return self._by_content[key], False
        start = f"{self.within}{folder}/"
        name = free_name(safe_name(stem), lambda free: f"{start}{free}{suffix}".lower() in self._taken, "_")
        path = f"{start}{name}{suffix}"
        self._taken.add(path.lower())
        self._by_content[key] = path
        return path, True


def safe_name(name: str) -> str:
    """A name that means a file on every system and nothing else: letters, digits and ``. _ - + = @ ( )``, no dot in front."""
    safe = _UNSAFE.sub("_", name).strip(". ")[:_MOST_LETTERS] or "file"
    return f"_{safe}" if _DEVICES.fullmatch(safe.split(".")[0]) else safe


def read_file(files: Files, uri: str) -> tuple[str, bytes] | None:
    """The path and content of the file that ``uri`` names, or None when there is none."""
    path = files.find(uri)
    if path is None:
        return None
    try:
        return path, files.read(path)
    except OSError:
        return None
