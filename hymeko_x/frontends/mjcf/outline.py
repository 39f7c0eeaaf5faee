"""The outline of an MJCF file together with the files that it includes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.frontends.mjcf.expand import included_source
from hymeko_x.outline import Outline
from hymeko_x.source import file_stem
from hymeko_x.xml.outline import STYLE, block_of, text_file
from hymeko_x.xml.parse import parse

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.outline import TextFile
    from hymeko_x.source import Source
    from hymeko_x.xml.tree import XmlNode


_CALLED_AS_FILE = frozenset({"mesh", "texture", "hfield", "skin"})
"""The elements that are called after their files where they have no name."""


def outline(source: Source, report: Report) -> Outline:
    """Where everything stands in an MJCF file; what an <include> stands for stands in its place.

    Raises: Refusal when a file is no XML, or an included one cannot be read.
    """
    document = parse(source, report, deepest=None)
    files = {source.name: text_file(source, document)}
    stack = [document.root]
    while stack:
        node = stack.pop()
        node.children = [inner for child in node.children for inner in _included(child, source, report, files)]
        stack += node.children
    datas = {name: file.data for name, file in files.items()}
    root = block_of(document.root, document.data, datas)
    for block in root.walk():
        if block.tag in _CALLED_AS_FILE and not block.name and "file" in block.fields:
            block.name = file_stem(block.fields["file"].text)
    return Outline(root, files, source.name, STYLE)


def _included(node: XmlNode, source: Source, report: Report, files: dict[str, TextFile]) -> list[XmlNode]:
    """What an element stands for: itself, or the content of the file that it includes, nested includes as well."""
    found: list[XmlNode] = []
    queue = [node]
    while queue:
        child = queue.pop()
        if child.tag != "include" or not child.attributes.get("file"):
            found.append(child)
            continue
        path, inner = included_source(child, source)
        document = parse(inner, report, deepest=None)
        files[inner.name] = replace(text_file(inner, document), path=path)
        queue += reversed(document.root.children)
    return found
