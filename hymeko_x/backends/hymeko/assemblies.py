"""Assemblies: elements side by side whose names begin alike, and templates of assemblies that are alike.

``left : assembly { hip {..} knee {..} }`` stands for ``left_hip {..} left_knee {..}``; an assembly may stand in several pieces.
Assemblies that are the same up to numbers, signs and words become instances of one template: ``left : leg(name=left) {}`` and
``right : leg(name=right side=-1) {}`` are two legs of which one mirrors the other. The parameters are found by anti-unification
(factor/unify.py).
"""

from __future__ import annotations

import heapq
import re
from collections import Counter
from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.backends.hymeko.values import value_of
from hymeko_x.factor.forms import Hole, Signed, words
from hymeko_x.factor.unify import unify
from hymeko_x.factor.words import limb_of_most, meaning
from hymeko_x.formats.hymeko import AXES, RESERVED, ROLE_MOVES
from hymeko_x.ir.digits import number_text
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.names import first_free_name
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import ArcItem, Comment, Expression, Field, Node, Parameter, Ref, Stereotype

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from hymeko_x.backends.hymeko.sheet import HymekoSheet
    from hymeko_x.factor.forms import Text
    from hymeko_x.factor.unify import Unified
    from hymeko_x.ir.mechanism import Extra
    from hymeko_x.language.syntax import Item, Value

Row = Id | list["Extra"]
"""An element, or the extras of the whole between two elements."""

_FRAME = 11
"""Letters of `` : assembly { }``."""
_FEWEST = 3
"""Elements of a piece of an assembly."""
_MOST_WORDS = 4
"""Of a name that the beginning may have."""
_BARE = "datum"
"""Elements that may be a name alone, which has no place in an assembly."""
_NO_NAMES = {*KINDS.values(), *RESERVED, *AXES}
_ROLES = frozenset(("", "at", "mimic", *ROLE_MOVES))
"""Roles of arcs that are words of the language; others are names."""


class Piece(NamedTuple):
    """Items of the root, or of the assembly ``home``."""

    home: str
    items: tuple[Item, ...]


class PieceInstance(NamedTuple):
    """A piece as an instance of a template."""

    node: Node


def assemblies(rows: Sequence[Row], sheet: HymekoSheet, refused: frozenset[str]) -> dict[Id, str]:
    """The assembly in which each element is to stand, the ones that save most first. ``refused`` are names that none may have."""
    members = _members(rows, sheet, refused)
    weight = {place: _mentions(row, sheet) for place, row in enumerate(rows) if isinstance(row, Id)}
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


def _members(rows: Sequence[Row], sheet: HymekoSheet, refused: frozenset[str]) -> dict[str, list[int]]:
    """By the beginnings of names, up to an underscore, the places of their elements; in assemblies comments in a block are not kept."""
    members: dict[str, list[int]] = {}
    for place, row in enumerate(rows):
        if not isinstance(row, Id) or row.kind == _BARE or _has_comments(row, sheet):
            continue
        for prefix in _prefixes(row.name):
            if prefix not in refused:
                members.setdefault(prefix, []).append(place)
    return members


def _has_comments(row: Id, sheet: HymekoSheet) -> bool:
    keys = (row, *sheet.shared.get(row, ()))
    return any(extra.format == "comment" for key in keys for extra in sheet.mechanism.extras.get(key, ()))


def _prefixes(name: str) -> Iterator[str]:
    cut = name.find("_")
    for _ in range(_MOST_WORDS):
        if not 0 < cut < len(name) - 1:
            return
        prefix, short = name[:cut], name[cut + 1 :]
        if prefix not in _NO_NAMES and short not in AXES and not short.startswith(f"{prefix}_"):
            yield prefix
        cut = name.find("_", cut + 1)


def _mentions(key: Id, sheet: HymekoSheet) -> tuple[str, ...]:
    """The names that an element's text has, its own first."""
    edge = sheet.mechanism.graph.edges.get(key)
    arcs = edge.arcs if edge is not None else sheet.attached.get(key, ())
    return (key.name, *(arc.target.name for arc in arcs if arc.target.name != key.name))


def _pieces(places: Sequence[int], rows: Sequence[Row]) -> list[list[int]]:
    """The places in runs between which nothing but comments stands."""
    pieces: list[list[int]] = []
    for place in places:
        gap = rows[pieces[-1][-1] + 1 : place] if pieces and place - pieces[-1][-1] <= 2 else None
        if gap is not None and all(isinstance(row, list) and all(extra.format == "comment" for extra in row) for row in gap):
            pieces[-1].append(place)
        else:
            pieces.append([place])
    return pieces


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


