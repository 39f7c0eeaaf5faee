"""USD out as a zip package that holds the stage as a crate file.

Images stay beside the package: they are copied as files, whose bytes a backend does not see.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from pxr import Sdf

from hymeko_x.backends.usd.crate import write as write_crate
from hymeko_x.source import Package

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism


def write(mechanism: Mechanism, report: Report) -> Package:
    """The mechanism as a package, which passes through a temporary file like a crate."""
    crate = write_crate(mechanism, report)
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        inner, outer = Path(folder) / "stage.usdc", Path(folder) / "stage.usdz"
        inner.write_bytes(crate.main)
        with Sdf.ZipFileWriter.CreateNew(str(outer)) as package:
            package.AddFile(str(inner), inner.name)
        return Package(outer.read_bytes(), crate.files, crate.copies)
