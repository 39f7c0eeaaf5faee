"""Whether a robot is complete and sane enough to compute with, to simulate, or to look at.

The checks of the paper's section 4, on a mechanism: structure, joints, inertia, shapes, and the declared numbers of links and
joints. Everything that is found is a diagnostic with a code, a place and a hint, for a person or for a loop that repairs.
Source: Hajdu and Hegyi, Appl. Mech. 2025, 6(4), 74, section 4.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import WORLD, Id, JointView, Mechanism, ShapeView
from hymeko_x.rewrite.inertia import principal_moments

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Files

_LARGEST = 1e3  # m; what is larger was probably written in millimetres
_LEAST_MASS = 1e-15  # kg; below it engines divide by zero
_SLACK = 1e-9  # relative, for principal moments at the edge of the triangle inequality


class Profile(Enum):
    """What the robot is for: computing poses, simulating it, or drawing it."""

    KINEMATICS = "kinematics"
    SIMULATION = "simulation"
    DISPLAY = "display"


class Declared(Struct, frozen=True):
    """How many links and joints the robot's author says that there are; None = not said."""

    links: int | None = None
    joints: int | None = None


def validate(
    mechanism: Mechanism, files: Files, report: Report, profiles: Iterable[Profile] = tuple(Profile), declared: Declared | None = None
) -> None:
    """Append what is wrong with a robot to the report. ``files`` are those that its meshes may be in."""
    wanted = set(profiles)
    check_structure(mechanism, report)
    check_numbers(mechanism, declared or Declared(), report)
    for view in mechanism.joints.values():
        for dof in view.joint.dofs:
            check_dof(mechanism, view, dof, report)
    if Profile.SIMULATION in wanted:
        check_inertia(mechanism, report)
        _check_presence(mechanism, parts.Role.COLLISION, report)
    if Profile.DISPLAY in wanted:
        _check_presence(mechanism, parts.Role.VISUAL, report)
    if wanted & {Profile.SIMULATION, Profile.DISPLAY}:
        check_shapes(mechanism, files, report)


# ---- structure -------------------------------------------------------------------------------------------------------


def check_structure(mechanism: Mechanism, report: Report) -> None:
    """There are bodies, every joint has two ends, no body has two parents, and every body hangs on a root."""
    bodies = [key for key, _ in mechanism.vertices(parts.Body)]
    if not bodies:
        report.error(codes.EMPTY_ROBOT, f"'{mechanism.name}' has no links", hint="a robot has at least one")
    for key, _, arcs in mechanism.edges(parts.Joint):
        if key not in mechanism.joints:
            above, below = sum(arc.sign > 0 for arc in arcs), sum(arc.sign < 0 for arc in arcs)
            said = f"{key} has {above} parents and {below} children; a joint has one of each"
            report.error(codes.LOOSE_JOINT, said, mechanism.origin(key), element=str(key))
    parents: dict[Id, Id] = {}
    for view in mechanism.joints.values():
        if view.parent == view.child:
            report.error(codes.LOOSE_JOINT, f"{view.id} joins {view.child} with itself", mechanism.origin(view.id), element=str(view.id))
        first = parents.setdefault(view.child, view.id)
        if first != view.id:
            said = f"{view.child} is the child of {first} and of {view.id}"
            report.error(
                codes.TWO_PARENTS,
                said,
                mechanism.origin(view.id),
                element=str(view.child),
                hint="close loops with a loop, not with a joint",
            )
    reached = set(mechanism.depth_first())
    for key in bodies:
        if key not in reached:
            report.error(codes.CYCLE, f"{key} hangs on no root: its joints lead back to it", mechanism.origin(key), element=str(key))
    _check_roots(mechanism, report)


def _check_roots(mechanism: Mechanism, report: Report) -> None:
    loose = [root for root in mechanism.roots if root not in mechanism.parent_joint]
    if len(loose) > 1:
        names = ", ".join(f"'{root.name}'" for root in loose[:5])
        report.warn(codes.SEVERAL_ROOTS, f"{len(loose)} links hang on nothing: {names}", element=str(loose[1]), hint="is a joint missing?")


