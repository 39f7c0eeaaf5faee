"""The parts of lumped networks, the dynamics dialect: masses, springs, dampers and ports are vertices, constitutive relations are edges."""

from __future__ import annotations

from msgspec import Struct

from hymeko_x.ir.fields import Parameters  # noqa: TC001 - a field's type is evaluated


class Spring(Struct, frozen=True):
    """A lumped spring: ``stiffness`` in N/m or Nm/rad, ``rest`` length or angle.

    ``law`` is the force as an expression in the deflection ``x`` from rest and the stiffness ``k``; empty = ``k*x``.
    ``domain`` is translation or rotation; empty = that of its neighbours.
    """

    stiffness: float
    rest: float = 0.0
    law: str = ""
    domain: str = ""


class Damper(Struct, frozen=True):
    """A lumped damper: ``damping`` in Ns/m or Nms/rad; ``law`` an expression in the rate ``v`` and the damping ``c``, empty = ``c*v``."""

    damping: float
    law: str = ""
    domain: str = ""


class Mass(Struct, frozen=True):
    """A lumped mass in kg, or moment of inertia in kg m^2 where the ``domain`` is rotation."""

    mass: float
    domain: str = ""


class Port(Struct, frozen=True):
    """Where effort or motion enters from outside: ``kind`` is ground, effort, position, flow (a velocity), pid or feedback.

    ``value`` is the constant part of what enters, of a controller its reference; the parameters are the signal, or the gains.
    """

    kind: str = "ground"
    value: float = 0.0
    domain: str = ""
    parameters: Parameters = ()


class Constitutive(Struct, frozen=True):
    """An n-ary relation of the dynamics dialect: springs, dampers and ports in parallel between masses.

    Arcs: ``+`` and ``-`` masses, bodies, grounds, weight (ratio,): the deflection is the sum of ratio * position, negative for ``+``.
    Springs, dampers, effort ports and controllers in any direction, weight (number of them,). What a controller measures has
    the role ``sense``, weight (gain of the position, gain of the velocity).
    """
