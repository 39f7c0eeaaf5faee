"""A mechanism in memory as a kinematic model: for HyMeKo text, which has no other reader, and for robots made in Python.

This is the one reader that is the project's own, and verdicts about its models say so.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

import numpy as np

from hymeko_x.ir import parts
from hymeko_x.ir import tendons as words
from hymeko_x.ir.mechanism import WORLD as WORLD_ID
from hymeko_x.ir.mechanism import Id, JointView, Mechanism, ShapeView, numbers_weight, pose_weight
from hymeko_x.verify.model import (
    CYLINDER,
    INF,
    JOINT,
    PULLEY,
    RELAXED,
    SIDE,
    SITE,
    SPHERE,
    WORLD,
    Array,
    Body,
    Coupling,
    Dof,
    Feature,
    Joint,
    Kind,
    KinematicModel,
    Loop,
    MeshFile,
    Role,
    Shape,
    Spring,
    Step,
    Surface,
    Tendon,
    between_frames,
    grounded,
    point_of,
)
from hymeko_x.verify.spatial import frame_with_z, pose

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.values import Pose

    Placed = tuple[int, Array]
    Said = float | str | tuple[float, ...] | None

_FORCE, _FORCED, _SPRING = "actuatorfrcrange", "actuatorfrclimited", "springlength"
SAYS = frozenset(Feature) - {Feature.ACTUATORS, Feature.TIED_TENDONS}


def from_mechanism(mechanism: Mechanism, *, format: str = "mechanism") -> KinematicModel:
    """The tree, its couplings and loops. A massless root link called ``world`` is the world itself, as for every other reader."""
    places = {WORLD_ID: WORLD}
    bodies = [grounded(shapes=tuple(_shapes(mechanism, WORLD_ID)))]
    for key in mechanism.depth_first():
        view = mechanism.parent_joint.get(key)
        if view is None and key.name == WORLD_ID.name and not _weighs(mechanism, key):
            places[key] = WORLD
            bodies[WORLD] = grounded(shapes=(*bodies[WORLD].shapes, *_shapes(mechanism, key)))
            continue
        places[key] = len(bodies)
        bodies.append(_body(mechanism, key, view, places))
    bare = KinematicModel(mechanism.name, format, "hymeko-x", tuple(bodies))
    dofs, sites = _dof_places(mechanism, bare, places), _frames(mechanism, places)
    return KinematicModel(
        name=mechanism.name,
        format=format,
        engine="hymeko-x (its own reader)",
        bodies=bare.bodies,
        couplings=tuple(_couplings(mechanism, dofs)),
        loops=tuple(_loops(mechanism, places, sites)),
        tendons=_tendons(mechanism, dofs, sites, places),
        says=SAYS,
        trusted=False,
    )


def _weighs(mechanism: Mechanism, key: Id) -> bool:
    inertial = mechanism.vertex(key, parts.Body).inertial
    return inertial is not None and bool(inertial.mass)


def _body(mechanism: Mechanism, key: Id, view: JointView | None, places: Mapping[Id, int]) -> Body:
    inertial = mechanism.vertex(key, parts.Body).inertial
    mass, com, tensor = _inertia(inertial)
    parent = WORLD if view is None else places[view.parent]
    joint = Joint(open=True) if view is None else _joint(view)
    shaped = inertial is None or inertial.tensor is not None or not inertial.mass
    return Body(key.name, parent, joint, mass, com, tensor, tuple(_shapes(mechanism, key)), shaped=shaped)


def _inertia(inertial: parts.Inertial | None) -> tuple[float, Array, Array]:
    if inertial is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    xx, yy, zz, xy, xz, yz = inertial.tensor or (0.0,) * 6
    return inertial.mass or 0.0, np.array(inertial.com), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _matrix(place: Pose) -> Array:
    return pose(np.array(place.xyz), np.array(place.quat))


# ---- joints ----------------------------------------------------------------------------------------------------------


def _joint(view: JointView) -> Joint:
    dofs = tuple(_dof(dof, view) for dof in view.joint.dofs)
    return between_frames(view.id.name, _matrix(view.parent_pose), dofs, _matrix(view.child_pose))


def _dof(dof: parts.Dof, view: JointView) -> Dof:
    limits = dof.limits
    effort = INF if limits.effort is None else limits.effort
    return Dof(
        kind=Kind(dof.kind.value),
        axis=np.array(dof.axis),
        anchor=np.array(dof.anchor),
        ref=dof.ref,
        name=dof.name or (view.id.name if len(view.joint.dofs) == 1 else None),
        lower=-INF if limits.lower is None else limits.lower,
        upper=INF if limits.upper is None else limits.upper,
        velocity=INF if limits.velocity is None else limits.velocity,
        effort=(-effort, effort),
        damping=dof.damping,
        friction=dof.friction,
        armature=dof.armature,
        stiffness=dof.stiffness,
        spring_ref=dof.spring_ref if dof.stiffness else 0.0,
        pitch=dof.pitch,
    )


def _dof_places(mechanism: Mechanism, model: KinematicModel, places: Mapping[Id, int]) -> dict[tuple[Id, str], int]:
    """The dof that a joint and a role mean: by its name, by its number, and without a role the only one."""
    found: dict[tuple[Id, str], int] = {}
    for view in mechanism.joints.values():
        first = model.first_dof[places[view.child]] if view.child in places else 0
        for number, dof in enumerate(view.joint.dofs):
            for role in filter(None, (dof.name, str(number))):
                found.setdefault((view.id, role), first + number)
        if len(view.joint.dofs) == 1:
            found[view.id, ""] = first
    return found


# ---- couplings and loops ---------------------------------------------------------------------------------------------


def _couplings(mechanism: Mechanism, dofs: Mapping[tuple[Id, str], int]) -> Iterator[Coupling]:
    for key, coupling, arcs in mechanism.edges(parts.Coupling):
        follower = next((dofs.get((arc.target, arc.role)) for arc in arcs if arc.sign > 0), None)
        if follower is None or not coupling.active:
            continue
        constant = 0.0
        leaders: list[tuple[int, tuple[float, ...]]] = []
        for arc in arcs:
            if arc.sign >= 0:
                continue
            numbers = numbers_weight(arc) or (0.0, 1.0)
            constant += numbers[0]
            leader = dofs.get((arc.target, arc.role))
            if leader is not None:
                leaders.append((leader, numbers[1:]))
        scale = next((numbers_weight(arc)[0] for arc in arcs if arc.sign > 0 and numbers_weight(arc)), 1.0)
        yield Coupling(follower, constant / scale, tuple((d, tuple(c / scale for c in cs)) for d, cs in leaders), key.name)


def _loops(mechanism: Mechanism, places: Mapping[Id, int], frames: Mapping[Id, tuple[int, Array]]) -> Iterator[Loop]:
    for key, loop, arcs in mechanism.edges(parts.Loop):
        ends = [end for arc in arcs if (end := _end(arc, places, frames)) is not None]
        if not loop.active or len(ends) < 2:
            continue
        kind, words, along = _closure(loop)
        yield Loop(kind, ends[0][0], ends[0][1] @ along, ends[1][0], ends[1][1] @ along, key.name, words)


def _end(arc: RobotArc, places: Mapping[Id, int], frames: Mapping[Id, tuple[int, Array]]) -> tuple[int, Array] | None:
    """The body that an arc of a loop leads to, and the closure's frame on it."""
    if arc.target in frames:
        body, on = frames[arc.target]
        return body, on @ _matrix(pose_weight(arc))
    return (places[arc.target], _matrix(pose_weight(arc))) if arc.target in places else None


