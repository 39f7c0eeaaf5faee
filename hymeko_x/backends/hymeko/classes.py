"""Default classes of a format as stereotypes of the elements that have them: ``visual : visual { .. }``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.hymeko.elements import SHAPES, Unit, group, is_open
from hymeko_x.language.classes import SAME, kind_of, native
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import Field, Item, Node, QuotedName, Ref, is_field
from hymeko_x.language.templates import standard_templates

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from hymeko_x.backends.hymeko.elements import PrintedElement
    from hymeko_x.language.classes import Given

Path = tuple[int, ...]


def unmarked(items: Sequence[Item]) -> tuple[list[Item], dict[Path, Field]]:
    """The items without marks, and the field ``class`` of each element with its mark, by place."""
    found: dict[Path, Field] = {}
    plain: list[Item] = []
    for number, item in enumerate(items):
        if not isinstance(item, Node) or item.parameters is not None:
            plain.append(item)
            continue
        inner = [_unmarked(part, (number, place), found) for place, part in enumerate(item.items)]
        plain.append(_unmarked(item._replace(items=tuple(inner)), (number,), found))
    return plain, found


def _unmarked(item: Item, path: Path, found: dict[Path, Field]) -> Item:
    """An element without its mark. A field that is only a mark leaves."""
    mark = next((part for part in item.items if is_field(part, ("class",))), None) if isinstance(item, Node) else None
    if mark is None or not isinstance(item, Node):
        return item
    found[path] = mark
    if not mark.type:
        return item
    left = (part for part in item.items if part is not mark or mark.type == SAME)
    return item._replace(items=tuple(part._replace(type="") if part is mark else part for part in left))


def apply_classes(elements: Iterable[PrintedElement], classes: Mapping[Path, Field], given: Given) -> None:
    """Give elements the classes that they have as stereotypes, where that is shorter."""
    for element in elements:
        mark = classes.get(element.path)
        name = _name(mark)
        if mark is None or name not in given:
            continue
        units = _units(given[name].get(kind_of(element.node, _bases(element.node)), ()))
        if not mark.type:
            units.append(Unit("class", print_item(mark), mark))
        texts = {unit.slot: unit.text for unit in units}
        saved = sum(unit.cost for slot, unit in element.units.items() if texts.get(slot) == unit.text)
        if saved <= len(name) + 1 or not texts.keys() <= element.units.keys():
            continue
        own = [slot for slot, unit in element.units.items() if texts.get(slot) != unit.text]
        if not is_open(group(element)[0]) or in_reading_order(own, texts) == list(element.units):
            element.give_class(name if name.isidentifier() else QuotedName(name), units)


def in_reading_order(own: Iterable[str], of_class: Iterable[str]) -> list[str]:
    """The slots of an element as its reader puts them: see :func:`hymeko_x.language.classes.settled`."""
    slots = list(dict.fromkeys((*own, *of_class)))
    first = [name for name in native().leading if name in slots]
    return [*first, *(slot for slot in slots if slot not in first)]


def _units(fields: Iterable[Field]) -> list[Unit]:
    return [Unit(field.name, print_item(field), field) for field in fields]


def _name(mark: Field | None) -> str:
    """The class that a field names; empty for none, or several."""
    value = mark.value if mark is not None else None
    if isinstance(value, Ref) and len(value.path) == 1:
        return value.path[0]
    return value if isinstance(value, str) else ""


def _bases(node: Node) -> Iterator[str]:
    """The standard types of a node."""
    stack = [*node.stereotypes]
    while stack:
        path = stack.pop(0).ref.path
        name = path[0]
        yield ".".join(path)
        yield name
        stack.extend(standard_templates()[name].stereotypes if name in standard_templates() else ())


def shortened(item: Item) -> Item:
    """An item in which shapes that have nothing but a mesh are fields: ``visual "file"``."""
    if not isinstance(item, Node) or item.parameters is not None:
        return item
    items = tuple(_as_field(part) for part in item.items)
    return item if all(part is old for part, old in zip(items, item.items, strict=True)) else item._replace(items=items)


def _as_field(item: Item) -> Item:
    if not isinstance(item, Node) or item.name not in SHAPES or item.stereotypes or len(item.items) != 1:
        return item
    only = item.items[0]
    return Field(item.name, only.value) if isinstance(only, Field) and only.name == "mesh" else item
