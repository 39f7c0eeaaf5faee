"""The text of a robot with the edits of its mechanism, and nothing else changed."""

from __future__ import annotations

import os
import posixpath
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.compare.diff import diff
from hymeko_x.compare.ledger import TOLERANCE
from hymeko_x.diagnostics import Origin, Refusal, Report, listed
from hymeko_x.edits.expanded import written_blocks
from hymeko_x.edits.merging import merged
from hymeko_x.edits.overrides import with_overrides
from hymeko_x.edits.splicing import ByteLines
from hymeko_x.ir.names import rename
from hymeko_x.residue.pairing import other_names, reordered_shapes
from hymeko_x.rewrite import Options, legalize
from hymeko_x.source import Source
from hymeko_x.xml.unread import COMMENT

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.compare.diff import Difference
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.outline import Outline, OutlineBlock
    from hymeko_x.source import Files, Package

_MOST_TRIES = 3
"""How often elements are replaced by their print before the whole text is."""


class Texts(NamedTuple):
    """Texts that changed, by their paths, the main one by the name of its source; and new files beside the main one.

    ``missing`` are imported elements whose edits have no place in the text, ``fault`` that in words; ``printed`` are elements that are
    printed anew, and ``is_whole`` says that the whole text is.
    """

    changed: dict[str, bytes]
    beside: Mapping[str, bytes]
    missing: frozenset[Id] = frozenset()
    fault: str = ""
    printed: frozenset[Id] = frozenset()
    is_whole: bool = False

    def report_printed(self, source: Source, report: Report) -> None:
        """Report what is printed anew in the text of a source."""
        for key in sorted(self.printed):
            report.note(codes.EDIT_REWRITTEN, f"{key} is printed anew in '{source.name}': its edit has no place in the author's text")
        if self.is_whole:
            message = f"the edits could not be placed in the text of '{source.name}', which is printed anew as a whole"
            report.warn(codes.EDIT_REWRITTEN, message)

    def report_missing(self, source: Source, report: Report) -> None:
        """Warn of the edits that have no place in the text of a source."""
        if self.fault:
            report.warn(codes.EDIT_DROPPED, self.fault, Origin(source.name))


class PackagesBehind(Struct, frozen=True):
    """Finds packages among the files behind it, if those know packages."""

    behind: Files

    def find_package(self, name: str, beside: str = "") -> str | None:
        """The folder of a package, or None."""
        return self.behind.find_package(name, beside) if isinstance(self.behind, DiskFiles | PackagesBehind) else None

    def guess_package(self, name: str, beside: str = "") -> str | None:
        """A folder that may be the package under another name, or None."""
        return self.behind.guess_package(name, beside) if isinstance(self.behind, DiskFiles | PackagesBehind) else None

    def match(self, pattern: str) -> list[str]:
        """The files that a path with wildcards names."""
        return self.behind.match(pattern) if isinstance(self.behind, DiskFiles | PackagesBehind) else []


def with_new_files(source: Source, beside: Mapping[str, bytes]) -> Source:
    """The source with new files, by their paths beside it."""
    folder = os.path.dirname(source.name)
    return replace(source, files=EditedFiles(source.files, {os.path.join(folder, name): data for name, data in beside.items()}, folder))


