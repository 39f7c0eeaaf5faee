"""What the path of a tendon cannot be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.parts import Cylinder, DofKind, Joint, Shape, Sphere

if TYPE_CHECKING:
    from hymeko_x.frontends.mjcf.draft import Draft
    from hymeko_x.ir.mechanism import RobotArc

_PULLEY, _SITE, _GEOM = "pulley", "site", "geom"


def wrong_fixed(arcs: list[RobotArc], draft: Draft) -> str | None:
    """What is wrong with a combination of joints: it is not empty, and no joint turns freely or comes twice."""
    if not arcs:
        return "is empty"
    seen: set[tuple[object, str]] = set()
    for arc in arcs:
        if (arc.target, arc.role) in seen:
            return f"has the joint '{arc.role or arc.target.name}' twice"
        seen.add((arc.target, arc.role))
        if not moves_along_one(arc, draft):
            return f"has the joint '{arc.role or arc.target.name}', expected a hinge or a slide"
    return None


def moves_along_one(arc: RobotArc, draft: Draft) -> bool:
    """Whether an arc leads to a hinge or a slide."""
    joint = draft.edges[arc.target].data
    assert isinstance(joint, Joint)
    dof = next((dof for dof in joint.dofs if arc.role and dof.name == arc.role), joint.dofs[0])
    return dof.kind in (DofKind.HINGE, DofKind.SLIDE)


def wrong_spatial(arcs: list[RobotArc], draft: Draft) -> str | None:
    """What is wrong with a cable: between pulleys it has at least two sites, and its geoms are round and stand between sites."""
    steps = [_PULLEY if arc.role == "pulley" else _GEOM if arc.role == "wrap" else _SITE for arc in arcs if arc.role != "side"]
    if not steps:
        return "is empty"
    if len(steps) < 2:
        return "has less than two steps"
    if steps[-1] == _PULLEY:
        return "ends with a pulley"
    around = zip([_PULLEY, *steps], steps, [*steps[1:], _PULLEY], strict=False)
    if any(step == _GEOM and (before != _SITE or after != _SITE) for before, step, after in around):
        return "has a geom that does not stand between two sites"
    odd = next((arc.target.name for arc in arcs if arc.role == "wrap" and not _is_round(arc, draft)), None)
    return None if odd is None else "wraps around a geom that is neither a sphere nor a cylinder"


def _is_round(arc: RobotArc, draft: Draft) -> bool:
    shape = draft.edges[arc.target].data
    return isinstance(shape, Shape) and isinstance(shape.geometry, Sphere | Cylinder)
