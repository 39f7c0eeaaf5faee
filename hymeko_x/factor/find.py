"""Finding candidates for macros: forms of one shape, and runs of siblings that repeat, with the characters that each would save.

Runs are found along diagonals: two forms whose names differ in one word (``LF_hip``, ``RF_hip``) are a likely pair, and a row
of pairs at one distance is a run that repeats. So only likely places are looked at, and the time stays near linear.
"""

from __future__ import annotations

import itertools
from collections import Counter
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.factor.unify import unify

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator

    from hymeko_x.factor.flat import Flat
    from hymeko_x.factor.forms import Dialect
    from hymeko_x.factor.unify import Unified, Vector

Run = tuple[int, int]
"""The numbers of the first and the last form of a run of siblings."""

NAME = 7
"""The assumed length of a name that is not chosen yet."""
_WORK_PER_TEXT = 4
_LEAST_WORK = 200_000
"""How many texts are compared in a round, at most."""
_MOST_WORDS = 8
_WIDEST_GAP = 16
"""How many forms without a likely partner may lie between two that have one."""
_MOST_PARAMETERS = 40
_NUMERIC = frozenset("-.0123456789")


class Family(Struct, frozen=True):
    """Runs that are instances of one macro, what they have in common, and how many characters the macro saves."""

    runs: tuple[Run, ...]
    unified: Unified
    saving: int


def families(flat: Flat, dialect: Dialect) -> list[Family]:
    """The families that a macro makes shorter, the best first."""
    bounds = {runs: _bound(runs, flat) for runs in _candidates(flat, dialect) if len(runs) > 1 and not _is_fragment(runs[0], flat, dialect)}
    candidates = sorted((runs for runs, bound in bounds.items() if bound >= dialect.least), key=lambda runs: (-bounds[runs], runs))
    work = max(_LEAST_WORK, _WORK_PER_TEXT * len(flat.texts))
    found: list[Family] = []
    for runs in candidates:
        work -= len(runs) * (flat.start[flat.end[runs[0][1]]] - flat.start[runs[0][0]])
        if work < 0:
            break
        family = family_of(runs, flat, dialect)
        if family.saving >= dialect.least:
            found.append(family)
    return sorted(found, key=lambda family: (-family.saving, family.runs))


def _is_fragment(run: Run, flat: Flat, dialect: Dialect) -> bool:
    """Whether a run has nothing but forms that mean nothing without the one around them."""
    number = run[0]
    while number <= run[1]:
        if flat.forms[number].tag not in dialect.fragments:
            return False
        number = flat.end[number]
    return True


def _bound(runs: tuple[Run, ...], flat: Flat) -> int:
    """The most that a macro could save."""
    return (len(runs) - 1) * _size(runs[0], flat)


def _size(run: Run, flat: Flat) -> int:
    number, total = run[0], 0
    while number <= run[1]:
        total += flat.size[number]
        number = flat.end[number]
    return total


def family_of(runs: tuple[Run, ...], flat: Flat, dialect: Dialect) -> Family:
    """Runs of the same shapes with what they have in common."""
    rows = [flat.texts[flat.start[first] : flat.start[flat.end[last]]] for first, last in runs]
    columns: list[Vector] = list(zip(*rows, strict=True))
    unified = unify(columns, dialect.cut, signs=dialect.signs)
    return Family(runs, unified, _saving(runs, columns, unified, flat, dialect))


def _saving(runs: tuple[Run, ...], columns: list[Vector], unified: Unified, flat: Flat, dialect: Dialect) -> int:
    before = sum([_size(run, flat) for run in runs])
    body = _size(runs[0], flat)
    for column, text in zip(columns, unified.texts, strict=True):
        if text is not column[0]:
            body += _length(text, flat) - flat.length(column[0])
    after = body + dialect.macro + NAME + len(runs) * (dialect.call + NAME)
    if len(unified.parameters) > _MOST_PARAMETERS:
        return 0
    for values in unified.parameters:
        default, uses = Counter(values).most_common(1)[0]
        is_default = is_usual(uses, len(values)) and isinstance(default, str)
        after += dialect.parameter + NAME + (dialect.default + flat.length(default) if is_default else 0)
        after += sum([dialect.argument + NAME + flat.length(value) for value in values if not is_default or value != default])
    return before - after


def is_usual(uses: int, count: int) -> bool:
    """Whether a value that is used so often among so many is a default: by half of them."""
    return uses > 1 and 2 * uses >= count


def _length(text: object, flat: Flat) -> int:
    """The length of a text whose holes have no names yet."""
    if isinstance(text, str):
        return flat.length(text)
    assert isinstance(text, tuple)
    return sum([flat.length(piece) if isinstance(piece, str) else flat.length_of_hole(piece) + NAME - 1 for piece in text])


# ---- candidates ----------------------------------------------------------------------------------------------------------


def _candidates(flat: Flat, dialect: Dialect) -> Iterator[tuple[Run, ...]]:
    keys = _Keys(flat, dialect)
    yield from _groups(flat, keys)
    yield from _runs(flat, keys)


