"""Texts that deserve a name: long ones that are still in many places once everything that repeats around them is said once."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.factor.forms import Call, Element, Factored, Hole, Value, joined

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.factor.dialect import Dialect
    from hymeko_x.factor.forms import Item, Piece, Text

_LEAST_TEXT = 16
_LEAST_NUMBER = 9
"""Shorter ones are easier to read where they are."""


def name_texts(factored: Factored, dialect: Dialect) -> Factored:
    """The same with named values where that is shorter: one line is less to understand than a macro, so that less will do."""
    uses: Counter[str] = Counter()
    places: dict[str, str] = {}
    for wish, text in _texts(factored, dialect):
        for part in _parts(text, dialect):
            uses[part] += 1
            places.setdefault(part, wish)
    taken = {*dialect.taken, *(parameter.name for macro in factored.macros for parameter in macro.parameters)}
    named: dict[str, str] = {}
    for part, count in sorted(uses.items(), key=lambda item: (-item[1] * len(item[0]), item[0])):
        name = _name(part, places[part], taken)
        saved = count * (len(part) - dialect.hole - len(name)) - dialect.value - len(name) - len(part)
        if saved >= dialect.least // 4 and dialect.can_be_value(part):
            named[part] = name
            taken.add(name)
    if not named:
        return factored
    macros = tuple([macro._replace(body=_rewritten(macro.body, named, dialect)) for macro in factored.macros])
    values = tuple([Value(name, text) for text, name in named.items()])
    return Factored(_rewritten(factored.items, named, dialect), macros, values)


def _texts(factored: Factored, dialect: Dialect) -> Iterator[tuple[str, Text]]:
    """Every text with the name that a value in it would have."""
    stack: list[Item] = [*reversed(factored.items), *(item for macro in factored.macros for item in macro.body)]
    while stack:
        item = stack.pop()
        if isinstance(item, Call):
            yield from item.arguments
        else:
            yield from ((dialect.leaf_name(item.tag, name), text) for name, text in item.leaves)
            stack += reversed(item.children)


def _parts(text: Text, dialect: Dialect) -> Iterator[str]:
    """What in a text could have a name: all of it, the folder of a file, long numbers."""
    if isinstance(text, str) and len(text) >= _LEAST_TEXT and " " not in text:
        yield text
    first = text if isinstance(text, str) else text[0]
    if isinstance(first, str) and "://" in first:
        yield first.rpartition("/")[0]
    for piece in (text,) if isinstance(text, str) else text:
        if isinstance(piece, str):
            yield from (part for part in dialect.cut(piece) if len(part) >= _LEAST_NUMBER and part[0].isdigit() and part != text)


def _name(part: str, wish: str, taken: set[str]) -> str:
    base = part.rpartition("/")[2] if "/" in part else wish
    base = re.sub(r"[^A-Za-z0-9]+", "_", base).strip("_") or "value"
    base = base if not base[0].isdigit() else f"x{base}"
    name, number = base, 2
    while name in taken:
        name, number = f"{base}{number}", number + 1
    return name


def _rewritten(items: tuple[Item, ...], named: Mapping[str, str], dialect: Dialect) -> tuple[Item, ...]:
    """The items with holes for what has a name. Iterative: rows under construction wait for what is in them."""
    top: list[Item] = []
    work: list[tuple[Item, list[Item], list[Item] | None]] = [(item, top, None) for item in reversed(items)]
    while work:
        item, out, kids = work.pop()
        if isinstance(item, Call):
            out.append(item._replace(arguments=tuple([(name, _with_holes(text, named, dialect)) for name, text in item.arguments])))
        elif kids is None and item.children:
            kids = []
            work.append((item, out, kids))
            work += [(kid, kids, None) for kid in reversed(item.children)]
        else:
            leaves = tuple([(name, _with_holes(text, named, dialect)) for name, text in item.leaves])
            out.append(Element(item.tag, leaves, tuple(kids or ()), item.hint))
    return tuple(top)


def _with_holes(text: Text, named: Mapping[str, str], dialect: Dialect) -> Text:
    if isinstance(text, str) and text in named:
        return (Hole(named[text]),)
    pieces: list[Piece] = []
    for place, piece in enumerate((text,) if isinstance(text, str) else text):
        if not isinstance(piece, str):
            pieces.append(piece)
            continue
        folder = piece.rpartition("/")[0]
        if place == 0 and folder in named and "://" in folder:
            pieces += [Hole(named[folder]), piece.removeprefix(folder)]
        else:
            pieces += [Hole(named[part]) if part in named else part for part in dialect.cut(piece)]
    return joined(pieces)
