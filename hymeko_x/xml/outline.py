"""The outline of XML: every element with its attributes, and the text of those that have nothing else in them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.outline import BlockStyle, Outline, OutlineBlock, OutlineField, TextFile
from hymeko_x.xml.parse import parse

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source
    from hymeko_x.xml.tree import XmlDocument, XmlNode

STYLE = BlockStyle(">", "</{tag}>", rb"[ \t]*(?:<!--[^\n]*?-->[ \t]*)*", {b"'": b"&apos;"})
TEXT = "text()"
"""The name of the field that is an element's text."""

_ATTRIBUTE = re.compile(rb"""\s+([^\s=<>"'/]+)\s*=\s*("[^"]*"|'[^']*')""")
_NAME = re.compile(rb"<[^\s/>]+")


def outline(source: Source, report: Report) -> Outline:
    """Where everything stands in an XML file that is all of its text. Raises: Refusal when it is no XML."""
    document = parse(source, report)
    root = block_of(document.root, document.data)
    return Outline(root, {root.file: text_file(source, document)}, root.file, STYLE)


def text_file(source: Source, document: XmlDocument) -> TextFile:
    """The file of a document; what stands before its root, such as a byte order mark, is as the author has it."""
    read = document.root.start
    content = document.data[read:]
    if not source.data.endswith(content):
        return TextFile(source.name, document.data)
    return TextFile(source.name, document.data, source.data.removesuffix(content), read)


def block_of(root: XmlNode, data: bytes, others: Mapping[str, bytes] | None = None) -> OutlineBlock:
    """The block of an element, with all that is in it. ``others`` are the bytes of elements from other files, by their names."""
    texts = others or {}
    top = _bare(root, texts.get(root.file, data))
    stack = [(root, top)]
    while stack:
        node, block = stack.pop()
        for child in node.children:
            if child.is_element:
                inner = _bare(child, texts.get(child.file, data))
                block.add(inner)
                stack.append((child, inner))
    return top


def _bare(node: XmlNode, data: bytes) -> OutlineBlock:
    """The block of an element without the blocks in it."""
    name = _NAME.match(data, node.start)
    assert name is not None, f"no element starts at {node.file}:{node.line}"
    at = first = name.end()
    fields: dict[str, OutlineField] = {}
    while found := _ATTRIBUTE.match(data, at):
        attribute = found[1].decode()
        fields[attribute] = OutlineField(
            node.attributes.get(attribute, ""), found.start(), found.end(), found.start(2) + 1, found.end(2) - 1
        )
        at = found.end()
    head = data.index(b">", at)
    if data[head - 1 : head] == b"/":
        return OutlineBlock(node.tag, node.attributes.get("name", ""), node.file, node.start, head + 1, first, head - 1, None, fields)
    end = data.index(b">", node.end) + 1
    if not node.children and node.text is not None and b"<" not in data[head + 1 : node.end]:
        fields[TEXT] = OutlineField(node.text.strip(), head + 1, node.end, *_stripped(data, head + 1, node.end))
    return OutlineBlock(node.tag, node.attributes.get("name", ""), node.file, node.start, end, first, head, (head + 1, node.end), fields)


def _stripped(data: bytes, start: int, end: int) -> tuple[int, int]:
    text = data[start:end]
    return start + len(text) - len(text.lstrip()), end - len(text) + len(text.rstrip())
