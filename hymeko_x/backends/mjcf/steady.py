"""The integrator that keeps stiff drives calm, where the author of a robot names none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats.mjcf.settings import settings, with_settings
from hymeko_x.ir.parts import Actuator, Tendon

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Context

_FEEDBACK = frozenset({"position", "velocity", "intvelocity", "orientation", "pid", "damper", "dcmotor"})
"""The kinds of actuators whose force depends on a velocity."""


def integrate_implicitly(mechanism: Mechanism, context: Context) -> Mechanism:
    """Forces that depend on velocities are integrated implicitly where a drive has one and no integrator is named.

    MuJoCo's default, Euler, integrates the damping of joints implicitly, and that of actuators and tendons explicitly, so that a stiff
    drive of a light body oscillates from step to step.

    Source: MuJoCo's documentation, Computation, Numerical integration.
    """
    if "integrator" in settings(mechanism, "option") or not _has_damped_drive(mechanism):
        return mechanism
    message = "integrator 'implicitfast' is written: forces of drives depend on velocities, which Euler's integrates explicitly"
    context.report.note(codes.FOR_TARGET, f"{context.reason}: {message}", element="mechanism")
    return with_settings(mechanism, "option", {"integrator": "implicitfast"})


def _has_damped_drive(mechanism: Mechanism) -> bool:
    if any(_is_damped(actuator) for _, actuator in mechanism.vertices(Actuator)):
        return True
    return any(tendon.damping for _, tendon, _ in mechanism.edges(Tendon))


def _is_damped(actuator: Actuator) -> bool:
    """Whether the force of an actuator depends on a velocity: by its kind, or by a general law."""
    given = dict(actuator.parameters)
    laws = ((given.get(f"{name}type"), given.get(f"{name}prm")) for name in ("gain", "bias"))
    is_affine = any(kind == "affine" and isinstance(numbers, tuple) and any(numbers[2:3]) for kind, numbers in laws)
    return actuator.kind in _FEEDBACK or (actuator.kind == "general" and is_affine)
