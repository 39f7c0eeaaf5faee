"""A block of HyMeKo text as its readers see it: fields by name, nodes, arcs, and the items that every element may have."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from hymeko_x import codes
from hymeko_x.formats.hymeko import CHILD_CLASS, FOREIGN
from hymeko_x.frontends.hymeko.extras import read_extras, read_foreign, read_text
from hymeko_x.frontends.hymeko.values import name_of
from hymeko_x.ir.mechanism import Extra
from hymeko_x.language.classes import IMPLIED
from hymeko_x.language.comments import comments_in, without_comments
from hymeko_x.language.markup import is_foreign
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import ArcItem, Comment, Field, Item, Node, QuotedName, is_list

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from hymeko_x.formats.hymeko import FieldWord
    from hymeko_x.frontends.hymeko.values import ValueReader

T = TypeVar("T")


class Block:
    """The items of one block. Every ``take`` removes the item that it returns; :meth:`rest` reports those that are left.

    In an ``open`` block fields may repeat: those that are no words of the part are its parameters, in order.
    """

    def __init__(self, items: Iterable[Item], reader: ValueReader, *, open: bool = False) -> None:
        self.reader = reader
        self.free: list[Field] | None = [] if open else None
        self.fields: dict[str, Field] = {}
        self.nodes: list[Node] = []
        self.arcs: list[ArcItem] = []
        self.extras: list[Extra] = []
        self.written: dict[str, str] = {}
        self.classes: tuple[str, ...] = ()
        self.is_implied = False
        self.unnamed = False
        self.comments = 0
        for item in items:
            if isinstance(item, Field):
                self._field(item)
            elif isinstance(item, Node):
                self._keep_comments(comments_in((item,)))
                self._node(without_comments(item))
            elif isinstance(item, ArcItem):
                self.arcs.append(item)
            elif isinstance(item, Comment):
                self._keep_comments((item,))

    def _keep_comments(self, comments: Iterable[Comment]) -> None:
        for comment in comments:
            self.extras.append(Extra("comment", "", comment.text, self.comments))
            self.comments += 1

    def _node(self, item: Node) -> None:
        if is_foreign(item):
            self.extras += read_foreign(item, self.reader)
        elif is_written(item):
            self.written.update(read_written_block(item, self.reader))
        else:
            self.nodes.append(item)

    def _field(self, item: Field) -> None:
        if self.free is not None:
            self.free.append(item)
        if isinstance(item.name, QuotedName) and self.free is not None:
            return
        if item.name in FOREIGN or item.name == "extra":
            self.extras += read_extras(item, self.reader)
        elif item.name == "class":
            self.classes = read_classes(item, self.reader)
            self.is_implied = item.type == IMPLIED
        elif item.name == "written":
            self.written.update(read_written(item, self.reader))
        elif item.name == CHILD_CLASS:
            self.written[CHILD_CLASS] = self.reader.text(item.value, item)
        elif item.name == "unnamed" and item.value is None:
            self.unnamed = True
        elif item.name in self.fields and self.free is None:
            raise self.reader.refuse(item, f"'{item.name}' is given twice", hint=f"it is first given in line {self.fields[item.name].line}")
        else:
            self.fields.setdefault(item.name, item)

    def take_rest(self, read: Callable[[Field], T]) -> list[tuple[str, T]]:
        """The fields of an open block that are neither words nor settings, in order, as names and values."""
        left = [item for item in self.free or () if isinstance(item.name, QuotedName) or item.name in self.fields]
        self.fields.clear()
        return [(str(item.name), read(item)) for item in left]

    def take(self, name: str, *aliases: str) -> Field | None:
        """The field of this name, or of one of the aliases."""
        for word in (name, *aliases):
            found = self.fields.pop(word, None)
            if found is not None:
                return found
        return None

    def take_text(self, name: str) -> str | None:
        """The field's text, or None when it is not there."""
        found = self.take(name)
        return None if found is None else self.reader.text(found.value, found)

    def take_role(self, role: str) -> ArcItem | None:
        """The first arc of this role."""
        for position, arc in enumerate(self.arcs):
            if arc.role == role:
                return self.arcs.pop(position)
        return None

    def take_node(self, name: str) -> Node | None:
        """The first node of this name."""
        for position, node in enumerate(self.nodes):
            if node.name == name:
                return self.nodes.pop(position)
        return None

    def take_words(self, words: Iterable[FieldWord], motion: str = "") -> dict[str, object]:
        """The attributes that these words set; ``motion`` is what the dimension of that name stands for."""
        found: dict[str, object] = {}
        for word in words:
            item = self.fields.pop(word.word, None)
            if item is not None:
                found[word.attribute] = self._word(word, item, motion if word.dimension == "motion" else word.dimension)
        return found

    def _word(self, word: FieldWord, item: Field, dimension: str) -> object:
        reader, value = self.reader, item.value
        match word.form:
            case "number":
                return reader.number(value, dimension, item)
            case "vec3":
                return reader.vec3(value, dimension, item)
            case "numbers":
                return (reader.number(value, dimension, item),) if type(value) is float else reader.numbers(value, dimension, item)
            case "rgba":
                return reader.rgba(value, item)
            case "integers" | "pixels":
                count = 2 if word.form == "pixels" else None
                return tuple(reader.whole(part, item) for part in reader.numbers(value, "", item, count))
            case "flag":
                return self._flag(item)
            case _:
                return reader.text(value, item)

    def _flag(self, item: Field) -> bool:
        word = "true" if item.value is None else self.reader.text(item.value, item)
        if word not in ("true", "false"):
            raise self.reader.refuse(item, f"{name_of(item)} is true or false, not '{word}'")
        return word == "true"

    def rest(self, element: str) -> None:
        """Report the items that are left (HX061) and keep them as extras of HyMeKo itself."""
        left: list[Field | Node | ArcItem] = [*self.fields.values(), *self.nodes, *self.arcs]
        for item in left:
            origin = self.reader.origin(item)
            name = item.name if not isinstance(item, ArcItem) else item.role or item.ref.dotted
            self.reader.report.warn(codes.UNKNOWN_TYPE, f"{element} has no '{name}'; it is kept as it is", origin, element=element)
            self.extras.append(Extra("hymeko", "", print_item(item)))


def read_classes(item: Field, reader: ValueReader) -> tuple[str, ...]:
    """``class "a"`` or, of a joint with several dofs, ``class ["a" "" "b"]``."""
    values = item.value if is_list(item.value) else (item.value,)
    return tuple(reader.text(value, item) for value in values)


def read_written(item: Field, reader: ValueReader) -> dict[str, str]:
    """``written ["key" "text" ...]``: how something was written, by key."""
    if not is_list(item.value) or len(item.value) % 2:
        raise reader.refuse(item, "'written' takes a list of keys and texts")
    texts = [reader.text(part, item) for part in item.value]
    return dict(zip(texts[::2], texts[1::2], strict=True))


def is_written(node: Node) -> bool:
    """Whether it is the block ``written { .. }``."""
    return node.name == "written" and not node.edge and not isinstance(node.name, QuotedName) and not node.stereotypes


def read_written_block(node: Node, reader: ValueReader) -> dict[str, str]:
    """``written { key text .. }``."""
    return {str(item.name): read_text(item, reader) for item in node.items if isinstance(item, Field)}
