"""Default classes of a format as stereotypes of a text: ``visual() : class { geom { group 2 } }``.

The blocks in a class are the format's own elements with their attributes, and classes in it begin with what it gives:
``collision() { foot() { geom { size 0.02 } } }``. An element made from a class has the fields that the class gives to its kind, and
the class itself where it is not in force there anyway (``childclass``). The same classes may stand as the format's own section,
``mjcf { default { .. } }``.
"""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, TypeGuard

from hymeko_x import formats
from hymeko_x.language.markup import markup_of
from hymeko_x.language.syntax import Field, Node, Quantity, QuotedName, Ref, Stereotype, is_list

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping, Sequence

    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Extra
    from hymeko_x.language.syntax import Document, Item, Value

CLASS = (Stereotype(Ref(("class",))),)
"""What a default class is a stereotype of."""
IMPLIED = "class"
"""The ``type`` of the fields that an element has from a default class that is its stereotype, also of the field ``class``."""
SAME = "same"
"""The ``type`` of the field ``class`` of an element whose class is in force there anyway, while a text is made."""
PLAIN_UNITS = {"angle": "deg", "length": "m", "mass": "kg"}
"""The units of plain numbers in a text that has no others."""
_AXES = {(1.0, 0.0, 0.0): "X", (0.0, 1.0, 0.0): "Y", (0.0, 0.0, 1.0): "Z"}
_JOINTS = {"prismatic": "prismatic", "ball": "ball", "floating": "ball", "screw": "", "fixed": "", "compound": "", "joint": "joint"}
_KINDS = frozenset({"material", "frame", "mesh", "motor", "servo"})
_SHAPES = frozenset({"visual", "collision", "shape"})

Given = dict[str, dict[str, tuple[Field, ...]]]
"""The fields that classes give, by class and by kind of element."""


def native() -> Format:
    """The format that has default classes."""
    return next(format for format in formats.FORMATS if format.classes)


def given_fields(texts: Iterable[str], units: Mapping[str, str]) -> Given:
    """What each class gives to each kind of element. ``texts`` are the elements of the whole; ``units`` those of plain numbers."""
    row = native()
    assert row.classes is not None
    settings = [text for text in texts if text.startswith(row.class_elements)]
    if not any(text.startswith(row.class_elements[0]) for text in settings):
        return {}
    found = formats.loaded(row.classes)(settings)
    return {
        name: {kind: tuple(_field(word, value, unit, units) for word, value, unit in fields) for kind, fields in kinds.items()}
        for name, kinds in found.items()
    }


def _field(word: str, value: Value, unit: str, units: Mapping[str, str]) -> Field:
    """A field of a class; its numbers have their unit where that is not the one of plain numbers."""
    if word == "axis" and is_list(value):
        back = tuple(-float(part) + 0.0 for part in value)  # type: ignore[arg-type]
        if value in _AXES or back in _AXES:
            return Field(word, Ref((_AXES[value],)) if value in _AXES else Ref((_AXES[back],), "-"))  # type: ignore[index]
    if isinstance(value, str):
        return Field(word, Ref((value,)) if value.isidentifier() else value)
    if not unit or unit in units.values():
        return Field(word, value)
    return Field(word, (_with_unit(value[0], unit), value[1]) if _is_turned(value) else _with_unit(value, unit))


def _is_turned(value: Value) -> TypeGuard[tuple[Value, Value]]:
    """Whether it is a place with a rotation, which has no unit."""
    return is_list(value) and len(value) == 2 and is_list(value[1])


def _with_unit(value: Value, unit: str) -> Value:
    if is_list(value):
        return tuple(_with_unit(part, unit) for part in value)
    return Quantity(value, unit) if isinstance(value, float) else value


def is_section(extra: Extra) -> bool:
    """Whether an extra of the whole is a section of default classes."""
    row = native()
    return extra.format == row.family and not extra.path and extra.text.startswith(row.class_elements[0])


def is_class(item: Item) -> bool:
    """Whether an item defines a default class."""
    return isinstance(item, Node) and item.parameters == () and item.stereotypes == CLASS


def kind_of(node: Node, types: Iterable[str]) -> str:
    """The kind of an element that a class gives fields to; ``types`` are those of its types that are no classes."""
    if node.name in _SHAPES and not node.edge:
        return "shape"
    found = [*types]
    if node.edge:
        return next((kind for name, kind in _JOINTS.items() if name in found), "" if found else "joint")
    return next((name for name in found if name in _KINDS or name.startswith("actuator.")), "")


def settled(items: tuple[Item, ...]) -> tuple[Item, ...]:
    """The items of an element with what its class gives behind its own, and the parameters that come first before all others."""
    given = [item for item in items if isinstance(item, Field) and item.type == IMPLIED]
    if not given:
        return items
    own = [item for item in items if not isinstance(item, Field) or item.type != IMPLIED]
    leading = native().leading
    first = [item for name in leading for item in (*own, *given) if isinstance(item, Field) and item.name == name]
    return (*first, *(item for item in (*own, *given) if item not in first))


