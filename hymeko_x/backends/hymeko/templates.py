"""Assemblies that are the same up to numbers, signs and words become instances of one template.

What differs is found by anti-unification (factor/unify.py), numbers and texts apart: ``left : leg(name=left) {}`` and
``right : leg(name=right side=-1) {}`` stand for two legs of which one is the mirror image of the other.
"""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.backends.hymeko.parts import value_of
from hymeko_x.factor.dialect import words
from hymeko_x.factor.forms import Hole, Signed
from hymeko_x.factor.unify import unify
from hymeko_x.ir.values import number_text
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import ArcItem, Comment, Expression, Field, Node, Parameter, Ref, Stereotype

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from hymeko_x.factor.forms import Text
    from hymeko_x.factor.unify import Unified
    from hymeko_x.language.syntax import Item, Value

_LEAST = 40
"""Letters that a template must save."""
_MOST_PARAMETERS = 16
"""Of one template, so that a reader can tell what an instance is."""
_MOST_ITEMS = 50_000
"""Templates stay far below what a reader lets them make of a text."""
_NAMED_AFTER = frozenset({"mass", "com", "inertia", "at", "limit", "effort", "velocity", "damping", "friction", "scale", "rgba", "color"})
"""Fields after which a parameter may be called; the others are plain values."""
_SIGNS = ("side", "front", "flip")
_WORD = re.compile(r"[A-Za-z]+")


class Piece(NamedTuple):
    """Items of the root, or of the assembly ``home``."""

    home: str
    items: tuple[Item, ...]


class Instance(NamedTuple):
    """What stands in place of a piece: its home as an instance of a template."""

    node: Node


class _Leaf(NamedTuple):
    """A number or text of a piece, and the field in which it stands."""

    value: float | str
    field: str


def templates(pieces: Sequence[Piece], taken: set[str]) -> tuple[list[Node], list[Piece | Instance]]:
    """The templates, whose names are added to ``taken``, and the pieces with instances where there is one."""
    found: list[Node] = []
    done: list[Piece | Instance] = list(pieces)
    if sum(len(piece.items) for piece in pieces) > _MOST_ITEMS:
        return found, done
    families: dict[str, list[int]] = {}
    for place, piece in enumerate(pieces):
        if piece.home and not _is_bound(piece):
            families.setdefault(_skeleton(piece), []).append(place)
    for places in families.values():
        made = _template([pieces[place] for place in places], taken) if len(places) > 1 else None
        if made is not None:
            found.append(made[0])
            for place, instance in zip(places, made[1], strict=True):
                done[place] = Instance(instance)
    return found, done


def _is_bound(piece: Piece) -> bool:
    """Whether a piece cannot stand in a template: comments are not kept there, and ``${`` means something."""
    return any(isinstance(item, Comment) for item in piece.items) or "${" in print_item(Node("", piece.items))


def _skeleton(piece: Piece) -> str:
    """What pieces must have in common: all but numbers and texts."""
    return print_item(Node("", _filled(piece.items, lambda leaf: 0.0 if isinstance(leaf.value, float) else "")))


def _template(pieces: list[Piece], taken: set[str]) -> tuple[Node, list[Node]] | None:
    """The template of pieces with one skeleton and its instances; None where that is not shorter."""
    rows = [_leaves(piece.items) for piece in pieces]
    numbers = [[number_text(leaf.value) for leaf in row if isinstance(leaf.value, float)] for row in rows]
    texts = [[leaf.value for leaf in row if isinstance(leaf.value, str)] for row in rows]
    of_numbers = unify(list(zip(*numbers, strict=True)), lambda text: (text,), signs=True)
    of_texts = unify(list(zip(*texts, strict=True)), words, signs=False)
    if len(of_numbers.parameters) + len(of_texts.parameters) > _MOST_PARAMETERS:
        return None
    fields = [leaf.field for leaf in rows[0] if isinstance(leaf.value, float)]
    names = _parameter_names(of_numbers, fields, len(of_texts.parameters))
    values: list[tuple[Value, ...]] = [
        *(tuple(value_of(text) for text in vector) for vector in of_texts.parameters),
        *(tuple(float(str(text)) for text in vector) for vector in of_numbers.parameters),
    ]
    said = iter([_number(text, names[len(of_texts.parameters) :]) for text in of_numbers.texts])
    written = iter([_text(text, names) for text in of_texts.texts])
    body = _filled(pieces[0].items, lambda leaf: next(said) if isinstance(leaf.value, float) else next(written))
    name = _free(_name(pieces[0]), taken)
    template = _with_defaults(Node(name, body, (Stereotype(Ref(("assembly",))),), ()), names, values)
    instances = [_instance(piece, template, values, place) for place, piece in enumerate(pieces)]
    before = sum(_letters(Node(piece.home, piece.items, template.stereotypes)) for piece in pieces)
    if before - _letters(template) - sum(map(_letters, instances)) < _LEAST:
        return None
    taken.add(name)
    return template, instances