def check_numbers(mechanism: Mechanism, declared: Declared, report: Report) -> None:
    """As many links and joints as were declared."""
    links, joints = sum(1 for _ in mechanism.vertices(parts.Body)), len(mechanism.joints)
    for word, found, expected in (("links", links, declared.links), ("joints", joints, declared.joints)):
        if expected is not None and found != expected:
            report.error(codes.WRONG_COUNT, f"there are {found} {word}, and {expected} were declared", element=mechanism.name)


# ---- joints ----------------------------------------------------------------------------------------------------------


def check_dof(mechanism: Mechanism, view: JointView, dof: parts.Dof, report: Report) -> None:
    """A direction where one is needed, and limits that leave room to move."""
    place, element = mechanism.origin(view.id), str(view.id)
    if dof.kind in (parts.DofKind.HINGE, parts.DofKind.SLIDE, parts.DofKind.SCREW) and not abs(math.hypot(*dof.axis) - 1.0) < 1e-6:
        report.error(codes.ZERO_AXIS, f"{view.id} has no direction to move in: its axis is {dof.axis}", place, element=element)
    lower, upper = dof.limits.lower, dof.limits.upper
    if lower is not None and upper is not None and lower > upper:
        report.error(codes.BAD_LIMITS, f"{view.id}: the lower limit {lower!r} is above the upper one {upper!r}", place, element=element)
    elif lower is not None and lower == upper:
        said = f"{view.id} cannot move: both limits are {lower!r}"
        report.warn(codes.BAD_LIMITS, said, place, element=element, hint="a joint that never moves is fixed; one without limits says none")
    elif (
        dof.kind is parts.DofKind.HINGE
        and max(abs(lower or 0.0), abs(upper or 0.0)) > 100.0
        and math.isfinite((lower or 0.0) + (upper or 0.0))
    ):
        report.warn(
            codes.BAD_LIMITS,
            f"{view.id} turns by up to {max(abs(lower or 0.0), abs(upper or 0.0)):g} rad",
            place,
            element=element,
            hint="degrees?",
        )
    for word, value in (("effort", dof.limits.effort), ("velocity", dof.limits.velocity)):
        if value is not None and value < 0.0:
            report.error(codes.BAD_LIMITS, f"{view.id}: the {word} limit {value!r} is negative", place, element=element)
    for word, value in (("damping", dof.damping), ("friction", dof.friction), ("armature", dof.armature)):
        if value < 0.0:
            report.error(codes.BAD_LIMITS, f"{view.id}: the {word} {value!r} is negative", place, element=element)


# ---- inertia ---------------------------------------------------------------------------------------------------------


def check_inertia(mechanism: Mechanism, report: Report) -> None:
    """Everything that moves has mass, itself or in what is fixed to it, and every tensor is one that a body can have."""
    for key, body in mechanism.vertices(parts.Body):
        if body.inertial is not None:
            _check_inertial(mechanism, key, body.inertial, report)
        view = mechanism.parent_joint.get(key)
        if view is None or not view.joint.dofs or _group_mass(mechanism, key) >= _LEAST_MASS:
            continue
        said = f"{key} moves and has no mass, nor has anything that is fixed to it"
        report.error(codes.NO_INERTIA, said, mechanism.origin(key), element=str(key), hint="give it a mass and an inertia tensor")


def _group_mass(mechanism: Mechanism, top: Id) -> float:
    total, stack = 0.0, [top]
    while stack:
        key = stack.pop()
        inertial = mechanism.vertex(key, parts.Body).inertial
        total += max(0.0, inertial.mass or 0.0) if inertial is not None else 0.0
        stack.extend(view.child for view in mechanism.children.get(key, ()) if not view.joint.dofs)
    return total


