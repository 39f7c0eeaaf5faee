"""The words of <material>: which elements of <pbr><metal> hold which number and which texture."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

AMBIENT = "material/ambient"
"""The path of the colour without light, which is a notation where it is the diffuse one."""
NUMBERS: Mapping[str, str] = MappingProxyType({"roughness": "roughness", "metalness": "metallic"})
MAPS: Mapping[str, str] = MappingProxyType(
    {
        "albedo_map": "rgb",
        "roughness_map": "roughness",
        "metalness_map": "metallic",
        "normal_map": "normal",
        "ambient_occlusion_map": "occlusion",
        "emissive_map": "emissive",
    }
)
"""The use of each texture, as a layer has it."""
