"""Stereotypes: fields that many elements share are written once, ``drive() { effort 87 velocity 2.2 }``.

Works on the finished syntax tree. Elements of one kind are compared field by field; the set of fields that saves most
letters becomes a stereotype of its own, and so on with the elements that are left. It is named after the default class, after what its
elements are (``hip``, of shapes what their bodies are), or after the material or the mesh that it gives, and never like a body or a
joint. Reading merges the fields again, in the same order.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.backends.hymeko.assemblies import take_name
from hymeko_x.backends.hymeko.classes import apply_classes, in_reading_order, shortened, unmarked
from hymeko_x.backends.hymeko.elements import AGAIN, PrintedElement, Unit, by_item, elements, group, is_open
from hymeko_x.backends.hymeko.naming import names as best_names
from hymeko_x.backends.hymeko.values import value_of
from hymeko_x.factor.sets import candidates
from hymeko_x.formats.hymeko import RESERVED
from hymeko_x.language.syntax import Field, Item, Node, Stereotype
from hymeko_x.language.templates import standard_templates

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from hymeko_x.factor.sets import Pair
    from hymeko_x.language.classes import Given

_LEAST = 12
"""Letters that a stereotype must save to be worth a name."""
_WORTH = 1.1
"""How much longer a text with the default classes as stereotypes may be: it says a class once."""
_NAME = 6
"""Letters of a name, as far as they count against a stereotype."""
_MOST = 32
"""Stereotypes of one kind of element."""


class _Definition(Struct):
    """A stereotype: its units in order, and the type that it refines."""

    name: str
    units: list[Unit]
    base: tuple[Stereotype, ...]


def with_stereotypes(items: Sequence[Item], taken: Iterable[str] = (), given: Given | None = None, homes: Sequence[str] = ()) -> list[Item]:
    """The items of a robot behind the stereotypes that several of them share. ``taken`` are names of other templates.

    ``given``: default classes that are stereotypes of the text, with what each gives; ``homes``: the assembly of each item, as far as it
    has one, which is a part of the names of what is in it.
    """
    items, classes = unmarked(items)
    names = {*standard_templates(), *RESERVED, *taken, *(given or ()), *_names_of_elements(items)}
    common = {home for home, count in Counter(homes).items() if 3 * count > len(homes)}  # those tell no element from another
    groups: dict[tuple[str, str], list[PrintedElement]] = {}
    for element in elements(items):
        home = homes[element.path[0]] if homes else ""
        element.home = "" if home in common else home
        groups.setdefault(group(element), []).append(element)
    definitions: list[_Definition] = []
    changed: dict[tuple[int, ...], Node] = {}
    for (kind, _), members in groups.items():
        found, made = _shortest(kind, members, classes, given or {}, names)
        definitions += found
        changed |= {element.path: _applied(element) for element in made if element.types != element.node.stereotypes}
    return [*map(_definition, definitions), *(shortened(_rebuilt(number, item, changed)) for number, item in enumerate(items))]


def _shortest(
    kind: str, members: list[PrintedElement], classes: Mapping[tuple[int, ...], Field], given: Given, names: set[str]
) -> tuple[list[_Definition], list[PrintedElement]]:
    """The stereotypes of one group and its elements with them: with default classes as stereotypes, or without, whichever is shorter."""
    ways: list[tuple[int, set[str], list[_Definition], list[PrintedElement]]] = []
    for wanted in (given, {}) if given else ({},):
        found = [PrintedElement(old.path, old.owner, old.node, old.units, home=old.home) for old in members]
        apply_classes(found, classes, wanted)
        if wanted and not any(element.of_class for element in found):
            continue
        taken = {*names}
        definitions = _stereotypes(kind, found, taken)
        ways.append((_cost(definitions, found), taken, definitions, found))
    _, taken, definitions, found = ways[0] if ways[0][0] <= _WORTH * ways[-1][0] else ways[-1]
    names |= taken
    return definitions, found


def _cost(definitions: list[_Definition], members: list[PrintedElement]) -> int:
    """Letters of the stereotypes, and of what the elements have beside them."""
    texts = [unit.text for definition in definitions for unit in definition.units]
    texts += [unit.text for element in members for unit in element.left]
    types = [kind for definition in definitions for kind in definition.base] + [kind for element in members for kind in element.types]
    return sum(len("".join(text.split())) for text in texts) + sum(len(kind.ref.dotted) + 1 for kind in types) + 5 * len(definitions)


def _names_of_elements(items: Iterable[Item]) -> Iterable[str]:
    """The names of bodies, joints and the like: one of a stereotype would be taken for them. A material is another kind of name."""
    for item in items:
        if isinstance(item, Node) and not (item.stereotypes and item.stereotypes[0].ref.path == ("material",)):
            yield str(item.name)


# ---- finding -------------------------------------------------------------------------------------------------------------


def _stereotypes(kind: str, members: list[PrintedElement], names: set[str]) -> list[_Definition]:
    """The stereotypes of one group, the one that saves most first, then those that refine it; those of each class for themselves."""
    found: list[_Definition] = []
    by_types: dict[tuple[object, ...], list[PrintedElement]] = {}
    for member in members:
        by_types.setdefault((member.types, "class" in member.of_class), []).append(member)
    queue = [(alike, alike[0].types) for alike in by_types.values()]
    for left, base in queue:
        while len(left) > 1 and len(found) < _MOST:
            best = _best(kind, left)
            if best is None:
                break
            units, served = best
            name = take_name([*best_names(kind, units, served)], names)
            definition = _Definition(name, units, base)
            for member in served:
                member.refine(name, units)
            found.append(definition)
            queue.append((served, served[0].types))
            gone = {member.path for member in served}
            left = [element for element in left if element.path not in gone]
    return found


def _best(kind: str, left: list[PrintedElement]) -> tuple[list[Unit], list[PrintedElement]] | None:
    """The set of units that saves most, and the elements that it serves."""
    for shared in candidates([element.pairs for element in left]):
        members = [element for element in left if all(slot in element.units and element.units[slot].text == text for slot, text in shared)]
        units = _in_order(kind, shared, members)
        members = [element for element in members if _keeps_order(kind, units, element)]
        if len(members) > 1 and _saving(kind, units, members) >= _LEAST:
            return units, members
    return None


def _in_order(kind: str, shared: frozenset[Pair], members: list[PrintedElement]) -> list[Unit]:
    """The units of a stereotype in the order of its first element.

    Where order counts, units between them that differ are held as well, with their most frequent text; elements then have their own.
    """
    first = members[0]
    slots = {slot for slot, _ in shared}
    last = max(number for number, slot in enumerate(first.units) if slot in slots)
    found: list[Unit] = []
    for slot, unit in list(first.units.items())[: last + 1]:
        if slot in slots:
            found.append(unit)
        elif _is_ordered(kind, unit) and slot not in first.given and not first.inherits(slot):
            texts = Counter(member.units[slot].text for member in members if slot in member.units)
            common = max(texts, key=lambda text: (texts[text], text))
            found.append(next(member.units[slot] for member in members if slot in member.units and member.units[slot].text == common))
    return found


def _is_ordered(kind: str, unit: Unit) -> bool:
    """Whether the order of such units counts: parameters of open kinds."""
    return not unit.format and isinstance(unit.item, Field) and unit.item.value is not None and is_open(kind)


def _keeps_order(kind: str, units: list[Unit], element: PrintedElement) -> bool:
    """Whether an element has all units of the stereotype, and merging both gives its units in their order."""
    given = {**element.given, **{unit.slot: unit for unit in units}}
    if not given.keys() <= element.units.keys():
        return False
    own = [slot for slot in element.units if slot not in given and not element.inherits(slot)]
    differing = [slot for slot, unit in given.items() if element.units[slot].text != unit.text]
    if not all(_is_ordered(kind, element.units[slot]) for slot in differing) or _splits_repeated(element, given, differing):
        return False
    by_format: dict[str, list[str]] = {}
    slots = in_reading_order((*given, *own), element.of_class) if element.of_class else (*given, *own)
    for slot in slots:
        by_format.setdefault(element.units[slot].format, []).append(slot)
    merged = {format: iter(slots) for format, slots in by_format.items()}
    ordered = is_open(kind)
    return all(next(merged[unit.format]) == slot for slot, unit in element.units.items() if unit.format or ordered)


def _splits_repeated(element: PrintedElement, given: Mapping[str, Unit], differing: list[str]) -> bool:
    """Whether some of several fields of one name would stand in the stereotype and some in the element."""
    repeated = {slot.split(AGAIN)[0] for slot in element.units if AGAIN in slot}
    names = Counter(slot.split(AGAIN)[0] for slot in element.units)
    shared = Counter(slot.split(AGAIN)[0] for slot in given if slot not in differing)
    return any(shared[name] not in (0, names[name]) for name in repeated) or any(slot.split(AGAIN)[0] in repeated for slot in differing)


def _saving(kind: str, units: list[Unit], members: list[PrintedElement]) -> int:
    """Letters that a stereotype saves, its definition and its name counted."""
    name = min(len(next(best_names(kind, units, members))), _NAME) + 1
    texts = {unit.slot: unit.text for unit in units}
    saved = 0
    for member in members:
        before = sum(len(step) + 1 for kind in member.types for step in kind.ref.path)
        saved += sum(unit.cost for unit in member.left if texts.get(unit.slot) == unit.text)
        saved -= 0 if member.stereotype else max(name - before, 0)
    return saved - sum(unit.cost for unit in units) - name - 10


# ---- applying ------------------------------------------------------------------------------------------------------------


def _definition(definition: _Definition) -> Node:
    items: list[Item] = []
    blocks: dict[str, list[Item]] = {}
    for unit in definition.units:
        if unit.format:
            blocks.setdefault(unit.format, []).append(unit.item)
        elif unit.slot == "class" and unit.item == Field("class", value_of(definition.name)):
            items.append(Field("class"))
        else:
            items.append(unit.item)
    items.extend(Node(form, tuple(inner)) for form, inner in blocks.items())
    return Node(definition.name, tuple(items), definition.base, ())


def _applied(element: PrintedElement) -> Node:
    """The element with its stereotype, without the units of that."""
    items: list[Item] = []
    for item, units in by_item(element.node):
        left = [unit for unit in units if not element.inherits(unit.slot)]
        if not units or (not units[0].format and left):
            items.append(item)
        elif left and isinstance(item, Node):
            items.append(item._replace(items=tuple(unit.item for unit in left)))
    return element.node._replace(items=tuple(items), stereotypes=element.types)


def _rebuilt(number: int, item: Item, changed: Mapping[tuple[int, ...], Node]) -> Item:
    """The item with its stereotypes, and with those of the shapes in it."""
    if not isinstance(item, Node):
        return item
    outer = changed.get((number,))
    inner = {place: node for place in range(len(item.items)) if (node := changed.get((number, place))) is not None}
    if inner:
        by_identity = {id(item.items[place]): node for place, node in inner.items()}
        base = outer or item
        return base._replace(items=tuple(by_identity.get(id(part), part) for part in base.items))
    return outer or item