# ---- templates ---------------------------------------------------------------------------------------------------------

_LEAST = 40
"""Letters that a template must save."""
_MOST_PARAMETERS = 16
"""Of one template, so that an instance stays readable."""
_MOST_ITEMS = 50_000
"""Larger mechanisms get no templates, which stay far below the reader's limit."""
_NAMED_AFTER = frozenset({"mass", "com", "inertia", "at", "limit", "effort", "velocity", "damping", "friction", "scale", "rgba", "color"})
_NAMED_AFTER |= {"axes", "anchor", "size", "fromto", "box", "sphere", "cylinder", "capsule", "armature", "stiffness", "ref"}
"""Fields after which a parameter may be called; the others are plain values."""
_TEXTS_NAMED_AFTER = frozenset(("mesh", "material", "file"))
"""Fields after which a parameter for texts of these alone is called; the others are names."""
_SIGNS = ("side", "front", "flip")
_WORD = re.compile(r"[A-Za-z]+")


class _Leaf(NamedTuple):
    """A number, text or name of a piece, and the field in which it stands."""

    value: float | str
    field: str


def templates(pieces: Sequence[Piece], taken: set[str]) -> tuple[list[Node], list[Piece | PieceInstance]]:
    """The templates, whose names are added to ``taken``, and the pieces with instances where there is one."""
    found: list[Node] = []
    done: list[Piece | PieceInstance] = list(pieces)
    if sum(len(piece.items) for piece in pieces) > _MOST_ITEMS:
        return found, done
    families: dict[str, list[int]] = {}
    for place, piece in enumerate(pieces):
        if piece.home and not _is_bound(piece):
            families.setdefault(_skeleton(piece), []).append(place)
    elements = {*_names_of_items(pieces), *(piece.home for piece in pieces)}
    for places in families.values():
        made = _template([pieces[place] for place in places], taken, elements) if len(places) > 1 else None
        if made is not None:
            found.append(made[0])
            for place, instance in zip(places, made[1], strict=True):
                done[place] = PieceInstance(instance)
    return found, done


def _is_bound(piece: Piece) -> bool:
    """Whether a piece cannot stand in a template: comments are not kept there, and ``${`` begins an expression."""
    return any(isinstance(item, Comment) for item in piece.items) or "${" in print_item(Node("", piece.items))


def _skeleton(piece: Piece) -> str:
    """The text of a piece without numbers, texts and names, which pieces of one template have in common."""
    return print_item(Node("", _filled(piece.items, lambda leaf: 0.0 if isinstance(leaf.value, float) else "")))


def _template(pieces: list[Piece], taken: set[str], elements: set[str]) -> tuple[Node, list[Node]] | None:
    """The template of pieces with one skeleton and its instances, not named like an element; None where that is not shorter."""
    rows = [_leaves(piece.items) for piece in pieces]
    numbers = [[number_text(leaf.value) for leaf in row if isinstance(leaf.value, float)] for row in rows]
    texts = [[leaf.value for leaf in row if isinstance(leaf.value, str)] for row in rows]
    of_numbers = unify(list(zip(*numbers, strict=True)), lambda text: (text,), signs=True)
    of_texts = unify(list(zip(*texts, strict=True)), words, signs=False)
    if len(of_numbers.parameters) + len(of_texts.parameters) > _MOST_PARAMETERS:
        return None
    fields = [leaf.field for leaf in rows[0] if isinstance(leaf.value, float)]
    names = _parameter_names(of_numbers, fields, of_texts, [leaf.field for leaf in rows[0] if isinstance(leaf.value, str)])
    values: list[tuple[Value, ...]] = [
        *(tuple(value_of(text) for text in vector) for vector in of_texts.parameters),
        *(tuple(float(str(text)) for text in vector) for vector in of_numbers.parameters),
    ]
    plain = iter([_number(text, names[len(of_texts.parameters) :]) for text in of_numbers.texts])
    written = iter([_text(text, names) for text in of_texts.texts])
    body = _filled(pieces[0].items, lambda leaf: next(plain) if isinstance(leaf.value, float) else next(written))
    name = take_name([_name(pieces)], taken | elements)
    template = _with_defaults(Node(name, body, (Stereotype(Ref(("assembly",))),), ()), names, values)
    instances = [_instance(piece, template, values, place) for place, piece in enumerate(pieces)]
    before = sum(_letters(Node(piece.home, piece.items, template.stereotypes)) for piece in pieces)
    if before - _letters(template) - sum(map(_letters, instances)) < _LEAST:
        return None
    taken.add(name)
    return template, instances


