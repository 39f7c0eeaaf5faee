"""The tendons of a mechanism in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir import parts
from hymeko_x.ir import tendons as words
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.verify.tendons import CYLINDER, JOINT, PULLEY, RELAXED, SIDE, SITE, SPHERE, Spring, Step, Tendon, point_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc
    from hymeko_x.verify.model import Array

    Placed = tuple[int, Array]
    Said = float | str | tuple[float, ...] | None

_FORCE, _FORCED, _SPRING = "actuatorfrcrange", "actuatorfrclimited", "springlength"


def read_tendons(
    mechanism: Mechanism, dofs: Mapping[tuple[Id, str], int], sites: Mapping[Id, Placed], shapes: Mapping[Id, Placed]
) -> Iterator[Tendon]:
    """Every tendon whose steps are there. ``sites`` and ``shapes`` say on which body each of them is, and where on it."""
    for key, tendon, arcs in mechanism.edges(parts.Tendon):
        steps = [_step(mechanism, arc, dofs, sites, shapes) for arc in arcs]
        path = tuple(step for step in steps if step is not None)
        if len(path) == len(steps):
            yield _tendon(key.name, tendon, path)


def _tendon(name: str, tendon: parts.Tendon, path: tuple[Step, ...]) -> Tendon:
    said = dict(tendon.parameters)
    lower, upper = tendon.limits.lower, tendon.limits.upper
    bound = lower is not None or upper is not None
    return Tendon(
        name,
        path,
        (tendon.stiffness, tendon.damping, tendon.friction, tendon.armature),
        (float("-inf") if lower is None else lower, float("inf") if upper is None else upper) if bound else None,
        _force(said.get(_FORCE), said.get(_FORCED, "auto")),
        _spring(said.get(_SPRING)) if tendon.stiffness else RELAXED,
    )


def _force(said: Said, limited: Said) -> tuple[float, float] | None:
    if not isinstance(said, tuple) or len(said) != 2 or limited == "false":
        return None
    return said[0], said[1]


def _spring(said: Said) -> Spring:
    """One length, or two; -1 and nothing are the length at rest."""
    numbers = said if isinstance(said, tuple) else (said,) if isinstance(said, float) else ()
    if not numbers or numbers[0] == -1.0:
        return RELAXED
    return Spring((numbers[0], numbers[-1]), at_rest=False)


def _step(
    mechanism: Mechanism,
    arc: RobotArc,
    dofs: Mapping[tuple[Id, str], int],
    sites: Mapping[Id, Placed],
    shapes: Mapping[Id, Placed],
) -> Step | None:
    """What an arc is in a path; None where it leads to nothing."""
    if arc.role == words.PULLEY:
        return Step(PULLEY, number=numbers_weight(arc)[0])
    if arc.target in sites:
        body, pose = sites[arc.target]
        return Step(SIDE if arc.role == words.SIDE else SITE, body, point=point_of(pose[:3, 3]))
    if arc.target in shapes:
        return _shape(mechanism.graph.edges[arc.target].data, *shapes[arc.target])
    dof = dofs.get((arc.target, arc.role))
    return None if dof is None else Step(JOINT, dof, numbers_weight(arc)[0])


def _shape(data: parts.EdgePart, body: int, pose: Array) -> Step | None:
    match data:
        case parts.Shape(parts.Sphere(radius)):
            return Step(SPHERE, body, radius, point_of(pose[:3, 3]))
        case parts.Shape(parts.Cylinder(radius, _)):
            return Step(CYLINDER, body, radius, point_of(pose[:3, 3]), point_of(pose[:3, 2]))
        case _:
            return None
