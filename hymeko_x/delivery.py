"""From a mechanism to files on the disk: converted, and put where it overwrites nothing of another robot's."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes, disk, formats, pipeline
from hymeko_x.assets import archives
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.assets.shelf import safe_name
from hymeko_x.diagnostics import Report
from hymeko_x.edits.copying import copied
from hymeko_x.pipeline import Result
from hymeko_x.reporting.mark import marked
from hymeko_x.rewrite import Options
from hymeko_x.source import Kept, suffix_of

if TYPE_CHECKING:
    from hymeko_x.formats import Assets, Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.pipeline import OutputPlace
    from hymeko_x.source import Files, Package, Source


class Delivery(Struct, frozen=True):
    """A mechanism, and how and where its output goes; ``path`` is empty where only the main file is wanted.

    ``own`` is the source that the mechanism was read from as it is, if that is of the same format. ``passed`` is what was kept for its
    source and is passed on, as in :func:`hymeko_x.pipeline.convert`.
    """

    mechanism: Mechanism
    format: Format
    options: Options
    files: Files
    place: OutputPlace
    path: str
    own: Source | None = None
    passed: Kept | None = None

    def convert(self, report: Report, *, measured: bool = True) -> Result:
        """The result to write. Its files go below a folder named like the main file when those of another output are in the way.

        Without ``measured`` it is not read back. Raises: as :func:`hymeko_x.pipeline.convert`.
        """
        if self._follows():
            return replace(self, options=replace(self.options, keep="beside")).convert(report, measured=measured)
        package = self._copied(report)
        if package is not None and (self.is_archive or self._in_the_way(package, f"{safe_name(self.options.beside)}/") is None):
            kept = self.passed or Kept("", "")
            package = pipeline.with_kept(package, kept if kept.is_beside else kept._replace(text=""), self.options, report)
            return Result(self.mechanism, package, report, ())
        place = replace(self.place, in_the_way=self._in_the_way if self.path and not self.is_archive else None)
        result = pipeline.convert(
            self.mechanism, self.format, self.options, self.files, report, place, measured=measured, passed=self.passed
        )
        return replace(result, package=self._marked(result.package))

    def _marked(self, package: Package) -> Package:
        """A file begins with the comment that says what made it; a text in a pipe does not."""
        if not self.path:
            return package
        return replace(package, main=marked(package.main, self.format, self.mechanism.source.file))

    def _follows(self) -> bool:
        """Whether what is kept beside the source goes along without being asked for: the output, of the same format, needs it as much."""
        return self.options.keep is None and bool(self.path) and self.passed is not None and self.passed.is_beside

    def _copied(self, report: Report) -> Package | None:
        """The output with the source's own text, where that is the robot and holds neither more nor less than is to be kept."""
        if self.own is None or not self.path or replace(self.options, beside="", keep=None, lenient=False) != Options():
            return None
        if self.passed is not None and self.passed.text and self.passed.is_beside is (self.options.keep == "inside"):
            return None
        if not self.own.data.startswith(self.format.suffix_magic.get(suffix_of(self.path), b"")):
            return None
        inside = self.passed.text if self.passed is not None and not self.passed.is_beside else ""
        return copied(self.own, self.format, self.mechanism, self.place, report, kept=inside)

    def below(self, folder: str) -> Package:
        """The output with every file beside the main one below this folder, which ends in a slash. Raises: as :meth:`convert`."""
        options = replace(self.options, within=folder)
        result = pipeline.convert(self.mechanism, self.format, options, self.files, Report(), self.place, passed=self.passed)
        return self._marked(result.package)

    def put(self, result: Result) -> None:
        """Write what :meth:`convert` made, whole or not at all. Raises: Refusal HX002."""
        if self.is_archive:
            disk.write_archive(result.package, self.path, archives.main_name(self.format), self.files)
        else:
            disk.write_package(result.package, self.path, self.files, self.below, makes_folder=self.options.package_layout)

    @property
    def is_archive(self) -> bool:
        """Whether everything goes into one file."""
        return archives.is_archive(self.path)

    def _in_the_way(self, package: Package, folder: str) -> str | None:
        return disk.in_the_way(package, self.path, folder, self.files)


def place_of(path: str, assets: Assets | None) -> pipeline.OutputPlace:
    """The place of an output on the disk. An archive is a place of its own, in which nothing is but what is put there."""
    folder = os.path.dirname(path) or "."
    if archives.is_archive(path):
        return pipeline.OutputPlace(path, "pack")
    name = os.path.basename(os.path.abspath(folder))
    return pipeline.OutputPlace(folder, assets, name, package=disk.package_uri(folder), around=DiskFiles(Path(folder)))


def archive_suffix(format: Format) -> str:
    """The suffix of the archive with everything of a robot in this format: that of its own container where it has one (``.usdz``)."""
    own = next((row for row in formats.FORMATS if row.holds_files and row.family == format.family), None)
    return format.archive if own is None else own.suffixes[0]


def reason_against(path: str, assets: Assets | None, format: Format) -> str:
    """Why files cannot go where they are asked to go; empty where they can."""
    is_whole = format.holds_files or archives.is_archive(path)
    if assets == "pack" and not is_whole:
        return f"everything is packed into one file: name the output {Path(path).stem}{archive_suffix(format)}"
    if assets not in (None, "pack") and is_whole:
        return f"{path} holds the files that it refers to: they cannot be {'copied beside it' if assets == 'copy' else 'referred to'}"
    return ""


def unchanged(source: Source, from_format: Format, to_format: Format) -> Source | None:
    """The source, if an output of this format may have its text: the same format, read without choices of the user."""
    is_plain = not (source.arguments or source.environment or source.variants)
    return source if from_format is to_format and is_plain else None


def report_unwritten(package: Package, where: str, report: Report) -> None:
    """Warn of the files beside a main file that goes where they cannot go."""
    beside = [*package.files, *package.copies]
    if beside:
        names = ", ".join(beside[:3]) + (f" and {len(beside) - 3} more" if len(beside) > 3 else "")
        report.warn(codes.ASSET_NOT_WRITTEN, f"{where} cannot carry {names}", hint="-o FILE writes them beside the file")
