"""What MuJoCo computes of a model that is about to be written."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.formats import MJCF, loaded
from hymeko_x.ir.mechanism import WORLD, Id

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.ir.values import Vec3
    from hymeko_x.rewrite.context import Context
    from hymeko_x.source import Files, Package

_MARGIN = 0.001
"""Shapes nearer than this, in m, touch: gravity moves joints a little."""


def touching(mechanism: Mechanism, context: Context) -> list[tuple[Id, Id]]:
    """The pairs of bodies of which shapes touch at the first keyframe, where MuJoCo lets them collide, in their order."""
    try:
        model = compiled(context.write(mechanism), context.files)
    except ValueError as error:
        reason = " ".join(str(error).split())
        message = f"{context.reason}: MuJoCo refuses the model, so that nothing tells which bodies touch at home: {reason}"
        context.report.warn(codes.ENGINE_REFUSED, message)
        return []
    model.geom_margin[:] = _MARGIN
    data = _at_home(model)
    names = {number: Id("body", model.body(number).name) if number else WORLD for number in range(model.nbody)}
    pairs = {tuple(sorted(int(model.geom_bodyid[geom]) for geom in contact.geom)) for contact in data.contact}
    found = [(names[a], names[b]) for a, b in sorted(pairs)]
    return [pair for pair in found if all(body in mechanism.graph for body in pair)]


def compiled(package: Package, files: Files) -> Any:
    """The mjModel of a package. Raises: ValueError where MuJoCo refuses it."""
    return loaded(MJCF.memory["mujoco"])(package.main, package.contents(files))


def extent(model: Any) -> tuple[float, Vec3, float]:
    """The lowest point of what collides at the first keyframe, the centre of the model, and its size, in m, to the centimetre."""
    import numpy as np

    data = _at_home(model)
    boxes = model.geom_aabb.reshape(-1, 2, 3)
    matrices = data.geom_xmat.reshape(-1, 3, 3)
    centres = data.geom_xpos + np.einsum("nij,nj->ni", matrices, boxes[:, 0])
    halves = np.einsum("nij,nj->ni", np.abs(matrices), boxes[:, 1])
    solid = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    lowest = float((centres - halves)[solid, 2].min()) if solid.any() else 0.0
    x, y, z = (round(float(value), 2) + 0.0 for value in model.stat.center)
    return math.floor(lowest * 100.0) / 100.0, (x, y, z), max(round(float(model.stat.extent), 2), 0.01)


def _at_home(model: Any) -> Any:
    import mujoco

    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return data
