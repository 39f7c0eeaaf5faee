"""The reference readers: each format through the library that defines it, never through this project's own frontends.

The table of formats names the module of each; it has ``read(path, lookup) -> KinematicModel``.
"""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from hymeko_x import codes, formats
from hymeko_x.assets import archives
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.extras import install_command
from hymeko_x.verify.readers import apart
from hymeko_x.verify.readers.bounded import bounded_memory

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.formats import Format
    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.readers.lookup import Lookup

T = TypeVar("T")

_HEAD = 65536  # bytes of a file in which its root element is searched


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
        return _read_with(format, format.reference, path, lookup)
    except ModuleNotFoundError as error:
        engine = (error.name or "").partition(".")[0]
        extra = format.libraries.get(engine)
        if extra is None:
            raise
        message = f"{format.name} is verified with {engine}, which is not installed"
        raise refuse(codes.ENGINE_MISSING, message, Origin(str(path)), hint=install_command(extra)) from error


def _read_with(format: Format, reader: str, path: Path, lookup: Lookup) -> KinematicModel:
    """The robot in a file, by the reader of its format. Raises: ModuleNotFoundError."""
    if format.crashing_engine is None:
        found: KinematicModel = formats.loaded(reader).read(path, lookup)
        return found
    if find_spec(format.crashing_engine) is None:
        raise ModuleNotFoundError(name=format.crashing_engine)
    return apart.read(reader, format.crashing_engine, path, lookup)


def _read_inside(within: archives.Inside, lookup: Lookup) -> KinematicModel:
    """The robot in a file of an archive, which is unpacked meanwhile: few engines open archives. Raises: as :func:`read`."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            archives.unpack(Path(within.archive), Path(folder), archives.stays_inside)
        except (OSError, *archives.DAMAGED) as error:
            raise refuse(codes.CANNOT_READ, f"cannot be unpacked: {error}", Origin(within.archive)) from error
        return read(Path(folder, within.name), lookup)


def in_own_thread(call: Callable[[], T]) -> T:
    """Returns and raises what ``call`` does, from a thread of its own and within the bound on memory.

    MuJoCo 4.0's bindings leave their handler of warnings in the thread in which a model makes them raise `Caught an unknown exception!`:
    the next warning about a file in that thread never ends.
    """
    with bounded_memory, ThreadPoolExecutor(1) as pool:
        return pool.submit(call).result()


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
