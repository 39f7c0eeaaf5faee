"""Elements whose names begin alike, side by side: they stand in an assembly, which says the beginning once.

``left : assembly { hip {..} knee {..} }`` instead of ``left_hip {..} left_knee {..}``. An assembly may stand in several pieces.
"""

from __future__ import annotations

import heapq
from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING

from hymeko_x.backends.hymeko.templates import Piece
from hymeko_x.formats.hymeko import AXES, RESERVED
from hymeko_x.ir.mechanism import KINDS, Id
from hymeko_x.language.syntax import Comment

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from hymeko_x.backends.hymeko.parts import Context
    from hymeko_x.ir.mechanism import Extra
    from hymeko_x.language.syntax import Item

Row = Id | list["Extra"]
"""An element, or what formats said of the whole between two elements."""

_FRAME = 11
"""Letters of `` : assembly { }``."""
_FEWEST = 3
"""Elements of a piece of an assembly."""
_MOST_WORDS = 4
"""Of a name that the beginning may have."""
_BARE = "datum"
"""What may be a name alone, which has no place in an assembly."""
_NO_NAMES = {*KINDS.values(), *RESERVED, *AXES}


def assemblies(rows: Sequence[Row], context: Context, refused: frozenset[str]) -> dict[Id, str]:
    """The assembly in which each element is to stand, the ones that save most first. ``refused`` are names that none may have."""
    members = _members(rows, context, refused)
    weight = {place: _mentions(row, context) for place, row in enumerate(rows) if isinstance(row, Id)}
    queue = [(-_saving(prefix, _pieces(places, rows), weight), prefix) for prefix, places in members.items()]
    heapq.heapify(queue)
    found: dict[int, str] = {}
    while queue and queue[0][0] < 0:
        before, prefix = heapq.heappop(queue)
        pieces = _pieces([place for place in members[prefix] if place not in found], rows)
        saving = _saving(prefix, pieces, weight)
        if saving == -before:
            found.update({place: prefix for piece in _worth(prefix, pieces, weight) for place in piece})
        elif saving > 0:
            heapq.heappush(queue, (-saving, prefix))
    return {row: found[place] for place, row in enumerate(rows) if isinstance(row, Id) and place in found}


def _members(rows: Sequence[Row], context: Context, refused: frozenset[str]) -> dict[str, list[int]]:
    """By the beginnings of names, up to an underscore, the places of the elements that have them."""
    members: dict[str, list[int]] = {}
    for place, row in enumerate(rows):
        if not isinstance(row, Id) or row.kind == _BARE or _has_comment(row, context):
            continue
        for prefix in _prefixes(row.name):
            if prefix not in refused:
                members.setdefault(prefix, []).append(place)
    return members


def _prefixes(name: str) -> Iterator[str]:
    cut = name.find("_")
    for _ in range(_MOST_WORDS):
        if not 0 < cut < len(name) - 1:
            return
        prefix, short = name[:cut], name[cut + 1 :]
        if prefix not in _NO_NAMES and short not in AXES and not short.startswith(f"{prefix}_"):
            yield prefix
        cut = name.find("_", cut + 1)


def _has_comment(key: Id, context: Context) -> bool:
    """Comments in a block are kept in the blocks of the root only."""
    return any(extra.format == "comment" for extra in context.mechanism.extras.get(key, ()))


def _mentions(key: Id, context: Context) -> tuple[str, ...]:
    """The names that an element's text has, its own first."""
    edge = context.mechanism.graph.edges.get(key)
    arcs = edge.arcs if edge is not None else context.attached.get(key, ())
    return (key.name, *(arc.target.name for arc in arcs if arc.target.name != key.name))


def _pieces(places: Sequence[int], rows: Sequence[Row]) -> list[list[int]]:
    """The places in runs between which nothing but comments stands."""
    pieces: list[list[int]] = []
    for place in places:
        gap = rows[pieces[-1][-1] + 1 : place] if pieces and place - pieces[-1][-1] <= 2 else None
        if gap is not None and all(_is_comment(row) for row in gap):
            pieces[-1].append(place)
        else:
            pieces.append([place])
    return pieces


def _is_comment(row: Row) -> bool:
    return isinstance(row, list) and all(extra.format == "comment" for extra in row)


def _worth(prefix: str, pieces: list[list[int]], weight: Mapping[int, tuple[str, ...]]) -> list[list[int]]:
    """The pieces that save something."""
    return [piece for piece in pieces if len(piece) >= _FEWEST and _saved(prefix, piece, weight) > 0]


def _saving(prefix: str, pieces: list[list[int]], weight: Mapping[int, tuple[str, ...]]) -> int:
    """Letters that an assembly saves in all its pieces."""
    return sum(_saved(prefix, piece, weight) for piece in _worth(prefix, pieces, weight))


def _saved(prefix: str, piece: list[int], weight: Mapping[int, tuple[str, ...]]) -> int:
    start = f"{prefix}_"
    count = sum(name.startswith(start) for place in piece for name in weight[place])
    return count * len(start) - len(prefix) - _FRAME


def pieces_of(rows: Sequence[Row], texts: Sequence[list[Item]], homes: Mapping[Id, str]) -> list[Piece]:
    """The items of the rows in order, those of one assembly together."""
    runs = groupby(zip(_homes(rows, texts, homes), texts, strict=True), key=itemgetter(0))
    return [Piece(home, tuple(item for _, text in run for item in text)) for home, run in runs]


def _homes(rows: Sequence[Row], texts: Sequence[list[Item]], homes: Mapping[Id, str]) -> list[str]:
    """The assembly in which each row stands; comments between two elements of one stand in it, too."""
    found = [homes.get(row, "") if isinstance(row, Id) else "" for row in rows]
    for place, text in enumerate(texts[1:-1], 1):
        between = found[place - 1] == found[place + 1] and not isinstance(rows[place], Id)
        if between and all(isinstance(item, Comment) for item in text):
            found[place] = found[place - 1]
    return found
