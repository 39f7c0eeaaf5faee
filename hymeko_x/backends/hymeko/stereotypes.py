"""Stereotypes: fields that many elements share are written once, ``drive() { effort 87 velocity 2.2 }``.

Works on the finished syntax tree. Elements of one kind are compared field by field; the set of fields that saves most
letters becomes a stereotype of its own, and so on with the elements that are left. It is named after the default class, after what its
elements are (``hip``, of shapes what their bodies are), or after the material or the mesh that it gives, and never like a body or a
joint. Reading merges the fields again, in the same order.
"""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct, field

from hymeko_x.backends.hymeko.assemblies import take_name
from hymeko_x.backends.hymeko.values import value_of
from hymeko_x.factor.sets import candidates
from hymeko_x.factor.words import common_words, meaning
from hymeko_x.formats.hymeko import FOREIGN, PARTS, RESERVED
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import Field, Item, Node, QuotedName, Ref, Stereotype
from hymeko_x.language.templates import standard_templates

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from hymeko_x.factor.sets import Pair, Row

_SHAPES = frozenset({"visual", "collision", "shape"})
_WHOLE = frozenset({"safety", "calibration", "written"})
_ONE_OF_A_KIND = _SHAPES | {"id", "mesh_id", "files"}
_AGAIN = "\0"
"""Between the name and the number of a field that is there several times."""
_LEAST = 12
"""Letters that a stereotype must save to be worth a name."""
_MOST = 32
"""Stereotypes of one kind of element."""
_NAMES = {
    "visual": "look",
    "collision": "hull",
    "shape": "solid",
    "@": "axle",
    "": "part",
    "motor": "act",
    "servo": "act",
    "actuator": "act",
    "drive": "gear",
    "material": "paint",
    "frame": "mark",
    "sensor": "probe",
    "tendon": "cable",
    "texture": "image",
    "prismatic": "slider",
    "fixed": "mount",
    "dof": "turn",
}
"""The name of a stereotype whose elements have no common words in their names, by the type of the elements."""


class _Unit(NamedTuple):
    """A field or a block of an element that a stereotype can hold, with its text.

    ``slot`` is its name among the units of the element; ``format`` is set for an attribute in the block of that format.
    """

    slot: str
    text: str
    item: Item
    format: str = ""

    @property
    def cost(self) -> int:
        """Letters."""
        return len("".join(self.text.split()))


class _Element(Struct):
    """An element that may get a stereotype: where it stands, its units in order, and the units of its stereotypes.

    ``owner`` is the name of the element, of a shape that of its body.
    """

    path: tuple[int, ...]
    owner: str
    node: Node
    units: dict[str, _Unit]
    stereotype: str = ""
    given: dict[str, _Unit] = field(default_factory=dict)
    left: list[_Unit] = field(default_factory=list)
    """The units that its stereotypes do not hold as they are."""
    pairs: Row = field(default_factory=list)
    """The slots and texts of those."""

    def __post_init__(self) -> None:
        self._keep(list(self.units.values()))

    def inherits(self, slot: str) -> bool:
        """Whether a stereotype holds this unit as it is."""
        given = self.given.get(slot)
        return given is not None and given.text == self.units[slot].text

    def refine(self, definition: _Definition) -> None:
        """Give the element a stereotype, which refines the one that it has."""
        self.stereotype = definition.name
        self.given = {**self.given, **{unit.slot: unit for unit in definition.units}}
        self._keep([unit for slot, unit in self.units.items() if not self.inherits(slot)])

    def _keep(self, left: list[_Unit]) -> None:
        self.left = left
        self.pairs = [(unit.slot, unit.text) for unit in left]


class _Definition(Struct):
    """A stereotype: its units in order, and the type that it refines."""

    name: str
    units: list[_Unit]
    base: tuple[Stereotype, ...]


def with_stereotypes(items: Sequence[Item], taken: Iterable[str] = ()) -> list[Item]:
    """The items of a robot behind the stereotypes that several of them share. ``taken`` are names of other templates."""
    groups: dict[tuple[str, str], list[_Element]] = {}
    for element in _elements(items):
        groups.setdefault(_group(element), []).append(element)
    names = {*standard_templates(), *RESERVED, *taken, *_names_of_elements(items)}
    definitions: list[_Definition] = []
    for (kind, _), elements in groups.items():
        definitions.extend(_stereotypes(kind, elements, names))
    if not definitions:
        return list(items)
    changed = {element.path: _applied(element) for group in groups.values() for element in group if element.stereotype}
    return [*map(_definition, definitions), *(_rebuilt(number, item, changed) for number, item in enumerate(items))]


def _names_of_elements(items: Iterable[Item]) -> Iterable[str]:
    """The names of bodies, joints and the like: one of a stereotype would be taken for them. A material is another kind of name."""
    for item in items:
        if isinstance(item, Node) and not (item.stereotypes and item.stereotypes[0].ref.path == ("material",)):
            yield str(item.name)


# ---- what elements are made of -------------------------------------------------------------------------------------------


