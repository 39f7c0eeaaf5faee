"""The text that Drake gets of a file: without what makes it refuse the file or crash.

A gearbox, which Drake refuses, is a frame. A model that is included by the name of its folder has a slash behind that name. A plane for
contact is a visual one: on a link it makes Drake crash where many shapes for contact are beside it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.etree import ElementTree

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from xml.etree.ElementTree import Element

PLANE = "hymeko_x_contact_"
"""What stands before the name of a plane for contact."""
_SHARED = frozenset({"geometry", "pose", "origin"})
"""The elements of a shape for contact that one for the eye may have, too; ``origin`` is the pose of old files."""
_FOLDER = re.compile(r"(model|package)://[^/]+")
_FRAMES_SINCE = 1.7
"""The version from which on a model may have frames of its own."""


def root_of(path: Path) -> Element | None:
    """The root element of a file; None for one that is no XML, which libsdformat refuses."""
    try:
        return ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, ValueError):
        return None


def readable_text(path: Path) -> str | None:
    """The file as Drake reads it, with absolute paths; None where it reads the file as it is."""
    root = root_of(path)
    if root is None:
        return None
    folders = [uri for uri in root.iterfind(".//include/uri") if _FOLDER.fullmatch((uri.text or "").strip())]
    planes = [shape for shape in root.iter("collision") if shape.find("geometry/plane") is not None]
    gearboxes = [*_gearboxes(root)]
    if not (folders or planes or gearboxes):
        return None
    for uri in folders:
        uri.text = f"{(uri.text or '').strip()}/"
    for shape in planes:
        shape.tag = "visual"
        shape.set("name", PLANE + shape.get("name", ""))
        shape[:] = [child for child in shape if child.tag in _SHARED]
    for model, joint in gearboxes:
        model[list(model).index(joint)] = _frame(joint, float(root.get("version", "0")))
    for uri in root.iter("uri"):
        name = (uri.text or "").strip()
        if "://" not in name and (path.parent / name).exists():
            uri.text = str((path.parent / name).resolve())
    return ElementTree.tostring(root, encoding="unicode")


def _gearboxes(root: Element) -> Iterator[tuple[Element, Element]]:
    """Each gearbox, behind its model."""
    for model in root.iter("model"):
        yield from ((model, joint) for joint in model.findall("joint[@type='gearbox']"))


def _frame(joint: Element, version: float) -> Element:
    """The frame of a joint as a frame, which is given in the child as well; a comment in old files, which have no frames."""
    if version < _FRAMES_SINCE:
        return ElementTree.Comment("gearbox")  # type: ignore[return-value]
    frame = ElementTree.Element("frame", {"name": joint.get("name", ""), "attached_to": (joint.findtext("child") or "").strip()})
    frame.extend(joint.findall("pose"))
    return frame
