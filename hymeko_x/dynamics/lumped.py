"""The dynamics of a lumped network: its system, its forms, its poles, its response."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics import forms
from hymeko_x.dynamics.equations import system_of
from hymeko_x.dynamics.linear import StateSpace, is_linear, linearize
from hymeko_x.dynamics.signals import KINDS, constant, signal_of, total
from hymeko_x.dynamics.simulation import Response, simulate
from hymeko_x.dynamics.system import input_of
from hymeko_x.networks.network import CONTROLLERS, gains_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.dynamics.signals import Signal
    from hymeko_x.dynamics.system import System, Variable
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.networks.network import Network


class Lumped(Struct, frozen=True, dict=True):
    """The dynamics of a lumped network. Positions count from where the file has them; SI units and rad."""

    network: Network

    @cached_property
    def system(self) -> System:
        """The equations x' = f(x, u, p), y = g(x, u, p) on any number type."""
        return system_of(self.network)

    @cached_property
    def is_linear(self) -> bool:
        """Whether no element has a law that is not linear."""
        return is_linear(self.system)

    def state_space(self, *, symbolic: bool = False) -> StateSpace:
        """A, B, C, D, exact or in symbols, at the initial state: rest."""
        return linearize(self.system, symbolic=symbolic)

    def second_order(self, *, symbolic: bool = False) -> forms.SecondOrder:
        """M, C, K, F.

        Raises: Refusal (HX408) where there are states of first order.
        """
        return forms.second_order(self.network, symbolic=symbolic)

    def port_hamiltonian(self, *, symbolic: bool = False) -> forms.PortHamiltonian:
        """J, R, G, the energy and its gradient.

        Raises: Refusal (HX408) for elements whose energy is not known.
        """
        return forms.port_hamiltonian(self.network, symbolic=symbolic)

    def input(self, name: str) -> Variable:
        """The input of this name, or the first one of the element of this name.

        Raises: Refusal (HX407) when there is none.
        """
        return input_of(self.system, name)

    def simulate(self, duration: float, step: float, inputs: Mapping[str, Signal] | None = None, at: str = "") -> Response:
        """The response from rest to the signals of the file, or to these instead, by the name of their input or its element.

        Raises: Refusal (HX407) for signals and names, and for ``at``; HX409 when the solution cannot be continued.
        """
        if at:
            raise refuse(codes.BAD_SIGNAL, f"{self.network.name} starts at rest; only a mechanism starts at '{at}'")
        return simulate(self.system, self.signals(duration, inputs or {}), duration, step)

    def signals(self, duration: float, inputs: Mapping[str, Signal]) -> dict[str, Signal]:
        """The signal of each input: that of the file, or this instead.

        Raises: Refusal (HX407) for signals and names.
        """
        signals = {}
        for variable in self.system.inputs:
            port = next((port for port in self._ports() if str(port[0]) == variable.element), None)
            own = signal_of(port[1], duration, variable.element) if port and not variable.rate_of else constant(0.0)
            signals[variable.name] = total([constant(variable.value), own])
        for name, signal in inputs.items():
            variable = self.input(name)
            signals[variable.name] = total([constant(variable.value), signal])
        return signals

    def _ports(self) -> list[tuple[Id, Parameters]]:
        """Every port with the parameters of its signal: all that are no gains."""
        return [(key, tuple([item for item in port.parameters if item[0] not in gains_of(port)])) for key, port in self.network.all_ports]


def checked(network: Network, mechanism: Mechanism) -> Lumped:
    """The dynamics of a mechanism's network whose ports have gains and signals that are known.

    Raises: Refusal (HX406) for a field that a controller does not have, HX407 for one that no signal has.
    """
    found = Lumped(network)
    for key, port in network.all_ports:
        gains = gains_of(port)
        known = {*gains, "signal", "noise", *[name for _, defaults in KINDS.values() for name in defaults]}
        wrong = next((name for name, _ in port.parameters if name not in known), None)
        if wrong is not None and port.kind in CONTROLLERS:
            own = ", ".join((*gains, "value"))
            hint = "the gains of a feedback are the weight of its arc with the role sense" if not gains else ""
            message = f"{key}: a {port.kind} has no '{wrong}'; it has {own} and a signal"
            raise refuse(codes.BAD_NETWORK, message, mechanism.origin(key), element=str(key), hint=hint)
    for key, parameters in found._ports():
        signal_of(parameters, 0.0, str(key))
    return found
