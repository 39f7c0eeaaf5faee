"""MjcActuator of MuJoCo's schema and the actuators of MJCF that it says: names of attributes and of parameters, in one table."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

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
"""Parameters that are words, with the attributes that say them."""
VECTORS: Mapping[str, str] = MappingProxyType({"dynprm": "dynPrm", "gainprm": "gainPrm", "biasprm": "biasPrm"})
RANGES: Mapping[str, str] = MappingProxyType(
    {"ctrlrange": "ctrlRange", "forcerange": "forceRange", "actrange": "actRange", "lengthrange": "lengthRange"}
)
"""Parameters that are two numbers, each with an attribute of its own below this one: ``min`` and ``max``."""
NUMBERS: Mapping[str, str] = MappingProxyType({"cranklength": "crankLength", "inheritrange": "inheritRange"})
INTEGERS: Mapping[str, str] = MappingProxyType({"actdim": "actDim", "group": "group"})
DEFAULTS: Mapping[str, str] = MappingProxyType({"dyntype": "none", "gaintype": "fixed", "biastype": "none"})
"""What the words are for a plain motor."""

TARGET, SLIDER, REFERENCE = "mjc:target", "mjc:sliderSite", "mjc:refSite"
RELATIONSHIPS: Mapping[str, str] = MappingProxyType({"": TARGET, "crank": TARGET, "slider": SLIDER, "reference": REFERENCE})
"""The relationship for each role of what an actuator acts on."""
