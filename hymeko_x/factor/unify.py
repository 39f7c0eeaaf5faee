"""Anti-unification: the most special text that several texts are instances of, for all columns of a family at once.

A column holds the texts that one leaf has in each instance. Equal pieces stay, different ones become holes, and holes that
differ in the same way share a parameter. A sign that changes in several columns in the same way is a parameter, too.
"""

from __future__ import annotations

import re
from collections import Counter
from functools import lru_cache
from itertools import combinations
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.factor.forms import Hole, Signed, joined

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.factor.forms import Piece, Text

Vector = tuple["Text", ...]
"""What a parameter is in each instance."""
Signs = tuple[bool, ...]
"""Whether a number is negative in each instance."""

_LIST = re.compile(r"[-+.\deE]+( [-+.\deE]+)+")
_MAGNITUDE = re.compile(r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


class _Varying(Struct, frozen=True):
    """A place that differs: the whole values and, where that is possible, their pieces."""

    values: Vector
    pieces: tuple[Piece | Vector, ...] = ()


class Unified(Struct):
    """A family's common texts, one for each column, with holes numbered by parameter: ``parameters[n]`` goes into Hole(str(n))."""

    texts: list[Text]
    parameters: list[Vector]
    columns: list[int]
    """The column where each parameter appeared first."""
    is_sign: list[bool]


def unify(columns: list[Vector], cut: Callable[[str], tuple[str, ...]], *, signs: bool) -> Unified:
    """Anti-unify the columns of a family. All columns have one text per instance."""
    drafts = {number: _aligned(column, cut) for number, column in enumerate(columns) if not _is_constant(column)}
    usage = _Usage(list(drafts.values()), signs=signs)
    made = Unified([column[0] for column in columns], [], [], [])
    known: dict[tuple[Vector, bool], int] = {}

    def hole(values: Vector, column: int, *, is_sign: bool = False) -> str:
        number = known.setdefault((values, is_sign), len(made.parameters))
        if number == len(made.parameters):
            made.parameters.append(values)
            made.columns.append(column)
            made.is_sign.append(is_sign)
        return str(number)

    for number, parts in drafts.items():
        pieces: list[Piece] = []
        for piece in usage.decided_of(columns[number], parts):
            if isinstance(piece, str | Hole | Signed):
                pieces.append(piece)
            elif signed := usage.signed(piece):
                factors, negative, magnitude = signed
                names = tuple([hole(tuple(["-1" if minus else "1" for minus in factor]), number, is_sign=True) for factor in factors])
                pieces.append(Signed(names, negative, magnitude))
            else:
                pieces.append(Hole(hole(piece, number)))
        made.texts[number] = joined(pieces)
    return made


def _is_list(text: Text) -> bool:
    """Whether a text is a list of numbers, some of which may be holes."""
    return bool(_LIST.fullmatch(text if isinstance(text, str) else "".join([piece if isinstance(piece, str) else "0" for piece in text])))


def _is_constant(column: tuple[object, ...]) -> bool:
    """Whether all instances have the same words. Holes of a macro around the instances have to be handed on to the new one."""
    return isinstance(column[0], str) and column.count(column[0]) == len(column)


def _aligned(column: Vector, cut: Callable[[str], tuple[str, ...]]) -> list[Piece | _Varying]:
    """Common pieces in front and behind, and the varying ones between them."""
    rows = [_pieces(text, cut) for text in column]
    shortest = min(map(len, rows))
    first = rows[0]
    front = 0
    while front < shortest and _is_constant(tuple([row[front] for row in rows])):
        front += 1
    back = 0
    while back < shortest - front and _is_constant(tuple([row[-1 - back] for row in rows])):
        back += 1
    middles = [row[front : len(row) - back] for row in rows]
    values = tuple([joined(list(middle)) for middle in middles])
    pieces: tuple[Piece | Vector, ...] = ()
    if len({len(middle) for middle in middles}) == 1:
        pieces = tuple([_piece(tuple(place)) for place in zip(*middles, strict=True)])
    return [*first[:front], _Varying(values, pieces), *(first[len(first) - back :] if back else ())]


def _piece(place: tuple[Piece, ...]) -> Piece | Vector:
    if _is_constant(place):
        return place[0]
    return tuple([piece if isinstance(piece, str) else (piece,) for piece in place])


def _pieces(text: Text, cut: Callable[[str], tuple[str, ...]]) -> tuple[Piece, ...]:
    if isinstance(text, str):
        return _cut(text, cut)
    found: list[Piece] = []
    for piece in text:
        found += _cut(piece, cut) if isinstance(piece, str) else (piece,)
    return tuple(found)


@lru_cache(100_000)
def _cut(text: str, cut: Callable[[str], tuple[str, ...]]) -> tuple[str, ...]:
    return cut(text)


class _Usage:
    """Facts about all columns of a family: which vectors occur several times, and which signs change together."""

    def __init__(self, drafts: list[list[Piece | _Varying]], *, signs: bool) -> None:
        varying = [part for parts in drafts for part in parts if isinstance(part, _Varying)]
        self._vectors = Counter(part.values for part in varying)
        patterns: Counter[Signs] = Counter()
        for part in varying:
            for piece in part.pieces:
                if isinstance(piece, tuple) and not isinstance(piece, Hole | Signed):
                    self._vectors[piece] += len(part.pieces) > 1
                    signed = _signs(piece) if signs else None
                    if signed is not None:
                        patterns[_normal(signed[0])] += 1
        self._factors = _basis(patterns)

    def signed(self, vector: Vector) -> tuple[tuple[Signs, ...], bool, str] | None:
        """The sign parameters, and the rest, of numbers that differ by sign alone; None where it occurs only once."""
        found = _signs(vector) if self._factors else None
        factors = self._factors.get(_normal(found[0])) if found else None
        return (factors, found[0][0], found[1]) if found and factors else None

    def decided_of(self, column: Vector, parts: list[Piece | _Varying]) -> list[Piece | Vector]:
        """The pieces of a column. Where several numbers of a list differ, and are one hole, the hole is the whole list."""
        found: list[Piece | Vector] = []
        for part in parts:
            if not isinstance(part, _Varying):
                found.append(part)
                continue
            pieces = self.decided(part)
            if len(pieces) == 1 < len(part.pieces) and all(map(_is_list, column)):
                return [column]
            found += pieces
        return found

    def decided(self, part: _Varying) -> tuple[Piece | Vector, ...]:
        """The varying values as a whole, or piece by piece where each of the pieces occurs elsewhere as well."""
        if len(part.pieces) == 1:
            return part.pieces
        if not part.pieces or self._vectors[part.values] > 1:
            return (part.values,)
        vectors = [piece for piece in part.pieces if isinstance(piece, tuple) and not isinstance(piece, Hole | Signed)]
        if all(self._vectors[vector] > 1 or self.signed(vector) for vector in vectors):
            return part.pieces
        return (part.values,)


def _basis(patterns: Counter[Signs]) -> dict[Signs, tuple[Signs, ...]]:
    """For each pattern of signs the parameters whose product it is. A pattern that is used once is none."""
    chosen: dict[Signs, tuple[Signs, ...]] = {}
    for pattern, uses in sorted(patterns.items(), key=lambda item: -item[1]):
        base = [key for key, factors in chosen.items() if len(factors) == 1]
        pairs = ((a, b) for a, b in combinations(base[:6], 2) if _product(a, b) == pattern)
        pair = next(pairs, None)
        if pair is not None:
            chosen[pattern] = pair
        elif uses > 1:
            chosen[pattern] = (pattern,)
    return chosen


def _product(a: Signs, b: Signs) -> Signs:
    return tuple([x != y for x, y in zip(a, b, strict=True)])


def _normal(signs: Signs) -> Signs:
    """The pattern with the first instance positive."""
    return tuple([not sign for sign in signs]) if signs[0] else signs


def _signs(vector: Vector) -> tuple[Signs, str] | None:
    """The signs and the common magnitude of numbers that differ by sign alone; None for anything else, and for zero."""
    first = vector[0]
    if not isinstance(first, str):
        return None
    magnitude = first.removeprefix("-")
    minus = f"-{magnitude}"
    if not all(text in (magnitude, minus) for text in vector):
        return None
    if not _MAGNITUDE.fullmatch(magnitude) or not float(magnitude):
        return None
    return tuple([text == minus for text in vector]), magnitude
