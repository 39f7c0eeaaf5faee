"""A mechanism that came from MJCF, printed as its author wrote it: classes, notations, and what only MuJoCo knows.

Of every element its class and exactly what differs from what the class gives; the recompiled mjModel is the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.native.assets import write_assets
from hymeko_x.backends.mjcf.native.bodies import write_worldbody
from hymeko_x.backends.mjcf.native.motors import write_actuators, write_sensors
from hymeko_x.backends.mjcf.native.relations import write_contacts, write_equalities, write_tendons
from hymeko_x.backends.mjcf.native.sheet import Sheet, write_aside
from hymeko_x.formats.mjcf import words
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.source import Package

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.mechanism import Mechanism

_WRITERS: Mapping[str, Callable[[Sheet], None]] = {
    "asset": write_assets,
    "worldbody": write_worldbody,
    "contact": write_contacts,
    "equality": write_equalities,
    "tendon": write_tendons,
    "actuator": write_actuators,
    "sensor": write_sensors,
}


def write_native(mechanism: Mechanism) -> Package:
    """The MJCF of a mechanism that came from MJCF."""
    sheet = Sheet(mechanism)
    text = sheet.text
    said = {extra.path[1:]: extra.text for extra in mechanism.extras.get(ROOT, ()) if extra.format == words.NAME and extra.path[:1] == "@"}
    name = None if mechanism.notation(ROOT, "unnamed") else mechanism.name
    text.open("mujoco", {"model": name, **said})
    for section in words.SECTIONS:
        write_aside(sheet, section)
        if section in _WRITERS:
            _WRITERS[section](sheet)
    write_aside(sheet, "")
    text.close()
    return Package(text.bytes())
