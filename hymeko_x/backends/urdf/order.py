"""In which order the elements stand at top level: as their author had them, the others where one looks for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.urdf.notations import Defined
from hymeko_x.ir.parts import Actuator, Body, Drive, Joint, Material

if TYPE_CHECKING:
    from hymeko_x.backends.urdf.sheet import Sheet
    from hymeko_x.ir.mechanism import Id


def order(sheet: Sheet) -> list[Id]:
    """Every element that stands at top level, once: new materials first, then the author's order, then what is new."""
    materials = _robot_materials(sheet)
    rest = [*_tree(sheet), *_transmissions(sheet)]
    wanted = {*materials, *rest}
    known = [key for key in dict.fromkeys(sheet.mechanism.layout) if key in wanted]
    placed = set(known)
    return [*(key for key in materials if key not in placed), *known, *(key for key in rest if key not in placed)]


def _robot_materials(sheet: Sheet) -> list[Id]:
    places = (Defined.ROBOT, Defined.BOTH)
    return [key for key, material in sheet.mechanism.vertices(Material) if material.name and sheet.place_of(key) in places]


def _tree(sheet: Sheet) -> list[Id]:
    """Each body behind the joint above it, parents first; then what no root leads to."""
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


def _transmissions(sheet: Sheet) -> list[Id]:
    """The drives that are transmissions; other actuators have no word in URDF."""
    vertices = sheet.mechanism.graph.vertices
    found = []
    for key, _, arcs in sheet.mechanism.edges(Drive):
        driving = [vertices.get(arc.target) for arc in arcs if arc.sign > 0]
        if all(isinstance(part, Actuator) and part.kind == "transmission" for part in driving):
            found.append(key)
    return found
