"""Conversion within one format: the author's text as it is, but for the paths of files that moved; what it includes goes along."""

from __future__ import annotations

import os
import posixpath
import re
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes, formats, pipeline
from hymeko_x.assets.pack import Keep, keep_references
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.assets.shelf import Shelf
from hymeko_x.compare.diff import diff
from hymeko_x.compare.ledger import TOLERANCE
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.edits.text import PackagesBehind, text_with_edits
from hymeko_x.residue.align import align
from hymeko_x.source import Package, PackageFiles

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files, Source


def copied(
    source: Source, format: Format, mechanism: Mechanism, place: pipeline.OutputPlace, report: Report, *, kept: str = ""
) -> Package | None:
    """The package with the source's own text, for an output in another place; None where only a new text would be the same robot there.

    Nor is a text copied whose root is that of an older version of its format, as the reader has reported, or that would lose what is
    ``kept`` inside of it.

    The files that the text includes stand beside the output as they stand beside the source, if they are in its folder or below that, and
    else below the output; a package that is not found from there (``$(find arm_description)``) gives way to the paths of its files.
    """
    if any(diagnostic.code == codes.WRONG_ROOT for diagnostic in report):
        return None
    if _is_folder(os.path.dirname(source.name) or ".", place.folder):
        return Package(source.data)
    found, opened = Report(), tuple(source.files.opened) if isinstance(source.files, DiskFiles) else ()
    shelf = Shelf(place.assets or format.assets, place.folder, around=place.around, origin=source.name)
    placed = _placed(mechanism, format, shelf, source.files, found)
    there = replace(source.files, base=Path(place.folder)) if isinstance(source.files, DiskFiles) else DiskFiles(Path(place.folder))
    package = _with_text(source, format, mechanism, placed, Package(source.data, shelf.files, shelf.copies), opened, there)
    if package is None or not _is_same_robot(package, source, format, placed, there, kept):
        return None
    report.extend(found)
    return package


def _is_folder(a: str, b: str) -> bool:
    return os.path.realpath(a) == os.path.realpath(b)


