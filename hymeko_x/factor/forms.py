"""Forms: the structure of a text of any format, before and after factoring; and the costs of a format's text.

A form is a tag, leaves (a name and a text each) and children. A macro is a run of forms with holes in their texts; a call
of it stands for the run with the holes filled. All of it is immutable and knows no format.
"""

from __future__ import annotations

import re
from string import digits
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


class Hole(NamedTuple):
    """The place of a parameter's value, or of a named value, in a text."""

    name: str


class Signed(NamedTuple):
    """A number whose sign is the product of parameters that are "1" or "-1": ``-side * front * 0.05``."""

    factors: tuple[str, ...]
    negative: bool
    magnitude: str


Piece = str | Hole | Signed
Text = str | tuple[Piece, ...]
"""A text without holes is a plain string, never a tuple."""


class FormElement(NamedTuple):
    """A form. ``hint`` is the name of the class, macro or template that it was made from, if known."""

    tag: str
    leaves: tuple[tuple[str, Text], ...] = ()
    children: tuple[Item, ...] = ()
    hint: str = ""


class Call(NamedTuple):
    """A run of forms as a macro with those values that are not its defaults."""

    macro: str
    arguments: tuple[tuple[str, Text], ...] = ()


Item = FormElement | Call


class MacroParameter(NamedTuple):
    """A parameter of a macro; default None = every call gives it."""

    name: str
    default: str | None = None


class Macro(NamedTuple):
    """A run of forms with holes. Its body may call other macros, never itself."""

    name: str
    parameters: tuple[MacroParameter, ...]
    body: tuple[Item, ...]


class Value(NamedTuple):
    """A text that has a name, because it stands in many places."""

    name: str
    text: str


class Factored(NamedTuple):
    """Factored forms: named values, macros (those that others call first), and the items."""

    items: tuple[Item, ...]
    macros: tuple[Macro, ...] = ()
    values: tuple[Value, ...] = ()


def expand(factored: Factored) -> tuple[FormElement, ...]:
    """The forms that were factored; the exact inverse. Does not recurse."""
    macros = {macro.name: macro for macro in factored.macros}
    known = {value.name: value.text for value in factored.values}
    done: list[FormElement] = []
    work: list[tuple[Item | None, dict[str, str], list[FormElement]]] = [(item, known, done) for item in reversed(factored.items)]
    heads: list[tuple[FormElement, list[FormElement], list[FormElement]]] = []
    while work:
        item, scope, out = work.pop()
        if item is None:
            head, children, place = heads.pop()
            place.append(head._replace(children=tuple(children)))
        elif isinstance(item, Call):
            macro = macros[item.macro]
            inner = known | _values_of(macro, item, scope)
            work += [(part, inner, out) for part in reversed(macro.body)]
        else:
            kids: list[FormElement] = []
            leaves = tuple([(name, fill(text, scope)) for name, text in item.leaves])
            heads.append((FormElement(item.tag, leaves, (), item.hint), kids, out))
            work.append((None, scope, out))
            work += [(part, scope, kids) for part in reversed(item.children)]
    return tuple(done)


def _values_of(macro: Macro, call: Call, scope: dict[str, str]) -> dict[str, str]:
    given = {name: fill(text, scope) for name, text in call.arguments}
    return {parameter.name: parameter.default for parameter in macro.parameters if parameter.default is not None} | given


def fill(text: Text, values: dict[str, str]) -> str:
    """A text with its holes filled.

    Raises: KeyError for a hole that has no value.
    """
    return text if isinstance(text, str) else "".join([_filled(piece, values) for piece in text])


def _filled(piece: Piece, values: dict[str, str]) -> str:
    match piece:
        case Hole(name):
            return values[name]
        case Signed(factors, negative, magnitude):
            for name in factors:
                negative ^= values[name] == "-1"
            return f"-{magnitude}" if negative else magnitude
        case _:
            return piece


def joined(pieces: list[Piece]) -> Text:
    """Pieces as one text: neighbouring strings become one, and a text of strings only is a string."""
    out: list[Piece] = []
    for piece in pieces:
        if isinstance(piece, str) and out and isinstance(out[-1], str):
            out[-1] += piece
        else:
            out.append(piece)
    if not out:
        return ""
    return out[0] if len(out) == 1 and isinstance(out[0], str) else tuple(out)


# ---- dialects -----------------------------------------------------------------------------------------------------------------

_PIECE = re.compile(r"(?<!\S)[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?!\S)|\s+|[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^A-Za-z0-9\s]")


def words(text: str) -> tuple[str, ...]:
    """A text cut into numbers, words, digits behind words, and single separators: ``LF_hip2`` -> LF _ hip 2."""
    return tuple(_PIECE.findall(text))


def _leaf_name(tag: str, leaf: str) -> str:
    """The name of a parameter for the text of this leaf."""
    return tag if leaf in ("name", "value", "") else leaf


class Dialect(Struct, frozen=True):
    """The costs of a backend's text, in characters without white space, and its rules for names.

    ``element`` are the characters around tag and leaves of a form (``</>``: 3), ``block`` those that children add, the tag
    again where ``closes_by_tag``; ``leaf`` those around a leaf's name and text (``=""``: 3). ``macro``, ``parameter``,
    ``default``, ``call``, ``argument``, ``hole`` and ``value`` likewise: the characters around the names and texts of a definition, a
    parameter in it, a default, a call, an argument, the name in a hole, and the definition of a named value.

    A macro must save ``least`` characters. ``cut`` cuts a text into the pieces that a hole
    may take; return ``(text,)`` where only the whole text can be one. ``leaf_name`` proposes a parameter's name from
    tag and leaf. ``taken`` are reserved names. ``name`` is the leaf that names a form. ``can_be_default``
    tells whether a text can be a default, ``signs`` whether the dialect can write a number with the sign of a parameter,
    ``values`` whether it has named values, and ``can_be_value`` which texts can be one. A parameter called as in
    ``without_default`` has none. Forms with the tags ``fragments`` are no macro by themselves. ``components`` are the names of
    the numbers of a list, by the name of a parameter for the list.
    """

    element: int = 3
    block: int = 2
    closes_by_tag: bool = True
    leaf: int = 3
    macro: int = 45
    parameter: int = 0
    default: int = 2
    call: int = 9
    argument: int = 3
    hole: int = 3
    value: int = 33
    least: int = 40
    cut: Callable[[str], tuple[str, ...]] = words
    leaf_name: Callable[[str, str], str] = _leaf_name
    taken: frozenset[str] = frozenset()
    name: str = "name"
    can_be_default: Callable[[str], bool] = bool
    signs: bool = True
    values: bool = False
    can_be_value: Callable[[str], bool] = bool
    without_default: frozenset[str] = frozenset()
    fragments: frozenset[str] = frozenset()
    components: Mapping[str, tuple[str, ...]] = MappingProxyType({})

    def has_default(self, parameter: str) -> bool:
        """Whether a parameter of this name may have a default, which is not empty."""
        return parameter.rstrip(digits) not in self.without_default
