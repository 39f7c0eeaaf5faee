"""From a mechanism to files on the disk: converted, and put where it overwrites nothing of another robot's."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import codes, disk, pipeline
from hymeko_x.assets.shelf import safe_name
from hymeko_x.diagnostics import Report

if TYPE_CHECKING:
    from hymeko_x.formats import Format
    from hymeko_x.ir.legalize import Options
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.pipeline import Place, Result
    from hymeko_x.source import Files, Package


@dataclass(frozen=True, slots=True)
class Delivery:
    """A mechanism, and how and where its output goes; ``path`` is None where only the main file is wanted."""

    mechanism: Mechanism
    format: Format
    options: Options
    files: Files
    place: Place
    path: str | None

    def convert(self, report: Report, *, measured: bool = True) -> Result:
        """What is to be written. Its assets go below a folder named like the main file when those of another output are in the way.

        Raises: as :func:`hymeko_x.pipeline.convert`.
        """
        result = self._converted(report, measured=measured)
        folder = f"{safe_name(Path(self.path or '').stem)}/"
        other = disk.in_the_way(result.package, self.path, folder, self.files) if self.path else None
        if other is None:
            return result
        report.note(codes.ASSETS_APART, f"'{other}' beside the output has another content and stays; files of this output go to '{folder}'")
        apart = replace(self, options=replace(self.options, within=folder))
        return replace(apart._converted(Report(), measured=measured), report=report)

    def put(self, result: Result) -> None:
        """Write what :meth:`convert` made, whole or not at all. Raises: Refusal HX002."""
        disk.write_package(result.package, os.fspath(self.path or ""), self.files, self._within)

    def _converted(self, report: Report, *, measured: bool) -> Result:
        make = pipeline.convert if measured else pipeline.write_unmeasured
        return make(self.mechanism, self.format, self.options, self.files, report, self.place)

    def _within(self, folder: str) -> Package:
        return pipeline.within(folder, self.mechanism, self.format, self.options, self.files, self.place)
