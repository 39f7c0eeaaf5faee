"""The checks of one robot: whether it is complete and sane enough to compute with, to simulate, or to look at.

The checks of the paper's section 4, on a mechanism: structure, joints, inertia, shapes, and the declared numbers of links and
joints. Each finding is a diagnostic with a code, an origin and a hint, for a person or for a loop that repairs.
Source: Hajdu and Hegyi, Appl. Mech. 2025, 6(4), 74, section 4.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes, formats
from hymeko_x.assets.pack import package_hint
from hymeko_x.assets.shelf import read_file
from hymeko_x.diagnostics import Origin, with_article
from hymeko_x.ir import parts
from hymeko_x.ir.ids import LUMPED_KINDS
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, JointView, Mechanism, ShapeView
from hymeko_x.meshes.unit import extents_of_stl
from hymeko_x.rewrite.apart import names_apart
from hymeko_x.rewrite.inertia import principal_moments
from hymeko_x.rewrite.mimics import leaders_first
from hymeko_x.source import suffix_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.diagnostics import Code, Report
    from hymeko_x.source import Files

_LARGEST = 1e3  # m; larger sizes were probably written in millimetres
_LARGEST_PART = 20.0  # m; a mesh of a body that is larger in a file without a unit was probably written in millimetres
_MOST_RADIANS = 100.0  # a hinge that turns further was probably written in degrees
LEAST_MASS = 1e-15  # kg; below it engines divide by zero
_EDGE = 1e-9  # relative: rounding of principal moments at the edge of the triangle inequality
UNIT_LENGTH = 1e-6  # by which the length of an axis may differ from 1: single precision
_MOST_NAMED = 5  # roots named in a message


class Profile(Enum):
    """The purpose of the robot: computing poses, simulating it, or drawing it; or that nothing at all is missing."""

    KINEMATICS = "kinematics"
    SIMULATION = "simulation"
    DISPLAY = "display"
    COMPLETE = "complete"
    """The six checks of the paper: structure, links, joints, and in every link a visual, a collision shape and an inertial."""


USUAL = (Profile.KINEMATICS, Profile.SIMULATION, Profile.DISPLAY)
"""What is checked when no purpose is given."""


class Declared(Struct, frozen=True):
    """The numbers of links and joints that the robot's author declares; None = not declared."""

    links: int | None = None
    joints: int | None = None


def validate(
    mechanism: Mechanism, files: Files, report: Report, profiles: Iterable[Profile] = USUAL, declared: Declared | None = None
) -> None:
    """Append the faults of a robot to the report. ``files`` are those that its meshes may be in."""
    wanted = set(profiles)
    found = _Findings(mechanism, report)
    _check_structure(found)
    _check_numbers(found, declared or Declared())
    _check_names(found)
    _check_poses(found)
    for view in mechanism.joints.values():
        for dof in view.joint.dofs:
            _check_dof(found, view.id, dof)
    if Profile.COMPLETE in wanted:
        _check_completeness(found)
    if wanted & {Profile.SIMULATION, Profile.COMPLETE}:
        _check_inertia(found)
    if Profile.COMPLETE not in wanted:
        roles = {Profile.SIMULATION: parts.Role.COLLISION, Profile.DISPLAY: parts.Role.VISUAL}
        for role in (role for profile, role in roles.items() if profile in wanted):
            _check_presence(found, role)
    if wanted - {Profile.KINEMATICS}:
        for shape in mechanism.every_shape():
            _check_size(found, shape)
            if shape.mesh is not None:
                _check_mesh(found, shape, shape.mesh, files)
        _check_files(found, files)


