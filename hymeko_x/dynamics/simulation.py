"""Responses over time: linear systems exactly, by the matrix exponential, others by scipy's solver for stiff and smooth equations."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.linear import is_linear, linearize
from hymeko_x.dynamics.numbers import floats

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.linear import StateSpace
    from hymeko_x.dynamics.signals import Signal
    from hymeko_x.dynamics.system import System, Variable

    Floats = NDArray[np.floating[Any]]
    Rates = Callable[[Floats, Sequence[float]], Floats]

_GROWTH = 1e9
"""A state that grows by this factor within one piece is taken to grow without bounds."""
_MOST = 5_000_000
"""Numbers in the table of a response."""


class Response(Struct, frozen=True):
    """Inputs, states and outputs (rows: times) of a system at times in s."""

    time: Floats
    inputs: Floats
    states: Floats
    outputs: Floats
    names: tuple[tuple[Variable, ...], tuple[Variable, ...], tuple[Variable, ...]]

    def columns(self) -> dict[str, Floats]:
        """The table by column: time, inputs, states, and the outputs that are no states."""
        found = {"time": self.time}
        for variables, values in zip(self.names, (self.inputs, self.states, self.outputs), strict=True):
            found |= {variable.name: values[:, number] for number, variable in enumerate(variables)}
        return found


def simulate(
    system: System,
    signals: Mapping[str, Signal],
    duration: float,
    step: float,
    start: Sequence[float] | None = None,
    rates: Rates | None = None,
) -> Response:
    """The response to signals (by the name of their input) from 0 to ``duration`` s, every ``step`` s.

    An input that is the rate of another one follows it, also through its jumps. A linear system without sines is computed exactly.
    ``rates`` is a faster function of the system's rates, of one that is known not to be linear.

    Raises: Refusal (HX407) for times that cannot be, HX409 when the solution cannot be continued.
    """
    import numpy as np

    time = grid_of(duration, step, len(system.states) + len(system.inputs) + len(system.outputs) + 1)
    initial = np.array(system.values("states") if start is None else start, dtype=float)
    straight = all(signal.straight for signal in signals.values())
    if rates is None and straight and is_linear(system):
        return _exact(system, linearize(system, [0.0] * len(initial), [0.0] * len(system.inputs)), signals, time, initial)
    return _integrated(system, signals, time, initial, rates or _rates(system))


def grid_of(duration: float, step: float, columns: int) -> Floats:
    """The times of a table with so many columns.

    Raises: Refusal (HX407) for times that cannot be, and for a table that is too long.
    """
    import numpy as np

    if not 0 < step <= duration < float("inf"):
        raise refuse(codes.BAD_SIGNAL, f"a simulation of {duration:g} s in steps of {step:g} s; 0 < step <= duration")
    if duration / step * columns > _MOST:
        raise refuse(codes.BAD_SIGNAL, f"{duration:g} s in steps of {step:g} s make a table of more than {_MOST} numbers")
    count = max(1, round(duration / step))
    time: Floats = np.arange(count + 1) / (count / duration)
    return time


def _grid(time: Floats, signals: Mapping[str, Signal]) -> Floats:
    """The times of the table and the corners of the signals between them."""
    import numpy as np

    corners = [corner for signal in signals.values() for corner in signal.corners if 0.0 < corner < time[-1]]
    grid = np.union1d(time, corners)
    kept: Floats = grid[np.concatenate([[True], np.diff(grid) > 1e-12 * time[-1]])]
    return kept


def _ends(signal: Signal, left: Floats, right: Floats) -> tuple[Floats, Floats]:
    """The values of a straight piece at its two ends, seen from inside of it."""
    early, late = (signal.value(left + part * (right - left)) for part in (0.25, 0.75))
    return early - (late - early) / 2, late + (late - early) / 2


def _exact(system: System, space: StateSpace, signals: Mapping[str, Signal], time: Floats, initial: Floats) -> Response:
    """x = w + B_r z, where z are the inputs with rates r = z': then w' = A w + (B_z + A B_r) z + ..., without the rates.

    Between two corners inputs are straight lines, and the step is exact. Source: the first-order hold, as in scipy.signal.lsim.
    """
    import numpy as np

    a, b, c, d = space.floats
    grid = _grid(time, signals)
    left, right, span = grid[:-1], grid[1:], np.diff(grid)
    place = {variable.name: number for number, variable in enumerate(system.inputs)}
    rates = {place[variable.name]: place[variable.rate_of] for variable in system.inputs if variable.rate_of}
    first, last = _inputs_at_ends(system, signals, left, right)
    shift = np.zeros_like(b)
    for rate, position in rates.items():
        shift[:, position] = b[:, rate]
        slope = (last[:, rate] - first[:, rate]) / span
        first[:, rate], last[:, rate] = slope, slope
    driven = b.copy()
    driven[:, list(rates)] = 0.0
    driven = driven + a @ shift
    offset = np.array(space.offset.tolist(), dtype=float).reshape(-1)
    rest = np.array([variable.value for variable in system.inputs])
    w = initial - shift @ rest
    states = np.empty((len(grid), len(w)))
    states[0] = w + shift @ first[0]
    steps: dict[float, tuple[Floats, Floats, Floats, Floats]] = {}
    for k, length in enumerate(span):
        key = float(f"{length:.14g}")
        if key not in steps:
            steps[key] = _hold(a, driven, offset, key)
        free, early, late, constant = steps[key]
        w = free @ w + early @ first[k] + late @ last[k] + constant
        states[k + 1] = w + shift @ last[k]
    inputs = np.vstack([first, last[-1:]])
    states[1:-1] += (first[1:] - last[:-1]) @ shift.T
    outputs = states @ c.T + inputs @ d.T
    chosen = np.searchsorted(grid, time - 1e-12 * time[-1])
    return Response(time, inputs[chosen], states[chosen], outputs[chosen], (system.inputs, system.states, system.outputs))


def _inputs_at_ends(system: System, signals: Mapping[str, Signal], left: Floats, right: Floats) -> tuple[Floats, Floats]:
    """The inputs (n, m) at both ends of n steps; of a rate the signal of which it is the rate."""
    import numpy as np

    first, last = (np.zeros((len(left), len(system.inputs))) for _ in range(2))
    for number, variable in enumerate(system.inputs):
        signal = signals.get(variable.rate_of or variable.name)
        if signal is not None:
            first[:, number], last[:, number] = _ends(signal, left, right)
    return first, last


def _hold(a: Floats, b: Floats, offset: Floats, step: float) -> tuple[Floats, Floats, Floats, Floats]:
    """The factors of the state, of the inputs at both ends, and the constant, of one step with inputs that are straight lines."""
    import numpy as np
    from scipy.linalg import expm

    n, m = b.shape
    whole = np.zeros((n + 2 * m + 2, n + 2 * m + 2))
    drive = np.hstack([b, offset[:, None]])
    whole[:n, :n], whole[:n, n : n + m + 1] = a * step, drive * step
    whole[n : n + m + 1, n + m + 1 :] = np.eye(m + 1)
    power = expm(whole)
    free, hold, ramp = power[:n, :n], power[:n, n : n + m + 1], power[:n, n + m + 1 :]
    return free, (hold - ramp)[:, :m], ramp[:, :m], hold[:, m]


def _rates(system: System) -> Rates:
    import numpy as np

    parameters, numbers = system.values("parameters"), floats()
    return lambda x, u: np.array([float(value) for value in system.rates(list(x), u, parameters, numbers)])


def _integrated(system: System, signals: Mapping[str, Signal], time: Floats, initial: Floats, rates: Rates) -> Response:
    """By scipy's LSODA from corner to corner, with relative errors of 1e-10."""
    import numpy as np

    parameters = system.values("parameters")
    numbers = floats()
    _refuse_jumps(system, signals, time)

    def inputs(t: float) -> list[float]:
        return [_input(variable, signals, t) for variable in system.inputs]

    corners = sorted({0.0, float(time[-1]), *[c for s in signals.values() for c in s.corners if 0.0 < c < time[-1]]})
    states = np.tile(initial, (len(time), 1))
    x = initial
    for begin, end in pairwise(corners):
        inside = (time > begin) & (time <= end)
        x, states[inside] = _piece(lambda t, x: rates(x, inputs(t)), begin, end, x, time[inside])
    driven = np.array([inputs(t) for t in time]).reshape(len(time), len(system.inputs))
    pairs = zip(states, driven, strict=True)
    outputs = [[float(value) for value in system.measured(list(s), list(u), parameters, numbers)] for s, u in pairs]
    table = np.array(outputs).reshape(len(time), len(system.outputs))
    return Response(time, driven, states, table, (system.inputs, system.states, system.outputs))


