"""Lumped networks: masses, grounds, and the branches between them.

A constitutive edge joins masses and grounds; springs, dampers and ports on it act in parallel along its deflection, the sum of
ratio * position over its ends, negative for ``+``. Source: Hajdu & Hegyi, Appl. Mech. 2025, 6(4), 74, section 5.2, with ratios and
more than two ends.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.ir import lumped, parts

if TYPE_CHECKING:
    import ast
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.ids import Id

MOTIONS = ("ground", "position", "flow")
"""Ports that move, or hold, an end of an edge; the others push along it."""
CONTROLLERS = ("pid", "feedback")
EFFORTS = ("effort", *CONTROLLERS)


def gains_of(port: lumped.Port) -> tuple[str, ...]:
    """The names of the parameters of a port that are no signal."""
    return ("p", "i", "d") if port.kind == "pid" else ()


class NetworkElement(Struct, frozen=True):
    """A spring, damper or effort port on an edge: ``count`` of them side by side, with the tree of its law if it has one."""

    id: Id
    part: lumped.Spring | lumped.Damper | lumped.Port
    count: float = 1.0
    law: ast.expr | None = None


class Branch(Struct, frozen=True):
    """A constitutive edge: its ends with signed ratios, its elements, and what its controllers measure (position and velocity gain)."""

    id: Id
    ends: tuple[tuple[Id, float], ...]
    elements: tuple[NetworkElement, ...]
    senses: tuple[tuple[Id, float, float], ...] = ()


class Network(Struct, frozen=True):
    """A lumped network. ``masses`` in kg or kg m^2; ``moved`` are the grounds and moved ends; ``followers`` q = c0 + sum c * q_leader,
    leaders before their followers; ``sensors`` by id with what they measure; ``domains`` of every end and element."""

    name: str
    masses: Mapping[Id, float]
    moved: Mapping[Id, lumped.Port]
    branches: tuple[Branch, ...]
    followers: Mapping[Id, tuple[float, tuple[tuple[Id, float], ...]]]
    sensors: Mapping[Id, tuple[parts.Sensor, Id]]
    domains: Mapping[Id, str]

    @property
    def coordinates(self) -> tuple[Id, ...]:
        """The masses whose positions are independent, in order."""
        return tuple(key for key in self.masses if key not in self.followers)

    @property
    def ports(self) -> Iterator[tuple[Branch, NetworkElement]]:
        """The ports that push, with their edges."""
        for branch in self.branches:
            yield from ((branch, element) for element in branch.elements if isinstance(element.part, lumped.Port))

    @property
    def all_ports(self) -> Iterator[tuple[Id, lumped.Port]]:
        """The ports that move an end, and those that push."""
        yield from self.moved.items()
        yield from ((element.id, element.part) for _, element in self.ports if isinstance(element.part, lumped.Port))
