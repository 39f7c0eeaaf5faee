"""What follows from edits: inertials of shapes where a file states none, and gains and springs that are computed from masses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.compare.diff import diff
from hymeko_x.diagnostics import Report
from hymeko_x.ir.parts import Actuator, Body, Inertial, Joint, Role
from hymeko_x.ir.solids import joined
from hymeko_x.rewrite.context import Context
from hymeko_x.rewrite.densities import Solids
from hymeko_x.rewrite.inertia import LEAST, LEAST_TENSOR

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Mapping

    from hymeko_x.compare.diff import Difference, Tolerance
    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotEdge
    from hymeko_x.ir.solids import Solid

_SINGLE = 1e-5
"""Of the largest number: how far inertials of sizes in single precision may be apart."""


def without_followed(edited: Mechanism, image: Mechanism, bare: Iterable[Id]) -> Mechanism:
    """The edited robot, in which those of the bare bodies have the inertial of the image whose inertial is that of their shapes.

    It is so in both files with one density. ``bare`` are bodies of the image for which ORIGINAL has no mass.
    """
    theirs, mine = (Solids(robot, Context(Report()), as_hull=True) for robot in (image, edited))
    followed: dict[Id, Body] = {}
    for key in bare:
        before, after = image.part(key, Body), edited.part(key, Body)
        if before is None or after is None or before.inertial == after.inertial:
            continue
        old, new = _density(before.inertial, _solid(theirs, key)), _density(after.inertial, _solid(mine, key))
        if old is not None and new is not None and math.isclose(old, new, rel_tol=_SINGLE):
            followed[key] = before
    return edited.replace(vertices=followed)


def with_computed_gains(edited: Mechanism, first: Mechanism, now: Mechanism, own: Mapping[Id, object]) -> tuple[Mechanism, list[Id]]:
    """The edited robot with the actuators of which no edit changed anything as ORIGINAL is converted to ``now``, and which these are.

    ``first`` is ORIGINAL as it was converted before the edits, and ``own`` what it has itself in place of each actuator: of the same kind
    it has gains of its own, which no conversion computes.
    """
    computed: dict[Id, Actuator] = {}
    for key, part in edited.vertices(Actuator):
        found, source = now.part(key, Actuator), own.get(key)
        is_own = isinstance(source, Actuator) and source.kind == part.kind
        if found is not None and found != part == first.graph.vertices.get(key) and not is_own:
            computed[key] = found
    return edited.replace(vertices=computed), list(computed)


def sprung_joints(image: Mechanism, original: Mechanism, homes: Mapping[Id, Id], engine: Callable[[], Mechanism]) -> set[Id]:
    """The joints of the image whose springs the engine of ORIGINAL computes, whatever stiffness and damping it states.

    ``homes`` are the ids in ORIGINAL of what has another one in the image, and ``engine`` gives ORIGINAL with what is computed of it.
    """
    others: dict[Id, Id] = {}
    for view in image.joints.values():
        source = original.joints.get(homes.get(view.id, view.id))
        if source is not None and any(there != own and any(there) for there, own in zip(_springs(view), _springs(source), strict=False)):
            others[view.id] = source.id
    if not others:
        return set()
    computed = engine().joints
    return {key for key, home in others.items() if _springs(computed[home]) != _springs(original.joints[home])}


def with_computed_springs(
    edited: Mechanism, first: Mechanism, now: Mechanism, joints: Container[Id], tolerance: Tolerance
) -> tuple[Mechanism, list[Id], list[Difference]]:
    """The edited robot, in which these joints have their springs as ORIGINAL is converted to ``now``; which of them had those of ``first``.

    ``first`` is ORIGINAL as it was converted before the edits. The third are the edits of the springs of the others.
    """
    sprung = _with_springs_of(now, edited, joints)
    others = {edit.element for edit in diff(sprung, edited, tolerance)} if sprung is not edited else set()
    since = diff(_with_springs_of(first, edited, joints), edited, tolerance) if others else ()
    edits = [edit for edit in since if edit.element in others]
    return sprung, sorted(others.difference(edit.element for edit in edits), key=str), edits


def _with_springs_of(robot: Mechanism, edited: Mechanism, joints: Container[Id]) -> Mechanism:
    """The edited robot, in which these joints have the stiffness and damping that they have in the other one."""
    edges: dict[Id, RobotEdge] = {}
    for view in edited.joints.values():
        other = robot.joints.get(view.id)
        if view.id in joints and other is not None and len(other.joint.dofs) == len(view.joint.dofs):
            dofs = [replace(dof, stiffness=k, damping=d) for dof, (k, d) in zip(view.joint.dofs, _springs(other), strict=True)]
            edges[view.id] = replace(edited.graph.edges[view.id], data=Joint(tuple(dofs)))
    return edited.replace(edges=edges) if edges else edited


def _springs(view: JointView) -> list[tuple[float, float]]:
    """Stiffness and damping of each dof."""
    return [(dof.stiffness, dof.damping) for dof in view.joint.dofs]


def with_least_masses(edited: Mechanism, image: Mechanism) -> Mechanism:
    """The edited robot, in which a body that has the least inertial in one of both robots alone has that of the image.

    A format demands it of bodies that have none, and demands none any more where an edit adds a body with a mass behind one.
    """
    least: dict[Id, Body] = {}
    for key, body in image.vertices(Body):
        other = edited.part(key, Body)
        is_asked = other is not None and other.inertial is None and body.inertial is not None and body.inertial.mass == LEAST
        if is_asked or (other is not None and other != body and _is_least(other.inertial, body.inertial)):
            least[key] = body
    return edited.replace(vertices=least)


def _is_least(inertial: Inertial | None, other: Inertial | None) -> bool:
    """Whether a mass or a tensor is the least one in place of a lesser one, and what else there is the same."""
    if inertial is None:
        return False
    other = Inertial(0.0) if other is None else other
    is_mass = inertial.mass == LEAST and (other.mass or 0.0) < LEAST
    is_tensor = inertial.tensor == LEAST_TENSOR and all(abs(value) < LEAST for value in other.tensor or ())
    is_same_mass, is_same_tensor = (inertial.mass, inertial.com) == (other.mass, other.com), inertial.tensor == other.tensor
    return (is_mass or is_same_mass) and (is_tensor or is_same_tensor) and not (is_same_mass and is_same_tensor)


def heavier(image: Mechanism, edited: Mechanism, complete: Mechanism) -> set[Id]:
    """The bodies without an inertial in EDITED that have a mass in the image; ``complete`` is EDITED with those that engines compute."""
    found: set[Id] = set()
    for key, body in image.vertices(Body):
        other, whole = edited.part(key, Body), complete.part(key, Body)
        if other is not None and other.inertial is None and not math.isclose(_mass(body), _mass(whole), rel_tol=_SINGLE, abs_tol=LEAST):
            found.add(key)
    return found


def computed_weights(image: Mechanism, edited: Mechanism, heavy: Container[Id]) -> set[Id]:
    """The bodies without an inertial in EDITED, and their shapes, whose masses came home: the image has them as those of the bodies."""
    given = {key for key, body in image.vertices(Body) if body.inertial is not None and key not in heavy}
    bodies = [key for key, body in edited.vertices(Body) if body.inertial is None and key in given]
    return {*bodies, *(view.id for key in bodies for view in edited.shapes.get(key, ()))}


def _mass(body: Body | None) -> float:
    """The mass in kg; 0 where none is stated."""
    return 0.0 if body is None or body.inertial is None else body.inertial.mass or 0.0


def _solid(solids: Solids, body: Id) -> Solid | None:
    """What collides of a body as one solid of density 1, in the body's frame."""
    views = [view for view in solids.mechanism.shapes.get(body, ()) if view.shape.role is not Role.VISUAL]
    found = [solid for view in views if (solid := solids.of(view)) is not None]
    return joined(found) if found else None


def _density(inertial: Inertial | None, solid: Solid | None) -> float | None:
    """The density in kg/m^3 with which a solid has this inertial, whose tensor may be stated as zeros; None where it has another one."""
    if inertial is None or inertial.mass is None or inertial.tensor is None or solid is None:
        return None
    density = inertial.mass / solid.mass
    expected = solid.times(density)
    is_tensor = not any(inertial.tensor) or _are_near(inertial.tensor, expected.tensor)
    return density if is_tensor and _are_near(inertial.com, expected.com) else None


def _are_near(numbers: tuple[float, ...], others: tuple[float, ...]) -> bool:
    """Whether they are the same but for single precision."""
    room = _SINGLE * max(map(abs, others), default=0.0)
    return all(abs(a - b) <= room for a, b in zip(numbers, others, strict=True))
