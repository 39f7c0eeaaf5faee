"""The equations of a lumped network: M q'' = forces(q, q', u), and the system of first order that they are."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.layout import PID_GAINS, NetworkLayout, layout_of, tex, variable
from hymeko_x.dynamics.numbers import add, dot, evaluate, factorize, solve, times
from hymeko_x.dynamics.system import System, Variable
from hymeko_x.ir import lumped
from hymeko_x.networks.domains import UNITS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.ir.ids import Id
    from hymeko_x.networks.network import Branch, Network, NetworkElement


class Motion(NamedTuple):
    """The position and the velocity of an end, or along an edge."""

    position: Number
    velocity: Number


class Moment(Struct, frozen=True, dict=True):
    """A network at a state x, with inputs u and parameters p, in one number type."""

    layout: NetworkLayout
    x: Sequence[Number]
    u: Sequence[Number]
    p: Sequence[Number]
    numbers: Numbers

    def state(self, key: Id, quantity: str) -> Number:
        """The value of a state."""
        return self.x[self.layout.state_of[key, quantity]]

    def input(self, key: Id, quantity: str) -> Number:
        """The value of an input."""
        return self.u[self.layout.input_of[key, quantity]]

    def parameter(self, key: Id, field: str) -> Number:
        """The value of a parameter."""
        return self.p[self.layout.parameter_of[key, field]]

    @cached_property
    def motions(self) -> dict[Id, Motion]:
        """The position and velocity of every mass and every moved end."""
        network, states, inputs = self.layout.network, self.layout.state_of, self.layout.input_of
        found = {key: Motion(self.state(key, "position"), self.state(key, "velocity")) for key in network.coordinates}
        for key, (offset, leaders) in network.followers.items():
            mean = self.combined([(found[leader], ratio) for leader, ratio in leaders])
            found[key] = Motion(add(mean.position, self.numbers.exact(offset)), mean.velocity)
        for key in network.moved:
            if (key, "velocity") not in inputs:
                found[key] = Motion(0, 0)
            elif (key, "position") in states:
                found[key] = Motion(self.state(key, "position"), self.input(key, "velocity"))
            else:
                found[key] = Motion(self.input(key, "position"), self.input(key, "velocity"))
        return found

    def combined(self, terms: Sequence[tuple[Motion, float]]) -> Motion:
        """The sum of ratio * motion."""
        ratios = [self.numbers.exact(ratio) for _, ratio in terms]
        return Motion(dot(ratios, [motion.position for motion, _ in terms]), dot(ratios, [motion.velocity for motion, _ in terms]))

    def deflection(self, branch: Branch) -> Motion:
        """The deflection of an edge and its rate."""
        return self.combined([(self.motions[key], ratio) for key, ratio in branch.ends])

    def effort(self, branch: Branch) -> Number:
        """The force or torque that the elements of an edge exert against its deflection."""
        along = self.deflection(branch)
        total: Number = 0
        for element in branch.elements:
            total = add(total, times(self.numbers.exact(element.count), self._force(branch, element, along)))
        return total

    def _force(self, branch: Branch, element: NetworkElement, along: Motion) -> Number:
        match element.part:
            case lumped.Spring(_, rest):
                k, x = self.parameter(element.id, "stiffness"), add(along.position, self.numbers.exact(-rest))
                return evaluate(element.law, {"x": x, "k": k}, self.numbers) if element.law else times(k, x)
            case lumped.Damper():
                c, v = self.parameter(element.id, "damping"), along.velocity
                return evaluate(element.law, {"v": v, "c": c}, self.numbers) if element.law else times(c, v)
            case lumped.Port(kind="effort"):
                return -1 * self.input(element.id, "effort")
            case lumped.Port(kind="feedback"):
                gains = [gain for _, *both in branch.senses for gain in both]
                sensed = dot(list(map(self.numbers.exact, gains)), [value for key, _, _ in branch.senses for value in self.motions[key]])
                return add(sensed, -1 * self.input(element.id, "reference"))
            case _:
                return -1 * self._pid(branch, element.id)

    def _pid(self, branch: Branch, key: Id) -> Number:
        p, i, d = (self.parameter(key, gain) for gain in PID_GAINS)
        force = add(times(p, self.error(branch, key)), times(i, self.state(key, "integral")))
        return add(force, -1 * times(d, self._controlled(branch).velocity))

    def error(self, branch: Branch, key: Id) -> Number:
        """The reference of a pid controller minus what it controls."""
        return add(self.input(key, "reference"), -1 * self._controlled(branch).position)

    def _controlled(self, branch: Branch) -> Motion:
        """What a pid controller holds at its reference: the weighted sum of what it senses, else the deflection of its edge."""
        if not branch.senses:
            return self.deflection(branch)
        return self.combined([(self.motions[key], gain) for key, gain, _ in branch.senses])

    def forces(self) -> list[Number]:
        """The force on every independent coordinate: everything in M q'' = forces."""
        network = self.layout.network
        on: dict[Id, Number] = {}
        for branch in network.branches:
            against = self.effort(branch)
            for key, ratio in branch.ends:
                on[key] = add(on.get(key, 0), -1 * times(self.numbers.exact(ratio), against))
        for key in reversed(list(network.followers)):
            for leader, ratio in network.followers[key][1]:
                on[leader] = add(on.get(leader, 0), times(self.numbers.exact(ratio), on.get(key, 0)))
        return [on.get(key, 0) for key in network.coordinates]

    def mass_matrix(self) -> Matrix:
        """M = sum of m_i t_i t_i' over the masses, where t_i is how the coordinates move mass i."""
        moves = participation(self.layout.network, self.numbers)
        n = len(self.layout.network.coordinates)
        matrix: Matrix = [[0] * n for _ in range(n)]
        for key, row in moves.items():
            mass = self.parameter(key, "mass")
            for i, a in row.items():
                for j, b in row.items():
                    matrix[i][j] = add(matrix[i][j], times(mass, times(a, b)))
        return matrix


