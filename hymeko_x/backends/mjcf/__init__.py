"""Prints a legal mechanism as MJCF for MuJoCo 4.0. Its rules made it legal, and its files have paths already.

A mechanism that came from MJCF keeps its classes and notations, so that MuJoCo compiles the same model from what is written.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.actuators import write_actuators
from hymeko_x.backends.mjcf.assets import write_assets
from hymeko_x.backends.mjcf.bodies import write_worldbody
from hymeko_x.backends.mjcf.classes import ROLE_CLASSES, settle
from hymeko_x.backends.mjcf.contacts import write_contacts
from hymeko_x.backends.mjcf.equalities import write_equalities
from hymeko_x.backends.mjcf.sensors import write_sensors
from hymeko_x.backends.mjcf.sheet import open_sheet
from hymeko_x.backends.mjcf.tendons import write_tendons
from hymeko_x.formats.mjcf import RESIDUE
from hymeko_x.formats.mjcf.words import SECTIONS
from hymeko_x.source import Package
from hymeko_x.xml.printing import render
from hymeko_x.xml.text import escaped, parts_of_text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options

_WRITERS: Mapping[str, Callable[[MjcfSheet], None]] = {
    "asset": write_assets,
    "worldbody": write_worldbody,
    "contact": write_contacts,
    "equality": write_equalities,
    "tendon": write_tendons,
    "actuator": write_actuators,
    "sensor": write_sensors,
}


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The MJCF of the mechanism. Files that it refers to are not part of it: `assets.pack` returns them."""
    del options, report
    sheet = open_sheet(mechanism, ROLE_CLASSES)
    settings_end = 1
    for section in SECTIONS:
        if section == "default":
            settings_end = len(sheet.root.children)
        sheet.write_kept(section)
        if section in _WRITERS:
            _WRITERS[section](sheet)
    sheet.write_kept("")
    if not sheet.from_mjcf:
        settle(sheet, settings_end)
    lines = render(sheet.root)
    return Package("\n".join([*lines, ""]).encode(), with_residue=lambda residue: _with_residue(sheet, lines, residue))


def _with_residue(sheet: MjcfSheet, lines: list[str], residue: str) -> bytes:
    """The lines of the document with a residue before their last one: the data of texts that mean nothing to MuJoCo."""
    if not sheet.root.children:
        sheet.root.has_end = True
        lines = render(sheet.root)
    parts = enumerate(parts_of_text(residue))
    texts = [f'    <text name="{RESIDUE}{number or ""}" data="{escaped(part)}"/>' for number, part in parts]
    return "\n".join([*lines[:-1], "  <custom>", *texts, "  </custom>", lines[-1], ""]).encode()
