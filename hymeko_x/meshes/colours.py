"""Names of colours, for materials that no author named."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import Rgba

_COLOURS: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {
        "black": (0.0, 0.0, 0.0),
        "dark_grey": (0.25, 0.25, 0.25),
        "grey": (0.5, 0.5, 0.5),
        "light_grey": (0.75, 0.75, 0.75),
        "off_white": (0.9, 0.9, 0.9),
        "white": (1.0, 1.0, 1.0),
        "red": (1.0, 0.0, 0.0),
        "dark_red": (0.5, 0.0, 0.0),
        "pink": (1.0, 0.6, 0.7),
        "orange": (1.0, 0.5, 0.0),
        "brown": (0.5, 0.3, 0.1),
        "yellow": (1.0, 1.0, 0.0),
        "beige": (0.9, 0.8, 0.6),
        "green": (0.0, 1.0, 0.0),
        "dark_green": (0.0, 0.4, 0.0),
        "light_green": (0.6, 1.0, 0.6),
        "cyan": (0.0, 1.0, 1.0),
        "blue": (0.0, 0.0, 1.0),
        "dark_blue": (0.0, 0.0, 0.5),
        "light_blue": (0.1, 0.6, 0.9),
        "magenta": (1.0, 0.0, 1.0),
        "purple": (0.5, 0.0, 0.5),
    }
)


def name_of_colour(rgba: Rgba) -> str:
    """The name of the colour that is next to this one, whatever its opacity: ``dark_grey``."""
    return min(_COLOURS, key=lambda name: sum((a - b) ** 2 for a, b in zip(_COLOURS[name], rgba, strict=False)))
