"""<actuator>: what drives, and what it acts on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf import TARGETS
from hymeko_x.formats.mjcf.words import LIMITED, UNBOUNDED, is_range
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Actuator, Drive
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.sheet import Attributes, MjcfSheet
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.xml.printing import Tag

_ROLES = {"crank": "cranksite", "slider": "slidersite", "reference": "refsite"}


def write_actuators(sheet: MjcfSheet) -> None:
    """Every actuator, as the element of its kind."""
    drives: dict[Id, tuple[Drive, tuple[RobotArc, ...]]] = {}
    for _, drive, arcs in sheet.mechanism.edges(Drive):
        drives |= {arc.target: (drive, arcs) for arc in arcs if arc.sign > 0}
    items: list[tuple[Id, Tag]] = []
    for key, actuator in sheet.mechanism.vertices(Actuator):
        own_class = sheet.own_class(key)
        base = sheet.base(actuator.kind if actuator.kind != "plugin" else "general", own_class)
        parameters = _bounded(actuator.parameters, base, autolimits=sheet.settings.autolimits)
        attributes = {
            "name": sheet.name(key),
            "class": own_class,
            **_targets(sheet, *drives[key], base),
            **sheet.parameters(parameters, f"actuator/{actuator.kind}", base),
            **sheet.kept_attributes(key),
        }
        items.append((key, tag_of(actuator.kind, attributes, sheet.inside(key), key)))
    sheet.write_section("actuator", items)


def _bounded(parameters: Parameters, base: Mapping[str, str], *, autolimits: bool) -> Parameters:
    """The parameters, with no limit of the class: an actuator that has none was not read with that class."""
    own = dict(parameters)
    needed = () if autolimits else [flag for flag, span in LIMITED.items() if flag not in own and is_range(own.get(span))]
    free = {name: text for name, text in UNBOUNDED.items() if name in base and name not in own and name not in needed}
    return (*parameters, *dict.fromkeys(needed, "true").items(), *free.items())


def _targets(sheet: MjcfSheet, drive: Drive, arcs: tuple[RobotArc, ...], base: Mapping[str, str]) -> Attributes:
    """What the actuator acts on, and its gear. One of 1, the default, is written where an author of MJCF wrote it."""
    found: Attributes = {}
    gear: tuple[float, ...] = ()
    for arc in arcs:
        if arc.sign >= 0:
            continue
        attribute = _ROLES.get(arc.role) if arc.target.kind == "frame" else None
        found[attribute or ("jointinparent" if drive.kind == "jointinparent" else TARGETS[arc.target.kind])] = sheet.reference(arc)
        gear = gear or numbers_weight(arc)
    if gear != (read_numbers(base.get("gear", "")) or ()) and (sheet.from_mjcf or gear != (1.0,)):
        found["gear"] = sheet.numbers(gear) if gear else None
    return found
