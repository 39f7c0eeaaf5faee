"""<sensor>: what measures, and what it measures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.words import ALONE, SENSED, SENSED_TYPES
from hymeko_x.frontends.mjcf.contacts import find_end
from hymeko_x.frontends.mjcf.mounts import take_parameters
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Camera, Sense, Sensor
from hymeko_x.ir.tendons import moves_along_one

if TYPE_CHECKING:
    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.xml.tree import XmlNode


def read_sensors(sections: list[XmlNode], builder: MjcfBuilder) -> None:
    """Sensors in order, each with the edge to what it measures."""
    for section in sections:
        for element in section.children:
            if element.tag.startswith("#"):
                builder.keep_at_root(element, "sensor")
            else:
                _read_sensor(element, builder)


def _read_sensor(element: XmlNode, builder: MjcfBuilder) -> None:
    key = builder.own(element, "sensor", element.tag)
    arcs: list[RobotArc] = []
    for word in ("objname", "refname"):
        kind = SENSED_TYPES.get(element.attributes.get("objtype" if word == "objname" else "reftype", ""))
        if word in element.attributes and kind is not None:
            arcs.append(_arc(element, kind, word, "" if word == "objname" else "reference", builder))
    for word, kind in SENSED.items():
        if word in element.attributes:
            arcs.append(_arc(element, kind, word, "" if word in ALONE and not arcs else word, builder))
    _check_target(element, arcs, builder)
    builder.vertices[key] = Sensor(element.tag, None, take_parameters(element, {}))
    builder.keep(element, key)
    builder.show(key)
    if arcs:
        sense = builder.names.take("sense", key.name)
        builder.edges[sense] = Edge(Sense(), (*arcs, Arc(key, -1)))
        builder.show(sense)


_SINGLE = ("jointpos", "jointvel", "jointactuatorfrc", "jointlimitpos", "jointlimitvel", "jointlimitfrc")


def _check_target(element: XmlNode, arcs: list[RobotArc], builder: MjcfBuilder) -> None:
    """Some sensors need a joint that moves along one coordinate, others a ball, others a camera with an image."""
    for arc in arcs:
        camera = builder.vertices.get(arc.target)
        if element.tag in ("camprojection", "rangefinder") and isinstance(camera, Camera) and 0 in (camera.resolution or (1, 1)):
            raise refuse(codes.BAD_NUMBER, f"<{element.tag}> measures in '{arc.target.name}', which has no resolution", element.origin)
    if "joint" not in element.attributes and not any(arc.target.kind == "joint" for arc in arcs):
        return
    single = moves_along_one(arcs[0], builder.edges)
    if (element.tag in _SINGLE and not single) or (element.tag.startswith("ball") and single):
        kind = "a ball joint" if single else "a hinge or a slide"
        raise refuse(
            codes.UNKNOWN_WORD, f"<{element.tag}> measures '{arcs[0].role or arcs[0].target.name}', expected {kind}", element.origin
        )


def _arc(element: XmlNode, kind: str, word: str, role: str, builder: MjcfBuilder) -> RobotArc:
    name = element.attributes[word]
    target: Id = find_end(element, kind, word, builder)
    if target.kind == "joint":
        role = builder.roles.get(target, {}).get(name, "") or role
    return Arc(target, 1, None, role)
