"""The units of HyMeKo text: their SI values, their dimensions, and which of them a field takes."""

from __future__ import annotations

import math
import re
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_LENGTH = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "um": 1e-6, "µm": 1e-6, "in": 0.0254, "ft": 0.3048}
_ANGLE = {"rad": 1.0, "deg": math.pi / 180.0, "°": math.pi / 180.0, "rev": 2.0 * math.pi, "mrad": 1e-3}
_MASSES = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237}
_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0, "h": 3600.0}
_FORCE = {"N": 1.0, "kN": 1e3, "mN": 1e-3}
_OTHER = {"Hz": 1.0, "kHz": 1e3, "rpm": 2.0 * math.pi / 60.0, "Nm": 1.0, "Nmm": 1e-3, "Pa": 1.0, "kPa": 1e3, "MPa": 1e6}
_OTHER |= {"W": 1.0, "V": 1.0, "A": 1.0, "%": 1e-2}

BASE_UNITS: Mapping[str, Mapping[str, float]] = MappingProxyType({"length": _LENGTH, "angle": _ANGLE, "mass": _MASSES, "time": _TIME})
"""The dimensions that a `units { }` block may set, and their units."""

MOST_DIGITS = 16
"""Doubles have hardly more decimal digits."""

_FACTORS = {**_LENGTH, **_ANGLE, **_MASSES, **_TIME, **_FORCE, **_OTHER}


def unit_factor(unit: str) -> float | None:
    """The SI value of one ``unit`` (``deg``, ``rad/s``, ``kg*m^2``, ``Nm``), or None when it is not known."""
    if unit in _FACTORS:
        return _FACTORS[unit]
    factor = 1.0
    for name, power in _factors(unit):
        if name not in _FACTORS or power is None:
            return None
        factor *= _FACTORS[name] ** power
    return factor


def rounded(number: float, digits: int) -> float:
    """A number with so many decimal digits, as `units { digits 12 }` asks of angles; 0 leaves it as it is."""
    return float(f"{number:.{digits}g}") if digits else number


def _factors(unit: str) -> Iterator[tuple[str, int | None]]:
    """The units of a product with their powers, which are negative behind a ``/``; None for a power that is no number."""
    sign = 1
    for part in unit.replace("/", " / ").replace("*", " ").replace("·", " ").replace("-", " ").split():
        if part == "/":
            sign = -1
            continue
        name, _, power = part.partition("^")
        yield name, sign * int(power or "1") if power.isdecimal() or not power else None
        sign = 1


_EXPONENTS: Mapping[str, tuple[int, int, int, int]] = MappingProxyType(
    {
        **dict.fromkeys(_LENGTH, (1, 0, 0, 0)),
        **dict.fromkeys(_MASSES, (0, 1, 0, 0)),
        **dict.fromkeys(_TIME, (0, 0, 1, 0)),
        **dict.fromkeys(_ANGLE, (0, 0, 0, 1)),
        **dict.fromkeys(_FORCE, (1, 1, -2, 0)),
        **dict.fromkeys(("Nm", "Nmm"), (2, 1, -2, 0)),
        **dict.fromkeys(("Hz", "kHz"), (0, 0, -1, 0)),
        "rpm": (0, 0, -1, 1),
    }
)
"""The exponents of length, mass, time and angle in the mechanical units."""


def unit_exponents(unit: str) -> tuple[int, int, int, int] | None:
    """The exponents of length, mass, time and angle in a unit: (0, 1, -2, 0) for ``N/m``. None where it is not mechanical."""
    total = [0, 0, 0, 0]
    for name, power in _factors(unit):
        if name not in _EXPONENTS or power is None:
            return None
        total = [old + power * new for old, new in zip(total, _EXPONENTS[name], strict=True)]
    length, mass, time, angle = total
    return (length, mass, time, angle)


def unit_dimension(unit: str) -> str:
    """The dimension of the first factor of a unit (``rad/s``: angle), or nothing when that is none of the base dimensions."""
    first = re.split(r"[/*·^-]", unit, maxsplit=1)[0]
    return next((dimension for dimension, units in BASE_UNITS.items() if first in units), "")


_DERIVED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "effort": ("N", "Nm"),
        "friction": ("N", "Nm"),
        "damping": ("N*s/m", "Nm*s/rad"),
        "stiffness": ("N/m", "Nm/rad"),
        "armature": ("kg", "kg*m^2"),
        "density": ("kg/m^3",),
    }
)
"""Units of the dimensions that are products; those for motions along a line and about an axis."""
_PLACES = {"length": 0, "mass": 1, "time": 2, "angle": 3}


def fitting_units(dimension: str) -> tuple[str, ...]:
    """Units that a field of this dimension takes, for a hint."""
    return _DERIVED.get(dimension) or tuple(list(BASE_UNITS[dimension])[:4])


def fits(unit: str, dimension: str) -> bool:
    """Whether a field of this dimension takes the unit: lengths and angles also per time, a mass also as that of a rotation."""
    exponents = unit_exponents(unit)
    if exponents is None or not dimension:
        return not dimension
    if dimension in _DERIVED:
        return any(exponents[:3] == (unit_exponents(known) or ())[:3] for known in _DERIVED[dimension])
    length, mass, time, angle = exponents
    others = {"length": (mass, angle), "mass": (time, angle), "time": (length, mass, angle), "angle": (length, mass)}[dimension]
    return exponents[_PLACES[dimension]] > 0 and not any(others)