# ---- as stereotypes ------------------------------------------------------------------------------------------------------


def definitions_of(section: Node) -> tuple[Node, ...] | None:
    """The section of classes as definitions, or None where they cannot stand for it (comments, no class at all)."""
    if section.parameters is not None or any(isinstance(item, Field) and item.name != "class" for item in section.items):
        return None
    row = native()
    named = any(isinstance(item, Field) for item in section.items)
    inner = [item for item in section.items if not (isinstance(item, Node) and item.name == section.name)]
    if inner:
        node = _definition(section, row.main_class)
        if node is None:
            return None
        mark = (Field("class"),) if named else ()
        return (node._replace(items=(*mark, *node.items), stereotypes=CLASS),)
    classes = [_definition(item, None) for item in section.items if isinstance(item, Node)]
    found = tuple(node._replace(stereotypes=CLASS) for node in classes if node is not None)
    return found if found and len(found) == len(section.items) else None


def _definition(section: Node, name: str | None) -> Node | None:
    """The definition of one class with those in it, as deep as XML blocks are."""
    items: list[Item] = []
    for item in section.items:
        if isinstance(item, Field) and item.name == "class":
            name = _word(item.value) if name is None else name
        elif not isinstance(item, Node) or section.parameters is not None:
            return None
        elif item.name != section.name:
            items.append(item)
        elif (inner := _definition(item, None)) is not None:
            items.append(inner)
        else:
            return None
    return None if name is None else Node(name if name.isidentifier() else QuotedName(name), tuple(items), parameters=())


def _word(value: Value | None) -> str | None:
    if isinstance(value, Ref) and len(value.path) == 1:
        return value.path[0]
    return value if isinstance(value, str) and value else None


def section_of(definitions: Sequence[Node]) -> Node:
    """The format's own section that these definitions stand for."""
    row = native()
    name = row.class_elements[0][1:]
    if len(definitions) == 1 and definitions[0].name == row.main_class:
        main = definitions[0]
        own = [item for item in main.items if not isinstance(item, Field)]
        mark = (Field("class", Ref((row.main_class,))),) if len(own) < len(main.items) else ()
        return Node(name, (*mark, *(_as_section(item, name) for item in own)), line=main.line, column=main.column)
    return Node(name, tuple(_as_section(item, name) for item in definitions), line=definitions[0].line, column=definitions[0].column)


def _as_section(item: Item, name: str) -> Item:
    if not isinstance(item, Node) or item.parameters != ():
        return item
    value: Value = Ref((str(item.name),)) if str(item.name).isidentifier() else str(item.name)
    inner = (_as_section(part, name) for part in item.items)
    return Node(name, (Field("class", value), *inner), line=item.line, column=item.column)


# ---- in a document -------------------------------------------------------------------------------------------------------


def with_classes(document: Document, reserved: Container[str]) -> Document:
    """The document with its classes as sections of their format, and as hidden templates that hold what each gives by kind.

    ``reserved`` are names that mean other types.
    """
    row = native()
    items = (_with_classes(item, row, reserved) if _is_root(item) else item for item in document.items)
    return document._replace(items=tuple(items))


def _is_root(item: Item) -> TypeGuard[Node]:
    return isinstance(item, Node) and item.parameters is None and not item.edge


def _with_classes(root: Node, row: Format, reserved: Container[str]) -> Node:
    """A root with its classes: ``row.family { .. }`` for each run of definitions, and the templates behind all."""
    items: list[Item] = []
    for are_classes, run in groupby(root.items, is_class):
        found = list(run)
        items += [Node(row.family, (section_of(found),))] if are_classes else found  # type: ignore[arg-type]
    blocks = [item for item in items if isinstance(item, Node) and item.name == row.family and not isinstance(item.name, QuotedName)]
    elements = [inner for block in blocks for inner in block.items if isinstance(inner, Node)]
    texts = [text for element in elements if (text := markup_of(element, None)) is not None]
    given = given_fields(texts, units_of(root))
    taken = {str(item.name) for item in items if isinstance(item, Node) and item.parameters is not None}
    return root._replace(
        items=(*items, *(template(name, kinds) for name, kinds in given.items() if name not in taken and name not in reserved))
    )


def template(name: str, kinds: Mapping[str, tuple[Field, ...]]) -> Node:
    """The hidden template of a class."""
    mark = Field("class", name, IMPLIED)
    blocks = (Node(kind, tuple(field._replace(type=IMPLIED) for field in fields)) for kind, fields in kinds.items())
    return Node(name, (mark, *blocks), CLASS, ())


def units_of(root: Node) -> dict[str, str]:
    """The units of plain numbers in a root."""
    words: list[str] = []
    for item in root.items:
        if isinstance(item, Node) and item.name == "units" and not item.stereotypes and not isinstance(item.name, QuotedName):
            fields = (field for field in item.items if isinstance(field, Field) and field.name != "digits")
            words += [word for field in fields for word in (field.name, _word(field.value)) if word]
    return {**PLAIN_UNITS, **dict(zip(words[::2], words[1::2], strict=False))}
