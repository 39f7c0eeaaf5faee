"""The elements of a syntax tree that may have a stereotype, and the fields and blocks of them that one can hold."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct, field

from hymeko_x.formats.hymeko import FOREIGN, PARTS
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import Field, Item, Node, QuotedName, Ref, Stereotype

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from hymeko_x.factor.sets import Row

SHAPES = frozenset({"visual", "collision", "shape"})
_WHOLE = frozenset({"safety", "calibration", "written"})
_ONE_OF_A_KIND = SHAPES | {"id", "mesh_id", "files"}
AGAIN = "\0"
"""Between the name and the number of a field that is there several times."""


class Unit(NamedTuple):
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


class PrintedElement(Struct):
    """An element that may get a stereotype: where it stands, its units in order, and the units of its stereotypes.

    ``owner`` is the name of the element, of a shape that of its body; ``types`` are what the element is made from;
    ``of_class`` are the units of the default class among those; ``home`` is the assembly that it stands in.
    """

    path: tuple[int, ...]
    owner: str
    node: Node
    units: dict[str, Unit]
    stereotype: str = ""
    given: dict[str, Unit] = field(default_factory=dict)
    left: list[Unit] = field(default_factory=list)
    """The units that its stereotypes do not hold as they are."""
    pairs: Row = field(default_factory=list)
    """The slots and texts of those."""

    types: tuple[Stereotype, ...] = ()
    of_class: dict[str, Unit] = field(default_factory=dict)
    home: str = ""

    def __post_init__(self) -> None:
        self.types = self.node.stereotypes
        self._keep(list(self.units.values()))

    def inherits(self, slot: str) -> bool:
        """Whether a stereotype or the default class holds this unit as it is."""
        given = self.given.get(slot) or self.of_class.get(slot)
        return given is not None and given.text == self.units[slot].text

    def refine(self, name: str, units: Iterable[Unit]) -> None:
        """Give the element a stereotype that holds these units, which refines the one that it has."""
        self.stereotype = name
        self.types = (Stereotype(Ref((name,))),)
        self.given = {**self.given, **{unit.slot: unit for unit in units}}
        self._keep_own()

    def give_class(self, name: str, units: Iterable[Unit]) -> None:
        """Give the element its default class as a stereotype, before all others."""
        self.types = (Stereotype(Ref((name,))), *self.types)
        self.of_class = {unit.slot: unit for unit in units}
        self._keep_own()

    def _keep_own(self) -> None:
        self._keep([unit for slot, unit in self.units.items() if not self.inherits(slot)])

    def _keep(self, left: list[Unit]) -> None:
        self.left = left
        self.pairs = [(unit.slot, unit.text) for unit in left]


def elements(items: Sequence[Item]) -> Iterable[PrintedElement]:
    """The elements, and the shapes and dofs in them."""
    for number, item in enumerate(items):
        if not isinstance(item, Node) or item.parameters is not None or (item.name in FOREIGN and not isinstance(item.name, QuotedName)):
            continue
        if item.name in ("units", "written", "world") and not isinstance(item.name, QuotedName) and not item.edge:
            continue
        outer = PrintedElement((number,), item.name, item, _units(item))
        if not (is_open(group(outer)[0]) and any(isinstance(inner, Field) and not _can_be_shared(inner) for inner in item.items)):
            yield outer  # parameters are in order, also those that no stereotype may hold
        for place, inner in enumerate(item.items):
            if isinstance(inner, Node) and (inner.name in SHAPES or (item.edge and inner.stereotypes)):
                yield PrintedElement((number, place), item.name, inner, _units(inner))


def group(element: PrintedElement) -> tuple[str, str]:
    """The kind and the type of an element; elements of one group may share a stereotype."""
    node = element.node
    if len(element.path) > 1 and not node.stereotypes:
        return node.name, ""
    if len(element.path) > 1:
        return "dof", node.stereotypes[0].ref.dotted
    types = ".".join(node.stereotypes[0].ref.path) if node.stereotypes else ""
    return (node.stereotypes[0].ref.path[0] if node.stereotypes else node.edge), f"{node.edge}{types}"


def _units(node: Node) -> dict[str, Unit]:
    """The units of a node by slot, in order."""
    return {unit.slot: unit for _, units in by_item(node) for unit in units}


def by_item(node: Node) -> Iterable[tuple[Item, list[Unit]]]:
    """The items of a node with their units; the slots of fields that are there several times are numbered."""
    count: Counter[str] = Counter()
    for item in node.items:
        units: list[Unit] = []
        for unit in _units_of(item):
            count[unit.slot] += 1
            number = count[unit.slot]
            units.append(unit if number == 1 else unit._replace(slot=f"{unit.slot}{AGAIN}{number}"))
        yield item, units


def _can_be_shared(item: Field) -> bool:
    """Whether a stereotype may hold a field: it is not one of a kind, not called like a format, without parameters of a template."""
    is_like_format = isinstance(item.name, QuotedName) and item.name in FOREIGN
    return item.name not in _ONE_OF_A_KIND and not is_like_format and "${" not in print_item(item)


def _units_of(item: Item) -> Iterable[Unit]:
    if isinstance(item, Node) and item.name in FOREIGN | _WHOLE and "${" in print_item(item):
        return
    if isinstance(item, Field) and item.name not in FOREIGN and _can_be_shared(item):
        yield Unit(f"`{item.name}" if isinstance(item.name, QuotedName) else item.name, print_item(item), item)
    elif isinstance(item, Node) and not isinstance(item.name, QuotedName) and item.name in FOREIGN | _WHOLE:
        if item.name in FOREIGN and item.parameters is None and all(isinstance(inner, Field) for inner in item.items):
            for inner in item.items:
                yield Unit(f"{item.name}/{getattr(inner, 'name', '')}", print_item(inner), inner, item.name)
        else:
            yield Unit(f"{item.name}{{}}" if item.parameters is None else f"{item.name}()", print_item(item), item)


def is_open(kind: str) -> bool:
    """Whether elements of this kind have parameters, the order of which counts."""
    words = PARTS.get({"motor": "actuator", "servo": "actuator", "pair": "contact", "connect": "loop", "weld": "loop"}.get(kind, kind))
    return words is not None and words.open
