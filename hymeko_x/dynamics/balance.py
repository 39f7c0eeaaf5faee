"""Responses that keep the power balance: port-Hamiltonian forms over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.dynamics.lumped import Lumped
from hymeko_x.dynamics.simulation import Response, grid_of
from hymeko_x.dynamics.system import Variable

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.multibody import Multibody
    from hymeko_x.dynamics.signals import Signal

    Floats = NDArray[np.floating[Any]]

ENERGY = Variable("energy", "J", "H")


def balanced_response(
    dynamics: Lumped | Multibody, duration: float, step: float, inputs: Mapping[str, Signal] | None = None, at: str = ""
) -> Response:
    """The states of the port-Hamiltonian form and its energy, every ``step`` s, by rules that keep the power balance in every step.

    Inputs are held at their mean within a step: positions of moved ends act by their differences.

    Raises: Refusal (HX407) for times, signals and names, HX408 when there is no such form, HX409 where a step has no solution.
    """
    import numpy as np

    system = dynamics.system
    time = grid_of(duration, step, len(system.states) + len(system.inputs) + 1)
    signals = dynamics.signals(duration, inputs or {})
    if isinstance(dynamics, Lumped):
        network = dynamics.port_hamiltonian()
        driven, names = _held(network.inputs, signals, time), (network.inputs, network.states)
        states, _, energies = network.simulate([0.0] * len(network.states), driven, time[1])
    else:
        form, positions = dynamics.port_hamiltonian(), dynamics.start(at)
        driven, names = _held(system.inputs, signals, time), (system.inputs, form.states)
        still = [0.0] * (len(form.states) - len(positions))
        states, energies, _, _ = form.simulate(form.state(positions, still), driven, time[1])
    return Response(time, np.vstack([driven, driven[-1:]]), states, energies[:, None], (*names, (ENERGY,)))


def _held(variables: Sequence[Variable], signals: Mapping[str, Signal], time: Floats) -> Floats:
    """The inputs (n, m) within n steps."""
    import numpy as np

    columns = []
    for variable in variables:
        signal = signals.get(variable.rate_of or variable.name)
        if signal is None:
            columns.append(np.full(len(time) - 1, 0.0 if variable.rate_of else variable.value))
        elif variable.rate_of:
            columns.append(np.diff(signal.value(time)) / np.diff(time))
        else:
            columns.append(np.asarray(signal.value((time[1:] + time[:-1]) / 2), dtype=float))
    return np.array(columns).reshape(len(variables), len(time) - 1).T