def _elements(items: Sequence[Item]) -> Iterable[_Element]:
    """The elements, and the shapes and dofs in them."""
    for number, item in enumerate(items):
        if not isinstance(item, Node) or item.parameters is not None or (item.name in FOREIGN and not isinstance(item.name, QuotedName)):
            continue
        if item.name in ("units", "written", "world") and not isinstance(item.name, QuotedName) and not item.edge:
            continue
        outer = _Element((number,), item.name, item, _units(item))
        if not (_is_open(_group(outer)[0]) and any(isinstance(inner, Field) and not _can_be_shared(inner) for inner in item.items)):
            yield outer  # parameters are in order, also those that no stereotype may hold
        for place, inner in enumerate(item.items):
            if isinstance(inner, Node) and (inner.name in _SHAPES or (item.edge and inner.stereotypes)):
                yield _Element((number, place), item.name, inner, _units(inner))


def _group(element: _Element) -> tuple[str, str]:
    """The kind and the type of an element; elements of one group may share a stereotype."""
    node = element.node
    if len(element.path) > 1 and not node.stereotypes:
        return node.name, ""
    if len(element.path) > 1:
        return "dof", node.stereotypes[0].ref.dotted
    types = ".".join(node.stereotypes[0].ref.path) if node.stereotypes else ""
    return (node.stereotypes[0].ref.path[0] if node.stereotypes else node.edge), f"{node.edge}{types}"


def _units(node: Node) -> dict[str, _Unit]:
    """The units of a node by slot, in order."""
    return {unit.slot: unit for _, units in _by_item(node) for unit in units}


def _by_item(node: Node) -> Iterable[tuple[Item, list[_Unit]]]:
    """The items of a node with their units; the slots of fields that are there several times are numbered."""
    count: Counter[str] = Counter()
    for item in node.items:
        units: list[_Unit] = []
        for unit in _units_of(item):
            count[unit.slot] += 1
            number = count[unit.slot]
            units.append(unit if number == 1 else unit._replace(slot=f"{unit.slot}{_AGAIN}{number}"))
        yield item, units


def _can_be_shared(item: Field) -> bool:
    """Whether a stereotype may hold a field: it is not one of a kind, not called like a format, without parameters of a template."""
    is_like_format = isinstance(item.name, QuotedName) and item.name in FOREIGN
    return item.name not in _ONE_OF_A_KIND and not is_like_format and "${" not in print_item(item)


def _units_of(item: Item) -> Iterable[_Unit]:
    if isinstance(item, Node) and item.name in FOREIGN | _WHOLE and "${" in print_item(item):
        return
    if isinstance(item, Field) and item.name not in FOREIGN and _can_be_shared(item):
        yield _Unit(f"`{item.name}" if isinstance(item.name, QuotedName) else item.name, print_item(item), item)
    elif isinstance(item, Node) and not isinstance(item.name, QuotedName) and item.name in FOREIGN | _WHOLE:
        if item.name in FOREIGN and item.parameters is None and all(isinstance(inner, Field) for inner in item.items):
            for inner in item.items:
                yield _Unit(f"{item.name}/{getattr(inner, 'name', '')}", print_item(inner), inner, item.name)
        else:
            yield _Unit(f"{item.name}{{}}" if item.parameters is None else f"{item.name}()", print_item(item), item)


# ---- finding -------------------------------------------------------------------------------------------------------------


def _stereotypes(kind: str, elements: list[_Element], names: set[str]) -> list[_Definition]:
    """The stereotypes of one group, the one that saves most first, then those that refine it."""
    found: list[_Definition] = []
    queue = [(elements, elements[0].node.stereotypes)]
    for left, base in queue:
        while len(left) > 1 and len(found) < _MOST:
            best = _best(kind, left)
            if best is None:
                break
            units, members = best
            definition = _Definition(_free_name(kind, units, members, names), units, base)
            for member in members:
                member.refine(definition)
            found.append(definition)
            queue.append((members, (Stereotype(Ref((definition.name,))),)))
            gone = {member.path for member in members}
            left = [element for element in left if element.path not in gone]
    return found


def _best(kind: str, elements: list[_Element]) -> tuple[list[_Unit], list[_Element]] | None:
    """The set of units that saves most, and the elements that it serves."""
    for shared in candidates([element.pairs for element in elements]):
        members = [
            element for element in elements if all(slot in element.units and element.units[slot].text == text for slot, text in shared)
        ]
        units = _in_order(kind, shared, members)
        members = [element for element in members if _keeps_order(kind, units, element)]
        if len(members) > 1 and _saving(kind, units, members) >= _LEAST:
            return units, members
    return None


