"""Making macros of families, the best ones first, and putting calls where their instances stood."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.factor.find import family_of
from hymeko_x.factor.flat import Draft, Form
from hymeko_x.factor.forms import Hole, Signed
from hymeko_x.factor.names import Namer

if TYPE_CHECKING:
    from hymeko_x.factor.dialect import Dialect
    from hymeko_x.factor.find import Family, Run
    from hymeko_x.factor.flat import Flat, Grown
    from hymeko_x.factor.forms import Text


def apply(found: list[Family], flat: Flat, grown: Grown, dialect: Dialect) -> bool:
    """Make a macro of every family that does not get into the way of a better one. Whether there was any."""
    taken = _Taken(flat)
    calls: dict[int, Form] = {}
    gone: set[int] = set()
    for candidate in found:
        family = _left(candidate, taken, flat, dialect)
        if family is None:
            continue
        _define(family, flat, grown, dialect, calls)
        for first, last in family.runs:
            taken.take(first, last)
            gone.update(id(form) for form in _siblings(first, last, flat))
    if calls:
        _replace(grown, flat, {id(flat.forms[number]): call for number, call in calls.items()}, gone)
    return bool(calls)


def _left(family: Family, taken: _Taken, flat: Flat, dialect: Dialect) -> Family | None:
    """The family without the instances that overlap with what was taken, if it still is worth a macro."""
    runs = tuple([run for run in family.runs if taken.is_free(*run)])
    if len(runs) == len(family.runs):
        return family
    if len(runs) < 2:
        return None
    family = family_of(runs, flat, dialect)
    return family if family.saving >= dialect.least else None


class _Taken:
    """Which forms are part of an instance, or around one. Forms inside an instance are marked with it."""

    def __init__(self, flat: Flat) -> None:
        self._flat = flat
        self._inside = bytearray(len(flat))
        self._around = bytearray(len(flat))

    def is_free(self, first: int, last: int) -> bool:
        """Whether a run of siblings neither is part of an instance nor has one in it."""
        if self._inside[first] or self._inside[last]:
            return False
        number = first
        while number <= last:
            if self._around[number] or self._inside[number]:
                return False
            number = self._flat.end[number]
        return True

    def take(self, first: int, last: int) -> None:
        """Mark a run."""
        end = self._flat.end[last]
        self._inside[first:end] = b"\1" * (end - first)
        above = self._flat.up[first]
        while above >= 0 and not self._around[above]:
            self._around[above] = 1
            above = self._flat.up[above]


def _siblings(first: int, last: int, flat: Flat) -> list[Form]:
    found = []
    number = first
    while number <= last:
        found.append(flat.forms[number])
        number = flat.end[number]
    return found


def _define(family: Family, flat: Flat, grown: Grown, dialect: Dialect, calls: dict[int, Form]) -> None:
    """Add a family's macro, and note a call for each of its runs at the number of the run's first form."""
    namer = Namer(family, flat, dialect, grown)
    names = namer.parameters()
    body = _body(family.runs[0], [_named(text, names) for text in family.unified.texts], flat)
    usual = tuple([_usual(values) for values in family.unified.parameters])
    draft = Draft(namer.macro(), names, usual, body)
    grown.macros[draft.name] = draft
    for place, (first, _) in enumerate(family.runs):
        calls[first] = Form(draft.name, names, tuple([values[place] for values in family.unified.parameters]), is_call=True)


def _usual(values: tuple[Text, ...]) -> Text | None:
    """What more than one instance gives for a parameter, and most of them; None if there is no such text."""
    text, uses = Counter(values).most_common(1)[0]
    return text if uses > 1 else None


def _named(text: Text, names: tuple[str, ...]) -> Text:
    """A text with the parameters' names in its new holes, which have numbers so far."""
    if isinstance(text, str):
        return text
    named: list[str | Hole | Signed] = []
    for piece in text:
        if isinstance(piece, Hole):
            named.append(Hole(names[int(piece.name)]))
        elif isinstance(piece, Signed):
            named.append(piece._replace(factors=tuple([names[int(name)] for name in piece.factors])))
        else:
            named.append(piece)
    return tuple(named)


def _body(run: Run, texts: list[Text], flat: Flat) -> list[Form]:
    """A copy of a run with other texts."""
    copies: dict[int, Form] = {}
    top: list[Form] = []
    base = flat.start[run[0]]
    for number in range(run[0], flat.end[run[1]]):
        form = flat.forms[number]
        own = tuple(texts[flat.start[number] - base : flat.start[number + 1] - base])
        copy = copies[number] = Form(form.tag, form.leaves, own, is_call=form.is_call, hint=form.hint)
        if form.kids:
            copy.kids = []
        above = copies.get(flat.up[number])
        row = top if above is None else above.kids
        assert isinstance(row, list)
        row.append(copy)
    return top


def _replace(grown: Grown, flat: Flat, calls: dict[int, Form], gone: set[int]) -> None:
    lists = [grown.items, *(macro.body for macro in grown.macros.values())]
    lists += [form.kids for form in flat.forms if isinstance(form.kids, list)]
    for row in lists:
        if any(id(form) in gone for form in row):
            row[:] = [calls.get(id(form), form) for form in row if id(form) in calls or id(form) not in gone]
