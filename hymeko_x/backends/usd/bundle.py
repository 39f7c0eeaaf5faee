"""USD out as a zip package that holds the stage as a crate file, or as several, and its images."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pxr import Sdf

from hymeko_x.backends.usd.carrier import carry_in_zip as carry_residue
from hymeko_x.backends.usd.crate import write as write_crate
from hymeko_x.source import Package

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism

__all__ = ["carry_residue", "enclose", "write"]

_MAIN = "stage.usdc"


def write(mechanism: Mechanism, report: Report) -> Package:
    """The mechanism as a package, which passes through a temporary file like a crate. Its first file is the one to open."""
    crate = write_crate(mechanism, report)
    return Package(_zipped({_MAIN: crate.main, **crate.files}))


def enclose(package: Package, files: Mapping[str, bytes]) -> Package:
    """The package with the files in it that would lie beside it."""
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        old = Path(folder) / "old.usdz"
        old.write_bytes(package.main)
        inside = Sdf.ZipFile.Open(str(old))
        return replace(package, main=_zipped({name: inside.GetFile(name) for name in inside.GetFileNames()} | dict(files)))


def _zipped(files: Mapping[str, bytes]) -> bytes:
    """Files as a package in their order; it passes through a temporary folder like a crate."""
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        outer = Path(folder) / "stage.usdz"
        with Sdf.ZipFileWriter.CreateNew(str(outer)) as package:
            for name, data in files.items():
                inner = Path(folder) / "in" / name
                inner.parent.mkdir(parents=True, exist_ok=True)
                inner.write_bytes(data)
                package.AddFile(str(inner), name)
        return outer.read_bytes()