class EditedFiles(PackagesBehind, frozen=True):
    """Files of which some have another content; a :class:`hymeko_x.source.Files` that knows packages if those behind it do."""

    changed: Mapping[str, bytes]
    folder: str = ""
    """Where the files stand that are new."""

    def find(self, uri: str) -> str | None:
        """The path of a file."""
        path = os.path.join(self.folder, uri)
        return self.behind.find(uri) or (path if path in self.changed else None)

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned. Raises: OSError."""
        return self.changed[path] if path in self.changed else self.behind.read(path)


def text_with_edits(source: Source, format: Format, before: Mechanism, after: Mechanism, report: Report) -> Texts:
    """The files of a source that change when its mechanism ``before`` becomes ``after``.

    What was written is read again and compared. Where it is not what was meant, the elements in question are replaced by their print, and
    at last the whole text.

    Raises: Refusal when the format cannot represent the mechanism.
    """
    attempt = _Attempt(source, format, before, after, report)
    companion = _companion_with_edits(source, format, before, after)
    replaced: dict[OutlineBlock, Id] = {}
    for _ in range(_MOST_TRIES):
        files = attempt.files(replaced)
        wrong = attempt.wrong(files)
        if wrong is None:
            return Texts({**files, **companion}, attempt.beside, printed=frozenset(replaced.values()))
        if wrong is not _UNREADABLE and attempt.imported.issuperset(wrong):
            names = listed(sorted(map(str, wrong)), _MOST_NAMES)
            fault = f"edits have no place in the text, which imports what they change: {names}"
            return Texts({**files, **companion}, attempt.beside, wrong, fault)
        more = None if wrong is _UNREADABLE or attempt.imported else attempt.blocks_of(wrong)
        if more is None or more.keys() <= replaced.keys():
            break
        replaced |= more
    if attempt.imported:
        missing = frozenset(difference.element for difference in diff(before, after, TOLERANCE))
        return Texts({}, {}, missing, "the edits have no place in the text, which imports robots of other files")
    return Texts({source.name: attempt.whole, **companion}, attempt.beside, is_whole=True)


def _companion_with_edits(source: Source, format: Format, before: Mechanism, after: Mechanism) -> dict[str, bytes]:
    """The file that is read with a source (SRDF), if it changes."""
    stem = posixpath.splitext(os.path.basename(source.name))[0]
    path = next((path for suffix in format.companions if (path := source.files.find(f"{stem}{suffix}")) is not None), None)
    if path is None or format.companion is None:
        return {}
    write, outline = formats.loaded(format.companion), formats.loaded(format.outline or "")
    names = {old: new for new, old in other_names(after, before).items()}
    prints = write(before, {}), write(after, names)
    if prints[0] == prints[1] or not all(prints):
        return {}
    own, old, new = (outline(Source(path, data), Report()) for data in (source.files.read(path), *prints))
    return {own.files[name].path: data for name, data in merged(own, old, new).items()}


_MOST_NAMES = 5
_UNREADABLE: frozenset[Id] = frozenset()


class _Attempt:
    """The outlines of the author's text and of the two prints, and the mechanism to be reached."""

    def __init__(self, source: Source, format: Format, before: Mechanism, after: Mechanism, report: Report) -> None:
        self.source, self.format = source, format
        printing = formats.by_name(format.expands_to) if format.expands_to else format
        outline = formats.loaded(printing.outline or "")
        own = Report()
        pipeline.read_file(source, format, own)
        self.errors = len(own.errors(0))
        self.own: Outline = formats.loaded(format.outline or "")(source, Report())
        self.written = written_blocks(self.own, before) if format.expands_to else {}
        package = printed(after, format, report)
        self.whole, self.beside = package.main, package.files
        sources = [Source(source.name, printed(robot, printing, Report(), flat=True).main, source.files) for robot in (before, after)]
        self.before, self.after = (outline(print, Report()) for print in sources)
        if format.imports is not None:
            texts = with_overrides(self.own, self.before, self.after)
            self.before, self.after = (outline(Source(source.name, text, source.files), Report()) for text in texts)
        self.imported = imported(source, format, before)
        image, self.goal = (pipeline.reader(printing)(print, Report()).mechanism for print in sources)
        names = {old: new for new, old in other_names(after, before).items()}
        self.unprinted = {(names.get(edit.element, edit.element), edit.field) for edit in diff(before, image, TOLERANCE)}

    def files(self, replaced: Mapping[OutlineBlock, Id]) -> dict[str, bytes]:
        """The files that change."""
        places = {block.start for block in replaced}
        return {self.own.files[name].path: data for name, data in merged(self.own, self.before, self.after, places, self.written).items()}

    def wrong(self, files: Mapping[str, bytes]) -> frozenset[Id] | None:
        """The elements that are not what they should be; None when all are, and ``_UNREADABLE`` where the text cannot be read.

        The author's text may have the shapes of a body in another order than a print.
        """
        main = files.get(self.source.name, self.source.data)
        edited = replace(self.source, data=main, files=EditedFiles(self.source.files, files))
        report = Report()
        try:
            found = pipeline.read_file(edited, self.format, report).mechanism
            found = rename(found, reordered_shapes(found, self.goal))
        except Refusal:
            return _UNREADABLE
        if len(report.errors(0)) > self.errors:
            return _UNREADABLE
        return frozenset(difference.element for difference in diff(self.goal, found, TOLERANCE) if self._counts(difference)) or None

    def _counts(self, difference: Difference) -> bool:
        """Whether a difference is none of comments, nor one that printing makes without any edit."""
        is_comment = difference.field.startswith(f"{COMMENT} ")
        return not is_comment and (difference.element, difference.field) not in self.unprinted

    def blocks_of(self, elements: Iterable[Id]) -> dict[OutlineBlock, Id] | None:
        """The blocks of the later print that elements stand in; None where one has none."""
        lines = ByteLines(self.after.files[self.after.main].data)
        starts: dict[int, OutlineBlock] = {}
        for block in self.after.root.walk():
            starts.setdefault(lines.of(block.start), block)
        found: dict[OutlineBlock, Id] = {}
        for key in elements:
            block = next((starts[line] for line in self._lines(key) if line in starts), None)
            if block is None or block.parent is None:
                return None
            found[block] = key
        return found

    def _lines(self, key: Id) -> Iterable[int]:
        """The lines of an element in the later print; of an edge without one of its own, those of what it connects."""
        keys = [key]
        edge = self.goal.graph.edges.get(key)
        if edge is not None:
            keys += [arc.target for arc in reversed(edge.arcs)]
        origins = (self.goal.origin(each) for each in keys)
        return [origin.line for origin in origins if origin is not None and origin.line is not None]


def imported(source: Source, format: Format, mechanism: Mechanism) -> frozenset[Id]:
    """The elements of a text's mechanism that stand in other files, which edits of the text leave as they are."""
    if format.imports is None:
        return frozenset()
    origins = ((key, mechanism.origin(key)) for key in (*mechanism.graph.vertices, *mechanism.graph.edges))
    return frozenset(key for key, origin in origins if origin is not None and origin.file != source.name)


def printed(mechanism: Mechanism, format: Format, report: Report, *, flat: bool = False) -> Package:
    """The text of a mechanism in a format, which refers to every file where it is; ``flat`` as the format's row has it."""
    legal = legalize(mechanism, format.name, report)
    write: pipeline.Writer = formats.loaded(format.flat) if flat and format.flat else pipeline.writer(format)
    return write(legal, Options(), report)
