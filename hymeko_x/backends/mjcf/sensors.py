"""<sensor>: what measures, and what it measures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.ir.parts import Sense, Sensor
from hymeko_x.rewrite.fragments import IMU

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.sheet import Attributes, MjcfSheet
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.xml.printing import Tag

_SENSED = {"frame": "site", "shape": "geom", "world": "body"}


def write_sensors(sheet: MjcfSheet) -> None:
    """Every sensor of a mechanism that came from MJCF, and those of IMUs; others have kinds that MuJoCo does not have."""
    senses: dict[Id, tuple[RobotArc, ...]] = {}
    for _, _, arcs in sheet.mechanism.edges(Sense):
        senses |= {arc.target: arcs for arc in arcs if arc.sign < 0}
    items: list[tuple[Id, Tag]] = []
    for key, sensor in sheet.mechanism.vertices(Sensor):
        if not sheet.from_mjcf and sensor.kind not in IMU:
            continue
        parameters = sheet.parameters(sensor.parameters, f"sensor/{sensor.kind}", {})
        attributes = {
            "name": sheet.name(key),
            **_sensed(sheet, senses.get(key, ()), parameters),
            **parameters,
            **sheet.kept_attributes(key),
        }
        items.append((key, tag_of(sensor.kind, attributes, sheet.inside(key))))
    sheet.write_section("sensor", items)


def _sensed(sheet: MjcfSheet, arcs: tuple[RobotArc, ...], parameters: Mapping[str, str]) -> Attributes:
    found: Attributes = {}
    for arc in arcs:
        if arc.sign <= 0:
            continue
        if arc.role == "reference":
            attribute = "refname"
        elif not found and "objtype" in parameters:
            attribute = "objname"
        elif arc.role and arc.target.kind != "joint":
            attribute = arc.role
        else:
            attribute = _SENSED.get(arc.target.kind, arc.target.kind)
        found[attribute] = sheet.reference(arc)
    return found
