"""Rotors for joints that move next to nothing."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.formats import native_format
from hymeko_x.ir.parts import Body, DofKind
from hymeko_x.rewrite.servos import loads

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context

_SHOWN = 3
"""How many joints a note names."""
_LIGHT = 1e-6
"""A dof that moves less than this, in kg m^2 or kg, moves nothing that a step of 2 ms resolves."""
_ROTOR: Mapping[DofKind, float] = MappingProxyType({DofKind.HINGE: 1e-3, DofKind.SCREW: 1e-3, DofKind.SLIDE: 0.1})
"""The armature of such a dof in kg m^2 or kg: the rotor of a small geared servo."""


def give_light_dofs_rotors(mechanism: Mechanism, context: Context) -> Mechanism:
    """A dof that moves next to nothing gets the inertia of a rotor, without which the steps of a simulation diverge.

    Source: MuJoCo's documentation, Modeling, Numerical stability: armature makes light joints stable.
    """
    light: dict[Id, list[int]] = {}
    for (joint, number), load in loads(mechanism).items():
        if load.free < _LIGHT:
            light.setdefault(joint, []).append(number)
    if not light or _has_unknown_masses(mechanism):
        return mechanism
    edges: dict[Id, RobotEdge] = {}
    for key, numbers in light.items():
        dofs = list(mechanism.joints[key].joint.dofs)
        for number in numbers:
            dofs[number] = replace(dofs[number], armature=_ROTOR[dofs[number].kind])
        edges[key] = replace(mechanism.graph.edges[key], data=replace(mechanism.joints[key].joint, dofs=tuple(dofs)))
    names = listed([f"'{key.name}'" for key in light], _SHOWN)
    message = f"armature is written for {counted(len(light), 'joint')}, moving less than {_LIGHT:g} kg m^2 or kg: {names}"
    context.report.note(codes.FOR_TARGET, f"{context.reason}: {message}", element=str(next(iter(light))))
    return mechanism.replace(edges=edges)


def _has_unknown_masses(mechanism: Mechanism) -> bool:
    """Whether an engine computes masses from shapes, as that of the format does from which the mechanism came."""
    return native_format(mechanism) is not None and any(body.inertial is None for _, body in mechanism.vertices(Body))