class _Findings(Struct, frozen=True):
    """The mechanism and the report that findings about its elements go to."""

    mechanism: Mechanism
    report: Report

    def error(self, code: Code, key: Id, message: str, hint: str = "") -> None:
        """A fault of an element."""
        self.report.error(code, message, self.mechanism.origin(key), element=str(key), hint=hint)

    def note(self, code: Code, key: Id, message: str, hint: str) -> None:
        """A remark about an element."""
        self.report.note(code, message, self.mechanism.origin(key), element=str(key), hint=hint)

    def warn(self, code: Code, key: Id, message: str, hint: str = "") -> None:
        """A doubtful value of an element."""
        self.report.warn(code, message, self.mechanism.origin(key), element=str(key), hint=hint)


# ---- structure -------------------------------------------------------------------------------------------------------


def _check_structure(found: _Findings) -> None:
    """There are bodies, every joint has two ends, no body has two parents, and every body descends from a root."""
    mechanism, report = found.mechanism, found.report
    bodies = [key for key, _ in mechanism.vertices(parts.Body)]
    if not bodies and not any(key.kind in LUMPED_KINDS for key in mechanism.graph.vertices):  # those are graphs and networks
        report.error(codes.EMPTY_ROBOT, f"'{mechanism.name}' has no links", hint="a robot has at least one")
    for key, _, arcs in mechanism.edges(parts.Joint):
        if key not in mechanism.joints:
            parents, children = sum(arc.sign > 0 for arc in arcs), sum(arc.sign < 0 for arc in arcs)
            found.error(codes.LOOSE_JOINT, key, f"{key} has {parents} parents and {children} children; a joint has one of each")
    _check_parents(found, mechanism.joints.values())
    reached = set(mechanism.depth_first())
    for key in bodies:
        if key not in reached:
            found.error(codes.CYCLE, key, f"{key} descends from no root: its joints lead back to it")
    loose = [root for root in mechanism.roots if root not in mechanism.parent_joint]
    if len(loose) > 1:
        names = ", ".join(f"'{root.name}'" for root in loose[:_MOST_NAMED])
        message = f"{len(loose)} links have no parent joint: {names}"
        report.warn(codes.SEVERAL_ROOTS, message, element=str(loose[1]), hint="is a joint missing?")


def _check_names(found: _Findings) -> None:
    """Programs that have one table of names find each link and each joint, and joints behind those that they follow."""
    mechanism, row = found.mechanism, formats.of_source(found.mechanism)
    if row is None or not row.one_namespace:
        return
    for key in names_apart(mechanism, set()):
        found.note(codes.SHARED_NAME, key, f"a link is called '{key.name}' as well", "`check --fix` gives the joint another name")
    for key, edge in leaders_first(mechanism).items():
        if edge != mechanism.graph.edges[key]:
            arcs = mechanism.graph.edges[key].arcs
            message = f"{arcs[0].target} follows {arcs[1].target}, which comes behind it in the tree, or follows another joint"
            found.note(codes.LATE_LEADER, key, message, "`check --fix` turns the relation round where it has no actuator")


def _check_poses(found: _Findings) -> None:
    """Named configurations have a number for each coordinate of the robot."""
    row = formats.of_source(found.mechanism)
    if row is None or row.misfits is None:
        return
    file = found.mechanism.source.file
    origin = found.mechanism.origin(ROOT) or (Origin(file) if file else None)
    for message, is_refused in formats.loaded(row.misfits)(found.mechanism):
        record = found.report.error if is_refused else found.report.warn
        record(codes.BAD_NUMBER, message, origin, element=str(ROOT))


def _check_parents(found: _Findings, joints: Iterable[JointView]) -> None:
    parents: dict[Id, Id] = {}
    for view in joints:
        if view.parent == view.child:
            found.error(codes.LOOSE_JOINT, view.id, f"{view.id} joins {view.child} with itself")
        first = parents.setdefault(view.child, view.id)
        if first != view.id:
            message, hint = f"{view.child} is the child of {first} and of {view.id}", "close loops with a loop, not with a joint"
            found.report.error(codes.TWO_PARENTS, message, found.mechanism.origin(view.id), element=str(view.child), hint=hint)