def _piece(rates: Callable[[float, Floats], Floats], begin: float, end: float, x: Floats, asked: Floats) -> tuple[Floats, Floats]:
    """The state at the end of a piece between two corners, and at the times that are asked for.

    Raises: Refusal (HX409).
    """
    import numpy as np
    from scipy.integrate import solve_ivp

    last = end - 1e-12 * (end - begin)  # a signal that jumps at the end has its value before the jump
    bound = _GROWTH * (1.0 + float(np.abs(x).max(initial=0.0)))

    def grown(t: float, y: Floats) -> float:
        return bound - float(np.abs(y).max())

    grown.terminal = True  # type: ignore[attr-defined]
    with np.errstate(over="ignore", invalid="ignore"):
        found = solve_ivp(
            lambda t, y: rates(min(t, last), y), (begin, end), x, "LSODA", np.union1d(asked, [end]), events=grown, rtol=1e-10, atol=1e-12
        )
    if found.status != 0 or not np.isfinite(found.y).all():
        raise refuse(
            codes.SIMULATION_FAILED,
            f"the solution grows without bounds at {found.t_events[0][0] if len(found.t_events[0]) else begin:.6g} s",
        )
    return found.y[:, -1], found.y.T[: len(asked)]


def _input(variable: Variable, signals: Mapping[str, Signal], t: float) -> float:
    import numpy as np

    signal = signals.get(variable.rate_of or variable.name)
    if signal is None:
        return 0.0 if variable.rate_of else variable.value
    if not variable.rate_of:
        return float(signal.value(np.array([t]))[0])
    tiny = 1e-6
    before, after = signal.value(np.array([t - tiny, t + tiny]))
    return float(after - before) / (2 * tiny)


def _refuse_jumps(system: System, signals: Mapping[str, Signal], time: Floats) -> None:
    """A position that jumps has an infinite rate, which only a linear system can be computed with."""
    import numpy as np

    for variable in system.inputs:
        signal = signals.get(variable.rate_of)
        if not variable.rate_of or signal is None or not signal.corners:
            continue
        corners = np.array([corner for corner in signal.corners if corner < time[-1]])
        jump = np.abs(signal.value(corners + 1e-9) - signal.value(corners - 1e-9)).max(initial=0.0)
        if jump > 1e-6:
            message = f"{variable.element}: its position jumps by {jump:.3g}, and the system is not linear; its velocity would be infinite"
            raise refuse(codes.BAD_SIGNAL, message, element=variable.element, hint="give the signal a rise time: rise=0.01")
