"""Rotors for joints that move next to nothing."""

from __future__ import annotations

import itertools
import operator
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.formats import native_format
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body, DofKind
from hymeko_x.rewrite.servos import home_poses, inertia_of, joints_inward, motion_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.ir.parts import Dof
    from hymeko_x.ir.values import Pose
    from hymeko_x.rewrite.context import Context
    from hymeko_x.rewrite.servos import CompositeInertia

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
    for (joint, number), inertia in articulated_inertias(mechanism).items():
        if inertia < _LIGHT:
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


# ---- articulated inertias --------------------------------------------------------------------------------------------------------

_Matrix = list[list[float]]
"""A spatial inertia in the world, about its origin: six rows, rotation before translation."""


def articulated_inertias(mechanism: Mechanism) -> dict[tuple[Id, int], float]:
    """The articulated inertia of each hinge, slide and screw at home, in kg m^2 or kg, by joint and number.

    It is what a dof moves while the dofs behind it are free.

    Source: R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7.
    """
    poses = home_poses(mechanism)
    moved = {body: _matrix_of(inertia_of(mechanism.vertex(body, Body), pose)) for body, pose in poses.items() if body != WORLD}
    found: dict[tuple[Id, int], float] = {}
    for view, frames in joints_inward(mechanism, poses):
        for number in reversed(range(len(view.joint.dofs))):
            dof = view.joint.dofs[number]
            if dof.kind in (DofKind.BALL, DofKind.FREE):
                moved[view.child] = [[0.0] * 6 for _ in range(6)]
            else:
                found[view.id, number] = _release(moved[view.child], dof, frames[number])
        if view.parent != WORLD:
            _add(moved[view.parent], moved[view.child])
    return found


def _release(moved: _Matrix, dof: Dof, frame: Pose) -> float:
    """The inertia that a dof in this frame moves; what moves freely along it is taken out of the matrix, for the dofs before it."""
    axis = [*itertools.chain(*motion_of(dof, frame))]
    pushed = [_dot(row, axis) for row in moved]
    inertia = max(_dot(axis, pushed), 0.0) + dof.armature
    if inertia > 0.0:
        _add(moved, [[-a * b / inertia for b in pushed] for a in pushed])
    return inertia


def _matrix_of(inertia: CompositeInertia) -> _Matrix:
    mass, (a, b, c), (xx, yy, zz, xy, xz, yz) = inertia
    return [
        [xx, xy, xz, 0.0, -c, b],
        [xy, yy, yz, c, 0.0, -a],
        [xz, yz, zz, -b, a, 0.0],
        [0.0, c, -b, mass, 0.0, 0.0],
        [-c, 0.0, a, 0.0, mass, 0.0],
        [b, -a, 0.0, 0.0, 0.0, mass],
    ]


def _add(to: _Matrix, other: _Matrix) -> None:
    for row, more in zip(to, other, strict=True):
        row[:] = map(operator.add, row, more)


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return float(sum(map(operator.mul, a, b)))
