"""A URDF file before it is text: its elements and extras in order."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.assets.written import contents_of
from hymeko_x.backends.urdf.joints import joint_tag
from hymeko_x.backends.urdf.links import link_tag
from hymeko_x.backends.urdf.sheet import UrdfSheet
from hymeko_x.backends.urdf.transmissions import transmission_tag
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import ros2_control
from hymeko_x.formats.urdf.notations import STYLE, VERSION, Defined, Style
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Actuator, Body, Drive, Joint, Material
from hymeko_x.xml.printing import Tag, foreign_text, put_back
from hymeko_x.xml.text import escaped, escaped_lines, parts_of_text
from hymeko_x.xml.unread import COMMENT, FOLLOWING, PRECEDING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.mechanism import Extra, Id, Mechanism


class UrdfDocument(NamedTuple):
    """The root, its elements, ready lines before and after it, and mesh files beside it.

    Each of the ``elements`` is made when it is asked for, so that those of a large robot are never there all at once.
    """

    root: Tag
    elements: Iterator[Tag | str]
    before: list[str]
    after: list[str]
    meshes: dict[str, bytes]


def document(mechanism: Mechanism, within: str = "", prefix: str = "") -> UrdfDocument:
    """The URDF document of a mechanism; tags at top level have their owner. Files beside it are in the folder ``within``,
    and their paths stand behind the ``prefix``.

    Raises: Refusal with HX104 for a joint or a shape that URDF cannot represent.
    """
    root = _root_tag(mechanism)
    sheet = UrdfSheet(mechanism, _declared(root), within, prefix)
    extras = [extra for extra in mechanism.extras.get(ROOT, ()) if extra.format in (words.FORMAT, COMMENT)]
    meshes = contents_of(mechanism, sheet.mesh_files, sheet.materials.textures)
    return UrdfDocument(root, _merged(extras, sheet), _around(extras, PRECEDING, sheet), _around(extras, FOLLOWING, sheet), meshes)


def residue_elements(text: str, *, readable: bool = True) -> list[str]:
    """The elements that contain a residue; ``readable`` allows CDATA, which xacro would not unescape."""
    texts = [f"<![CDATA[\n{part}]]>" if readable and "]]>" not in part else escaped_lines(part) for part in parts_of_text(text)]
    return [f'<{words.RESIDUE} xmlns:hymeko="{words.RESIDUE_NAMESPACE}">{part}</{words.RESIDUE}>' for part in texts]


def _root_tag(mechanism: Mechanism) -> Tag:
    root = Tag("robot", {"name": mechanism.name})
    if VERSION in (mechanism.notation(ROOT, STYLE) or Style()).habits:
        root.attributes["version"] = "1.0"
    own = [extra for extra in mechanism.extras.get(ROOT, ()) if extra.format == words.FORMAT and extra.path.startswith("@")]
    put_back(root, own, {})
    return root


def _declared(root: Tag) -> dict[str, str]:
    return {name: uri for name, uri in root.attributes.items() if name.startswith("xmlns")}


def _tag(key: Id, sheet: UrdfSheet) -> Tag:
    tag = sheet.materials.robot_tag(key) if key.kind == "material" else _WRITERS[key.kind](key, sheet)
    tag.owner = key
    sheet.put_back(tag, key)
    return tag


_WRITERS = {"body": link_tag, "joint": joint_tag, "drive": transmission_tag}


def _merged(extras: list[Extra], sheet: UrdfSheet) -> Iterator[Tag | str]:
    """Typed elements and extras in one row: an extra goes to its place, as far as there are elements before it."""
    foreign = sorted((extra for extra in extras if extra.path in ("", "text()")), key=lambda extra: (extra.index, extra.path == ""))
    waiting = iter(foreign)
    extra = next(waiting, None)
    place = 0
    for key in _order(sheet):
        while extra is not None and extra.index <= place:
            yield _text(extra, sheet)
            extra = next(waiting, None)
            place += 1
        yield _tag(key, sheet)
        place += 1
    while extra is not None:
        yield _text(extra, sheet)
        extra = next(waiting, None)


def _text(extra: Extra, sheet: UrdfSheet) -> str:
    return escaped(extra.text) if extra.path == "text()" else foreign_text(extra, sheet.declared)


def _around(extras: list[Extra], path: str, sheet: UrdfSheet) -> list[str]:
    """The lines before or after the root element."""
    return [_text(extra, sheet) for extra in sorted(extras, key=lambda extra: extra.index) if extra.path == path]


# ---- order --------------------------------------------------------------------------------------------------------------------


def _order(sheet: UrdfSheet) -> list[Id]:
    """Every element that stands at top level, once: materials, new roots, the author's order, and other new elements."""
    materials = _robot_materials(sheet)
    rest = [*_tree(sheet), *_transmissions(sheet)]
    wanted = {*materials, *rest}
    known = [key for key in dict.fromkeys(sheet.mechanism.layout) if key in wanted]
    placed = set(known)
    new = [key for key in rest if key not in placed]
    roots = {key: None for key in new if key.kind == "body" and key not in sheet.mechanism.parent_joint}
    first = next((place for place, key in enumerate(known) if key.kind != "material"), len(known))
    before, behind = known[:first], known[first:]
    return [*(key for key in materials if key not in placed), *before, *roots, *behind, *(key for key in new if key not in roots)]


def _robot_materials(sheet: UrdfSheet) -> list[Id]:
    places = (Defined.ROBOT, Defined.BOTH)
    return [key for key, material in sheet.mechanism.vertices(Material) if material.name and sheet.materials.definitions[key] in places]


def _tree(sheet: UrdfSheet) -> list[Id]:
    """Each body behind its parent joint, parents first; then bodies and joints that no root leads to."""
    mechanism = sheet.mechanism
    found: dict[Id, None] = {}
    for body in mechanism.depth_first():
        joint = mechanism.parent_joint.get(body)
        if joint is not None:
            found[joint.id] = None
        found[body] = None
    found.update({key: None for key, _ in mechanism.vertices(Body)})
    found.update({key: None for key, _, _ in mechanism.edges(Joint)})
    return list(found)


def _transmissions(sheet: UrdfSheet) -> list[Id]:
    """The drives that are transmissions; URDF cannot represent other actuators. Those of <ros2_control> stand there."""
    vertices = sheet.mechanism.graph.vertices
    found = []
    for key, drive, arcs in sheet.mechanism.edges(Drive):
        if drive.kind == ros2_control.TAG:
            continue
        driving = [vertices.get(arc.target) for arc in arcs if arc.sign > 0]
        if all(isinstance(part, Actuator) and part.kind == "transmission" for part in driving):
            found.append(key)
    return found
