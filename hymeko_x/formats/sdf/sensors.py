"""The words of sensors, cameras and lights."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.formats.sdf.values import NUMBER, ValueField

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.values import Quat, Vec3

CAMERA_TURN: Quat = (0.5, 0.5, -0.5, -0.5)
"""A camera of SDF looks along x with z up; one of the IR along -z with y up."""
DOWN: Vec3 = (0.0, 0.0, -1.0)
"""Where a light shines in its own frame."""
HFOV = ValueField("horizontal_fov", "horizontal_fov", NUMBER, 1.047)
IMAGE = (ValueField("image/width", "width", NUMBER, 320.0), ValueField("image/height", "height", NUMBER, 240.0))
LIGHTS: Mapping[str, str] = MappingProxyType({"point": "point", "spot": "spot", "directional": "directional"})
"""The kind of a light by its type; the same words."""
LEAST_FOV = 0.1 + 1e-9
"""The least horizontal field of view in rad that libsdformat accepts, with room for rounding."""