def _frames(mechanism: Mechanism, places: Mapping[Id, int]) -> dict[Id, tuple[int, Array]]:
    found: dict[Id, tuple[int, Array]] = {}
    for _, _, arcs in mechanism.edges(parts.Mount):
        body = next((arc for arc in arcs if arc.sign > 0), None)
        thing = next((arc for arc in arcs if arc.sign < 0), None)
        if body is not None and thing is not None and body.target in places:
            found[thing.target] = places[body.target], _matrix(pose_weight(body))
    return found


def _closure(loop: parts.Loop) -> tuple[str, str, Array]:
    """Its kind, words for one that has no kind, and the frame, in those of the closure, whose z axis stays free."""
    if loop.kind in ("connect", "weld"):
        return loop.kind, "", np.eye(4)
    match loop.dofs:
        case ():
            return "weld", "", np.eye(4)
        case (dof,) if dof.kind in (parts.DofKind.HINGE, parts.DofKind.SLIDE):
            return dof.kind.value, "", frame_with_z(np.array(dof.axis), np.array(dof.anchor))
        case dofs:
            return "other", " ".join(dof.kind.value for dof in dofs), np.eye(4)


# ---- shapes ----------------------------------------------------------------------------------------------------------


def _shapes(mechanism: Mechanism, key: Id) -> Iterator[Shape]:
    for view in mechanism.shapes.get(key, ()):
        kind, size = _geometry(view.shape.geometry)
        if kind == "none":
            continue
        mesh = _mesh(mechanism, view)
        yield Shape(kind, Role(view.shape.role.value), _matrix(view.pose), size, view.shape.name, mesh)


def _tendons(
    mechanism: Mechanism, dofs: Mapping[tuple[Id, str], int], sites: Mapping[Id, tuple[int, Array]], places: Mapping[Id, int]
) -> tuple[Tendon, ...]:
    """All tendons; only for them it matters where the shapes are."""
    if next(mechanism.edges(parts.Tendon), None) is None:
        return ()
    return tuple(read_tendons(mechanism, dofs, sites, _placed_shapes(mechanism, places)))


def _placed_shapes(mechanism: Mechanism, places: Mapping[Id, int]) -> dict[Id, tuple[int, Array]]:
    """The body of each shape, and where on it the shape is."""
    return {view.id: (places[key], _matrix(view.pose)) for key, views in mechanism.shapes.items() if key in places for view in views}


def _geometry(geometry: parts.Geometry) -> tuple[str, tuple[float, ...]]:
    match geometry:
        case parts.Box(size):
            return "box", size
        case parts.Sphere(radius):
            return "sphere", (radius,)
        case parts.Cylinder(radius, length):
            return "cylinder", (radius, length)
        case parts.Capsule(radius, length):
            return "capsule", (radius, length)
        case parts.Ellipsoid(radii):
            return "ellipsoid", radii
        case parts.Plane():
            return "plane", ()
        case parts.MeshShape():
            return "mesh", ()
        case parts.NoShape():
            return "none", ()
        case _:
            assert_never(geometry)


def _mesh(mechanism: Mechanism, view: ShapeView) -> Surface | MeshFile | None:
    if view.mesh is None:
        return None
    mesh = mechanism.vertex(view.mesh, parts.Mesh)
    if mesh.vertices and mesh.faces:
        points = np.array(mesh.vertices).reshape(-1, 3) * np.array(mesh.scale)
        return Surface(points, np.array(mesh.faces, dtype=np.intp).reshape(-1, 3))
    return MeshFile(mesh.uri or mesh.name or "", None, mesh.scale)


# ---- tendons ---------------------------------------------------------------------------------------------------------


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