def _in_order(kind: str, shared: frozenset[Pair], members: list[_Element]) -> list[_Unit]:
    """The units of a stereotype in the order of its first element.

    Where order counts, units between them that differ are held as well, with their most frequent text; elements then have their own.
    """
    first = members[0]
    slots = {slot for slot, _ in shared}
    last = max(number for number, slot in enumerate(first.units) if slot in slots)
    found: list[_Unit] = []
    for slot, unit in list(first.units.items())[: last + 1]:
        if slot in slots:
            found.append(unit)
        elif _is_ordered(kind, unit) and slot not in first.given:
            texts = Counter(member.units[slot].text for member in members if slot in member.units)
            common = max(texts, key=lambda text: (texts[text], text))
            found.append(next(member.units[slot] for member in members if slot in member.units and member.units[slot].text == common))
    return found


def _is_ordered(kind: str, unit: _Unit) -> bool:
    """Whether the order of such units counts: parameters of open kinds."""
    return not unit.format and isinstance(unit.item, Field) and unit.item.value is not None and _is_open(kind)


def _is_open(kind: str) -> bool:
    words = PARTS.get({"motor": "actuator", "servo": "actuator", "pair": "contact", "connect": "loop", "weld": "loop"}.get(kind, kind))
    return words is not None and words.open


def _keeps_order(kind: str, units: list[_Unit], element: _Element) -> bool:
    """Whether an element has all units of the stereotype, and merging both gives its units in their order."""
    given = {**element.given, **{unit.slot: unit for unit in units}}
    if not given.keys() <= element.units.keys():
        return False
    own = [slot for slot in element.units if slot not in given]
    differing = [slot for slot, unit in given.items() if element.units[slot].text != unit.text]
    if not all(_is_ordered(kind, element.units[slot]) for slot in differing) or _splits_repeated(element, given, differing):
        return False
    by_format: dict[str, list[str]] = {}
    for slot in (*given, *own):
        by_format.setdefault(element.units[slot].format, []).append(slot)
    merged = {format: iter(slots) for format, slots in by_format.items()}
    ordered = _is_open(kind)
    return all(next(merged[unit.format]) == slot for slot, unit in element.units.items() if unit.format or ordered)


def _splits_repeated(element: _Element, given: Mapping[str, _Unit], differing: list[str]) -> bool:
    """Whether some of several fields of one name would stand in the stereotype and some in the element."""
    repeated = {slot.split(_AGAIN)[0] for slot in element.units if _AGAIN in slot}
    names = Counter(slot.split(_AGAIN)[0] for slot in element.units)
    shared = Counter(slot.split(_AGAIN)[0] for slot in given if slot not in differing)
    return any(shared[name] not in (0, names[name]) for name in repeated) or any(slot.split(_AGAIN)[0] in repeated for slot in differing)


def _saving(kind: str, units: list[_Unit], members: list[_Element]) -> int:
    """Letters that a stereotype saves, its definition and its name counted."""
    name = len(next(_names(kind, units, members))) + 1
    texts = {unit.slot: unit.text for unit in units}
    saved = 0
    for member in members:
        types = member.node.stereotypes
        before = sum(len(step) for step in types[0].ref.path) + 1 if types else 0
        saved += sum(unit.cost for unit in member.left if texts.get(unit.slot) == unit.text)
        saved -= 0 if member.stereotype else max(name - before, 0)
    return saved - sum(unit.cost for unit in units) - name - 10


# ---- naming --------------------------------------------------------------------------------------------------------------


def _free_name(kind: str, units: list[_Unit], members: list[_Element], taken: set[str]) -> str:
    """The first of the names that is free, which is taken then; the last of them with a number where none is."""
    wanted = [*_names(kind, units, members)]
    return take_name(next((name for name in wanted if name not in taken), wanted[-1]), taken)


def _names(kind: str, units: list[_Unit], members: list[_Element]) -> Iterator[str]:
    """The default class, what the elements are by their names, the material or the mesh that they have, or a word for their type."""
    given = {unit.slot: name for unit in units if isinstance(unit.item, Field) and (name := _word(unit.item.value))}
    if "class" in given:
        yield given["class"]
    owners = [member.owner for member in members]
    plain = _NAMES.get(kind, f"{kind}_kind" if kind.isidentifier() else "kind")
    own = meaning(owners)
    is_inside = len(members[0].path) > 1
    yield from filter(_WORD.fullmatch, (own, f"{own}_{plain}") if is_inside else (common_words(owners), own))
    yield from (given[slot] for slot in ("material", "mesh") if _WORD.fullmatch(given.get(slot, "")))
    yield plain


def _word(value: object) -> str:
    """The name that a field gives: a word or a text; empty for another value."""
    if isinstance(value, Ref):
        return value.path[-1]
    return value if isinstance(value, str) else ""


_WORD = re.compile(r"[A-Za-z]\w{1,23}")
"""Words that make a good name."""


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


def _applied(element: _Element) -> Node:
    """The element with its stereotype, without the units of that."""
    items: list[Item] = []
    for item, units in _by_item(element.node):
        left = [unit for unit in units if not element.inherits(unit.slot)]
        if not units or (not units[0].format and left):
            items.append(item)
        elif left and isinstance(item, Node):
            items.append(item._replace(items=tuple(unit.item for unit in left)))
    return element.node._replace(items=tuple(items), stereotypes=(Stereotype(Ref((element.stereotype,))),))


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
