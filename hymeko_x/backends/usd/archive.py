"""Zip archives as USD wants them: files that are stored as they are, each at a place that a renderer can map into memory."""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from pxr import Sdf

if TYPE_CHECKING:
    from collections.abc import Mapping

_BEGINNING = (1980, 1, 1, 0, 0, 0, 0, 0, -1)
"""The date of every file, in whatever time zone, so that the same files make the same archive; a zip file knows none before it."""


def zipped(files: Mapping[str, bytes]) -> bytes:
    """Files as an archive in their order; they pass through a temporary folder, since USD writes archives of files on a disk only."""
    date = time.mktime(_BEGINNING)
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        outer = Path(folder) / "stage.usdz"
        with Sdf.ZipFileWriter.CreateNew(str(outer)) as archive:
            for number, (name, data) in enumerate(files.items()):
                inner = Path(folder) / f"{number}{Path(name).suffix}"
                inner.write_bytes(data)
                os.utime(inner, (date, date))
                archive.AddFile(str(inner), name)
        return outer.read_bytes()


def unzipped(data: bytes) -> dict[str, bytes]:
    """The files in an archive, in their order."""
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        path = Path(folder) / "stage.usdz"
        path.write_bytes(data)
        archive = Sdf.ZipFile.Open(str(path))
        return {name: archive.GetFile(name) for name in archive.GetFileNames()}