def _check_inertial(mechanism: Mechanism, key: Id, inertial: parts.Inertial, report: Report) -> None:
    place, element = mechanism.origin(key), str(key)
    mass = inertial.mass
    if mass is not None and not (math.isfinite(mass) and mass >= 0.0):
        report.error(codes.BAD_MASS, f"{key} has mass {mass!r}", place, element=element, hint="a mass is a positive number of kg")
    if inertial.tensor is None:
        return
    if not all(map(math.isfinite, inertial.tensor)):
        report.error(codes.BAD_TENSOR, f"the inertia tensor of {key} has numbers that are not finite", place, element=element)
        return
    low, middle, high = principal_moments(inertial.tensor)
    hint = f"a solid of {mass:g} kg and 0.1 m has about {(mass or 0.0) * 0.01 / 6:.2g} kg m^2" if mass else ""
    if low < -_SLACK * high or (mass and low <= 0.0 and high <= 0.0):
        said = f"the inertia tensor of {key} is not positive definite: its principal moments are {low:.6g}, {middle:.6g}, {high:.6g}"
        report.error(codes.BAD_TENSOR, said, place, element=element, hint=hint)
    elif low + middle < high * (1.0 - _SLACK):
        said = (
            f"no body can have the inertia tensor of {key}: of {low:.6g}, {middle:.6g}, {high:.6g} the last exceeds the sum of the others"
        )
        report.error(codes.BAD_TENSOR, said, place, element=element, hint=hint)


# ---- shapes ----------------------------------------------------------------------------------------------------------


def _check_presence(mechanism: Mechanism, role: parts.Role, report: Report) -> None:
    """Bodies with a mass have something to see, and something to touch."""
    code = codes.NO_VISUAL if role is parts.Role.VISUAL else codes.NO_COLLISION
    for key, body in mechanism.vertices(parts.Body):
        shapes = mechanism.shapes.get(key, ())
        heavy = body.inertial is not None and (body.inertial.mass or 0.0) > 0.0
        if heavy and not any(view.shape.role in (role, parts.Role.BOTH) for view in shapes):
            report.warn(code, f"{key} has a mass and no {role.value} shape", mechanism.origin(key), element=str(key))


def check_shapes(mechanism: Mechanism, files: Files, report: Report) -> None:
    """Sizes are positive and not absurd, and mesh files exist."""
    for view in mechanism.every_shape():
        _check_size(mechanism, view, report)
        if view.mesh is not None:
            _check_mesh(mechanism, view, files, report)


def _check_size(mechanism: Mechanism, view: ShapeView, report: Report) -> None:
    sizes = _sizes(view.shape.geometry)
    place, element = mechanism.origin(view.id), str(view.id)
    if any(not (math.isfinite(size) and size > 0.0) for size in sizes):
        said = f"a {_word(view.shape.geometry)} of {_on(view)} has the sizes {', '.join(f'{size:g}' for size in sizes)}"
        report.error(codes.BAD_SIZE, said, place, element=element, hint="sizes are positive numbers of metres")
    elif any(size > _LARGEST for size in sizes):
        said = f"a {_word(view.shape.geometry)} of {_on(view)} is {max(sizes):g} m large"
        report.warn(codes.BAD_SIZE, said, place, element=element, hint="was it written in millimetres?")


def _sizes(geometry: parts.Geometry) -> tuple[float, ...]:
    match geometry:
        case parts.Box(size):
            return size
        case parts.Sphere(radius):
            return (radius,)
        case parts.Cylinder(radius, length) | parts.Capsule(radius, length):
            return radius, length
        case parts.Ellipsoid(radii):
            return radii
        case _:
            return ()


def _word(geometry: parts.Geometry) -> str:
    return type(geometry).__name__.lower()


def _on(view: ShapeView) -> str:
    return "the world" if view.body == WORLD else str(view.body)


def _check_mesh(mechanism: Mechanism, view: ShapeView, files: Files, report: Report) -> None:
    assert view.mesh is not None
    mesh = mechanism.vertex(view.mesh, parts.Mesh)
    place, element = mechanism.origin(view.id), str(view.id)
    if any(scale == 0.0 or not math.isfinite(scale) for scale in mesh.scale):
        report.error(codes.BAD_SIZE, f"a mesh of {_on(view)} has the scale {mesh.scale}", place, element=element)
    if mesh.uri is not None and not mesh.vertices and files.find(mesh.uri) is None:
        said = f"the mesh '{mesh.uri}' of {_on(view)} was not found"
        report.warn(codes.ASSET_NOT_FOUND, said, place, element=element, hint="--package NAME=DIR tells where package://NAME is")
