"""The way home of edits: the text of a robot with the edits of its mechanism, and nothing else changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes, formats, pipeline
from hymeko_x.compare.diff import diff
from hymeko_x.compare.ledger import TOLERANCE
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.rewrite import Options, legalize
from hymeko_x.source import NoFiles, Source
from hymeko_x.update.merging import merged
from hymeko_x.update.splicing import Lines

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.outline import Block, Outline
    from hymeko_x.source import Files

_MOST_TRIES = 3
"""How often elements are replaced by their print before the whole text is."""


class EditedFiles(Struct, frozen=True):
    """Files of which some have another content; a :class:`hymeko_x.source.Files`."""

    changed: Mapping[str, bytes]
    behind: Files

    def find(self, uri: str) -> str | None:
        """The path of a file."""
        return self.behind.find(uri)

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned. Raises: OSError."""
        return self.changed[path] if path in self.changed else self.behind.read(path)


def text_with_edits(source: Source, format: Format, before: Mechanism, after: Mechanism, report: Report) -> dict[str, bytes]:
    """The files of a source that change when its mechanism ``before`` becomes ``after``, by their paths; its own under its name.

    What was written is read again and compared. Where it is not what was meant, the elements in question are replaced by their print, and
    at last the whole text; both are reported.

    Raises: Refusal when the format cannot represent the mechanism.
    """
    attempt = _Attempt(source, format, before, after, report)
    replaced: dict[Block, Id] = {}
    for _ in range(_MOST_TRIES):
        files = attempt.files(replaced)
        wrong = attempt.wrong(files)
        if wrong is None:
            _report_replaced(replaced.values(), source, report)
            return files
        more = None if wrong is _UNREADABLE else attempt.blocks_of(wrong)
        if more is None or more.keys() <= replaced.keys():
            break
        replaced |= more
    report.warn(codes.EDIT_REWRITTEN, f"the edits could not be placed in the text of '{source.name}', which is printed anew as a whole")
    return {source.name: attempt.whole}


def _report_replaced(elements: Iterable[Id], source: Source, report: Report) -> None:
    for key in dict.fromkeys(elements):
        report.note(codes.EDIT_REWRITTEN, f"{key} is printed anew in '{source.name}': its edit has no place in the author's text")


_UNREADABLE: frozenset[Id] = frozenset()


class _Attempt:
    """The outlines of the author's text and of the two prints, and the mechanism to be reached."""

    def __init__(self, source: Source, format: Format, before: Mechanism, after: Mechanism, report: Report) -> None:
        self.source, self.format = source, format
        printing = formats.by_name(format.expands_to) if format.expands_to else format
        outline = formats.loaded(printing.outline or "")
        self.own: Outline = formats.loaded(format.outline or "")(source, Report())
        self.whole = printed(after, printing, report)
        sources = [Source("<print>", text, source.files) for text in (printed(before, printing, Report()), self.whole)]
        self.before, self.after = (outline(print, Report()) for print in sources)
        self.goal = pipeline.reader(printing)(sources[1], Report()).mechanism

    def files(self, replaced: Mapping[Block, Id]) -> dict[str, bytes]:
        """The files that change."""
        places = {block.start for block in replaced}
        return {self.own.files[name].path: data for name, data in merged(self.own, self.before, self.after, places).items()}

    def wrong(self, files: Mapping[str, bytes]) -> frozenset[Id] | None:
        """The elements that are not what they should be; None when all are, and ``_UNREADABLE`` where the text cannot be read."""
        main = files.get(self.source.name, self.source.data)
        edited = replace(self.source, data=main, files=EditedFiles(files, self.source.files))
        try:
            found = pipeline.reader(self.format)(edited, Report()).mechanism
        except Refusal:
            return _UNREADABLE
        return frozenset(difference.element for difference in diff(self.goal, found, TOLERANCE)) or None

    def blocks_of(self, elements: Iterable[Id]) -> dict[Block, Id] | None:
        """The blocks of the later print that elements stand in; None where one has none."""
        lines = Lines(self.after.files[self.after.main].data)
        starts: dict[int, Block] = {}
        for block in self.after.root.walk():
            starts.setdefault(lines.of(block.start), block)
        found: dict[Block, Id] = {}
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


def printed(mechanism: Mechanism, format: Format, report: Report) -> bytes:
    """The text of a mechanism in a format, which refers to every file where it is."""
    legal = legalize(mechanism, format.name, Options(), report)
    return pipeline.writer(format)(legal, Options(), report).main
