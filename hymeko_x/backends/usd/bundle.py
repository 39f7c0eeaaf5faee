"""USD out as a zip package that holds the stage as a crate file, or as several.

Images stay beside the package: they are copied as files, whose bytes a backend does not see.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from pxr import Sdf

from hymeko_x.backends.usd.carrier import carry_in_zip as carry_residue
from hymeko_x.backends.usd.crate import write as write_crate
from hymeko_x.source import Package

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism

__all__ = ["carry_residue", "write"]

_MAIN = "stage.usdc"


def write(mechanism: Mechanism, report: Report) -> Package:
    """The mechanism as a package, which passes through a temporary file like a crate. Its first file is the one to open."""
    crate = write_crate(mechanism, report)
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        outer = Path(folder) / "stage.usdz"
        with Sdf.ZipFileWriter.CreateNew(str(outer)) as package:
            for name, data in ((_MAIN, crate.main), *crate.files.items()):
                inner = Path(folder) / "in" / name
                inner.parent.mkdir(parents=True, exist_ok=True)
                inner.write_bytes(data)
                package.AddFile(str(inner), name)
        return Package(outer.read_bytes())
