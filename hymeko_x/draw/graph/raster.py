"""A picture of pixels from SVG of our own."""

from __future__ import annotations

import math
import re

import resvg_py

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

_SIZE = re.compile(r'<svg [^>]*width="([\d.]+)" height="([\d.]+)"')
_SHARP = 2.0
"""Pixels by unit of the SVG, as on the screens of today."""
_MOST_PIXELS = 40_000_000


def png(svg: str) -> bytes:
    """The picture as PNG, light, at two pixels a unit, or fewer where it would be very large.

    Raises: Refusal HX502 when it cannot be drawn.
    """
    found = _SIZE.match(svg)
    assert found is not None, "our pictures begin with their size"
    width, height = float(found[1]), float(found[2])
    zoom = min(_SHARP, math.sqrt(_MOST_PIXELS / (width * height)))
    try:
        return bytes(resvg_py.svg_to_bytes(svg_string=svg, zoom=zoom, monospace_family="DejaVu Sans Mono"))
    except ValueError as error:
        raise refuse(codes.CANNOT_DRAW, f"the picture cannot be made: {error}", hint="-o OUT.svg needs no other library") from error
