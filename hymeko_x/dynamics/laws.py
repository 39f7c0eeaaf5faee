"""The laws of actuators: force = gain * signal + bias, both affine in length and rate, and how the signal follows the control."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import Actuator

Affine = tuple[float, float, float]
NOTHING: Affine = (0.0, 0.0, 0.0)

_KINDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"dyntype": ("none", "integrator", "filter", "filterexact"), "gaintype": ("fixed", "affine"), "biastype": ("none", "affine")}
)
"""Of a general actuator, what it is by default first."""
_LEAST = 1e-15
"""In s: the least time constant of a filter, as in MuJoCo."""


class Law(NamedTuple):
    """gain and bias are numbers before 1, the length and the rate. The force is gain * signal + bias.

    ``lag`` None: the signal is the control u; 0: it is the state a with a' = u; a time T in s: a' = (u - a) / T.
    """

    gain: Affine
    bias: Affine = NOTHING
    lag: float | None = None

    @property
    def damping_ratio(self) -> float:
        """The damping ratio that stands for the bias of the rate where a servo has a positive one, as in MuJoCo; else 0."""
        return self.bias[2] if self.bias[2] > 0.0 and self.gain[0] == -self.bias[1] else 0.0


def law_of(actuator: Actuator) -> Law | str:
    """The law of an actuator; as text the reason why it has none here."""
    given = dict(actuator.parameters)
    for name in ("armature", "damping", "delay", "plugin"):
        if name in given and given[name] != 0.0:
            return f"has the attribute '{name}'"
    match actuator.kind:
        case "motor" | "transmission":
            return Law((1.0, 0.0, 0.0))
        case "position":
            lag = _number(given, "timeconst", 0.0)
            return _servo(given, lag if lag > 0.0 else None)
        case "intvelocity":
            return _servo(given, 0.0)
        case "velocity":
            kv = _number(given, "kv", 1.0)
            return Law((kv, 0.0, 0.0), (0.0, 0.0, -kv))
        case "damper":
            return Law((0.0, 0.0, -_number(given, "kv", 1.0)))
        case "cylinder":
            diameter = _number(given, "diameter", 0.0)
            area = math.pi / 4 * diameter**2 if diameter > 0.0 else _number(given, "area", 1.0)
            return Law((area, 0.0, 0.0), _affine(given, "bias", 0.0), max(_LEAST, _number(given, "timeconst", 1.0)))
        case "general":
            return _general(given)
    return f"is of the kind '{actuator.kind}'"


def _servo(given: Mapping[str, object], lag: float | None) -> Law:
    kp = _number(given, "kp", 1.0)
    rate = _number(given, "dampratio", 0.0) or -_number(given, "kv", 0.0)
    return Law((kp, 0.0, 0.0), (0.0, -kp, rate), lag)


def _general(given: Mapping[str, object]) -> Law | str:
    kinds = {name: str(given.get(name, known[0])) for name, known in _KINDS.items()}
    for name, value in kinds.items():
        if value not in _KINDS[name]:
            return f"has the {name} '{value}'"
    state, gain, bias = kinds.values()
    lag = 0.0 if state == "integrator" else None if state == "none" else max(_LEAST, _number(given, "dynprm", 1.0))
    gains, biases = _affine(given, "gainprm", 1.0), _affine(given, "biasprm", 0.0)
    return Law(gains if gain == "affine" else (gains[0], 0.0, 0.0), biases if bias == "affine" else NOTHING, lag)


def damped(law: Law, mass: float) -> Law:
    """The law with its damping ratio at the mass (kg or kg m^2) that it moves as a bias of the rate."""
    rate = -2.0 * law.damping_ratio * math.sqrt(law.gain[0] * mass)
    return law._replace(bias=(*law.bias[:2], rate))


def _affine(given: Mapping[str, object], name: str, usual: float) -> Affine:
    found = _numbers(given, name) or (usual,)
    return (*found, 0.0, 0.0)[:3]  # type: ignore[return-value]


def _numbers(given: Mapping[str, object], name: str) -> tuple[float, ...]:
    value = given.get(name, ())
    return tuple(map(float, value)) if isinstance(value, tuple) else (float(value),)  # type: ignore[arg-type]


def _number(given: Mapping[str, object], name: str, default: float) -> float:
    return (*_numbers(given, name), default)[0]
