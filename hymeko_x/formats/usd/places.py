"""Where the prims of bodies stand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.usd import POSE
from hymeko_x.ir.parts import Body

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.values import Pose


def places(mechanism: Mechanism) -> dict[Id, Pose]:
    """The poses on the stage of the bodies that do not stand where their joints put them."""
    return {key: pose for key, _ in mechanism.vertices(Body) if (pose := mechanism.notation(key, POSE)) is not None}
