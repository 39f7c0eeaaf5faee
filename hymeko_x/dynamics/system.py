"""A dynamic system: names and units of its variables, and its equations on any number type."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from hymeko_x.dynamics.numbers import Number, Numbers

    Equations = Callable[[Sequence[Number], Sequence[Number], Sequence[Number], Numbers], list[Number]]


class Variable(Struct, frozen=True):
    """A state, an input, an output or a parameter.

    ``value`` is the initial value of a state, the constant part of an input, the value of a parameter.
    ``rate_of`` is set on an input that is the time derivative of another one (the velocity of a moved ground); ``symbol`` is
    how formulas write it, and ``element`` the element that it belongs to.
    """

    name: str
    unit: str
    symbol: str = ""
    value: float = 0.0
    element: str = ""
    rate_of: str = ""


class System(Struct, frozen=True):
    """x' = rates(x, u, p), y = measured(x, u, p) with states x, inputs u, parameters p and outputs y, in SI units and rad."""

    name: str
    states: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    parameters: tuple[Variable, ...]
    rates: Equations
    measured: Equations

    def values(self, which: Literal["states", "inputs", "parameters"]) -> list[float]:
        """The initial states, the constant parts of the inputs, or the parameters."""
        variables: tuple[Variable, ...] = getattr(self, which)
        return [variable.value for variable in variables]


def input_of(system: System, name: str) -> Variable:
    """The input of this name, or the first one of the element of this name.

    Raises: Refusal (HX407) when there is none.
    """
    for variable in system.inputs:
        if name in (variable.name, variable.name.rpartition(".")[0]):
            return variable
    known = ", ".join(variable.name for variable in system.inputs) or "none"
    raise refuse(codes.BAD_SIGNAL, f"there is no input '{name}'; there are {known}")
