"""New names of elements in files of other formats: what `update` would change in the author's text."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

from lsprotocol import types
from msgspec.structs import replace

from hymeko_x import pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.edits.text import text_with_edits
from hymeko_x.ir.mechanism import WORLD, Id
from hymeko_x.ir.names import rename
from hymeko_x.server.text import TextPlaces
from hymeko_x.source import Source

if TYPE_CHECKING:
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.server.analysis import Analysis

_VALUE = re.compile(r"""([\w:.-]+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_QUOTES = {'"': "&quot;", "'": "&apos;"}
_KINDS = {"joint": "joint", "joint1": "joint", "link": "body", "body": "body", "body1": "body", "body2": "body"}
"""The kind of the element that an attribute or a node refers to."""


def rename_element(document: Analysis, position: types.Position, name: str) -> dict[str, list[types.TextEdit]] | str:
    """The edits, by uri, that give the element at a position another name; a text where it cannot have it."""
    source = Source(document.path, document.text.encode("utf-8", "surrogatepass"), DiskFiles(Path(document.path).parent))
    assert document.format is not None
    try:
        before = pipeline.read(source, document.format, Report(), lenient=True)
        found = _element(document, before, document.places.offset(position))
        if isinstance(found, str):
            return found
        new = Id(found.kind, name)
        if new in before.graph:
            return f"there is a {found.kind} '{name}' already"
        return _edits(source, document.format, before, rename(before, {found: new}), (found.name, name))
    except Refusal as refusal:
        return str(refusal.diagnostic.message)


def _edits(
    source: Source, format: Format, before: Mechanism, after: Mechanism, names: tuple[str, str]
) -> dict[str, list[types.TextEdit]] | str:
    """The edits between two mechanisms: of the places where the name is written out, where these are all, else as `update` finds them."""
    text = source.data.decode()
    literal = _written_out(text, *names)
    if _reads_as(replace(source, data=literal.encode()), format, after):
        return {_uri(source.name): edits_between(text, literal)}
    found = text_with_edits(source, format, before, after, Report())
    if found.printed or found.is_whole:
        return f"'{names[0]}' stands in the text in more places than where it is written out, in a macro for example"
    return {
        _uri(path): edits_between(text if path == source.name else Path(path).read_text("utf-8"), data.decode())
        for path, data in found.changed.items()
    }


def _written_out(text: str, old: str, new: str) -> str:
    """The text with the new name as each value of an attribute that is the old one."""
    return re.sub(rf"""(=\s*)(["']){re.escape(old)}\2""", lambda found: found[1] + found[2] + escape(new, _QUOTES) + found[2], text)


def _reads_as(source: Source, format: Format, robot: Mechanism) -> bool:
    try:
        return pipeline.read(source, format, Report(), lenient=True) == robot
    except Refusal:
        return False


def _element(document: Analysis, robot: Mechanism, offset: int) -> Id | str:
    """The element whose name the attribute at an offset has; a text where there is none, or more than one."""
    attribute = next((found for found in _VALUE.finditer(document.text) if found.start() <= offset <= found.end()), None)
    name = "" if attribute is None else attribute[2] or attribute[3] or ""
    known = [Id(kind, name) for kind in {key.kind for table in (robot.graph.vertices, robot.graph.edges) for key in table}]
    known = [key for key in known if key in robot.graph and key != WORLD]
    if attribute is None or not known:
        return "there is no name of an element here"
    node = document.text.rfind("<", 0, offset)
    line = document.text.count("\n", 0, node) + 1
    here = [key for key in known if attribute[1] == "name" and (origin := robot.origins.get(key)) is not None and origin.line == line]
    meant = [key for key in known if key.kind == _KINDS.get(attribute[1])]
    found = here or meant or known
    return found[0] if len(found) == 1 else f"'{name}' is the name of {' and '.join(f'a {key.kind}' for key in found)}"


def _uri(path: str) -> str:
    return Path(path).resolve().as_uri()


def edits_between(old: str, new: str) -> list[types.TextEdit]:
    """The edits that make one text another: each line that differs, or all of it where their numbers differ."""
    if old.count("\n") != new.count("\n"):
        return [types.TextEdit(TextPlaces(old).range(0, len(old)), new)]
    places, start, found = TextPlaces(old), 0, []
    for before, after in zip(old.split("\n"), new.split("\n"), strict=True):
        if before != after:
            found.append(types.TextEdit(places.range(start, start + len(before)), after))
        start += len(before) + 1
    return found
