"""What macros and their parameters are called: by what the source called them, else by what the names have in common."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.factor.forms import Hole

if TYPE_CHECKING:
    from collections.abc import Container

    from hymeko_x.factor.dialect import Dialect
    from hymeko_x.factor.find import Family
    from hymeko_x.factor.flat import Flat, Form, Grown
    from hymeko_x.factor.forms import Text

_SIGNS = ("side", "front", "flip")


class Namer:
    """Names for one family."""

    def __init__(self, family: Family, flat: Flat, dialect: Dialect, grown: Grown) -> None:
        self._family = family
        self._dialect = dialect
        self._grown = grown
        first, last = family.runs[0]
        self._forms = flat.forms[first : flat.end[last]]
        self._top = [number - first for number in range(first, flat.end[last]) if flat.up[number] == flat.up[first]]
        self._around = flat.forms[flat.up[first]].tag if flat.up[first] >= 0 else ""
        self._leaves = self._places(first, flat)

    def _places(self, first: int, flat: Flat) -> list[tuple[str, Form, str]]:
        """For each column the tag around its form, its form and its leaf."""
        found = []
        for offset, form in enumerate(self._forms):
            above = flat.up[first + offset] - first
            around = self._forms[above].tag if above >= 0 else form.tag
            found += [(around, form, leaf) for leaf in form.leaves]
        return found

    def parameters(self) -> tuple[str, ...]:
        """A name for every parameter."""
        names: list[str] = []
        for number, column in enumerate(self._family.unified.columns):
            taken = {*names, *self._dialect.taken}
            names.append(_free(self._wishes(number, column), taken))
        return tuple(names)

    def _wishes(self, number: int, column: int) -> list[str]:
        """What a parameter would be called, the best first."""
        if self._family.unified.is_sign[number]:
            return list(_SIGNS)
        around, form, leaf = self._leaves[column]
        text = self._family.unified.texts[column]
        if leaf == self._dialect.name and isinstance(text, tuple) and len(text) > 1:
            place = text.index(Hole(str(number)))
            return ["prefix"] if place == 0 else ["suffix"] if place == len(text) - 1 else ["part"]
        if leaf == self._dialect.name and form is self._forms[0]:
            return ["name"]
        wish = leaf if form.is_call else self._dialect.leaf_name(form.tag, leaf)
        return [_identifier(wish), _identifier(f"{around}_{wish}")]

    def macro(self) -> str:
        """The name of the macro."""
        return _free(self._macro_wishes(), {*self._grown.macros, *self._dialect.taken})

    def _macro_wishes(self) -> list[str]:
        hints = Counter(form.hint for form in self._forms if form.hint)
        tops = [self._forms[place] for place in self._top]
        said = [self._words(place) for place in self._top]
        if hints:
            return [_identifier(hints.most_common(1)[0][0])]
        if len(tops) == 1:
            return [_identifier("_".join([*said[0], tops[0].tag])), _identifier(tops[0].tag)]
        named = [words for words in said if words]
        if not named:
            return [_identifier(f"{self._around}_parts" if self._around else f"{tops[0].tag}_group")]
        common = [word for word in named[0] if all(word in words for words in named)]
        if common:
            return [_identifier("_".join(common))]
        first, last = "_".join(named[0]), "_".join(named[-1])
        return [_identifier(first if first == last else f"{first}_to_{last}")]

    def _words(self, place: int) -> list[str]:
        """The words of a form's name that all instances share."""
        form = self._forms[place]
        if self._dialect.name not in form.leaves or form.is_call:
            return []
        start = sum(len(earlier.leaves) for earlier in self._forms[:place])
        text: Text = self._family.unified.texts[start + form.leaves.index(self._dialect.name)]
        pieces = [text] if isinstance(text, str) else [piece for piece in text if isinstance(piece, str)]
        return [word.lower() for piece in pieces for word in re.findall(r"[A-Za-z][A-Za-z0-9]*", piece)][:3]


def _identifier(text: str) -> str:
    """The text as a name that every format accepts."""
    name = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_")
    return name if name and not name[0].isdigit() else f"x{name}"


def _free(wishes: list[str], taken: Container[str]) -> str:
    for wish in wishes:
        if wish not in taken:
            return wish
    number = 2
    while f"{wishes[-1]}{number}" in taken:
        number += 1
    return f"{wishes[-1]}{number}"
