"""The reference readers: each format through the library that defines it, never through this project's own frontends."""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
import tempfile
from typing import TYPE_CHECKING, Protocol, cast

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Origin, refuse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from hymeko_x.source import Files
    from hymeko_x.verify.model import KinematicModel

READERS: Mapping[str, str] = {
    "urdf": "hymeko_x.verify.readers.urdf",
    "xacro": "hymeko_x.verify.readers.xacro",
    "mjcf": "hymeko_x.verify.readers.mjcf",
    "usd": "hymeko_x.verify.readers.usd",
    "sdf": "hymeko_x.verify.readers.sdf",
    "hymeko": "hymeko_x.verify.readers.hymeko",
}
"""The module that reads each format; each has ``read(path, places) -> KinematicModel``."""

EXTRAS: Mapping[str, str] = {
    "pinocchio": "pin",
    "mujoco": "mujoco",
    "pxr": "usd-core",
    "yourdfpy": "yourdfpy",
    "pydrake": "drake",
    "xacro": "xacro",
}
"""The package that installs each engine's module."""

_SUFFIXES: Mapping[str, str] = {
    ".urdf": "urdf",
    ".xacro": "xacro",
    ".mjcf": "mjcf",
    ".usd": "usd",
    ".usda": "usd",
    ".usdc": "usd",
    ".usdz": "usd",
    ".sdf": "sdf",
    ".world": "sdf",
    ".hymeko": "hymeko",
    ".himeko": "hymeko",
}
_ROOTS: Mapping[str, str] = {"mujoco": "mjcf", "mujocoinclude": "mjcf", "robot": "urdf", "sdf": "sdf"}


class Reader(Protocol):
    """What every module in :data:`READERS` offers."""

    def read(self, path: Path, places: Places) -> KinematicModel:
        """The robot that the format's own engine sees."""
        ...


class Places(Struct, frozen=True):
    """Where the files are that a robot refers to: the user's own NAME=DIR, the folders in which packages
    stand, the arguments of a xacro file, and the variants of a USD file."""

    packages: Mapping[str, Path] = field(default_factory=dict)
    search_path: tuple[Path, ...] = ()
    arguments: Mapping[str, str] = field(default_factory=dict)
    variants: Mapping[str, str] = field(default_factory=dict)

    def files(self, folder: Path) -> Files:
        """The files that a robot in this folder may refer to."""
        return DiskFiles(folder, self.packages, self.search_path)


NOWHERE = Places()


def read(path: Path, places: Places = NOWHERE, *, format: str | None = None) -> KinematicModel:
    """The robot in a file, as the format's reference engine sees it.

    Raises: Refusal HX001 (no such file), HX003 (no such format), HX301 (no engine), HX302 (the engine refuses the file).
    """
    if not path.is_file():
        raise refuse(codes.CANNOT_READ, f"there is no file '{path}'", Origin(str(path)))
    kind = format or format_of(path)
    try:
        module = cast("Reader", importlib.import_module(READERS[kind]))
        return module.read(path, places)
    except ModuleNotFoundError as error:
        engine = (error.name or "").partition(".")[0]
        package = EXTRAS.get(engine)
        if package is None:
            raise
        raise refuse(
            codes.ENGINE_MISSING,
            f"{kind} is verified with {engine}, which is not installed",
            Origin(str(path)),
            hint=f"pip install {package}",
        ) from error


def format_of(path: Path) -> str:
    """The format of a file, by its suffix, and for .xml by its root element.

    Raises: Refusal HX003.
    """
    known = _SUFFIXES.get(path.suffix.lower())
    if known is not None:
        return known
    kind = _ROOTS.get(_root_element(path))
    if kind is not None:
        return kind
    raise refuse(
        codes.UNKNOWN_FORMAT, f"the format of '{path}' is not known; known suffixes: {', '.join(sorted(_SUFFIXES))}", Origin(str(path))
    )


def _root_element(path: Path) -> str:
    """The name of the first element in an XML file, by a look at its beginning; "" when there is none."""
    with path.open("rb") as file:
        text = file.read(65536).decode("utf-8", "replace")
    while True:
        _, found, text = text.partition("<")
        if not found:
            return ""
        if text.startswith("!--"):
            text = text.partition("-->")[2]
        elif not text.startswith(("?", "!")):
            return text.replace(">", " ").replace("/", " ").split()[0] if text.split() else ""


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
