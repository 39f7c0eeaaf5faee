"""Frequency responses of linear systems, and Bode plots of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.dynamics.tables import figure_file

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.linear import StateSpace

    Floats = NDArray[np.floating[Any]]
    Complexes = NDArray[np.complexfloating[Any, Any]]

_POINTS = 400
_BEYOND = 10.0
"""How many times the slowest and the fastest pole a plot goes beyond them."""


def frequencies(space: StateSpace) -> Floats:
    """Angular frequencies in rad/s around the poles that are not zero; 0.01 to 100 without such poles."""
    import numpy as np

    found = [pole.frequency for pole in space.poles if pole.frequency > 1e-6] or [0.1, 10.0]
    return np.geomspace(min(found) / _BEYOND, max(found) * _BEYOND, _POINTS)


def frequency_response(space: StateSpace, w: Floats) -> Complexes:
    """The transfer functions (n, outputs, free inputs) at angular frequencies in rad/s; a position and its rate are one input."""
    import numpy as np

    a, b, c, d = space.floats
    columns = {variable.name: number for number, variable in enumerate(space.inputs)}
    rates = {variable.rate_of: columns[variable.name] for variable in space.inputs if variable.rate_of}
    free = [columns[variable.name] for variable in space.free_inputs]
    found = np.empty((len(w), len(c), len(free)), dtype=complex)
    for number, frequency in enumerate(w):
        s = 1j * frequency
        whole = c @ np.linalg.solve(s * np.eye(len(a)) - a, b) + d
        found[number] = whole[:, free]
        for place, column in enumerate(free):
            rate = rates.get(space.inputs[column].name)
            if rate is not None:
                found[number, :, place] += s * whole[:, rate]
    return found


def draw_bode(space: StateSpace, title: str, path: Path) -> None:
    """Draw magnitude (dB) and phase (degrees) of every transfer function that is not zero over the frequency in rad/s.

    Raises: Refusal (HX002) when it cannot be written, HX003 for a suffix that matplotlib does not know.
    """
    import numpy as np

    w = frequencies(space)
    response = frequency_response(space, w)
    with figure_file(path, title) as figure:
        magnitude, phase = figure.subplots(2, 1, sharex=True)
        for row, output in enumerate(space.outputs):
            for column, source in enumerate(space.free_inputs):
                values = response[:, row, column]
                if np.abs(values).max() <= 1e-12 * max(1e-300, float(np.abs(response).max())):
                    continue
                magnitude.semilogx(
                    w, 20 * np.log10(np.maximum(np.abs(values), 1e-300)), label=f"{output.name} / {source.name}", linewidth=1
                )
                phase.semilogx(w, np.degrees(np.unwrap(np.angle(values))), linewidth=1)
        magnitude.set_ylabel("magnitude (dB)")
        phase.set_ylabel("phase (degrees)")
        phase.set_xlabel("frequency (rad/s)")
        for axes in (magnitude, phase):
            axes.grid(alpha=0.3, which="both")
        magnitude.legend(loc="best", fontsize="small")
