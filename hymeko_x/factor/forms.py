"""Forms: what a text of any format consists of once its words are forgotten, and what it is when what repeats is said once.

A form is a tag, leaves (a name and a text each) and children. A macro is a run of forms with holes in their texts; a call
of it stands for the run with the holes filled. All of it is immutable and knows no format.
"""

from __future__ import annotations

from typing import NamedTuple


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


class Element(NamedTuple):
    """A form. ``hint`` is what its source called the thing that it was made from (a class, macro or template), if known."""

    tag: str
    leaves: tuple[tuple[str, Text], ...] = ()
    children: tuple[Item, ...] = ()
    hint: str = ""


class Call(NamedTuple):
    """What stands in place of a run of forms: the macro, and the values that are not its defaults."""

    macro: str
    arguments: tuple[tuple[str, Text], ...] = ()


Item = Element | Call


class Parameter(NamedTuple):
    """A parameter of a macro; default None = every call gives it."""

    name: str
    default: str | None = None


class Macro(NamedTuple):
    """A run of forms with holes. Its body may call other macros, never itself."""

    name: str
    parameters: tuple[Parameter, ...]
    body: tuple[Item, ...]


class Value(NamedTuple):
    """A text that has a name, because it stands in many places."""

    name: str
    text: str


class Factored(NamedTuple):
    """Forms in which nothing is said twice: named values, macros (those that others call first), and the items."""

    items: tuple[Item, ...]
    macros: tuple[Macro, ...] = ()
    values: tuple[Value, ...] = ()


def expand(factored: Factored) -> tuple[Element, ...]:
    """The forms that were factored; the exact inverse. Does not recurse."""
    macros = {macro.name: macro for macro in factored.macros}
    known = {value.name: value.text for value in factored.values}
    done: list[Element] = []
    work: list[tuple[Item | None, dict[str, str], list[Element]]] = [(item, known, done) for item in reversed(factored.items)]
    heads: list[tuple[Element, list[Element], list[Element]]] = []
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
            kids: list[Element] = []
            leaves = tuple([(name, fill(text, scope)) for name, text in item.leaves])
            heads.append((Element(item.tag, leaves, (), item.hint), kids, out))
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
