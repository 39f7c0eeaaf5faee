"""MjcActuator of MuJoCo's schema and the actuators of MJCF that it represents: names of attributes and of parameters."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.parts import Actuator, Parameters

    Numbers = tuple[float, ...]

PRIM = "MjcActuator"
LENGTH = 10
"""How many numbers the parameter vectors of the schema have."""

TOKENS: Mapping[str, str] = MappingProxyType(
    {
        "dyntype": "dynType",
        "gaintype": "gainType",
        "biastype": "biasType",
        "ctrllimited": "ctrlLimited",
        "forcelimited": "forceLimited",
        "actlimited": "actLimited",
    }
)
"""Parameters that are words, with their attributes."""
VECTORS: Mapping[str, str] = MappingProxyType({"dynprm": "dynPrm", "gainprm": "gainPrm", "biasprm": "biasPrm"})
RANGES: Mapping[str, str] = MappingProxyType(
    {"ctrlrange": "ctrlRange", "forcerange": "forceRange", "actrange": "actRange", "lengthrange": "lengthRange"}
)
"""Parameters that are two numbers, each with an attribute of its own below this one: ``min`` and ``max``."""
NUMBERS: Mapping[str, str] = MappingProxyType({"cranklength": "crankLength", "inheritrange": "inheritRange"})
INHERITED = "hymeko:drive:{}:inheritRange"
"""The attribute of a drive's joint for the one parameter of a position servo that follows from no other value, by the drive's instance."""
INTEGERS: Mapping[str, str] = MappingProxyType({"actdim": "actDim", "group": "group"})
DEFAULTS: Mapping[str, str] = MappingProxyType({"dyntype": "none", "gaintype": "fixed", "biastype": "none"})
"""The words of a plain motor."""

TARGET, SLIDER, REFERENCE = "mjc:target", "mjc:sliderSite", "mjc:refSite"
RELATIONSHIPS: Mapping[str, str] = MappingProxyType({"": TARGET, "crank": TARGET, "slider": SLIDER, "reference": REFERENCE})
"""The relationship for each role of a target of an actuator."""


# ---- actuators that MJCF has elements of their own for ---------------------------------------------------------------------------

_MUSCLE = MappingProxyType(
    {
        "force": (-1.0,),
        "scale": (200.0,),
        "lmin": (0.5,),
        "lmax": (1.6,),
        "vmax": (1.5,),
        "fpmax": (1.3,),
        "fvmax": (1.2,),
    }
)
_LAW = ("gaintype", "gainprm", "biastype", "biasprm", "dyntype", "dynprm")
_DETAILS = frozenset(("kp", "kv", "dampratio", "timeconst", "tausmooth", "range", *_MUSCLE))


def in_general(kind: str, parameters: Parameters) -> Parameters | None:
    """The parameters of an actuator of this kind as those of a general one; None for kinds that are not documented as such.

    Source: MuJoCo, user_api.cc, mjs_setToPosition and its siblings.
    """
    if kind in ("motor", "general"):
        return parameters
    numbers = {name: value if isinstance(value, tuple) else (value,) for name, value in parameters if not isinstance(value, str)}
    authored = _GENERAL.get(kind)
    if authored is None:
        return None
    return (*authored(numbers), *(item for item in parameters if item[0] not in _DETAILS))


def _servo(authored: Mapping[str, Numbers]) -> Parameters:
    """A position servo: kp (u - length) - kv velocity; a positive number in place of -kv is a damping ratio."""
    kp, lag = authored.get("kp", (1.0,))[0], authored.get("timeconst", (0.0,))[0]
    damping = -authored.get("kv", (0.0,))[0] or authored.get("dampratio", (0.0,))[0]
    filtered: Parameters = (("dyntype", "filterexact"), ("dynprm", (lag,))) if lag else ()
    return (*filtered, ("gainprm", (kp,)), ("biastype", "affine"), ("biasprm", (0.0, -kp, damping)))


def with_inherited_range(actuator: Actuator) -> Actuator:
    """A general actuator that takes its range from its target as the position servo that it is, which only such a servo does."""
    law = {name: value if isinstance(value, str | tuple) else (value,) for name, value in actuator.parameters}
    gain, bias = law.get("gainprm"), law.get("biasprm")
    if law.get("biastype") != "affine" or not law.get("inheritrange") or law.get("dyntype") not in (None, "filterexact"):
        return actuator
    if not isinstance(gain, tuple) or not isinstance(bias, tuple):
        return actuator
    damping = bias[2] if len(bias) > 2 else 0.0
    found: Parameters = (("kp", gain[0]), *([("kv", -damping)] if damping < 0.0 else [("dampratio", damping)] if damping else []))
    lag = law.get("dynprm")
    found += (("timeconst", lag[0]),) if isinstance(lag, tuple) and "dyntype" in law else ()
    servo = replace(actuator, kind="position", parameters=(*found, *(item for item in actuator.parameters if item[0] not in _LAW)))
    again = dict(in_general("position", found) or ())
    return servo if all(_trimmed(again.get(name)) == _trimmed(law.get(name)) for name in _LAW) else actuator


def _trimmed(value: object) -> object:
    """A value; of numbers without the zeros at the end."""
    while isinstance(value, tuple) and value and value[-1] == 0.0:
        value = value[:-1]
    return value


def _speed(authored: Mapping[str, Numbers]) -> Parameters:
    """A velocity servo: kv (u - velocity)."""
    kv = authored.get("kv", (1.0,))[0]
    return (("gainprm", (kv,)), ("biastype", "affine"), ("biasprm", (0.0, 0.0, -kv)))


def _muscle(authored: Mapping[str, Numbers]) -> Parameters:
    """A muscle; the same numbers describe its active and its passive force."""
    law = (*authored.get("range", (0.75, 1.05)), *(authored.get(name, usual)[0] for name, usual in _MUSCLE.items()))
    times = (*authored.get("timeconst", (0.01, 0.04)), *authored.get("tausmooth", (0.0,)))
    kinds = tuple((name, "muscle") for name in DEFAULTS)
    return (*kinds, ("dynprm", times), ("gainprm", law), ("biasprm", law))


_GENERAL: Mapping[str, Callable[[Mapping[str, Numbers]], Parameters]] = MappingProxyType(
    {"position": _servo, "velocity": _speed, "muscle": _muscle}
)
