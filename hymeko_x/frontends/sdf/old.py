"""Files of SDF 1.0 to 1.2, whose root is <gazebo>, in the words of SDF 1.3; in 1.0 and 1.1 values are attributes.

Source: the schemas of 1.0 and 1.2, and libsdformat's rules between them. Programs read such files until libsdformat 2.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats.sdf import fragments
from hymeko_x.xml.printing import markup
from hymeko_x.xml.tree import TreeBuilder, XmlDocument, XmlNode

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Report

ROOT = "gazebo"
VERSIONS = ("1.0", "1.1", "1.2")
MODERN = "1.3"

_STAY = frozenset(
    {
        *(("light", "type"), ("joint", "type"), ("sensor", "type"), ("physics", "type"), ("shader", "type"), ("trajectory", "type")),
        *(("trajectory", "id"), ("gui", "fullscreen"), ("save", "enabled"), ("sky", "material"), ("state", "world_name")),
    }
)
"""Attributes that are attributes in 1.2 as well, besides names."""
_TEXTS: Mapping[str, str] = MappingProxyType(
    {
        "origin": "pose",
        "horizontal_fov": "angle",
        **dict.fromkeys(("gravity", "direction"), "xyz"),
        **dict.fromkeys(("shadows", "grid"), "enabled"),
        **dict.fromkeys(("parent", "child"), "link"),
        **dict.fromkeys(("ambient", "background", "diffuse", "specular", "emissive"), "rgba"),
    }
)
"""Elements with one attribute, which is the text of the element in 1.2."""
_NEW: Mapping[str, str] = MappingProxyType({"origin": "pose", "damping": "velocity_decay"})
"""Elements that have another name in 1.2."""
_NEW_IN: Mapping[tuple[str, str], str] = MappingProxyType(
    {
        ("fog", "rgba"): "color",
        ("heightmap", "origin"): "pos",
        **{(tag, "filename"): "uri" for tag in ("mesh", "heightmap", "image", "include")},
    }
)
"""Attributes whose elements have another name."""


def modernised(document: XmlDocument, report: Report) -> XmlDocument:
    """A document whose root is <sdf>, with the lines of the original; the same one where that is so already."""
    root = document.root
    if root.tag != ROOT or root.attributes.get("version", VERSIONS[0]) not in VERSIONS:
        return document
    message = f"the root is <{ROOT}>, as up to SDF {VERSIONS[-1]}, which libsdformat does not read any more; read as {MODERN}"
    report.warn(codes.WRONG_ROOT, message, root.origin)
    if root.attributes.get("version") != VERSIONS[-1]:
        _turn_attributes_into_elements(root)
    root.tag, root.attributes["version"] = "sdf", MODERN
    for node in root.walk():
        if node.tag == "mesh":
            for child in node.children:
                child.tag = _NEW_IN.get((node.tag, child.tag), child.tag)
        elif node.tag == "script" and node.text and node.parent is not None and node.parent.tag == "material":
            texts = (("uri", fragments.MATERIALS), ("name", node.text))
            node.children, node.text = [XmlNode(tag, {}, node, node.file, node.line, text=text) for tag, text in texts], None
    lines = [node.line or 1 for node in root.walk() if node.is_element]
    text = markup(root).encode()
    again = TreeBuilder(root.file, text, report, iter(lines)).document()
    return XmlDocument(again.root, document.preceding, document.following, again.data)


def _turn_attributes_into_elements(root: XmlNode) -> None:
    """Plugins are left as they are."""
    stack = [child for child in root.children if child.is_element]
    while stack:
        node = stack.pop()
        if node.tag == "plugin":
            continue
        children = []
        for name in [name for name in node.attributes if name != "name" and (node.tag, name) not in _STAY]:
            text = node.attributes.pop(name)
            if _TEXTS.get(node.tag) == name:
                node.text = text
                continue
            child = XmlNode(_NEW_IN.get((node.tag, name), name), {}, node, node.file, node.line, text=text)
            children.append(child)
        stack += [child for child in node.children if child.is_element]
        node.children = [*children, *node.children]
        if node.tag != "damping" or (node.parent is not None and node.parent.tag == "link"):
            node.tag = _NEW.get(node.tag, node.tag)
