"""Overrides: what a text changes of the elements that it makes from a template, or imports from another file.

The print of a robot has such an element as a block of its own, ``arm_link7 { mass 2 inertia [...] }``. Where the author's text has no such
block, only an instance ``arm``, the print gets what would stand there for it: ``arm.link7 { mass 2 }`` with the fields that changed.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.edits.splicing import Splices

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping

    from hymeko_x.outline import Outline, OutlineBlock

    Blocks = Mapping[tuple[str, str], OutlineBlock]

_FIELD = re.compile(r"[^\W\d]\w*")
_INNER, _OUTER = "-", "+"
"""The fields of a joint's block with its child and its parent; the second is that of an instance, with its place, as well."""


def with_overrides(own: Outline, before: Outline, after: Outline) -> tuple[bytes, bytes]:
    """The texts of two prints of a robot, with overrides for what only an instance in the author's text stands for."""
    authored, old, new = ({(block.tag, block.name): block for block in _top(outline)} for outline in (own, before, after))
    instances = {name for tag, name in authored if not tag and "." not in name}
    first, second = (Splices(print.files[print.main].data, print.style) for print in (before, after))
    for key, block in old.items():
        instance = None if key in authored else _instance_of(block.name, instances)
        if instance is None:
            continue
        _override(first, block, block, instance, authored)
        if key in new:
            _override(second, block, new[key], instance, authored)
    return first.result(), second.result()


def _instance_of(name: str, instances: Container[str]) -> str | None:
    """The instance whose name the name of an element begins with, the longest one."""
    parts = name.split("_")
    return next((found for number in range(len(parts) - 1, 0, -1) if (found := "_".join(parts[:number])) in instances), None)


def _top(outline: Outline) -> Iterator[OutlineBlock]:
    """The blocks in the outermost ones: the elements of the robot."""
    for block in outline.root.children:
        yield from block.children


def _override(splices: Splices, before: OutlineBlock, block: OutlineBlock, instance: str, authored: Blocks) -> None:
    """Replace the block of an element of an instance by what would stand in the author's text for it, if anything."""
    rest = block.name.removeprefix(f"{instance}_")
    reference = f"{block.tag}{instance}.{rest}"
    text = splices.data[block.start : block.end].decode()
    if (block.tag, f"{instance}.{rest}") in authored:
        splices.put(block.start, block.end, text.replace(f"{block.tag}{block.name}", reference, 1).encode())
    elif _OUTER in authored["", instance].fields and _is_placement(block, instance):
        splices.put(block.start, block.end, f"{instance} {{ {block.fields[_OUTER].text} }}".encode())
    elif changes := _changes(splices, before, block):
        splices.put(block.start, block.end, f"{reference} {{ {changes} }}".encode())
    else:
        splices.remove(block)


def _is_placement(block: OutlineBlock, instance: str) -> bool:
    """Whether a block is the joint that puts the root of an instance in its place; its child may follow from its name."""
    inner, outer = (block.fields.get(name) for name in (_INNER, _OUTER))
    if not block.tag or outer is None or f"+ {instance}_" in outer.text:
        return False
    return inner is None or f"- {instance}_" in inner.text


def _changes(splices: Splices, before: OutlineBlock, after: OutlineBlock) -> str:
    """The fields of a block that have another value now; its arcs stay what they are in an imported robot."""
    fields = [field for name, field in after.fields.items() if _is_changed(name, before, after)]
    return " ".join(splices.data[field.start : field.end].decode().strip() for field in fields)


def _is_changed(name: str, before: OutlineBlock, after: OutlineBlock) -> bool:
    old = before.fields.get(name)
    return _FIELD.fullmatch(name) is not None and (old is None or old.text != after.fields[name].text)
