"""The ids of elements, and their kinds."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir import lumped, parts

if TYPE_CHECKING:
    from collections.abc import Mapping


class Id(NamedTuple):
    """The key of an element: its kind (``body``, ``joint``, ``shape``, ...) and a name unique among its kind."""

    kind: str
    name: str

    def __str__(self) -> str:
        return f"{self.kind} '{self.name}'"


WORLD = Id("world", "world")
WORLD_LINK = Id("body", "world")
"""The link that represents the world in formats without one."""
ROOT = Id("mechanism", "")
"""The key under which side tables keep what belongs to the mechanism as a whole."""

KINDS: Mapping[type, str] = MappingProxyType(
    {
        parts.Body: "body",
        parts.World: "world",
        parts.Frame: "frame",
        parts.Material: "material",
        parts.Texture: "texture",
        parts.Mesh: "mesh",
        parts.Actuator: "actuator",
        parts.Sensor: "sensor",
        parts.Camera: "camera",
        parts.Light: "light",
        parts.PoseSet: "pose",
        lumped.Spring: "spring",
        lumped.Damper: "damper",
        lumped.Mass: "mass",
        lumped.Port: "port",
        parts.Datum: "datum",
        parts.Shape: "shape",
        parts.Mount: "mount",
        parts.Layer: "layer",
        parts.Subset: "subset",
        parts.Joint: "joint",
        parts.Coupling: "coupling",
        parts.Loop: "loop",
        parts.Tendon: "tendon",
        parts.Drive: "drive",
        parts.Sense: "sense",
        parts.Stance: "stance",
        parts.Contact: "contact",
        lumped.Constitutive: "constitutive",
        parts.Relation: "relation",
        parts.Nest: "nest",
    }
)
"""The kind of every part: an element's id has the kind of its part."""
LUMPED_KINDS = frozenset({"spring", "damper", "mass", "port", "datum"})
"""The kinds of vertices of graphs and of lumped systems, which are no robots."""
