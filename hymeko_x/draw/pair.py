"""Two robots by the same camera in the same scene, and where their pictures differ."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.draw.render import open_studio

if TYPE_CHECKING:
    from hymeko_x.draw.files import Picture
    from hymeko_x.draw.render import PictureOptions
    from hymeko_x.ir.holder import Holder

_ROUNDING = 4
"""By so much of 255 a colour may differ in two pictures of the same: edges and shades, of which one was computed from rounded numbers."""
_CHANGED = (214, 39, 40)
_GREY = 0.45
"""How much of the first picture is left behind the changes; the rest is white."""


class Subject(NamedTuple):
    """A robot to draw, and its file where MuJoCo reads that itself, as :func:`hymeko_x.draw.render.open_studio` takes them."""

    robot: Holder
    path: str | None


class PicturePair(Struct, frozen=True, eq=False):
    """Two pictures, the places in which they differ, red on the faded first one, and their part of all pixels."""

    before: Picture
    after: Picture
    difference: Picture
    changed: float


def pair(a: Subject, b: Subject, wanted: PictureOptions) -> PicturePair:
    """The first robot in the pose in which its file places the bodies, the second one with its joints there; light, ground and camera are
    those that fit the first one.

    Raises: Refusal as :class:`hymeko_x.draw.render.Studio`.
    """
    wanted = replace(wanted, is_authored=True)
    studio = open_studio(a.robot, a.path, wanted)
    return compared(studio.still(), open_studio(b.robot, b.path, wanted, studio).still())


def compared(before: Picture, after: Picture) -> PicturePair:
    """Two pictures of one size, and where they differ by more than rounding."""
    is_changed = np.abs(before.astype(np.int16) - after).max(axis=2) > _ROUNDING
    grey = before.mean(axis=2, keepdims=True).repeat(3, axis=2)
    faded = (255.0 - _GREY * (255.0 - grey)).astype(np.uint8)
    return PicturePair(before, after, np.where(is_changed[..., None], np.array(_CHANGED, np.uint8), faded), float(is_changed.mean()))
