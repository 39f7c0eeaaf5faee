"""References over imports: the texts that import a text, and the places in all of them that mean one name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from lsprotocol import types

from hymeko_x import formats
from hymeko_x.language.printer import print_name
from hymeko_x.server import answers
from hymeko_x.server.analysis import Analysis, analyse, path_of
from hymeko_x.server.text import NodeDefinition, word_at, words

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_MOST_FILES = 200
"""How many files of a folder are asked whether they import a text."""


class Workspace:
    """The HyMeKo texts around a document: those that are open as their editors have them, the others as they are on the disk."""

    def __init__(self, opened: Mapping[str, Analysis]) -> None:
        self._known = {Path(path_of(uri)).resolve(): document for uri, document in opened.items()}

    def text(self, path: Path) -> Analysis | None:
        """The text at a path; None for a file of another format, or where there is none."""
        path = path.resolve()
        if path not in self._known:
            try:
                self._known[path] = analyse(path.as_uri(), path.read_text("utf-8"))
            except (OSError, UnicodeDecodeError):
                return None
        return self._known[path] if self._known[path].is_text else None

    def home(self, document: Analysis, position: types.Position) -> tuple[Analysis, NodeDefinition] | None:
        """The text in which the name at a position is defined, and its definition there."""
        word = word_at(document.text, document.places.offset(position))
        place = None if word is None else answers.definition(document, position, self.text)
        home = None if place is None else self.text(Path(path_of(place.uri)))
        if word is None or place is None or home is None:
            return None
        found = (one for one in home.by_name.get(word.path[-1], ()) if _stands_at(home, one, place.range.start))
        return next(((home, one) for one in found), None)

    def importers(self, home: Analysis) -> Iterator[Analysis]:
        """The texts that import a text: the open ones, and those of its folder."""
        path = Path(home.path).resolve()
        files = (found for suffix in formats.OWN.suffixes for found in sorted(path.parent.glob(f"*{suffix}"))[:_MOST_FILES])
        for found in dict.fromkeys((*self._known, *(found.resolve() for found in files))):
            other = self.text(found) if found != path and (found in self._known or _names(found, path.name)) else None
            if other is not None and path in {(found.parent / given).resolve() for given in other.imports().values()}:
                yield other

    def references(self, document: Analysis, position: types.Position) -> dict[str, list[types.Range]]:
        """The places, by uri, that mean the name at a position: its definition, and those in the texts that import it."""
        found = self.home(document, position)
        if found is None:
            return {}
        home, target = found
        places = {_uri(home): answers.references(home, home.places.position(target.start))}
        for other in self.importers(home):
            named = [word for word in words(other.text) if word.path[-1] == target.path[-1]]
            same = [word for word in named if self.home(other, other.places.position(word.start)) == (home, target)]
            if same:
                places[_uri(other)] = [other.places.range(word.start, word.end) for word in same]
        return places

    def rename(self, document: Analysis, position: types.Position, name: str) -> dict[str, list[types.TextEdit]] | str:
        """The edits, by uri, that give the element at a position another name; a text where it cannot have it."""
        found = self.home(document, position)
        if found is None:
            return "there is no element here that a HyMeKo text defines"
        home, target = found
        if any(one.path == (*target.path[:-1], name) for one in home.definitions):
            return f"there is a '{name}' already"
        return {
            uri: [types.TextEdit(place, print_name(name)) for place in places]
            for uri, places in self.references(document, position).items()
        }


def _stands_at(home: Analysis, found: NodeDefinition, start: types.Position) -> bool:
    """Whether a definition is the one at a place: of its name, or of its line where an element of a robot has no more."""
    return home.places.position(found.start) == start or home.places.position(found.first).line == start.line


def _names(path: Path, name: str) -> bool:
    """Whether the file at a path has a name in it: what does not, is no importer and need not be read as a robot."""
    return name.encode() in path.read_bytes()


def _uri(document: Analysis) -> str:
    return Path(document.path).resolve().as_uri()
