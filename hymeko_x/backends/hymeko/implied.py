"""Actuators of transmissions that need no text: the first arc of the drive names them (formats/hymeko/implied.py)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko import TARGETS
from hymeko_x.formats.hymeko.implied import IMPLIED_ACTUATOR
from hymeko_x.ir.parts import Drive

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism


def implied_actuators(mechanism: Mechanism, names: Mapping[str, list[str]]) -> dict[Id, Id]:
    """By actuator that a text need not describe the drive that names it first. ``names``: the kinds of elements by name."""
    marked = {*mechanism.extras, *mechanism.notations, *mechanism.stereotypes, *mechanism.layout}
    found: dict[Id, Id] = {}
    for key, edge in mechanism.graph.edges.items():
        arc = edge.arcs[0] if edge.arcs and isinstance(edge.data, Drive) and edge.data.kind else None
        if arc is None or arc.role or arc.weight is not None or arc.sign <= 0:
            continue
        target = arc.target
        is_plain = mechanism.graph.vertices.get(target) == IMPLIED_ACTUATOR and target not in marked
        if is_plain and not _means_another(target, names):
            found.setdefault(target, key)
    return found


def fits_in(home: str, actuator: Id, names: Mapping[str, list[str]]) -> bool:
    """Whether the name of an actuator can be written in an assembly, where it has its end alone."""
    if not home:
        return True
    short = actuator.name.removeprefix(f"{home}_")
    return short != actuator.name and bool(short) and not names.get(short)


def _means_another(actuator: Id, names: Mapping[str, list[str]]) -> bool:
    """Whether the name means something else that a drive may lead to."""
    return any(kind in TARGETS["drive"] for kind in names[actuator.name] if kind != actuator.kind) or actuator.name == "world"
