"""What MuJoCo computes of a model that is about to be written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import MJCF, loaded
from hymeko_x.ir.mechanism import WORLD, Id

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Context

_MARGIN = 0.001
"""Shapes nearer than this, in m, touch: gravity moves joints a little."""


def touching(mechanism: Mechanism, context: Context) -> list[tuple[Id, Id]]:
    """The pairs of bodies of which shapes touch at the first keyframe, where MuJoCo lets them collide, in the order of their names."""
    model = _compiled(mechanism, context)
    if model is None:
        return []
    import mujoco

    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    model.geom_margin[:] = _MARGIN
    mujoco.mj_forward(model, data)
    bodies = {model.body(number).name: number for number in range(model.nbody)}
    names = {number: WORLD if number == 0 else Id("body", name) for name, number in bodies.items()}
    pairs = {tuple(sorted(int(model.geom_bodyid[geom]) for geom in contact.geom)) for contact in data.contact}
    found = [(names[a], names[b]) for a, b in sorted(pairs)]
    return [pair for pair in found if all(body in mechanism.graph for body in pair)]


def _compiled(mechanism: Mechanism, context: Context):  # type: ignore[no-untyped-def]
    """The mjModel, or None where MuJoCo refuses it: a mesh may be missing, which is reported by itself."""
    package = context.write(mechanism)
    contents = {**package.files, **{name: context.files.read(path) for name, path in package.copies.items()}}
    try:
        return loaded(MJCF.memory["mujoco"])(package.main, contents)
    except ValueError as error:
        reason = " ".join(str(error).split())
        message = f"{context.reason}: MuJoCo refuses the model, so that nothing tells which bodies touch at home: {reason}"
        context.report.warn(codes.ENGINE_REFUSED, message)
        return None