def _with_defaults(template: Node, names: list[str], values: list[tuple[Value, ...]]) -> Node:
    """The template with its parameters; the most frequent value is the default, if several instances have it."""
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


def _parameter_names(numbers: Unified, fields: list[str], texts: Unified, text_fields: list[str]) -> list[str]:
    """Names for the texts, then for the numbers."""
    taken: set[str] = set()
    names = []
    for number in range(len(texts.parameters)):
        used = {
            field for field, text in zip(text_fields, texts.texts, strict=True) if not isinstance(text, str) and Hole(str(number)) in text
        }
        names.append(take_name([used.pop() if len(used) == 1 and used < _TEXTS_NAMED_AFTER else "name"], taken))
    for column, is_sign in zip(numbers.columns, numbers.is_sign, strict=True):
        field = fields[column]
        names.append(take_name([*_SIGNS, "value"] if is_sign else [field if field in _NAMED_AFTER else "value"], taken))
    return names


def take_name(wanted: Sequence[str], taken: set[str]) -> str:
    """The first of these names that is free, or the last one with a number behind it; then it is taken."""
    name = first_free_name(wanted, taken, "")
    taken.add(name)
    return name


def _name(pieces: Sequence[Piece]) -> str:
    """What the assemblies are, by their names or as a limb: ``finger``, ``leg``; else from where to where they lead: ``base_to_sensor``."""
    names = _names_of_items(pieces[:1])
    found = meaning([piece.home for piece in pieces]) or limb_of_most(names)
    if found:
        return found.lower()
    named = [words[0].lower() for name in names if (words := _WORD.findall(name))]
    if not named:
        return "limb"
    return named[0] if named[0] == named[-1] else f"{named[0]}_to_{named[-1]}"


def _names_of_items(pieces: Sequence[Piece]) -> list[str]:
    return [item.name for piece in pieces for item in piece.items if isinstance(item, Node)]


# ---- leaves --------------------------------------------------------------------------------------------------------------


def _leaves(items: tuple[Item, ...]) -> list[_Leaf]:
    """The numbers, texts and names of items, in order."""
    found: list[_Leaf] = []

    def collect(leaf: _Leaf) -> Value:
        found.append(leaf)
        return leaf.value

    _filled(items, collect)
    return found


def _filled(items: tuple[Item, ...], fill: Callable[[_Leaf], Value], *, within: bool = False) -> tuple[Item, ...]:
    """The items with every number, text and name of something else replaced, in order; ``within``: they stand in an element."""
    done: list[Item] = []
    for item in items:
        if isinstance(item, Field) and item.value is not None:
            item = item._replace(value=_filled_value(item.value, item.name, fill))
        elif isinstance(item, Node):
            name = _filled_name(item.name, fill) if within and item.stereotypes else item.name
            item = item._replace(name=name, items=_filled(item.items, fill, within=True))
        elif isinstance(item, ArcItem):
            weight = item.weight and tuple(_filled_value(value, "value", fill) for value in item.weight)
            role = item.role if item.role in _ROLES else _filled_name(item.role, fill)
            inner = _filled(item.items, fill, within=True)
            item = item._replace(role=role, ref=_filled_ref(item.ref, fill), weight=weight, items=inner)
        done.append(item)
    return tuple(done)


def _filled_ref(ref: Ref, fill: Callable[[_Leaf], Value], field: str = "name") -> Ref:
    return ref._replace(path=tuple(_filled_name(step, fill, field) for step in ref.path))


def _filled_name(name: str, fill: Callable[[_Leaf], Value], field: str = "name") -> str:
    """A name; a word with a meaning stays."""
    if name in _NO_NAMES:
        return name
    text = fill(_Leaf(name, field))
    assert isinstance(text, str)
    return text


def _filled_value(value: Value, field: str, fill: Callable[[_Leaf], Value]) -> Value:
    if isinstance(value, float | str):
        return fill(_Leaf(value, field))
    if type(value) is tuple:
        return tuple(_filled_value(part, field, fill) for part in value)
    return _filled_ref(value, fill, field) if isinstance(value, Ref) else value


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
