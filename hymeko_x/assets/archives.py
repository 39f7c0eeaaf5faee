"""Archives: a robot with all its files in one zip, which is read like a folder: ``robot.mjz/model.xml`` is a file in one."""

from __future__ import annotations

import errno
import io
import os
import shutil
import stat
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import IO, TYPE_CHECKING, NamedTuple

from hymeko_x import codes, formats
from hymeko_x.diagnostics import Origin, Refusal, refuse
from hymeko_x.source import KEPT_SUFFIX

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

DAMAGED = (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, ValueError)
"""The exceptions of `zipfile` for archives that are damaged, encrypted or of an unknown kind."""
MOST_BYTES = 2**30
"""So large may be a file that is read from an archive."""
MOST_UNPACKED = 4 * 2**30
MOST_MEMBERS = 200_000
"""So many bytes, and files, may be unpacked from one archive."""
_STEM = "model"
"""The name of the main file without its suffix: engines find it whatever the archive is called."""
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The time of all files in an archive, so that equal robots are equal archives."""


class Inside(NamedTuple):
    """A file in an archive: the archive's path, and the name in it."""

    archive: str
    name: str


def is_archive(path: str) -> bool:
    """Whether the suffix is that of an archive."""
    return path.lower().endswith(formats.archive_suffixes())


def inside(place: str | Path) -> Inside | None:
    """The archive on the disk through which a path leads, and the name in it; None where there is none."""
    text = str(place).lower()
    if not any(suffix in text for suffix in formats.archive_suffixes()):
        return None
    path = Path(place)
    above = next((folder for folder in path.parents if is_archive(folder.name) and folder.is_file()), None)
    return None if above is None else Inside(str(above), os.path.normpath(path.relative_to(above)).replace(os.sep, "/"))


def names_in(archive: str) -> frozenset[str]:
    """The files in an archive; none where it is damaged."""
    try:
        with zipfile.ZipFile(archive) as opened:
            return frozenset(opened.namelist())
    except (zipfile.BadZipFile, OSError):
        return frozenset()


def read_inside(archive: str | IO[bytes], name: str) -> bytes:
    """The content of a file in an archive. Raises: OSError when the file is not there, damaged or too large."""
    try:
        with zipfile.ZipFile(archive) as opened:
            if opened.getinfo(name).file_size > MOST_BYTES:
                raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), name)
            return opened.read(name)
    except (KeyError, *DAMAGED) as error:
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), name) from error


# ---- the robot of an archive ------------------------------------------------------------------------------------------------------


def main_name(format: formats.Format) -> str:
    """The name of the main file in an archive with a robot in this format."""
    return f"{_STEM}{format.suffixes[0]}"


def main_file(archive: str) -> str:
    """The path of the robot in an archive: called like that or ``model``, beside or in a folder of its name; else the only one there is.

    Raises: Refusal HX001 where there is no robot, or several.
    """
    names = sorted(names_in(archive), key=lambda name: (name.count("/"), name))
    stem = Path(archive).name.split(".")[0]
    for wanted in (stem, _STEM, f"{stem}/{stem}"):
        called = [name for name in names if os.path.splitext(name)[0] == wanted and _is_robot(archive, name)]
        if called:
            return f"{archive}/{called[0]}"
    robots = [name for name in names if _is_robot(archive, name)]
    highest = [name for name in robots if name.count("/") == robots[0].count("/")]
    if len(highest) == 1:
        return f"{archive}/{highest[0]}"
    if not highest:
        raise refuse(codes.CANNOT_READ, "the archive has no file of a robot, or is damaged", Origin(archive))
    message, hint = f"the archive has several robots: {', '.join(highest[:5])}", f"{archive}/{highest[0]} names one"
    raise refuse(codes.CANNOT_READ, message, Origin(archive), hint=hint)


def _is_robot(archive: str, name: str) -> bool:
    """Whether a file in an archive is one of a robot: by its suffix, or by its content where others have the suffix too."""
    row = None if name.endswith(KEPT_SUFFIX) else formats.of_file(name)
    if row is None or not row.shared_suffixes:
        return row is not None
    try:
        formats.of_input(name, read_inside(archive, name))
    except (Refusal, OSError):
        return False
    return True


# ---- whole archives ---------------------------------------------------------------------------------------------------------------


def packed(contents: Iterable[tuple[str, bytes]]) -> bytes:
    """An archive of these files, in their order. Equal files are an equal archive, whenever it was made."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents:
            info = zipfile.ZipInfo(name, _EPOCH)
            info.external_attr = 0o644 << 16
            archive.writestr(info, content, zipfile.ZIP_DEFLATED)
    return data.getvalue()


def unpack(archive: Path, folder: Path, wants: Callable[[str], bool]) -> None:
    """Unpack the members of a zip file that are wanted into a new folder.

    Raises: Refusal HX212 when a member would land outside the folder or is a link, HX007 when there is too much;
    one of DAMAGED when the archive is.
    """
    with zipfile.ZipFile(archive) as zipped:
        members = [member for member in zipped.infolist() if not member.is_dir() and wants(member.filename)]
        check_members(archive.name, members)
        for member in members:
            target = folder / member.filename
            target.parent.mkdir(parents=True, exist_ok=True)
            with zipped.open(member) as packed, target.open("wb") as file:
                shutil.copyfileobj(packed, file, 2**20)


def check_members(archive: str, members: list[zipfile.ZipInfo]) -> None:
    """Look at every name and size before anything is written. (Reading stops at the declared size, so that cannot lie.)"""
    for member in members:
        if not stays_inside(member.filename) or stat.S_ISLNK(member.external_attr >> 16):
            raise refuse(codes.PACKAGE_DAMAGED, f"{archive} holds '{member.filename}', which would leave the folder")
    total = sum(member.file_size for member in members)
    if total > MOST_UNPACKED or len(members) > MOST_MEMBERS:
        allowed = f"{MOST_MEMBERS} files, {MOST_UNPACKED} bytes"
        raise refuse(codes.TOO_LARGE, f"{archive} unpacks to {len(members)} files, {total} bytes; allowed: {allowed}")


def stays_inside(name: str) -> bool:
    """Whether a member's name stays below the folder that it is unpacked into, on every platform."""
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts and "\\" not in name and ":" not in name
