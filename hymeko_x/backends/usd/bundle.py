"""USD as a zip package that holds the stage as a crate file, or as several, and its images."""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from pxr import Sdf

from hymeko_x.backends.usd.crate import write as write_crate
from hymeko_x.backends.usd.layers import crate_with_residue
from hymeko_x.source import Package

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options

_MAIN = "stage.usdc"


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The mechanism as a package, which passes through a temporary file like a crate. Its first file is the one to open."""
    crate = write_crate(mechanism, options, report)
    return _packed({_MAIN: crate.main, **crate.files})


def _packed(files: Mapping[str, bytes]) -> Package:
    """The files in one archive, which takes more of them in, and contains a residue in the first one."""
    return Package(
        zipped(files),
        with_residue=lambda residue: zipped({**files, _MAIN: crate_with_residue(files[_MAIN], residue)}),
        enclose=lambda others: _packed({**files, **others}),
    )


_BEGINNING = (1980, 1, 1, 0, 0, 0, 0, 0, -1)
"""The date of every file, in any time zone, so that the same files make the same archive; the earliest of the zip format."""


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
