"""Bytes in and bytes out: what a frontend reads from and what a backend returns.

Nothing here touches a disk. The shell gives a frontend a :class:`Source` whose ``files`` can look things up
(a folder, a wheel, a dictionary in a test), and takes from a backend a :class:`Package` to write.
"""

from __future__ import annotations

import posixpath
from contextlib import suppress
from pathlib import PurePath
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple, Protocol

from msgspec import Struct, field

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.diagnostics import Origin
    from hymeko_x.ir.mechanism import Mechanism


class Files(Protocol):
    """The files that a robot description may refer to."""

    def find(self, uri: str) -> str | None:
        """The path of the file that ``uri`` names (``package://pkg/a.stl``, ``../b.obj``), or None when there is none."""
        ...

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned.

        Raises: OSError when the file vanished or may not be read.
        """
        ...


class NoFiles:
    """A world without files: every look-up fails. For text from a pipe or a string."""

    def find(self, uri: str) -> str | None:
        """None for every uri."""
        return None

    def read(self, path: str) -> bytes:
        """Raises: FileNotFoundError, always."""
        raise FileNotFoundError(path)


NO_FILES = NoFiles()

KEPT_SUFFIX = ".keep.hymeko"
"""What follows the name of a file in the name of the kept file beside it."""


KEPT_FOLDER = ".keep.files"
"""What follows the name of a file in the name of the folder beside it that has the originals kept for it."""

DIGESTS = "digests.txt"
"""The name of the text in that folder that tells what the output has in the places of originals."""

NOTHING_KEPT: Mapping[str, str] = MappingProxyType({})
"""No originals."""


class Kept(NamedTuple):
    """What is kept for a file of the robot that it was made from.

    ``text`` is the text of a residue, and ``file`` the name of the file that has it; ``originals`` are files of that robot that are not
    among the output's own, by their names in their folder, with their paths; ``digests`` is the text of :mod:`hymeko_x.residue.digests`.
    """

    text: str
    file: str
    originals: Mapping[str, str] = NOTHING_KEPT
    digests: str = ""

    @property
    def is_beside(self) -> bool:
        """Whether it has a file of its own."""
        return bool(self.text) and self.file.endswith(KEPT_SUFFIX)


def with_prefix(text: str, prefix: str) -> str:
    """The text of a residue for a robot all of whose names begin so by now."""
    if not prefix:
        return text
    escaped = prefix.replace("\\", "\\\\").replace('"', '\\"')
    return text.replace("version ", f'prefix "{escaped}" version ', 1)


class Parts(Protocol):
    """Reads the robots of other files for a description that imports them."""

    def __call__(self, path: str, arguments: tuple[tuple[str, float | str], ...], origin: Origin) -> Mechanism:
        """The robot in a file: complete, without classes, and with uris that lead from the importing file to its files.

        ``path`` is as the description has it, ``origin`` where it imports. Raises: Refusal.
        """
        ...


class Source(Struct, frozen=True):
    """One input: its name as the user typed it (used in messages), its bytes, and the files around it.

    ``arguments`` are the user's values for a format that takes some (xacro's NAME:=VALUE), ``environment`` the
    variables that the user passes on to it (xacro's `$(env NAME)`); the program's own environment stays closed. ``variants``
    are the choices for a format that leaves some open (USD's variant sets). ``kept`` is what the kept file beside it holds, and
    ``originals`` the files that are kept for it; with ``ignores_kept`` neither is used, nor what is kept inside of the file.
    ``parts`` reads robots that the description imports.
    """

    name: str
    data: bytes
    files: Files = field(default_factory=NoFiles)
    arguments: Mapping[str, str] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)
    variants: Mapping[str, str] = field(default_factory=dict)
    kept: Kept | None = None
    originals: Mapping[str, str] = NOTHING_KEPT
    ignores_kept: bool = False
    parts: Parts | None = None

    @property
    def stem(self) -> str:
        """The name of the file without folders and suffix: the name of a robot that has none of its own."""
        return PurePath(self.name.replace("\\", "/")).stem.strip("-<> ") or "robot"

    def is_whole(self, inside: str) -> bool:
        """Whether the file has all of the robot: nothing is kept inside of it (the text ``inside`` is empty), nor beside it."""
        return not inside and (self.kept is None or self.ignores_kept)


class Reading(NamedTuple):
    """What a frontend reads: the mechanism, and the text of the residue that is kept inside the file (empty = none)."""

    mechanism: Mechanism
    residue: str = ""


class Package(Struct, frozen=True):
    """One output: the main file's bytes and the files beside it, by relative path with forward slashes.

    ``copies`` names files that are to be copied as they are: relative path -> path in the source's ``files``. ``with_residue`` prints the
    main file again with the text of a residue where other readers of the format ignore it; None for a format that represents
    everything. ``enclose`` gives the package with files inside of the main one; None where they stand beside it. ``kept`` is the text of
    the kept file beside the main one; where it is empty there is none. ``originals`` are copies in the folder of what is kept, and
    ``digests`` a text there.
    ``prefix`` is what stands before the paths of its files in its text.
    """

    main: bytes
    files: Mapping[str, bytes] = field(default_factory=dict)
    copies: Mapping[str, str] = field(default_factory=dict)
    with_residue: Callable[[str], bytes] | None = None
    enclose: Callable[[Mapping[str, bytes]], Package] | None = None
    kept: str = ""
    originals: Mapping[str, str] = field(default_factory=dict)
    digests: str = ""
    prefix: str = ""

    def contents(self, files: Files) -> dict[str, bytes]:
        """The files beside the main one, by relative path; copies are read from ``files``. Raises: OSError."""
        return {**self.files, **{name: files.read(path) for name, path in self.copies.items()}}


class PackageFiles(Struct, frozen=True):
    """The files of a package that has not been written yet; a :class:`Files`."""

    package: Package
    behind: Files

    def find(self, uri: str) -> str | None:
        """The normalised relative name if the package has it."""
        prefix = f"{self.package.prefix}/"
        name = posixpath.normpath(uri.removeprefix(prefix) if self.package.prefix else uri)
        return name if name in self.package.files or name in self.package.copies else self.behind.find(uri)

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned. Raises: OSError."""
        if path in self.package.files:
            return self.package.files[path]
        return self.behind.read(self.package.copies.get(path, path))


class PlacedFiles(Struct, frozen=True):
    """The files of a mechanism that another file contained: what is not where it was lies where that file has it."""

    places: Mapping[str, str]
    behind: Files

    def find(self, uri: str) -> str | None:
        """The path of a file, first by its own name."""
        return self.behind.find(uri) or (self.behind.find(self.places[uri]) if uri in self.places else None)

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned. Raises: OSError."""
        return self.behind.read(path)


class OriginalFiles(Struct, frozen=True):
    """The files of a mechanism for which originals are kept, by their uris: these count, whatever else has their names."""

    originals: Mapping[str, str]
    behind: Files

    def find(self, uri: str) -> str | None:
        """The path of a file: that of the original, where one is kept."""
        return self.originals.get(uri) or self.behind.find(uri)

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned. Raises: OSError."""
        return self.behind.read(path)


def find_stand_in(files: Files, uri: str) -> str | None:
    """The path of the file that is kept, or that another file has, for one that is not where its uri leads; None where there is none."""
    own = files
    while isinstance(own, PlacedFiles | OriginalFiles):
        own = own.behind
    return None if own is files or own.find(uri) is not None else files.find(uri)


class ManyFiles(Struct, frozen=True):
    """The files around several descriptions: what the first ones do not find, the others do."""

    all: tuple[Files, ...]

    def find(self, uri: str) -> str | None:
        """The path of a file, of the first that finds it."""
        return next((path for files in self.all if (path := files.find(uri)) is not None), None)

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned. Raises: OSError."""
        for files in self.all[:-1]:
            with suppress(OSError):
                return files.read(path)
        return self.all[-1].read(path)


def file_stem(uri: str) -> str:
    """The name of a file without folders and suffix (``package://a/b/hip.stl``, ``a.usdz[b/hip.png]`` -> ``hip``); may be empty."""
    last = uri.replace("\\", "/").rstrip("/]").rpartition("/")[2]
    return last.rpartition(".")[0] or last


def suffix_of(path: str) -> str:
    """The suffix of a path in small letters, with its dot."""
    return posixpath.splitext(path.replace("\\", "/").rstrip("]"))[1].lower()
