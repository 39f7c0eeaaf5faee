"""Input signals over time: constants, steps, pulses, sines, noise, tables, and sums of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Parameters

    Floats = NDArray[np.floating[Any]]

MOST_PIECES = 1_000_000
"""Pieces of a signal between its corners; more are refused."""


class Signal(Struct, frozen=True):
    """A function of time in s. Between neighbouring ``corners`` it is smooth, and a straight line if it is ``straight``."""

    value: Callable[[Floats], Floats]
    corners: tuple[float, ...] = ()
    straight: bool = True


def constant(value: float) -> Signal:
    """The same value at all times."""
    import numpy as np

    return Signal(lambda t: np.full(np.shape(t), value))


def total(signals: Sequence[Signal]) -> Signal:
    """The sum of signals."""
    import numpy as np

    corners = tuple(sorted({corner for signal in signals for corner in signal.corners}))
    return Signal(lambda t: np.sum([signal.value(t) for signal in signals], axis=0), corners, all(signal.straight for signal in signals))


def _step(given: Mapping[str, float], until: float) -> Signal:
    import numpy as np

    return Signal(lambda t: given["amplitude"] * (np.asarray(t) >= given["start"]), (given["start"],))


def _pulse(given: Mapping[str, float], until: float) -> Signal:
    """Up for the part ``duty`` of each period, with straight flanks of ``rise`` seconds at both of its ends."""
    import numpy as np

    period, width, rise, start = given["period"], given["duty"] * given["period"], given["rise"], given["start"]
    _positive("period", period)
    if not 0 < given["duty"] <= 1 or not 0 <= 2 * rise <= width:
        raise _bad(f"a pulse with duty {given['duty']:g} and rise {rise:g} s in a period of {period:g} s; 0 < duty <= 1, rise fits twice")
    count = math.ceil(max(until - start, 0.0) / period) + 1
    _few(4 * count)
    corners = sorted({start + k * period + edge for k in range(count) for edge in (0.0, rise, width - rise, width)})

    def value(t: Floats) -> Floats:
        late = np.asarray(t) - start
        phase = np.mod(late, period)
        flanks = np.minimum(phase, width - phase) / rise if rise else np.where(phase < width, 1.0, 0.0)
        shape = np.clip(flanks, 0.0, 1.0)
        return given["amplitude"] * shape * (late >= 0)

    return Signal(value, tuple(corners))


def _sine(given: Mapping[str, float], until: float) -> Signal:
    import numpy as np

    return Signal(lambda t: given["amplitude"] * np.sin(2 * np.pi * given["frequency"] * np.asarray(t) + given["phase"]), straight=False)


def _noise(given: Mapping[str, float], until: float) -> Signal:
    """Band-limited white noise: a new normal number every ``sample`` seconds, of the variance power / sample."""
    import numpy as np

    sample = given["sample"]
    _positive("sample", sample)
    count = math.ceil(until / sample) + 2
    _few(count)
    values = np.random.default_rng(int(given["seed"])).normal(0.0, math.sqrt(max(given["power"], 0.0) / sample), count)

    def value(t: Floats) -> Floats:
        held = np.floor(np.asarray(t) / sample + 1e-9).astype(int)
        return np.asarray(values[np.clip(held, 0, count - 1)])

    return Signal(value, tuple(k * sample for k in range(count)))


def table(times: Sequence[float], values: Sequence[float]) -> Signal:
    """Straight lines between points; constant before the first and after the last."""
    import numpy as np

    return Signal(lambda t: np.interp(t, times, values), tuple(times))


KINDS: Mapping[str, tuple[Callable[[Mapping[str, float], float], Signal], Mapping[str, float]]] = {
    "step": (_step, {"amplitude": 1.0, "start": 0.0}),
    "pulse": (_pulse, {"amplitude": 1.0, "period": 1.0, "duty": 0.5, "start": 0.0, "rise": 0.0}),
    "sine": (_sine, {"amplitude": 1.0, "frequency": 1.0, "phase": 0.0}),
    "noise": (_noise, {"power": 0.1, "sample": 0.1, "seed": 0.0}),
}
"""The signals, with their parameters and the defaults of these."""


def signal_of(parameters: Parameters, until: float, name: str) -> Signal:
    """The signal that the parameters of a port describe; ``noise`` (a power), ``sample`` and ``seed`` add noise to any of them.

    Raises: Refusal (HX407) for a signal that is not known, a parameter that it does not have, or a value that it cannot take.
    """
    given = dict(parameters)
    kind = given.pop("signal", "")
    parts: list[Signal] = []
    if kind != "noise" and "noise" in given:
        extra: dict[str, object] = {"power": given.pop("noise")}
        extra |= {key: given.pop(key) for key in ("sample", "seed") if key in given}
        parts.append(_made("noise", extra, until, name))
    if kind:
        parts.append(_made(str(kind), given, until, name))
    elif given:
        raise _bad(f"{name} has {', '.join(given)} and no signal; there are {', '.join(KINDS)}")
    return total(parts) if parts else constant(0.0)


def _made(kind: str, given: Mapping[str, object], until: float, name: str) -> Signal:
    if kind not in KINDS:
        raise _bad(f"{name} has the signal '{kind}'; there are {', '.join(KINDS)}")
    make, defaults = KINDS[kind]
    values: dict[str, float] = dict(defaults)
    for key, value in given.items():
        if key not in defaults:
            raise _bad(f"{name}: a {kind} has no '{key}'; it has {', '.join(defaults)}")
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise _bad(f"{name}: '{key}' of a {kind} is a number, not {value!r}")
        values[key] = float(value)
    return make(values, until)


def _positive(name: str, value: float) -> None:
    if not value > 0:
        raise _bad(f"'{name}' of a signal is positive, not {value:g}")


def _few(count: int) -> None:
    if count > MOST_PIECES:
        raise _bad(f"a signal of {count} pieces; at most {MOST_PIECES} are simulated")


def _bad(message: str) -> Exception:
    return refuse(codes.BAD_SIGNAL, message, hint="docs/dynamics.md lists the signals and their parameters")
