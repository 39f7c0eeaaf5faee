"""Unpacking an archive from strangers: nothing leaves the target folder, and nothing grows without bound."""

from __future__ import annotations

import shutil
import stat
import zipfile
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Callable

MOST_BYTES = 4 * 2**30
MOST_MEMBERS = 200_000


def unpack(archive: Path, folder: Path, wants: Callable[[str], bool]) -> None:
    """Unpack the members of a zip file that are wanted into a new folder.

    Raises: Refusal HX212 when a member would land outside the folder or is a link, HX007 when there is too much;
    zipfile.BadZipFile when the archive is damaged.
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
        if not is_inside(member.filename) or stat.S_ISLNK(member.external_attr >> 16):
            raise refuse(codes.PACKAGE_DAMAGED, f"{archive} holds '{member.filename}', which would leave the folder")
    total = sum(member.file_size for member in members)
    if total > MOST_BYTES or len(members) > MOST_MEMBERS:
        raise refuse(
            codes.TOO_LARGE, f"{archive} unpacks to {len(members)} files, {total} bytes; allowed: {MOST_MEMBERS} files, {MOST_BYTES} bytes"
        )


def is_inside(name: str) -> bool:
    """Whether a member's name stays below the folder that it is unpacked into, on every platform."""
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts and "\\" not in name and ":" not in name
