"""Equality constraints and actuators of an mjModel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from numpy.polynomial import Polynomial

from hymeko_x.verify.model import Coupling, Loop, Record
from hymeko_x.verify.spatial import pose

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.verify.model import Array

_EQ, _OBJ, _TRN = mujoco.mjtEq, mujoco.mjtObj, mujoco.mjtTrn
_SCALAR = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))


def _equalities(compiled: Any, *kinds: Any) -> Iterator[int]:
    """The active equality constraints of these kinds."""
    wanted = {int(kind) for kind in kinds}
    return (i for i in range(compiled.neq) if int(compiled.eq_type[i]) in wanted and compiled.eq_active0[i])


# ---- couplings -------------------------------------------------------------------------------------------------------


def read_couplings(compiled: Any, dofs: Mapping[int, int]) -> Iterator[Coupling]:
    """Joint equalities as polynomials in absolute coordinates.

    MuJoCo's are relative to the initial configuration: q1 - q1_0 = poly(q2 - q2_0). Source: MuJoCo XML reference, equality/joint.
    """
    for i in _equalities(compiled, _EQ.mjEQ_JOINT):
        first, second = int(compiled.eq_obj1id[i]), int(compiled.eq_obj2id[i])
        if int(compiled.jnt_type[first]) not in _SCALAR:
            continue
        name = compiled.equality(i).name or None
        start = float(compiled.qpos0[compiled.jnt_qposadr[first]])
        relative = Polynomial([float(x) for x in compiled.eq_data[i][:5]])
        if second < 0:
            yield Coupling(dofs[first], start + float(relative.coef[0]), (), name)
            continue
        zero = float(compiled.qpos0[compiled.jnt_qposadr[second]])
        absolute = [float(x) for x in relative(Polynomial([-zero, 1.0])).coef]
        yield Coupling(dofs[first], start + absolute[0], ((dofs[second], _trimmed(absolute[1:])),), name)


def _trimmed(coefficients: list[float]) -> tuple[float, ...]:
    """Without zeros at the end, but never empty."""
    while len(coefficients) > 1 and coefficients[-1] == 0.0:
        coefficients = coefficients[:-1]
    return tuple(coefficients)


# ---- loops -----------------------------------------------------------------------------------------------------------


def read_loops(compiled: Any) -> Iterator[Loop]:
    """Connects and welds, between bodies or sites."""
    for i in _equalities(compiled, _EQ.mjEQ_CONNECT, _EQ.mjEQ_WELD):
        connect = int(compiled.eq_type[i]) == int(_EQ.mjEQ_CONNECT)
        name = compiled.equality(i).name or None
        a, b = int(compiled.eq_obj1id[i]), int(compiled.eq_obj2id[i])
        if int(compiled.eq_objtype[i]) == int(_OBJ.mjOBJ_SITE):
            (body_a, pose_a), (body_b, pose_b) = _site(compiled, a), _site(compiled, b)
        else:
            body_a, body_b = a, b
            pose_a, pose_b = _anchors(compiled.eq_data[i], connect=connect)
        yield Loop("connect" if connect else "weld", body_a, pose_a, body_b, pose_b, name)


def _site(compiled: Any, site: int) -> tuple[int, Array]:
    return int(compiled.site_bodyid[site]), pose(compiled.site_pos[site], compiled.site_quat[site])


def _anchors(data: Array, *, connect: bool) -> tuple[Array, Array]:
    """The closure's frame in both bodies.

    A connect has its point in body 1 and in body 2; a weld its anchor in body 2, and the pose in body 1 that it meets.
    Source: MuJoCo engine_core_constraint.c.
    """
    straight = np.array([1.0, 0.0, 0.0, 0.0])
    if connect:
        return pose(data[0:3], straight), pose(data[3:6], straight)
    return pose(data[3:6], data[6:10]), pose(data[0:3], straight)


# ---- tendons and actuators -------------------------------------------------------------------------------------------


def read_tied_tendons(compiled: Any) -> Iterator[Record]:
    """The equalities between tendons."""
    for i in _equalities(compiled, _EQ.mjEQ_TENDON):
        ends = [compiled.tendon(int(t)).name if t >= 0 else "" for t in (compiled.eq_obj1id[i], compiled.eq_obj2id[i])]
        yield Record(compiled.equality(i).name or None, ("equality", *ends), tuple(float(x) for x in compiled.eq_data[i][:5]))


def read_actuators(compiled: Any) -> Iterator[Record]:
    """The target, law and numbers of each actuator; ranges that do not limit count as zero."""
    for i in range(compiled.nactuator):
        words = (
            _TRN(int(compiled.actuator_trntype[i])).name.removeprefix("mjTRN_").lower(),
            _target(compiled, i),
            mujoco.mjtGain(int(compiled.actuator_gaintype[i])).name.removeprefix("mjGAIN_").lower(),
            mujoco.mjtBias(int(compiled.actuator_biastype[i])).name.removeprefix("mjBIAS_").lower(),
            mujoco.mjtDyn(int(compiled.actuator_dyntype[i])).name.removeprefix("mjDYN_").lower(),
        )
        yield Record(compiled.actuator(i).name or None, words, _actuator_numbers(compiled, i))


_ELEMENTS = {
    "jointactfrc": "jointactuatorfrc",
    "tendonactfrc": "tendonactuatorfrc",
    "geomdist": "distance",
    "geomnormal": "normal",
    "geomfromto": "fromto",
}
"""The elements of <sensor> that mjtSensor calls otherwise."""


def _kind(sensor: Any) -> str:
    """A kind of sensor by the name of its element in MJCF."""
    name = str(sensor.name).removeprefix("mjSENS_").lower()
    return _ELEMENTS.get(name, name)


SENSOR_KINDS = frozenset(map(_kind, mujoco.mjtSensor.__members__.values()))
"""The kinds of sensors that MJCF has."""


def read_sensors(compiled: Any) -> Iterator[Record]:
    """What each sensor measures, of what, and where it cuts its values off."""
    for i in range(compiled.nsensor):
        kind = _kind(mujoco.mjtSensor(int(compiled.sensor_type[i])))
        objects = zip(
            (compiled.sensor_objtype[i], compiled.sensor_reftype[i]), (compiled.sensor_objid[i], compiled.sensor_refid[i]), strict=True
        )
        names = (mujoco.mj_id2name(compiled, int(type_), int(id_)) or "" if id_ >= 0 else "" for type_, id_ in objects)
        yield Record(compiled.sensor(i).name or None, (kind, *names), (float(compiled.sensor_cutoff[i]),))


def _target(compiled: Any, actuator: int) -> str:
    kind, target = int(compiled.actuator_trntype[actuator]), int(compiled.actuator_trnid[actuator][0])
    if kind in (int(_TRN.mjTRN_JOINT), int(_TRN.mjTRN_JOINTINPARENT)):
        return str(compiled.joint(target).name)
    if kind == int(_TRN.mjTRN_TENDON):
        return str(compiled.tendon(target).name)
    if kind == int(_TRN.mjTRN_BODY):
        return str(compiled.body(target).name)
    if kind in (int(_TRN.mjTRN_SITE), int(_TRN.mjTRN_SLIDERCRANK)):
        return str(compiled.site(target).name)
    return ""


def _actuator_numbers(compiled: Any, i: int) -> tuple[float, ...]:
    """The numbers of an actuator, with those of each of its controls and outputs: an orientation has several."""
    controls = slice(first := int(compiled.actuator_ctrladr[i]), first + int(compiled.actuator_ctrlnum[i]))
    outputs = slice(first := int(compiled.actuator_outadr[i]), first + int(compiled.actuator_outnum[i]))
    plain = [np.ravel(getattr(compiled, f"actuator_{name}")[i]) for name in ("gainprm", "biasprm", "dynprm", "cranklength")]
    ranges = [
        np.ravel(getattr(compiled, f"actuator_{name}range")[rows] * getattr(compiled, f"actuator_{name}limited")[rows, None].astype(bool))
        for name, rows in (("ctrl", controls), ("force", slice(i, i + 1)), ("act", slice(i, i + 1)))
    ]
    return tuple(float(x) for x in np.concatenate([np.ravel(compiled.actuator_gear[outputs]), *plain, *ranges]))