def _with_defaults(template: Node, names: list[str], values: list[tuple[Value, ...]]) -> Node:
    """The template with its parameters; what most instances give is the default, where they agree."""
    parameters = []
    for name, vector in zip(names, values, strict=True):
        usual, uses = Counter(vector).most_common(1)[0]
        parameters.append(Parameter(name, usual if uses > 1 else None))
    signs = {name: 1.0 for name in names if name in _SIGNS}
    return template._replace(
        parameters=tuple(parameter._replace(default=signs.get(parameter.name, parameter.default)) for parameter in parameters)
    )


def _instance(piece: Piece, template: Node, values: list[tuple[Value, ...]], place: int) -> Node:
    given = tuple(
        (parameter.name, vector[place])
        for parameter, vector in zip(template.parameters or (), values, strict=True)
        if parameter.default is None or str(vector[place]) != str(parameter.default)
    )
    return Node(piece.home, (), (Stereotype(Ref((template.name,)), given or None),))


def _letters(node: Node) -> int:
    return len("".join(print_item(node).split()))


# ---- names ---------------------------------------------------------------------------------------------------------------


def _parameter_names(numbers: Unified, fields: list[str], texts: int) -> list[str]:
    """Names for the texts, then for the numbers."""
    taken: set[str] = set()
    names = [_taken("name", taken) for _ in range(texts)]
    for column, is_sign in zip(numbers.columns, numbers.is_sign, strict=True):
        field = fields[column]
        free = [sign for sign in _SIGNS if sign not in taken] if is_sign else []
        names.append(_taken(free[0] if free else field if field in _NAMED_AFTER and not is_sign else "value", taken))
    return names


def _taken(wish: str, taken: set[str]) -> str:
    name = _free(wish, taken)
    taken.add(name)
    return name


def _free(wish: str, taken: set[str]) -> str:
    name, number = wish, 2
    while name in taken:
        name, number = f"{wish}{number}", number + 1
    return name


def _name(piece: Piece) -> str:
    """From where to where the assembly leads: ``hip_to_foot``."""
    named = [found[0].lower() for item in piece.items if isinstance(item, Node) and (found := _WORD.findall(item.name))]
    if not named:
        return "limb"
    return named[0] if named[0] == named[-1] else f"{named[0]}_to_{named[-1]}"


# ---- leaves --------------------------------------------------------------------------------------------------------------


def _leaves(items: tuple[Item, ...]) -> list[_Leaf]:
    """The numbers and texts of items, in order."""
    found: list[_Leaf] = []

    def collect(leaf: _Leaf) -> Value:
        found.append(leaf)
        return leaf.value

    _filled(items, collect)
    return found


def _filled(items: tuple[Item, ...], fill: Callable[[_Leaf], Value]) -> tuple[Item, ...]:
    """The items with every number and text replaced, in order."""
    done: list[Item] = []
    for item in items:
        if isinstance(item, Field) and item.value is not None:
            item = item._replace(value=_filled_value(item.value, item.name, fill))
        elif isinstance(item, Node):
            item = item._replace(items=_filled(item.items, fill))
        elif isinstance(item, ArcItem):
            weight = item.weight and tuple(_filled_value(value, "value", fill) for value in item.weight)
            item = item._replace(weight=weight, items=_filled(item.items, fill))
        done.append(item)
    return tuple(done)


def _filled_value(value: Value, field: str, fill: Callable[[_Leaf], Value]) -> Value:
    if isinstance(value, float | str):
        return fill(_Leaf(value, field))
    if type(value) is tuple:
        return tuple(_filled_value(part, field, fill) for part in value)
    return value


def _number(text: Text, names: list[str]) -> Value:
    """A number, a parameter, or a number with the sign of parameters."""
    if isinstance(text, str):
        return float(text)
    piece = text[0]
    if isinstance(piece, Hole):
        return Expression(names[int(piece.name)])
    assert isinstance(piece, Signed)
    signs = "*".join(names[int(name)] for name in piece.factors)
    return Expression(f"{'-' if piece.negative else ''}{signs}*{piece.magnitude}")


def _text(text: Text, names: list[str]) -> str:
    """A text with its holes as ``${name}``."""
    if isinstance(text, str):
        return text
    return "".join(f"${{{names[int(piece.name)]}}}" if isinstance(piece, Hole) else str(piece) for piece in text)
