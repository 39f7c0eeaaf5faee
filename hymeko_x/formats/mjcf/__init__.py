"""The words of MJCF that its reader and its writer share. MuJoCo 4.0; data only."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.ir.parts import DofKind, Role

if TYPE_CHECKING:
    from collections.abc import Mapping

NAME = "mjcf"

RESIDUE = "hymeko-x residue"
"""How the names of the texts in <custom> begin that contain a residue, which means nothing to MuJoCo."""

DOFS: Mapping[DofKind, str] = MappingProxyType({DofKind.HINGE: "hinge", DofKind.SLIDE: "slide", DofKind.BALL: "ball", DofKind.FREE: "free"})
"""The joint type of each kind of dof; a screw has none."""

MAIN = "main"
"""The class of everything that has none."""

CLASSES: Mapping[Role, str] = MappingProxyType({Role.VISUAL: "visual", Role.COLLISION: "collision"})
"""The default class of a geom by what it is for; one that is for both has none."""

TARGETS: Mapping[str, str] = MappingProxyType({"joint": "joint", "tendon": "tendon", "frame": "site", "body": "body"})
"""The attribute of an actuator or sensor that names what it acts on, by the kind of the element's id."""

LIGHTS = ("spot", "directional", "point", "image")
"""The types of light; the first one is the default."""

MOST_STL_FACES = 200_000
"""MuJoCo refuses an STL file with more faces, while OBJ files may have any number."""
