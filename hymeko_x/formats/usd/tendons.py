"""MjcTendon of MuJoCo's schema: its path, and the attributes of a tendon."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

PRIM = "MjcTendon"
KIND = "mjc:type"
"""The kind of tendon, spatial by default."""

PATH = "mjc:path"
"""What the path leads through, each prim once."""
INDICES = "mjc:path:indices"
"""Which of these prims each step is."""
COEFFICIENTS = "mjc:path:coef"
"""The coefficient of each joint of a fixed tendon."""
SEGMENTS = "mjc:path:segments"
"""In which part of the path each step is, of those that pulleys divide it into."""
DIVISORS = "mjc:path:divisors"
"""The divisor of the length of each part."""
SIDES = "mjc:sideSites"
SIDE_INDICES = "mjc:sideSites:indices"
"""Which of the sites beside shapes belongs to each step, -1 for none."""
NO_SIDE = -1

LIMITED = "mjc:limited"
RANGE = ("mjc:range:min", "mjc:range:max")
NUMBERS: Mapping[str, str] = MappingProxyType(
    {
        "stiffness": "mjc:stiffness",
        "damping": "mjc:damping",
        "friction": "mjc:frictionloss",
        "armature": "mjc:armature",
    }
)
"""Numbers of a tendon that are 0 by default, with their attributes."""
WIDTH, COLOUR = "mjc:width", "mjc:rgba"

VECTORS: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "solreflimit": (0.02, 1.0),
        "solimplimit": (0.9, 0.95, 0.001, 0.5, 2.0),
        "solreffriction": (0.02, 1.0),
        "solimpfriction": (0.9, 0.95, 0.001, 0.5, 2.0),
    }
)
"""Parameters of several numbers, with the defaults of the schema; the last ones may be left out."""
SPRING, MARGIN, GROUP = "springlength", "margin", "group"
FORCE_RANGE, FORCE_LIMITED = "actuatorfrcrange", "actuatorfrclimited"


def attribute(parameter: str) -> str:
    """The attribute of a parameter that has the same name in MJCF."""
    return f"mjc:{parameter}"