def participation(network: Network, numbers: Numbers) -> dict[Id, dict[int, Number]]:
    """For each mass how much the independent coordinates (by number) move it."""
    moves: dict[Id, dict[int, Number]] = {key: {number: 1} for number, key in enumerate(network.coordinates)}
    for key, (_, leaders) in network.followers.items():
        row: dict[int, Number] = {}
        for leader, ratio in leaders:
            for number, value in moves[leader].items():
                row[number] = add(row.get(number, 0), times(numbers.exact(ratio), value))
        moves[key] = row
    return moves


def system_of(network: Network) -> System:
    """The equations of a network as a system of first order.

    Raises: Refusal (HX406) for a controller with wrong gains, and for a sensor of something that is not there.
    """
    layout = layout_of(network)
    integrals = [(branch, element.id) for branch, element in network.ports if (element.id, "integral") in layout.state_of]
    flows = [key for key, port in network.moved.items() if port.kind == "flow"]
    measurements = _measurements(network)

    def rates(x: Sequence[Number], u: Sequence[Number], p: Sequence[Number], numbers: Numbers) -> list[Number]:
        now = Moment(layout, x, u, p, numbers)
        acceleration = solve(factorize(now.mass_matrix()), now.forces())
        velocities = [now.motions[key].velocity for key in network.coordinates]
        return [
            *velocities,
            *acceleration,
            *[now.error(branch, key) for branch, key in integrals],
            *[now.input(key, "velocity") for key in flows],
        ]

    def measured(x: Sequence[Number], u: Sequence[Number], p: Sequence[Number], numbers: Numbers) -> list[Number]:
        now = Moment(layout, x, u, p, numbers)
        return [_measure(now, kind, key) for kind, key in measurements]

    outputs = tuple(_output(network, kind, key) for kind, key in measurements)
    return System(network.name, layout.states, layout.inputs, outputs, layout.parameters, rates, measured)


# ---- outputs -------------------------------------------------------------------------------------------------------------


def _measurements(network: Network) -> list[tuple[str, Id]]:
    """What is measured: what the sensors say, else the position of every independent mass."""
    if network.sensors:
        return [(sensor.kind, key) for sensor, key in network.sensors.values()]
    return [("position", key) for key in network.coordinates]


def _output(network: Network, kind: str, key: Id) -> Variable:
    units = UNITS[network.domains[key]]
    kinds = ("position", "velocity") if key.kind != "constitutive" else ("deflection", "rate", "effort")
    if kind not in kinds:
        message = f"a sensor of the type '{kind}' on {key}; there are {', '.join(kinds)}"
        raise refuse(codes.BAD_NETWORK, message, element=str(key))
    if key.kind != "constitutive":
        return variable(network, key, kind)
    unit = {"deflection": units.position, "rate": units.velocity, "effort": units.effort}[kind]
    return Variable(f"{key.name}.{kind}", unit, rf"\mathrm{{{kind}}}_{{{tex(key)}}}", 0.0, str(key))


def _measure(now: Moment, kind: str, key: Id) -> Number:
    if key.kind != "constitutive":
        return getattr(now.motions[key], kind)
    branch = next(branch for branch in now.layout.network.branches if branch.id == key)
    if kind == "effort":
        return now.effort(branch)
    along = now.deflection(branch)
    return along.position if kind == "deflection" else along.velocity
