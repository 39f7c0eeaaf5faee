"""<actuator> and <sensor>."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.native.parameters import parameter_attributes
from hymeko_x.backends.mjcf.native.sheet import write_section
from hymeko_x.formats.mjcf import TARGETS
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Actuator, Drive, Sense, Sensor
from hymeko_x.ir.values import numbers_text
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.ir.mechanism import Id, RobotArc

_ROLES = {"crank": "cranksite", "slider": "slidersite", "reference": "refsite"}
_SENSED = {"frame": "site", "shape": "geom", "world": "body"}


def write_actuators(sheet: Sheet) -> None:
    """Every actuator, as the element that its author used."""
    drives: dict[Id, tuple[Drive, tuple[RobotArc, ...]]] = {}
    for _, drive, arcs in sheet.mechanism.edges(Drive):
        drives |= {arc.target: (drive, arcs) for arc in arcs if arc.sign > 0}
    items = []
    for key, actuator in sheet.mechanism.vertices(Actuator):
        own_class = sheet.own_class(key)
        base = sheet.base(actuator.kind if actuator.kind != "plugin" else "general", own_class)
        attributes: Attributes = {
            "name": sheet.name(key),
            "class": own_class,
            **_targets(sheet, *drives[key], base),
            **parameter_attributes(actuator.parameters, base),
            **sheet.said(key),
        }
        items.append((key, actuator.kind, attributes, sheet.inside(key)))
    write_section(sheet, "actuator", items)


def _targets(sheet: Sheet, drive: Drive, arcs: tuple[RobotArc, ...], base: Mapping[str, str]) -> Attributes:
    found: Attributes = {}
    gear: tuple[float, ...] = ()
    for arc in arcs:
        if arc.sign >= 0:
            continue
        word = _ROLES.get(arc.role) if arc.target.kind == "frame" else None
        if word is None:
            word = drive.kind if drive.kind == "jointinparent" else TARGETS[arc.target.kind]
        found[word] = sheet.reference(arc)
        gear = gear or numbers_weight(arc)
    inherited = read_numbers(base.get("gear", "")) or ()
    if gear != inherited:
        found["gear"] = numbers_text(gear) if gear else None
    return found


def write_sensors(sheet: Sheet) -> None:
    """Every sensor with what it measures."""
    senses: dict[Id, tuple[RobotArc, ...]] = {}
    for _, _, arcs in sheet.mechanism.edges(Sense):
        senses |= {arc.target: arcs for arc in arcs if arc.sign < 0}
    items = []
    for key, sensor in sheet.mechanism.vertices(Sensor):
        parameters = parameter_attributes(sensor.parameters, {})
        attributes: Attributes = {
            "name": sheet.name(key),
            **_sensed(sheet, senses.get(key, ()), parameters),
            **parameters,
            **sheet.said(key),
        }
        items.append((key, sensor.kind, attributes, sheet.inside(key)))
    write_section(sheet, "sensor", items)


def _sensed(sheet: Sheet, arcs: tuple[RobotArc, ...], parameters: Mapping[str, str]) -> Attributes:
    found: Attributes = {}
    for arc in arcs:
        if arc.sign <= 0:
            continue
        if arc.role == "reference":
            word = "refname"
        elif not found and "objtype" in parameters:
            word = "objname"
        elif arc.role and arc.target.kind != "joint":
            word = arc.role
        else:
            word = _SENSED.get(arc.target.kind, arc.target.kind)
        found[word] = sheet.reference(arc)
    return found
