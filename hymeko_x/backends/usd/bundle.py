"""USD out as a zip package that holds the stage as a crate file, or as several, and its images."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x.backends.usd.archive import unzipped, zipped
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
    return Package(zipped({_MAIN: crate.main, **crate.files}))


def enclose(package: Package, files: Mapping[str, bytes]) -> Package:
    """The package with the files in it that would lie beside it."""
    return replace(package, main=zipped(unzipped(package.main) | dict(files)))