def _groups(flat: Flat, keys: _Keys) -> Iterator[tuple[Run, ...]]:
    """Forms of one shape, and those among them whose numbers are the same up to the sign."""
    for labels in (flat.shape, keys.alike):
        groups: dict[int, list[int]] = {}
        for number, label in enumerate(labels):
            groups.setdefault(label, []).append(number)
        for group in groups.values():
            if len(group) > 1 and not flat.forms[group[0]].is_call and not _is_covered(group, groups, labels, flat):
                yield tuple([(number, number) for number in group])


def _is_covered(group: list[int], groups: dict[int, list[int]], labels: list[int], flat: Flat) -> bool:
    """Whether all forms of a group are inside of forms that have even more in common."""
    around = {flat.up[number] for number in group}
    if len(around) < len(group) or min(around) < 0:
        return False
    kinds = {labels[number] for number in around}
    return len(kinds) == 1 and len(groups[kinds.pop()]) == len(group)


def _runs(flat: Flat, keys: _Keys) -> Iterator[tuple[Run, ...]]:
    row = _Row(flat)
    seen: set[tuple[int, ...]] = set()
    for distance, start, length in _segments(_pairs(flat, keys, row), row):
        if distance == 1:
            continue  # forms of one shape in a row: they are a group
        if length >= distance:
            count = length // distance + 1
            starts = [start + distance * step for step in range(count)]
            yield tuple([row.run(place, distance) for place in starts if row.fits(start, place, distance)])
        length = min(length, distance)
        key = tuple(row.shapes[start : start + length])
        if length > 1 and key not in seen:
            seen.add(key)
            yield _occurrences(start, length, keys, row)


def _occurrences(start: int, length: int, keys: _Keys, row: _Row) -> tuple[Run, ...]:
    """Every run like the one at a place: those that begin with a form like its first one, without overlap."""
    found: list[int] = []
    alike = {number for key in keys.of(row.numbers[start]) for number in keys.members[key]}
    for place in sorted([row.place[number] for number in alike]):
        if row.fits(start, place, length) and (not found or place >= found[-1] + length):
            found.append(place)
    return tuple([row.run(place, length) for place in found])


class _Row:
    """All siblings in a row, list after list, with a gap between lists."""

    def __init__(self, flat: Flat) -> None:
        children: dict[int, list[int]] = {}
        for number, up in enumerate(flat.up):
            children.setdefault(up, []).append(number)
        self.numbers: list[int] = []
        self.shapes: list[int] = []
        self.place: dict[int, int] = {}
        for row in children.values():
            for number in row:
                self.place[number] = len(self.numbers)
                self.numbers.append(number)
                self.shapes.append(flat.shape[number])
            self.numbers.append(-1)
            self.shapes.append(-len(self.shapes) - 1)

    def run(self, place: int, length: int) -> Run:
        return self.numbers[place], self.numbers[place + length - 1]

    def fits(self, start: int, place: int, length: int) -> bool:
        """Whether the forms at two places have the same shapes."""
        return self.shapes[start : start + length] == self.shapes[place : place + length]


def _pairs(flat: Flat, keys: _Keys, row: _Row) -> dict[int, list[int]]:
    """By distance, the places of forms that have a likely partner at that distance."""
    found: dict[int, set[int]] = {}
    for members in keys.members.values():
        places = sorted([row.place[number] for number in members])
        for here, there in itertools.pairwise(places):
            found.setdefault(there - here, set()).add(here)
    return {distance: sorted(places) for distance, places in sorted(found.items())}


def _segments(pairs: dict[int, list[int]], row: _Row) -> Iterator[tuple[int, int, int]]:
    """Distance, start and length of rows of pairs between which all shapes are the same."""
    for distance, places in pairs.items():
        start = last = places[0]
        for place in places[1:]:
            if place - last > min(distance, _WIDEST_GAP) or not row.fits(last, last + distance, place - last):
                yield distance, start, last - start + 1
                start = place
            last = place
        yield distance, start, last - start + 1


class _Keys:
    """The keys by which two forms are likely partners: names that differ in one word, or numbers that are equal up to their sign."""

    def __init__(self, flat: Flat, dialect: Dialect) -> None:
        self._dialect = dialect
        self.alike = flat.labels(lambda number: (flat.shape[number], *map(self._unsigned, flat.forms[number].texts)))
        self._flat = flat
        self.members: dict[Hashable, list[int]] = {}
        for number in range(len(flat)):
            for key in self.of(number):
                self.members.setdefault(key, []).append(number)

    @staticmethod
    def _unsigned(text: object) -> str:
        """A text that begins with a number, without signs; nothing for other words."""
        return text.replace("-", "") if isinstance(text, str) and text[:1] in _NUMERIC else ""

    def of(self, number: int) -> Iterator[Hashable]:
        """The keys of a form: forms with a common key are likely partners."""
        shape, form = self._flat.shape[number], self._flat.forms[number]
        yield self.alike[number]
        if self._dialect.name not in form.leaves:
            return
        name = form.texts[form.leaves.index(self._dialect.name)]
        words = self._dialect.cut(name)[:_MOST_WORDS] if isinstance(name, str) else ()
        for place, word in enumerate(words):
            if word.isalnum():
                yield shape, words[:place], words[place + 1 :]
