"""From a mechanism to files on the disk: converted, and put where it overwrites nothing of another robot's."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes, disk, pipeline
from hymeko_x.assets.shelf import safe_name
from hymeko_x.diagnostics import Report

if TYPE_CHECKING:
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.pipeline import Place, Result
    from hymeko_x.rewrite import Options
    from hymeko_x.source import Files


class Delivery(Struct, frozen=True):
    """A mechanism, and how and where its output goes; ``path`` is empty where only the main file is wanted."""

    mechanism: Mechanism
    format: Format
    options: Options
    files: Files
    place: Place
    path: str

    def convert(self, report: Report, *, measured: bool = True) -> Result:
        """What is to be written. Its assets go below a folder named like the main file when those of another output are in the way.

        Raises: as :func:`hymeko_x.pipeline.convert`.
        """
        result = self._converted(self.options, report, measured=measured)
        folder = f"{safe_name(self.options.beside)}/"
        other = disk.in_the_way(result.package, self.path, folder, self.files) if self.path else None
        if other is None:
            return result
        report.note(codes.ASSETS_APART, f"'{other}' beside the output has another content and stays; files of this output go to '{folder}'")
        return replace(self.below(folder, measured=measured), report=report)

    def below(self, folder: str, *, measured: bool = True) -> Result:
        """The same with every file beside the main one below this folder, which ends in a slash. Raises: as :meth:`convert`."""
        return self._converted(replace(self.options, within=folder), Report(), measured=measured)

    def put(self, result: Result) -> None:
        """Write what :meth:`convert` made, whole or not at all. Raises: Refusal HX002."""
        disk.write_package(result.package, self.path, self.files, lambda folder: self.below(folder).package)

    def _converted(self, options: Options, report: Report, *, measured: bool) -> Result:
        if measured:
            return pipeline.convert(self.mechanism, self.format, options, self.files, report, self.place)
        package = pipeline.write(self.mechanism, self.format, options, self.files, report, self.place)
        return pipeline.Result(self.mechanism, package, report, None)
