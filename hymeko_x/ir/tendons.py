"""The path of a tendon: its steps in order, and what it cannot be."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import Id, RobotEdge, numbers_weight
from hymeko_x.ir.parts import Cylinder, DofKind, Shape, Sphere

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import Tendon

Edges = Mapping[Id, RobotEdge]
FIXED, SPATIAL = "fixed", "spatial"
PULLEY, SIDE, WRAP = "pulley", "side", "wrap"
_SITE, _GEOM, _OTHER = "site", "geom", "other"


def wrong_path(tendon: Tendon, arcs: Sequence[RobotArc], edges: Edges) -> str | None:
    """What is wrong with the path of a tendon as MuJoCo sees it; None when nothing is.

    Source: MuJoCo, user_objects.cc, the checks of mjCTendon.
    """
    if tendon.kind == FIXED:
        return _wrong_fixed(arcs, edges)
    if tendon.kind != SPATIAL:
        return f"is neither {FIXED} nor {SPATIAL}"
    wrong = _wrong_spatial(arcs, edges)
    if wrong is None and tendon.armature and any(_step(arc) == _GEOM for arc in arcs):
        return "has an armature and wraps around a geom"
    return wrong


def _wrong_fixed(arcs: Sequence[RobotArc], edges: Edges) -> str | None:
    """What is wrong with a combination of joints: it is not empty, and no joint turns freely or comes twice."""
    if not arcs:
        return "is empty"
    seen: set[tuple[object, str]] = set()
    for arc in arcs:
        if (arc.target, arc.role) in seen:
            return f"has the joint '{arc.role or arc.target.name}' twice"
        seen.add((arc.target, arc.role))
        if not moves_along_one(arc, edges):
            return f"has the joint '{arc.role or arc.target.name}', expected a hinge or a slide"
        if len(numbers_weight(arc)) != 1:
            return f"has no coefficient for '{arc.role or arc.target.name}'"
    return None


def moves_along_one(arc: RobotArc, edges: Edges) -> bool:
    """Whether an arc leads to a hinge or a slide."""
    found = dof_at(edges, arc)
    return found is not None and found[1].kind in (DofKind.HINGE, DofKind.SLIDE)


def _wrong_spatial(arcs: Sequence[RobotArc], edges: Edges) -> str | None:
    """What is wrong with a cable: between pulleys it has at least two sites, and its geoms are round and stand between sites."""
    odd = next((arc for before, arc in zip([None, *arcs], arcs, strict=False) if _is_odd(before, arc)), None)
    if odd is not None:
        return f"leads through {odd.target}, which is no step of a cable"
    steps = [_step(arc) for arc in arcs if arc.role != SIDE]
    if not steps:
        return "is empty"
    if len(steps) < 2:
        return "has less than two steps"
    if steps[-1] == PULLEY:
        return "ends with a pulley"
    around = zip([PULLEY, *steps], steps, [*steps[1:], PULLEY], strict=False)
    if any(step == _GEOM and (before != _SITE or after != _SITE) for before, step, after in around):
        return "has a geom that does not stand between two sites"
    if all(_is_round(arc, edges) for arc in arcs if _step(arc) == _GEOM):
        return None
    return "wraps around a geom that is neither a sphere nor a cylinder"


def _step(arc: RobotArc) -> str:
    """What an arc is in the path of a cable."""
    if arc.role == PULLEY:
        return PULLEY
    if arc.target.kind == "frame":
        return _SITE if arc.role in ("", SIDE) else _OTHER
    return _GEOM if arc.target.kind == "shape" and arc.role in ("", WRAP) else _OTHER


def _is_odd(before: RobotArc | None, arc: RobotArc) -> bool:
    """Whether an arc has no place in a cable, where it stands."""
    if arc.role == PULLEY:
        numbers = numbers_weight(arc)
        return len(numbers) != 1 or not numbers[0] > 0.0
    if arc.role == SIDE:
        return arc.target.kind != "frame" or before is None or _step(before) != _GEOM
    return _step(arc) == _OTHER


def _is_round(arc: RobotArc, edges: Edges) -> bool:
    edge = edges.get(arc.target)
    return edge is not None and isinstance(edge.data, Shape) and isinstance(edge.data.geometry, Sphere | Cylinder)
