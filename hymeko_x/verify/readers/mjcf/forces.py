"""What the actuators of an mjModel can exert on its joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from hymeko_x.verify.model import INF

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_TRN, _DYN = mujoco.mjtTrn, mujoco.mjtDyn
_OF_JOINTS = (int(_TRN.mjTRN_JOINT), int(_TRN.mjTRN_JOINTINPARENT))
_FOLLOWING = (int(_DYN.mjDYN_NONE), int(_DYN.mjDYN_FILTER), int(_DYN.mjDYN_FILTEREXACT))
"""The dynamics by which an activation comes to be the control."""


def driven_joints(compiled: Any) -> Mapping[int, float]:
    """The largest force in N or Nm that the actuators of each hinge and slide can exert on it together; infinite if nothing bounds it.

    Source: MuJoCo, engine_forward.c, mj_fwdActuation: the sum over actuators of moment times force, which the force range clamps.
    """
    spans: dict[int, tuple[float, float]] = {}
    for actuator in range(compiled.nactuator):
        low, high = _span(compiled, actuator)
        for joint, moment in _moments(compiled, actuator):
            ends = sorted((low * moment, high * moment)) if moment else (0.0, 0.0)
            first, second = spans.get(joint, (0.0, 0.0))
            spans[joint] = (first + ends[0], second + ends[1])
    return {joint: max(-low, high) or INF for joint, (low, high) in spans.items()}


def _span(compiled: Any, actuator: int) -> tuple[float, float]:
    """The least and the greatest force of an actuator: by its force range, and of a motor by its control range."""
    low, high = compiled.actuator_forcerange[actuator] if compiled.actuator_forcelimited[actuator] else (-INF, INF)
    control = int(compiled.actuator_ctrladr[actuator])
    is_motor = (
        int(compiled.actuator_gaintype[actuator]) == int(mujoco.mjtGain.mjGAIN_FIXED)
        and int(compiled.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_NONE)
        and int(compiled.actuator_dyntype[actuator]) in _FOLLOWING
    )
    if is_motor and compiled.actuator_ctrllimited[control]:
        ends = np.sort(compiled.actuator_gainprm[actuator][0] * compiled.actuator_ctrlrange[control])
        low, high = max(low, ends[0]), min(high, ends[1])
    return float(low), float(high)


def _moments(compiled: Any, actuator: int) -> Iterator[tuple[int, float]]:
    """The joints that an actuator acts on, directly or by a combination of joints, with its constant moment on each."""
    kind, target = int(compiled.actuator_trntype[actuator]), int(compiled.actuator_trnid[actuator][0])
    gear = float(compiled.actuator_gear[int(compiled.actuator_outadr[actuator])][0])
    if kind in _OF_JOINTS:
        yield target, gear
    elif kind == int(_TRN.mjTRN_TENDON):
        first, count = int(compiled.tendon_adr[target]), int(compiled.tendon_num[target])
        for wrap in range(first, first + count):
            if int(compiled.wrap_type[wrap]) == int(mujoco.mjtWrap.mjWRAP_JOINT):
                yield int(compiled.wrap_objid[wrap]), gear * float(compiled.wrap_prm[wrap])
