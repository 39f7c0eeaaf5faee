"""newton: what its ModelBuilder makes of a file in ``source`` (URDF, MJCF or USD): bodies, and joints by their dofs."""

from __future__ import annotations

import math
from typing import Any

import newton
import numpy as np
import warp
from loop import answer_all
from newton import JointTargetMode, JointType
from newton.solvers import SolverMuJoCo
from newton.usd import SchemaResolverMjc, SchemaResolverNewton

warp.config.quiet = True
_NO_LIMIT = 1e6
_PULLEY = 2.0


def describe(job: dict[str, Any]) -> dict[str, Any]:
    """Masses and centres of bodies; type, ends, frames, axes and limits of joints. Names are the last step of a label.

    With ``tendons`` in the job also what tendons lead through.
    """
    builder = newton.ModelBuilder()
    if job.get("tendons"):
        SolverMuJoCo.register_custom_attributes(builder)
    source = job["source"]
    if source.endswith(".urdf"):
        builder.add_urdf(source, floating=True, collapse_fixed_joints=False, parse_visuals_as_colliders=False)
    elif source.endswith(".xml"):
        builder.add_mjcf(source, collapse_fixed_joints=False)
    else:
        builder.add_usd(source, collapse_fixed_joints=False, schema_resolvers=[SchemaResolverNewton(), SchemaResolverMjc()])
    tendons = _tendons(builder) if job.get("tendons") else []
    return {"bodies": _bodies(builder), "joints": _joints(builder), "tendons": tendons}


def _tendons(builder: Any) -> list[dict[str, list[float]]]:
    """The steps of each spatial tendon (0 site, 1 shape, 2 pulley) with the divisors of its pulleys, and coefficients of the fixed ones."""
    attributes = {
        name.rpartition("tendon_")[2]: list(item.values or ()) for name, item in builder.custom_attributes.items() if "tendon_" in name
    }
    found = []
    for first, count, kind in zip(attributes["wrap_adr"], attributes["wrap_num"], attributes["type"], strict=True):
        steps = [float(step) for step in attributes["wrap_type"][first : first + count]] if kind else []
        divisors = [float(attributes["wrap_prm"][first + place]) for place, step in enumerate(steps) if step == _PULLEY]
        found.append({"steps": steps, "divisors": divisors})
    return [*sorted(found, key=str), {"coefficients": _list(attributes["coef"])}]


def _bodies(builder: Any) -> list[dict[str, Any]]:
    rows = zip(builder.body_label, builder.body_mass, builder.body_com, builder.body_inertia, builder.body_q, strict=True)
    return [
        {"name": label, "mass": float(mass), "com": _list(com), "tensor": _list(np.array(tensor).ravel()), "at": _list(at)}
        for label, mass, com, tensor, at in rows
    ]


def _joints(builder: Any) -> list[dict[str, Any]]:
    starts = [*builder.joint_qd_start, builder.joint_dof_count]
    found = []
    for number, label in enumerate(builder.joint_label):
        dofs = range(starts[number], starts[number + 1])
        found.append(
            {
                "name": label,
                "type": JointType(builder.joint_type[number]).name,
                "parent": int(builder.joint_parent[number]),
                "child": int(builder.joint_child[number]),
                "above": _list(builder.joint_X_p[number]),
                "below": _list(builder.joint_X_c[number]),
                "axes": [_list(builder.joint_axis[dof]) for dof in dofs],
                "lower": [_finite(builder.joint_limit_lower[dof]) for dof in dofs],
                "upper": [_finite(builder.joint_limit_upper[dof]) for dof in dofs],
                "velocity": [_limit(builder.joint_velocity_limit[dof]) for dof in dofs],
                "effort": [_limit(builder.joint_effort_limit[dof]) for dof in dofs],
                "armature": [_finite(builder.joint_armature[dof]) for dof in dofs],
                "friction": [_finite(builder.joint_friction[dof]) for dof in dofs],
                "damping": [_finite(builder.joint_damping[dof]) for dof in dofs],
                "stiffness of drive": [_finite(builder.joint_target_ke[dof]) for dof in dofs],
                "damping of drive": [_finite(builder.joint_target_kd[dof]) for dof in dofs],
                "mode of drive": [JointTargetMode(builder.joint_target_mode[dof]).name for dof in dofs],
            }
        )
    return found


def _list(values: Any) -> list[float]:
    return [float(value) for value in values]


def _finite(value: Any) -> float | None:
    """None stands for no limit, which Newton writes as a very large number."""
    return float(value) if math.isfinite(value) and abs(value) < 1e9 else None


def _limit(value: Any) -> float | None:
    """None stands for no limit: Newton's default for speed and effort is a million, for what USD leaves open infinity."""
    return float(value) if abs(value) < _NO_LIMIT else None


if __name__ == "__main__":
    answer_all(describe)
