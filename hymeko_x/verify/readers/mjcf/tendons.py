"""The tendons of an mjModel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from hymeko_x.verify.model import CYLINDER, JOINT, PULLEY, RELAXED, SIDE, SITE, SPHERE, SpringRange, Step, Tendon, point_of
from hymeko_x.verify.spatial import rotation_from_quat

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.verify.model import Array

_WRAP = mujoco.mjtWrap
_SAME_LENGTH = 1e-9  # relative: the accuracy of computed lengths
_MECHANICS = ("stiffness", "damping", "frictionloss", "armature")
_CURVES = ("stiffnesspoly", "dampingpoly", "springyield")


def read_tendons(compiled: Any, dofs: Mapping[int, int]) -> Iterator[Tendon]:
    """Every tendon's path, mechanics and bounds. ``dofs`` are the dofs of the model by joint."""
    rest = _lengths_at_rest(compiled)
    for tendon in range(compiled.ntendon):
        first, count = int(compiled.tendon_adr[tendon]), int(compiled.tendon_num[tendon])
        curves = tuple(float(x) for name in _CURVES for x in np.ravel(getattr(compiled, f"tendon_{name}")[tendon]))
        stiffness, damping, friction, armature = (float(getattr(compiled, f"tendon_{name}")[tendon]) for name in _MECHANICS)
        yield Tendon(
            compiled.tendon(tendon).name or None,
            tuple(step for wrap in range(first, first + count) for step in _steps(compiled, wrap, dofs)),
            (stiffness, damping, friction, armature),
            _range(compiled.tendon_range[tendon]) if compiled.tendon_limited[tendon] else None,
            _range(compiled.tendon_actfrcrange[tendon]) if compiled.tendon_actfrclimited[tendon] else None,
            _spring(compiled, tendon, rest[tendon]) if stiffness or any(curves) else RELAXED,
            curves if any(curves) else (),
        )


def _range(bounds: Array) -> tuple[float, float]:
    return float(bounds[0]), float(bounds[1])


def _lengths_at_rest(compiled: Any) -> Array:
    """The lengths where all springs of joints are at rest, which are those of tendons without their own."""
    data = mujoco.MjData(compiled)
    data.qpos[:] = compiled.qpos_spring
    mujoco.mj_kinematics(compiled, data)
    mujoco.mj_comPos(compiled, data)
    mujoco.mj_tendon(compiled, data)
    return np.array(data.ten_length)


def _spring(compiled: Any, tendon: int, rest: float) -> SpringRange:
    low, high = _range(compiled.tendon_lengthspring[tendon])
    return SpringRange((low, high), at_rest=bool(max(abs(low - rest), abs(high - rest)) <= _SAME_LENGTH * max(1.0, abs(rest))))


def _steps(compiled: Any, wrap: int, dofs: Mapping[int, int]) -> Iterator[Step]:
    """One item of a path: a joint with its coefficient, a site, a pulley, or a shape with the site beside it."""
    kind, target = int(compiled.wrap_type[wrap]), int(compiled.wrap_objid[wrap])
    number = float(compiled.wrap_prm[wrap])
    if kind == int(_WRAP.mjWRAP_JOINT):
        yield Step(JOINT, dofs[target], number)
    elif kind == int(_WRAP.mjWRAP_SITE):
        yield _site(compiled, target, SITE)
    elif kind == int(_WRAP.mjWRAP_PULLEY):
        yield Step(PULLEY, number=number)
    else:
        yield _shape(compiled, target, is_sphere=kind == int(_WRAP.mjWRAP_SPHERE))
        if number >= 0:
            yield _site(compiled, int(number), SIDE)


def _site(compiled: Any, site: int, kind: str) -> Step:
    return Step(kind, int(compiled.site_bodyid[site]), point=point_of(compiled.site_pos[site]))


def _shape(compiled: Any, geom: int, *, is_sphere: bool) -> Step:
    axis = None if is_sphere else point_of(rotation_from_quat(compiled.geom_quat[geom])[:, 2])
    radius, centre = float(compiled.geom_size[geom][0]), point_of(compiled.geom_pos[geom])
    return Step(SPHERE if is_sphere else CYLINDER, int(compiled.geom_bodyid[geom]), radius, centre, axis)
