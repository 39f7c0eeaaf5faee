"""Where an element of a body stands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.ir.values import IDENTITY, Pose, compose

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id


class Spot(Struct, frozen=True):
    """The body of an element, the <frame> around it (its number, empty for none) with its pose in the body, and the childclass.

    ``stem``: the nearest name above, after which nameless bodies are called; so their names do not grow with depth.
    """

    body: Id
    stem: str
    frame: str = ""
    pose: Pose = IDENTITY
    childclass: str | None = None


def placed(pose: Pose, spot: Spot) -> Pose:
    """A pose, given in the frame around the element, seen from the body."""
    return compose(spot.pose, pose) if spot.frame else pose
