"""The unit of a field: that of its numbers in the IR, which are in SI units and radians."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.ir.parts import DofKind, Joint, Loop, Tendon

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism

_PLACE = re.compile(r"\[\d+\]")
_DOF = re.compile(r"dofs\[(\d+)\]\.(.+)")

_POSE = {"xyz": "m", "rotation": "rad"}
_OF_DOFS = {
    "limits.lower": ("rad", "m"),
    "limits.upper": ("rad", "m"),
    "limits.velocity": ("rad/s", "m/s"),
    "limits.effort": ("N m", "N"),
    "limits.acceleration": ("rad/s^2", "m/s^2"),
    "limits.jerk": ("rad/s^3", "m/s^3"),
    "damping": ("N m s/rad", "N s/m"),
    "friction": ("N m", "N"),
    "stiffness": ("N m/rad", "N/m"),
    "spring_ref": ("rad", "m"),
    "ref": ("rad", "m"),
    "armature": ("kg m^2", "kg"),
    "anchor": ("m", "m"),
    "pitch": ("m/rad", "m/rad"),
}
"""The units of a dof that turns, and of one that slides; a tendon has the latter."""

_OF_PARTS = {
    ("body", "inertial.mass"): "kg",
    ("body", "inertial.com"): "m",
    ("body", "inertial.tensor"): "kg m^2",
    ("shape", "mass"): "kg",
    ("shape", "density"): "kg/m^3",
    ("shape", "geometry.radius"): "m",
    ("shape", "geometry.length"): "m",
    ("shape", "geometry.size"): "m",
    ("frame", "size"): "m",
    ("mesh", "vertices"): "m",
    ("mesh", "content.volume"): "m^3",
    ("mesh", "content.area"): "m^2",
    ("mesh", "content.distance"): "m",
    ("camera", "fovy"): "rad",
    ("sensor", "rate"): "Hz",
    ("tendon", "width"): "m",
    ("poseset", "time"): "s",
}


def unit_of(mechanism: Mechanism, element: Id, field: str) -> str:
    """The unit of a field's numbers; empty where they have none, and where the field is no number."""
    dof = _DOF.fullmatch(field)
    if dof is not None:
        return _of_dof(mechanism, element, int(dof[1]), dof[2])
    if field.startswith("[") and ".weight." in field:
        return _POSE.get(field.rpartition(".")[2], "")
    edge = mechanism.graph.edges.get(element)
    if edge is not None and isinstance(edge.data, Tendon) and field in _OF_DOFS:
        return _OF_DOFS[field][1]
    return _OF_PARTS.get((element.kind, _PLACE.sub("", field)), "")


def _of_dof(mechanism: Mechanism, element: Id, number: int, field: str) -> str:
    edge = mechanism.graph.edges.get(element)
    part = None if edge is None else edge.data
    dofs = part.dofs if isinstance(part, Joint | Loop) else ()
    turning, sliding = _OF_DOFS.get(field, ("", ""))
    return sliding if number < len(dofs) and dofs[number].kind is DofKind.SLIDE else turning
