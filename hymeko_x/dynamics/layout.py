"""The variables of a lumped network: which states, inputs and parameters it has, with names, units and columns.

States are the positions and velocities of the independent masses, the integral of each PID controller, and the position of
each end whose velocity is given. Inputs are the efforts of ports, the references of controllers, the positions (with their
rates) or velocities of moved ends. Grounds are inputs only where nothing else is: the road of the quarter vehicle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.system import Variable
from hymeko_x.ir import lumped
from hymeko_x.networks.domains import UNITS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.ids import Id
    from hymeko_x.networks.network import Network, NetworkElement


class NetworkLayout(Struct, frozen=True):
    """Which column each variable of a network has, by element and quantity."""

    network: Network
    states: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    parameters: tuple[Variable, ...]
    state_of: Mapping[tuple[Id, str], int]
    input_of: Mapping[tuple[Id, str], int]
    parameter_of: Mapping[tuple[Id, str], int]


def layout_of(network: Network) -> NetworkLayout:
    """The variables of a network in order."""
    controllers = [(branch, element) for branch, element in network.ports if element.part.kind != "effort"]  # type: ignore[union-attr]
    states: dict[tuple[Id, str], Variable] = {}
    for quantity in ("position", "velocity"):
        for key in network.coordinates:
            states[key, quantity] = variable(network, key, quantity)
    for branch, element in controllers:
        if element.part.kind == "pid":  # type: ignore[union-attr]
            unit = f"{UNITS[network.domains[branch.id]].position}*s"
            states[element.id, "integral"] = Variable(
                f"{element.id.name}.integral", unit, rf"\xi_{{{tex(element.id)}}}", 0.0, str(element.id)
            )
    inputs = _inputs(network)
    for key, port in network.moved.items():
        if port.kind == "flow":
            states[key, "position"] = variable(network, key, "position")
    parameters = _parameters(network)
    numbered = [{key: number for number, key in enumerate(table)} for table in (states, inputs, parameters)]
    return NetworkLayout(network, tuple(states.values()), tuple(inputs.values()), tuple(parameters.values()), *numbered)


def variable(network: Network, key: Id, quantity: str, value: float = 0.0, rate_of: str = "") -> Variable:
    """A quantity (position, velocity, acceleration) of a mass or a branch, with its unit and its letter."""
    unit = getattr(UNITS[network.domains[key]], quantity)
    letter = {"position": "x", "velocity": r"\dot x", "acceleration": r"\ddot x"}[quantity]
    if network.domains[key] == "rotation":
        letter = letter.replace("x", r"\varphi")
    return Variable(f"{key.name}.{quantity}", unit, f"{letter}_{{{tex(key)}}}", value, str(key), rate_of)


def tex(key: Id) -> str:
    """The name of an element as an upright index in LaTeX."""
    name = key.name.replace("_", r"\_")
    return rf"\mathrm{{{name}}}"


def _inputs(network: Network) -> dict[tuple[Id, str], Variable]:
    found: dict[tuple[Id, str], Variable] = {}
    for branch, element in network.ports:
        port = element.part
        assert isinstance(port, lumped.Port)
        units = UNITS[network.domains[branch.id]]
        quantity = "effort" if port.kind == "effort" else "reference"
        unit = units.position if port.kind == "pid" else units.effort
        letter = "F" if quantity == "effort" else "r"
        name = f"{element.id.name}.{quantity}"
        found[element.id, quantity] = Variable(name, unit, f"{letter}_{{{tex(element.id)}}}", port.value, str(element.id))
    driven = [key for key, port in network.moved.items() if port.kind != "ground"]
    if not driven and not found:
        driven = [key for key in network.moved if key.kind == "port"]
    for key in driven:
        port = network.moved[key]
        if port.kind == "flow":
            found[key, "velocity"] = variable(network, key, "velocity", port.value)
        else:
            position = variable(network, key, "position", port.value)
            found[key, "position"] = position
            found[key, "velocity"] = variable(network, key, "velocity", 0.0, position.name)
    return found


PID_GAINS = ("p", "i", "d")


def _parameters(network: Network) -> dict[tuple[Id, str], Variable]:
    """Masses, stiffnesses, dampings and gains: ``m``, ``k``, ``c`` where there is one of a kind, else with the element's name."""
    found: list[tuple[Id, str, str, float, str]] = []
    for key, mass in network.masses.items():
        found.append((key, "mass", "J" if network.domains[key] == "rotation" else "m", mass, UNITS[network.domains[key]].mass))
    for branch in network.branches:
        units = UNITS[network.domains[branch.id]]
        for element in branch.elements:
            match element.part:
                case lumped.Spring(stiffness):
                    found.append((element.id, "stiffness", "k", stiffness, units.stiffness))
                case lumped.Damper(damping):
                    found.append((element.id, "damping", "c", damping, units.damping))
                case lumped.Port(kind="pid") as port:
                    found += [(element.id, gain, gain, value, "") for gain, value in _gains(element, port).items()]
    unique = {(key, field): (letter, value, unit) for key, field, letter, value, unit in found}
    letters = [letter for letter, _, _ in unique.values()]
    return {
        (key, field): Variable(
            letter if letters.count(letter) == 1 else f"{letter}_{key.name}",
            unit,
            letter if letters.count(letter) == 1 else f"{letter}_{{{tex(key)}}}",
            value,
            str(key),
        )
        for (key, field), (letter, value, unit) in unique.items()
    }


def _gains(element: NetworkElement, port: lumped.Port) -> dict[str, float]:
    given = dict(port.parameters)
    gains = {gain: given.get(gain, 0.0) for gain in PID_GAINS}
    if not all(isinstance(value, float) for value in gains.values()) or not any(gains.values()):
        message = f"{element.id} has the gains {gains}; a pid controller takes the numbers p, i and d"
        raise refuse(codes.BAD_NETWORK, message, element=str(element.id))
    return {gain: float(value) for gain, value in gains.items()}  # type: ignore[arg-type]
