"""Units of the language: the SI values of a suffix or of a `units { }` block."""

from __future__ import annotations

import math
import re
from types import MappingProxyType

_LENGTH = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "um": 1e-6, "µm": 1e-6, "in": 0.0254, "ft": 0.3048}
_ANGLE = {"rad": 1.0, "deg": math.pi / 180.0, "°": math.pi / 180.0, "rev": 2.0 * math.pi, "mrad": 1e-3}
_MASS = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237}
_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0, "h": 3600.0}
_FORCE = {"N": 1.0, "kN": 1e3, "mN": 1e-3}
_OTHER = {
    "Hz": 1.0,
    "kHz": 1e3,
    "rpm": 2.0 * math.pi / 60.0,
    "Nm": 1.0,
    "Nmm": 1e-3,
    "Pa": 1.0,
    "kPa": 1e3,
    "MPa": 1e6,
    "W": 1.0,
    "V": 1.0,
    "A": 1.0,
    "%": 1e-2,
}

BASE_UNITS = MappingProxyType(
    {
        "length": MappingProxyType(_LENGTH),
        "angle": MappingProxyType(_ANGLE),
        "mass": MappingProxyType(_MASS),
        "time": MappingProxyType(_TIME),
    }
)
"""The dimensions that a `units { }` block may set, and their units."""

_FACTORS = {**_LENGTH, **_ANGLE, **_MASS, **_TIME, **_FORCE, **_OTHER}


def unit_factor(unit: str) -> float | None:
    """The SI value of one ``unit`` (``deg``, ``rad/s``, ``kg*m^2``, ``Nm``), or None when it is not known."""
    if unit in _FACTORS:
        return _FACTORS[unit]
    factor = 1.0
    sign = 1
    for part in unit.replace("/", " / ").replace("*", " ").replace("·", " ").replace("-", " ").split():
        if part == "/":
            sign = -1
            continue
        name, _, power = part.partition("^")
        if name not in _FACTORS or not (power.isdecimal() or not power):
            return None
        factor *= _FACTORS[name] ** (sign * int(power or "1"))
        sign = 1
    return factor


def unit_dimension(unit: str) -> str:
    """The dimension of the first factor of a unit (``rad/s``: angle), or nothing when that is none of the base dimensions."""
    first = re.split(r"[/*·^-]", unit, maxsplit=1)[0]
    return next((dimension for dimension, units in BASE_UNITS.items() if first in units), "")
