"""<sensor>: what measures, and what it measures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf.schema import attributes_of
from hymeko_x.formats.mjcf.words import AT_SITES
from hymeko_x.ir.parts import Sense, Sensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.sheet import Attributes, MjcfSheet
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.xml.printing import Tag

_MEASURED = {
    "frame": AT_SITES,
    "joint": frozenset(
        {"jointpos", "jointvel", "jointactuatorfrc", "jointlimitpos", "jointlimitvel", "jointlimitfrc", "ballquat", "ballangvel"}
    ),
    "tendon": frozenset({"tendonpos", "tendonvel", "tendonactuatorfrc", "tendonlimitpos", "tendonlimitvel", "tendonlimitfrc"}),
    "actuator": frozenset({"actuatorpos", "actuatorvel", "actuatorfrc"}),
    "body": frozenset({"subtreecom", "subtreelinvel", "subtreeangmom"}),
}
"""MuJoCo's kinds of sensors that need nothing but the element that they measure, by its kind."""
_SENSED = {"frame": "site", "shape": "geom", "world": "body"}


def write_sensors(sheet: MjcfSheet) -> None:
    """Every sensor of MuJoCo's kinds of a mechanism that came from MJCF; of others those that measure what MuJoCo measures by them."""
    senses: dict[Id, tuple[RobotArc, ...]] = {}
    for _, _, arcs in sheet.mechanism.edges(Sense):
        senses |= {arc.target: arcs for arc in arcs if arc.sign < 0}
    items: list[tuple[Id, Tag]] = []
    for key, sensor in sheet.mechanism.vertices(Sensor):
        if not (attributes_of(f"sensor/{sensor.kind}") if sheet.from_mjcf else _is_of_mujoco(sensor, senses.get(key, ()))):
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


def _is_of_mujoco(sensor: Sensor, arcs: tuple[RobotArc, ...]) -> bool:
    measured = [arc.target.kind for arc in arcs if arc.sign > 0]
    if sensor.kind.startswith("frame") and "objtype" in dict(sensor.parameters):
        return bool(measured)
    return len(measured) == 1 and sensor.kind in _MEASURED.get(measured[0], ())


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
