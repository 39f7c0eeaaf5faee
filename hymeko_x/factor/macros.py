"""Making macros of families, the best ones first, with names for them and their parameters, and calls in place of their instances."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.factor.find import NAME, family_of, is_usual
from hymeko_x.factor.flat import Form, OpenMacro
from hymeko_x.factor.forms import Hole, Signed
from hymeko_x.factor.words import limb_of_most
from hymeko_x.ir.names import first_free_name

if TYPE_CHECKING:
    from hymeko_x.factor.find import Family, Run
    from hymeko_x.factor.flat import FactoringState, Flat
    from hymeko_x.factor.forms import Dialect, Text


def apply(found: list[Family], flat: Flat, workspace: FactoringState, dialect: Dialect) -> bool:
    """Make a macro of every family that does not overlap with a better one. Returns whether there was any."""
    taken = _Taken(flat)
    calls: dict[int, Form] = {}
    gone: set[int] = set()
    for candidate in found:
        family = _left(candidate, taken, flat, dialect)
        if family is None:
            continue
        _define(family, flat, workspace, dialect, calls)
        for first, last in family.runs:
            taken.take(first, last)
            gone.update(id(form) for form in _siblings(first, last, flat))
    if calls:
        _replace(workspace, flat, {id(flat.forms[number]): call for number, call in calls.items()}, gone)
    return bool(calls)


def _left(family: Family, taken: _Taken, flat: Flat, dialect: Dialect) -> Family | None:
    """The family without the instances that overlap with those of better ones, if a macro still makes it shorter."""
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


def _define(family: Family, flat: Flat, workspace: FactoringState, dialect: Dialect, calls: dict[int, Form]) -> None:
    """Add a family's macro, and note a call for each of its runs at the number of the run's first form."""
    namer = Namer(family, flat, dialect, workspace)
    names = namer.parameters()
    body = _body(family.runs[0], [_named(text, names) for text in family.unified.texts], flat)
    usual = tuple([_usual(name, values, dialect) for name, values in zip(names, family.unified.parameters, strict=True)])
    draft = OpenMacro(namer.macro(), names, usual, body)
    workspace.macros[draft.name] = draft
    for place, (first, _) in enumerate(family.runs):
        calls[first] = Form(draft.name, names, tuple([values[place] for values in family.unified.parameters]), is_call=True)


def _usual(name: str, values: tuple[Text, ...], dialect: Dialect) -> Text | None:
    """The value that half of the instances give for a parameter; None if there is no such text, or the parameter has no default."""
    text, uses = Counter(values).most_common(1)[0]
    return text if is_usual(uses, len(values)) and (not text or dialect.has_default(name)) else None


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
        if form.children:
            copy.children = []
        above = copies.get(flat.up[number])
        row = top if above is None else above.children
        assert isinstance(row, list)
        row.append(copy)
    return top


def _replace(workspace: FactoringState, flat: Flat, calls: dict[int, Form], gone: set[int]) -> None:
    lists = [workspace.items, *(macro.body for macro in workspace.macros.values())]
    lists += [form.children for form in flat.forms if isinstance(form.children, list)]
    for row in lists:
        if any(id(form) in gone for form in row):
            row[:] = [calls.get(id(form), form) for form in row if id(form) in calls or id(form) not in gone]


# ---- names --------------------------------------------------------------------------------------------------------------------

_SIGNS = ("side", "front", "flip")
_PREFIX = "prefix"
_FEWEST_OF_LIMB = 3
"""A limb has more parts with names than that."""


class Namer:
    """Names for one family."""

    def __init__(self, family: Family, flat: Flat, dialect: Dialect, workspace: FactoringState) -> None:
        self._family = family
        self._dialect = dialect
        self._grown = workspace
        first, last = family.runs[0]
        self._forms = flat.forms[first : flat.end[last]]
        self._top = [number - first for number in range(first, flat.end[last]) if flat.up[number] == flat.up[first]]
        self._around = flat.forms[flat.up[first]].tag if flat.up[first] >= 0 else ""
        self._leaves = self._places(first, flat)

    def _places(self, first: int, flat: Flat) -> list[tuple[str, Form, str]]:
        """For each column the tag around its form, without those around nothing else, its form and its leaf."""
        found = []
        for offset, form in enumerate(self._forms):
            above = flat.up[first + offset] - first
            while above >= 0 and _is_wrapper(self._forms[above]) and flat.up[first + above] >= first:
                above = flat.up[first + above] - first
            around = self._forms[above].tag if above >= 0 else form.tag
            found += [(around, form, leaf) for leaf in form.leaves]
        return found

    def parameters(self) -> tuple[str, ...]:
        """A name for every parameter."""
        names: list[str] = []
        for number, column in enumerate(self._family.unified.columns):
            taken = {*names, *self._dialect.taken}
            names.append(first_free_name(self._wishes(number, column), taken, ""))
        return tuple(names)

    def _wishes(self, number: int, column: int) -> list[str]:
        """The names that suit a parameter, the best first."""
        if self._family.unified.is_sign[number]:
            return list(_SIGNS)
        around, form, leaf = self._leaves[column]
        text = self._family.unified.texts[column]
        if leaf == self._dialect.name and isinstance(text, tuple) and len(text) > 1:
            place = text.index(Hole(str(number)))
            return [_PREFIX] if place == 0 else ["suffix"] if place == len(text) - 1 else ["part"]
        if leaf == self._dialect.name and form is self._forms[0]:
            return ["name"]
        wish = leaf if form.is_call else self._dialect.leaf_name(form.tag, leaf)
        part = self._dialect.components.get(wish, ())
        if isinstance(text, tuple) and len(text) > 1 and (place := _component(text, Hole(str(number)))) < len(part):
            wish = part[place]
        return [identifier(wish), identifier(f"{around}_{wish}")]

    def macro(self) -> str:
        """The name of the macro: the best one that does not cost more than the macro saves, else the shortest."""
        wishes = self._macro_wishes()
        places = len(self._family.runs) + 1
        short = [wish for wish in wishes if (len(wish) - NAME) * places < self._family.saving]
        taken = {*self._grown.macros, *self._dialect.taken}
        return first_free_name(short or [min([*wishes, identifier(self._forms[0].tag)], key=len)], taken, "")

    def _macro_wishes(self) -> list[str]:
        hints = Counter(form.hint for form in self._forms if form.hint)
        tops = [self._forms[place] for place in self._top]
        shared = [self._words(place) for place in self._top]
        if hints:
            return [identifier(hints.most_common(1)[0][0])]
        if len(tops) == 1:
            content = _content(tops[0])
            other = [identifier(f"{content}_{tops[0].tag}")] if content else []
            own = shared[0] if shared[0][-1:] == [tops[0].tag] else [*shared[0], tops[0].tag]
            return [identifier("_".join(own)), *other, identifier(tops[0].tag)]
        named = [words for words in shared if words]
        if (part := limb_of_most(["_".join(words) for words in named])) and len(named) > _FEWEST_OF_LIMB:
            return [part]
        if not named:
            inside = [identifier(f"{child.tag}_{top.tag}") for top in tops if _is_wrapper(top) for child in top.children]
            return inside[:1] or [identifier(f"{self._around}_parts" if self._around else f"{tops[0].tag}_group")]
        common = [word for word in named[0] if all(word in words for words in named)]
        if common:
            return [identifier("_".join(common))]
        first, last = "_".join(named[0]), "_".join(named[-1])
        return [identifier(first if first == last else f"{first}_to_{last}")]

    def _words(self, place: int) -> list[str]:
        """The words of a form's name that all instances share."""
        form = self._forms[place]
        named = next((leaf for leaf in (self._dialect.name, _PREFIX) if leaf in form.leaves), None)
        if named is None:
            return []
        start = sum(len(earlier.leaves) for earlier in self._forms[:place])
        text: Text = self._family.unified.texts[start + form.leaves.index(named)]
        pieces = [text] if isinstance(text, str) else [piece for piece in text if isinstance(piece, str)]
        return [word.lower() for piece in pieces for word in re.findall(r"[A-Za-z][A-Za-z0-9]*", piece)][:3]


def _component(text: tuple[str | Hole | Signed, ...], hole: Hole) -> int:
    """Which number of a list the hole is."""
    before = itertools.takewhile(lambda piece: piece != hole, text)
    return sum(piece.count(" ") for piece in before if isinstance(piece, str))


def _is_wrapper(form: Form) -> bool:
    """Whether a form is around one other and has no texts, as ``<geometry>`` is."""
    return not form.leaves and len(form.children) == 1


def _content(form: Form) -> str:
    """The tag of what a form is about: that of the only child of a form without texts of its own; empty for none."""
    inside = [inner.tag for child in form.children if _is_wrapper(child) for inner in child.children]
    return inside[0] if len(inside) == 1 else ""


def identifier(text: str) -> str:
    """The text as a name that every format accepts."""
    name = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_")
    return name if name and not name[0].isdigit() else f"x{name}"
