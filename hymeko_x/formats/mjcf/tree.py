"""MJCF as a tree of XML nodes: comments are kept at every depth, of which there is no limit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.xml import parse as xml
from hymeko_x.xml.parse import parse_text
from hymeko_x.xml.printing import markup as verbatim
from hymeko_x.xml.tree import COMMENT_NODE as COMMENT
from hymeko_x.xml.tree import INSTRUCTION_NODE, XmlNode

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source

__all__ = ["COMMENT", "parse", "parse_text", "verbatim"]


def parse(source: Source, report: Report) -> XmlNode:
    """The root of an XML file; comments before it are the first children.

    Raises: Refusal with HX004 (not XML, or an instruction in an element, where MuJoCo stops reading), HX007 (too large), HX008 (entities).
    """
    document = xml.parse(source, report, comments=True, deepest=None)
    if b"<?" in document.data[1:]:
        for node in document.root.walk():
            if node.tag == INSTRUCTION_NODE:
                target = (node.text or "").partition(" ")[0]
                raise refuse(codes.NOT_XML, f"a processing instruction (<?{target} ...?>) cannot stand inside of an element", node.origin)
    _take_texts(document.root)
    document.root.children[:0] = [node for node in document.preceding if node.tag == COMMENT]
    return document.root


def _take_texts(root: XmlNode) -> None:
    """The data of texts that stand between their tags, as MuJoCo saves long ones, as the attributes that they are otherwise."""
    for section in root.children:
        for node in section.children if section.tag == "custom" else ():
            if node.tag == "text" and node.text is not None and "data" not in node.attributes:
                node.attributes["data"] = node.text
                node.text = None