def _check_numbers(found: _Findings, declared: Declared) -> None:
    """As many links and joints as were declared."""
    mechanism = found.mechanism
    links, joints = sum(1 for _ in mechanism.vertices(parts.Body)), len(mechanism.joints)
    for word, count, expected in (("links", links, declared.links), ("joints", joints, declared.joints)):
        if expected is not None and count != expected:
            message = f"there are {count} {word}, and {expected} were declared"
            found.report.error(codes.WRONG_COUNT, message, element=mechanism.name)


# ---- joints ----------------------------------------------------------------------------------------------------------


def _check_dof(found: _Findings, key: Id, dof: parts.Dof) -> None:
    """A direction where one is needed, and limits that leave room to move."""
    if dof.kind not in (parts.DofKind.BALL, parts.DofKind.FREE) and not abs(math.hypot(*dof.axis) - 1.0) < UNIT_LENGTH:
        found.error(codes.ZERO_AXIS, key, f"{key} has no direction to move in: its axis is {dof.axis}")
    _check_limits(found, key, dof)
    numbers = {"effort limit": dof.limits.effort, "velocity limit": dof.limits.velocity}
    numbers |= {"damping": dof.damping, "friction": dof.friction, "armature": dof.armature}
    for word, value in numbers.items():
        if value is not None and value < 0.0:
            found.error(codes.BAD_LIMITS, key, f"{key}: the {word} {value:.6g} is negative")


def _check_limits(found: _Findings, key: Id, dof: parts.Dof) -> None:
    lower, upper = dof.limits.lower, dof.limits.upper
    farthest = max(abs(lower or 0.0), abs(upper or 0.0))
    if lower is not None and upper is not None and lower > upper:
        found.error(codes.BAD_LIMITS, key, f"{key}: the lower limit {lower:.6g} is above the upper one {upper:.6g}")
    elif lower is not None and lower == upper:
        hint = "a joint that never moves is fixed; one without limits has none"
        found.warn(codes.BAD_LIMITS, key, f"{key} cannot move: both limits are {lower!r}", hint)
    elif dof.kind is parts.DofKind.HINGE and farthest > _MOST_RADIANS and math.isfinite((lower or 0.0) + (upper or 0.0)):
        found.warn(codes.BAD_LIMITS, key, f"{key} turns by up to {farthest:g} rad", "degrees?")


# ---- inertia ---------------------------------------------------------------------------------------------------------


def _check_inertia(found: _Findings) -> None:
    """Whatever moves has mass, itself or in bodies that are fixed to it, and every tensor is one that a body can have."""
    mechanism = found.mechanism
    for key, body in mechanism.vertices(parts.Body):
        if body.inertial is not None:
            _check_inertial(found, key, body.inertial)
            _check_centre(found, key, body.inertial)
        view = mechanism.parent_joint.get(key)
        if view is not None and view.joint.dofs and _group_mass(mechanism, key) < LEAST_MASS:
            message = f"{key} moves and has no mass, nor has anything that is fixed to it"
            ways = "; `check --fix --density 1000` computes them from its shapes" if mechanism.shapes.get(key) else ""
            found.error(codes.NO_INERTIA, key, message, f"give it a mass and an inertia tensor{ways}")


def _group_mass(mechanism: Mechanism, top: Id) -> float:
    """The mass of a body and of those that are fixed to it, in kg; infinite where an engine computes it from a shape."""
    total, stack = 0.0, [top]
    is_computed = formats.native_format(mechanism) is not None
    while stack:
        key = stack.pop()
        inertial = mechanism.vertex(key, parts.Body).inertial
        if inertial is not None:
            total += max(0.0, inertial.mass or 0.0)
        elif is_computed and any(0.0 not in (view.shape.mass, view.shape.density) for view in mechanism.shapes.get(key, ())):
            return math.inf
        stack.extend(view.child for view in mechanism.children.get(key, ()) if not view.joint.dofs)
    return total