def _placed(mechanism: Mechanism, format: Format, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    """The mechanism with the new paths of meshes and images that cannot stay."""
    if format.pack is not None and formats.native_format(mechanism) is format:
        placed: Mechanism = formats.loaded(format.pack)(mechanism, shelf, files, report)
        return placed
    return keep_references(mechanism, shelf, files, report, Keep.PACKAGES if shelf.mode == "reference" else Keep.PACKAGES_AND_PATHS)


def _with_text(
    source: Source, format: Format, before: Mechanism, after: Mechanism, package: Package, opened: Collection[str], there: DiskFiles
) -> Package | None:
    """The package with the text in which the paths are those of the mechanism ``after``, and with the files ``opened`` for reading it."""
    home = os.path.dirname(source.name) or "."
    changed: dict[str, bytes] = {}
    if after is not before:
        if format.outline is None:
            return None
        changed = text_with_edits(_with_placed(source, package), format, before, after, Report()).changed
    changed = {**changed, **_with_includes_below(source, changed, opened, there)}
    copies = {name: path for path in opened if (name := _below(path, home)) is not None and path not in changed}
    files = {_name_below(path, home): data for path, data in changed.items() if path != source.name}
    return replace(
        package, main=changed.get(source.name, source.data), files={**package.files, **files}, copies={**copies, **package.copies}
    )


def _with_placed(source: Source, package: Package) -> Source:
    """The source, around which the meshes and images of a package are already."""
    if not isinstance(source.files, DiskFiles):
        return source
    return replace(source, files=Elsewhere(source.files, PackageFiles(package, source.files), source.files))


def _with_includes_below(source: Source, changed: Mapping[str, bytes], opened: Iterable[str], there: DiskFiles) -> dict[str, bytes]:
    """The texts that include files which stand above their folder or beside it, and these, with paths to where they are put: below it."""
    suffix, home = os.path.splitext(source.name)[1], os.path.dirname(source.name) or "."
    texts = {source.name: changed.get(source.name, source.data)}
    texts |= {path: changed.get(path) or source.files.read(path) for path in opened if path.endswith(suffix)}
    moved: set[str] = set()
    for path in [path for path in texts if _below(path, home) is None]:
        old, new = (f'"{name}"'.encode() for name in (_relative(path, home), _name_below(path, home)))
        users = [user for user, text in texts.items() if old in text]
        for user in users:
            texts[user] = texts[user].replace(old, new)
        moved |= {path, *users} if users else set()
    for path, text in texts.items():
        texts[path], named = _without_packages(path, text, source, frozenset(opened), there)
        moved |= {path, *named} if named else set()
    return {path: texts.get(path) or source.files.read(path) for path in moved}


_IN_PACKAGE = re.compile(rb"\$\(find ([\w.-]+)\)(/[\w./-]+)")


def _without_packages(path: str, text: bytes, source: Source, opened: Collection[str], there: DiskFiles) -> tuple[bytes, set[str]]:
    """The text of a file in which opened files that it names by packages are named by where they are put, and these files.

    Packages that are found from the output as well stay.
    """
    home = os.path.dirname(source.name) or "."
    named: set[str] = set()

    def by_place(match: re.Match[bytes]) -> bytes:
        package, rest = (part.decode() for part in match.groups())
        folder = None
        if isinstance(source.files, DiskFiles) and there.find_package(package) is None:
            folder = source.files.find_package(package, path) or source.files.guess_package(package, path)
        file = None if folder is None else os.path.normpath(f"{folder}{rest}")
        if file is None or file not in opened:
            return match[0]
        named.add(file)
        return _relative(_name_below(file, home), os.path.dirname(_name_below(path, home)) or ".").encode()

    return (_IN_PACKAGE.sub(by_place, text) if b"$(find " in text else text), named


def _relative(path: str, home: str) -> str:
    return os.path.relpath(path, home).replace(os.sep, "/")


def _name_below(path: str, home: str) -> str:
    """The path below a folder at which a file is put that may stand above it."""
    return _below(path, home) or re.sub(r"^(\.\./)+", "", _relative(path, home))


def _below(path: str, home: str) -> str | None:
    """The path from a folder to a file in it or below it."""
    relative = _relative(path, home)
    return None if relative.startswith("../") or "[" in relative else relative


class Elsewhere(PackagesBehind, frozen=True):
    """The files around an output that is not on the disk yet, with the packages of its source; a :class:`hymeko_x.source.Files`."""

    package: PackageFiles
    around: DiskFiles

    def find(self, uri: str) -> str | None:
        """The path of a file: of the package, from the output's folder, or of what means the same from everywhere."""
        name = posixpath.normpath(uri)
        if name in self.package.package.files or name in self.package.package.copies:
            return name
        return self.behind.find(uri) if "://" in uri or os.path.isabs(uri) else self.around.find(uri)

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned. Raises: OSError."""
        return self.package.read(path)

    def find_package(self, name: str, beside: str = "") -> str | None:
        """The folder of a package that is found from where the output is, or None."""
        return self.around.find_package(name)

    def guess_package(self, name: str, beside: str = "") -> str | None:
        """No folder: where a package is guessed from tells nothing of where the output is read."""
        return None


def _is_same_robot(package: Package, source: Source, format: Format, mechanism: Mechanism, there: DiskFiles, kept: str) -> bool:
    """Whether the text is the robot where it is going to be, and holds what is kept inside of it."""
    files = Elsewhere(source.files, PackageFiles(package, source.files), there)
    try:
        name = os.path.join(there.base, os.path.basename(source.name))
        found, inside = pipeline.read_file(replace(source, name=name, data=package.main, files=files, kept=None), format, Report())
    except Refusal:
        return False
    return inside == kept and not diff(mechanism, align(found, mechanism)[1], TOLERANCE)
