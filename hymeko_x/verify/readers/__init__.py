"""The reference readers: each format through the library that defines it, never through this project's own frontends.

The table of formats names the module of each; it has ``read(path, lookup) -> KinematicModel``.
"""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x import codes, formats
from hymeko_x.assets import archives
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.extras import install_command

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from hymeko_x.source import Files
    from hymeko_x.verify.model import KinematicModel

_HEAD = 65536  # bytes of a file in which its root element is searched


class Lookup(Struct, frozen=True):
    """Where a robot's files are, and which of its choices are meant.

    ``packages`` are the user's own NAME=DIR, ``search_path`` the folders of further packages, ``arguments`` those of a file with macros,
    ``variants`` the selected variant of each variant set.
    """

    packages: Mapping[str, Path] = field(default_factory=dict)
    search_path: tuple[Path, ...] = ()
    arguments: Mapping[str, str] = field(default_factory=dict)
    variants: Mapping[str, str] = field(default_factory=dict)

    def files(self, folder: Path) -> Files:
        """The files that a robot in this folder may refer to."""
        return DiskFiles(folder, self.packages, self.search_path)


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """The robot in a file, as the format's reference engine sees it.

    Raises: Refusal HX001 (no such file), HX003 (no such format), HX301 (no engine), HX302 (the engine refuses the file).
    """
    if archives.is_archive(path.name) and path.is_file():
        path = Path(archives.main_file(str(path)))
    within = archives.inside(path)
    if within is not None and within.name in archives.names_in(within.archive):
        return _read_inside(within, lookup)
    if not path.is_file():
        raise refuse(codes.CANNOT_READ, f"there is no file '{path}'", Origin(str(path)))
    with path.open("rb") as file:
        format = formats.of_input(str(path), file.read(_HEAD))
    if format.reference is None:
        raise refuse(codes.ENGINE_MISSING, f"{format.name} has no reference reader", Origin(str(path)))
    try:
        found: KinematicModel = formats.loaded(format.reference).read(path, lookup)
    except ModuleNotFoundError as error:
        engine = (error.name or "").partition(".")[0]
        extra = format.libraries.get(engine)
        if extra is None:
            raise
        message = f"{format.name} is verified with {engine}, which is not installed"
        raise refuse(codes.ENGINE_MISSING, message, Origin(str(path)), hint=install_command(extra)) from error
    return found


def _read_inside(within: archives.Inside, lookup: Lookup) -> KinematicModel:
    """The robot in a file of an archive, which is unpacked meanwhile: few engines open archives. Raises: as :func:`read`."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            archives.unpack(Path(within.archive), Path(folder), archives.stays_inside)
        except (OSError, *archives.DAMAGED) as error:
            raise refuse(codes.CANNOT_READ, f"cannot be unpacked: {error}", Origin(within.archive)) from error
        return read(Path(folder, within.name), lookup)


@contextlib.contextmanager
def native_output() -> Iterator[Callable[[], str]]:
    """Captures what native code writes to standard output and error, where libraries put the reason that their exceptions leave out.

    Yields a function that returns the text. Python's own streams are flushed before and after, so that nothing else is lost.
    """
    with tempfile.TemporaryFile() as file, contextlib.ExitStack() as stack:
        sys.stdout.flush()
        sys.stderr.flush()
        for descriptor in (1, 2):
            kept = os.dup(descriptor)
            stack.callback(os.close, kept)
            stack.callback(os.dup2, kept, descriptor)
            os.dup2(file.fileno(), descriptor)

        def text() -> str:
            file.seek(0)
            return " ".join(file.read().decode("utf-8", "replace").split())

        yield text