def _check_inertial(found: _Findings, key: Id, inertial: parts.Inertial) -> None:
    mass = inertial.mass
    if mass is not None and not (math.isfinite(mass) and mass >= 0.0):
        found.error(codes.BAD_MASS, key, f"{key} has mass {mass!r}", "a mass is a positive number of kg")
    fault = tensor_fault(inertial)
    if fault is not None:
        hint = f"a solid of {mass:g} kg and 0.1 m has about {(mass or 0.0) * 0.01 / 6:.2g} kg m^2" if mass and mass > 0.0 else ""
        is_finite = all(map(math.isfinite, inertial.tensor or ()))
        found.error(codes.BAD_TENSOR, key, fault.format(key), hint if is_finite else "")


def tensor_fault(inertial: parts.Inertial) -> str | None:
    """Why no body can have this tensor, with ``{}`` for the body; None where one can, or nothing is given."""
    tensor = inertial.tensor
    if tensor is None:
        return None
    if not all(map(math.isfinite, tensor)):
        return "the inertia tensor of {} has numbers that are not finite"
    low, middle, high = principal_moments(tensor)
    moments = f"{low:.6g}, {middle:.6g}, {high:.6g}"
    if low < -_EDGE * high or (inertial.mass and low <= 0.0 and high <= 0.0):
        return f"the inertia tensor of {{}} is not positive definite: its principal moments are {moments}"
    if low + middle < high * (1.0 - _EDGE):
        return f"no body can have the inertia tensor of {{}}: of {moments} the last exceeds the sum of the others"
    return None


def _check_centre(found: _Findings, key: Id, inertial: parts.Inertial) -> None:
    """The centre of mass is in the box around the body's shapes, or not much farther away than this is large."""
    low, high = [math.inf] * 3, [-math.inf] * 3
    for view in found.mechanism.shapes.get(key, ()):
        reach = math.hypot(*_sizes(view.shape.geometry))
        if not reach or not math.isfinite(reach):
            return  # meshes, planes and shapes without a size have no extent that is known here
        low = [min(least, at - reach) for least, at in zip(low, view.pose.xyz, strict=True)]
        high = [max(most, at + reach) for most, at in zip(high, view.pose.xyz, strict=True)]
    away = math.hypot(*(max(least - at, at - most, 0.0) for least, at, most in zip(low, inertial.com, high, strict=True)))
    if math.isfinite(away) and away > math.dist(low, high) / 2.0:
        message = f"the centre of mass of {key} is {away:.3g} m away from its shapes"
        found.warn(codes.COM_OUTSIDE, key, message, "is it in the frame of the link, and in metres?")


# ---- shapes ----------------------------------------------------------------------------------------------------------


def _check_completeness(found: _Findings) -> None:
    """Every link has a visual shape, a collision shape, a mass and a tensor; a link that stands for the world needs none."""
    mechanism = found.mechanism
    for key, body in mechanism.vertices(parts.Body):
        if body.inertial is None and key.name == WORLD.name and key not in mechanism.parent_joint:
            continue
        roles = {view.shape.role for view in mechanism.shapes.get(key, ())}
        for code, role in ((codes.NO_VISUAL, parts.Role.VISUAL), (codes.NO_COLLISION, parts.Role.COLLISION)):
            if not roles & {role, parts.Role.BOTH}:
                found.error(code, key, f"{key} has no {role.value} shape")
        if body.inertial is None or not body.inertial.mass or body.inertial.tensor is None:
            found.error(codes.NO_INERTIA, key, f"{key} has no mass with an inertia tensor")


def _check_presence(found: _Findings, role: parts.Role) -> None:
    """Bodies with a mass have a shape of this role."""
    code = codes.NO_VISUAL if role is parts.Role.VISUAL else codes.NO_COLLISION
    for key, body in found.mechanism.vertices(parts.Body):
        shapes = found.mechanism.shapes.get(key, ())
        heavy = body.inertial is not None and (body.inertial.mass or 0.0) > 0.0
        if heavy and not any(view.shape.role in (role, parts.Role.BOTH) for view in shapes):
            found.warn(code, key, f"{key} has a mass and no {role.value} shape")


def _check_size(found: _Findings, view: ShapeView) -> None:
    """Sizes are positive and not absurd."""
    sizes = _sizes(view.shape.geometry)
    label = f"{with_article(type(view.shape.geometry).__name__.lower())} of {_owner(view)}"
    if any(not (math.isfinite(size) and size > 0.0) for size in sizes):
        message = f"{label} has the sizes {', '.join(f'{size:g}' for size in sizes)}"
        found.error(codes.BAD_SIZE, view.id, message, "sizes are positive numbers of metres")
    elif any(size > _LARGEST for size in sizes):
        found.warn(codes.BAD_SIZE, view.id, f"{label} is {max(sizes):g} m large", "was it written in millimetres?")


def _sizes(geometry: parts.Geometry) -> tuple[float, ...]:
    match geometry:
        case parts.Box(size) | parts.Ellipsoid(size):
            return size
        case parts.Sphere(radius):
            return (radius,)
        case parts.Cylinder(radius, length) | parts.Capsule(radius, length):
            return radius, length
        case _:
            return ()


def _owner(view: ShapeView) -> str:
    return "the world" if view.body == WORLD else str(view.body)


def _check_mesh(found: _Findings, view: ShapeView, key: Id, files: Files) -> None:
    """The scale is a size, and the file exists."""
    mesh = found.mechanism.vertex(key, parts.Mesh)
    if any(scale == 0.0 or not math.isfinite(scale) for scale in mesh.scale):
        found.error(codes.BAD_SIZE, view.id, f"a mesh of {_owner(view)} has the scale {mesh.scale}")
    if mesh.uri is None or mesh.vertices:
        return
    if files.find(mesh.uri) is None:
        message = f"the mesh '{mesh.uri}' of {_owner(view)} was not found"
        found.warn(codes.ASSET_NOT_FOUND, view.id, message, package_hint(mesh.uri))
    elif view.body != WORLD and suffix_of(mesh.uri) == ".stl":
        _check_unit(found, view, mesh, files)


def _check_unit(found: _Findings, view: ShapeView, mesh: parts.Mesh, files: Files) -> None:
    """A mesh of a file without a unit has the size of a part of a robot."""
    content = read_file(files, mesh.uri or "")
    sizes = None if content is None else extents_of_stl(content[1])
    largest = max((size * abs(scale) for size, scale in zip(sizes or (), mesh.scale, strict=False)), default=0.0)
    if largest > _LARGEST_PART:
        message = f"the mesh '{mesh.uri}' of {_owner(view)} is {largest:g} m large"
        found.warn(codes.BAD_SIZE, view.id, message, "was it written in millimetres? A scale of 0.001 makes them metres")


def _check_files(found: _Findings, files: Files) -> None:
    """Images exist, and the engine of the format that the robot came from reads each file."""
    mechanism = found.mechanism
    row = formats.of_source(mechanism)
    refused = None if row is None or row.refused is None else formats.loaded(row.refused)
    for key, part in mechanism.assets():
        if part.uri is None or (isinstance(part, parts.Mesh) and part.vertices):
            continue
        content = read_file(files, part.uri)
        if content is None and isinstance(part, parts.Texture):
            found.warn(codes.ASSET_NOT_FOUND, key, f"the image '{part.uri}' was not found", package_hint(part.uri))
        reason = None if content is None or refused is None else refused(suffix_of(part.uri), content[1])
        if reason is not None:
            found.error(codes.ASSET_UNREADABLE, key, f"the file '{part.uri}' {reason}")
