"""HyMeKo text, its JSON form, and mechanisms in memory, as kinematic models.

HyMeKo text and its JSON form have no other readers than this project's own; verdicts note that. Text that came from another format may
leave values to that format's engine, like inertias to the shapes; they are computed by it, as for every export of such a text.
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, assert_never

import numpy as np
from msgspec.structs import replace

from hymeko_x import codes, formats
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.ir import parts
from hymeko_x.ir import tendons as roles
from hymeko_x.ir.mechanism import WORLD as WORLD_ID
from hymeko_x.ir.mechanism import Id, JointView, Mechanism, ShapeView, numbers_weight, pose_weight
from hymeko_x.ir.notations import UNNAMED, WITHOUT_TENSOR
from hymeko_x.ir.solids import evenly_spread
from hymeko_x.rewrite.context import Options
from hymeko_x.rewrite.differentials import combinations
from hymeko_x.rewrite.efforts import actuator_efforts
from hymeko_x.rewrite.transmissions import commanded
from hymeko_x.source import Source
from hymeko_x.verify import model as m
from hymeko_x.verify.features import Feature
from hymeko_x.verify.model import INF, WORLD, Array, Body, Dof, Kind, KinematicModel, Step, Tendon, point_of, world_body
from hymeko_x.verify.spatial import frame_with_z, pose

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.values import Pose, Vec3
    from hymeko_x.verify.readers.lookup import Lookup

    Placed = Mapping[Id, tuple[int, Array]]
    Parameter = float | str | tuple[float, ...] | None

FEATURES = frozenset(Feature) - {Feature.TIED_TENDONS}

_CONTACT, _CONTACTS = "contact", "contacts"
"""The kind of a sensor of contacts, and what it is called where it does not name what touches."""
_TRANSMISSION = "transmission"
"""The kind of the actuators whose law depends on the program that commands them."""


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """The robot in a text. Raises: Refusal HX302 when it cannot be read."""
    files = lookup.files(path.parent)
    source = Source(str(path), path.read_bytes(), files)
    format = formats.of_input(source.name, source.data)
    kind = "HyMeKo text" if format is formats.OWN else f"{format.name} document"
    try:
        given = formats.loaded(format.imports)(source, Report()) if format.imports else source
        mechanism = formats.loaded(str(format.frontend)).read(given, Report()).mechanism
    except Refusal as refusal:
        raise refuse(codes.ENGINE_REFUSED, f"the {kind} cannot be read: {refusal.diagnostic}", Origin(str(path))) from refusal
    if WORLD_ID not in mechanism.graph.vertices and next(mechanism.vertices(parts.Body), None) is None:
        raise refuse(codes.ENGINE_REFUSED, f"the {kind} describes a hypergraph without bodies, which is no robot", Origin(str(path)))
    native = formats.native_format(mechanism)
    if native is not None and native.completes is not None and native.backend is not None:
        write = formats.loaded(native.backend).write
        completed = formats.loaded(native.completes)(
            mechanism, lambda: (mechanism, write(mechanism, Options(), Report()).main), files, Report()
        )
        return from_mechanism(completed, format=format.name)
    return from_mechanism(mechanism, format=format.name)


def from_mechanism(mechanism: Mechanism, *, format: str = "mechanism") -> KinematicModel:
    """The tree, its couplings and loops. A massless root link called ``world`` is the world itself, as for every other reader."""
    numbers = {WORLD_ID: WORLD}
    efforts = actuator_efforts(mechanism)
    bodies = [world_body(shapes=tuple(_shapes(mechanism, WORLD_ID)))]
    for key in mechanism.depth_first():
        view = mechanism.parent_joint.get(key)
        inertial = mechanism.vertex(key, parts.Body).inertial
        if view is None and key.name == WORLD_ID.name and not (inertial is not None and inertial.mass):
            numbers[key] = WORLD
            bodies[WORLD] = world_body(shapes=(*bodies[WORLD].shapes, *_shapes(mechanism, key)))
            continue
        numbers[key] = len(bodies)
        bodies.append(_body(mechanism, key, view, inertial, numbers, efforts))
    bare = KinematicModel(mechanism.name, format, "hymeko-x", tuple(bodies))
    dofs, frames = _dof_numbers(mechanism, bare, numbers), _frames(mechanism, numbers)
    return KinematicModel(
        name=mechanism.name,
        format=format,
        engine="hymeko-x (its own reader)",
        bodies=bare.bodies,
        couplings=tuple(_couplings(mechanism, dofs)),
        loops=tuple(_loops(mechanism, numbers, frames)),
        actuators=tuple(_actuators(mechanism)),
        sensors=tuple(_sensors(mechanism)),
        tendons=tuple(_tendons(mechanism, dofs, frames, numbers)),
        features=FEATURES,
        is_independent=False,
    )


def _actuators(mechanism: Mechanism) -> Iterator[m.Record]:
    """The actuators; of transmissions those that simulators have, without their law, which the text does not give."""
    yield from _records(mechanism, [key for key, part in mechanism.vertices(parts.Actuator) if part.kind != _TRANSMISSION])
    yield from (m.Record(key.name, (), ()) for key in (*commanded(mechanism), *combinations(mechanism)))


def _sensors(mechanism: Mechanism) -> Iterator[m.Record]:
    """The sensors; SDF's contact sensor reports all contacts of a link, MuJoCo's those between elements that it names by their roles."""
    keys = {key: sensor.kind for key, sensor in mechanism.vertices(parts.Sensor)}
    of_mujoco = {arc.target for _, _, arcs in mechanism.edges(parts.Sense) if any(arc.role for arc in arcs) for arc in arcs}
    for key, record in zip(keys, _records(mechanism, keys), strict=True):
        yield replace(record, kind=_CONTACTS if keys[key] == _CONTACT and key not in of_mujoco else keys[key])


def _records(mechanism: Mechanism, keys: Iterable[Id]) -> Iterator[m.Record]:
    """Elements of which only the names are compared; None for those that have none in their source."""
    for key in keys:
        yield m.Record(None if mechanism.notation(key, UNNAMED) is not None else key.name, (), ())


def _body(
    mechanism: Mechanism,
    key: Id,
    view: JointView | None,
    inertial: parts.Inertial | None,
    numbers: Mapping[Id, int],
    efforts: Mapping[tuple[Id, int], float],
) -> Body:
    inertial = inertial or parts.Inertial(0.0)
    xx, yy, zz, xy, xz, yz = inertial.tensor or (0.0,) * 6
    return Body(
        key.name,
        WORLD if view is None else numbers[view.parent],
        m.Joint(open=True) if view is None else _joint(view, efforts),
        inertial.mass or 0.0,
        np.array(_centre(mechanism, key, inertial)),
        np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
        tuple(_shapes(mechanism, key)),
        tensor_is_known=inertial.tensor is not None or not inertial.mass,
    )


def _centre(mechanism: Mechanism, key: Id, inertial: parts.Inertial) -> Vec3:
    """The centre of mass: that of the shapes where a body has a mass without centre and tensor that its source leaves to the shapes."""
    stays = inertial.tensor is not None or any(inertial.com) or mechanism.notation(key, WITHOUT_TENSOR)
    if stays or not inertial.mass:
        return inertial.com
    spread = evenly_spread(mechanism.shapes.get(key, ()))
    return inertial.com if spread is None else spread.com


def _matrix(value: Pose) -> Array:
    return pose(np.array(value.xyz), np.array(value.quat))


# ---- joints ----------------------------------------------------------------------------------------------------------


def _joint(view: JointView, efforts: Mapping[tuple[Id, int], float]) -> m.Joint:
    dofs = tuple(_dof(dof, view, efforts.get((view.id, number), INF)) for number, dof in enumerate(view.joint.dofs))
    return m.between_frames(view.id.name, _matrix(view.parent_pose), dofs, _matrix(view.child_pose))


def _dof(dof: parts.Dof, view: JointView, driven: float) -> Dof:
    """The dof; ``driven`` is what its actuators can exert on it."""
    limits = dof.limits
    effort = _or(limits.effort, INF)
    return Dof(
        kind=Kind(dof.kind.value),
        axis=np.array(dof.axis),
        anchor=np.array(dof.anchor),
        ref=dof.ref,
        name=dof.name or (view.id.name if len(view.joint.dofs) == 1 else None),
        lower=_or(limits.lower, -INF),
        upper=_or(limits.upper, INF),
        velocity=_or(limits.velocity, INF),
        effort=(-effort, effort),
        driven=driven,
        damping=dof.damping,
        friction=dof.friction,
        armature=dof.armature,
        stiffness=dof.stiffness,
        spring_ref=dof.spring_ref if dof.stiffness else 0.0,
        pitch=dof.pitch,
    )


def _or(value: float | None, default: float) -> float:
    return default if value is None else value


def _dof_numbers(mechanism: Mechanism, model: KinematicModel, numbers: Mapping[Id, int]) -> dict[tuple[Id, str], int]:
    """The dof of a joint and a role: by its name, by its number, and without a role the only one."""
    found: dict[tuple[Id, str], int] = {}
    for view in mechanism.joints.values():
        first = model.first_dof[numbers[view.child]] if view.child in numbers else 0
        for number, dof in enumerate(view.joint.dofs):
            for role in filter(None, (dof.name, str(number))):
                found.setdefault((view.id, role), first + number)
        if len(view.joint.dofs) == 1:
            found[view.id, ""] = first
    return found


# ---- couplings and loops ---------------------------------------------------------------------------------------------


def _couplings(mechanism: Mechanism, dofs: Mapping[tuple[Id, str], int]) -> Iterator[m.Coupling]:
    for key, coupling, arcs in mechanism.edges(parts.Coupling):
        follower = next((dofs.get((arc.target, arc.role)) for arc in arcs if arc.sign > 0), None)
        if follower is None or not coupling.active:
            continue
        constant = 0.0
        leaders: list[tuple[int, tuple[float, ...]]] = []
        for arc in arcs:
            if arc.sign >= 0:
                continue
            coefficients = numbers_weight(arc) or (0.0, 1.0)
            constant += coefficients[0]
            leader = dofs.get((arc.target, arc.role))
            if leader is not None:
                leaders.append((leader, coefficients[1:]))
        scale = next((numbers_weight(arc)[0] for arc in arcs if arc.sign > 0 and numbers_weight(arc)), 1.0)
        yield m.Coupling(follower, constant / scale, tuple((d, tuple(c / scale for c in cs)) for d, cs in leaders), key.name)


def _loops(mechanism: Mechanism, numbers: Mapping[Id, int], frames: Placed) -> Iterator[m.Loop]:
    """The closures; one of several bodies joins the first with each of the others, of which the second has its name."""
    for key, loop, arcs in mechanism.edges(parts.Loop):
        ends = [end for arc in arcs if (end := _end(arc, numbers, frames)) is not None]
        if not loop.active or len(ends) < 2:
            continue
        kind, words, along = _closure(loop)
        (body, pose), *others = ends
        for number, (other, place) in enumerate(others):
            yield m.Loop(kind, body, pose @ along, other, place @ along, None if number else key.name, words)


def _end(arc: RobotArc, numbers: Mapping[Id, int], frames: Placed) -> tuple[int, Array] | None:
    """The body that an arc of a loop leads to, and the closure's frame on it."""
    if arc.target in frames:
        body, on = frames[arc.target]
        return body, on @ _matrix(pose_weight(arc))
    return (numbers[arc.target], _matrix(pose_weight(arc))) if arc.target in numbers else None


def _frames(mechanism: Mechanism, numbers: Mapping[Id, int]) -> Placed:
    """The body of each mounted element, and its pose there."""
    views = chain.from_iterable(mechanism.mounts.values())
    return {view.mounted: (numbers[view.body], _matrix(view.pose)) for view in views if view.body in numbers}


def _closure(loop: parts.Loop) -> tuple[str, str, Array]:
    """Its kind, the names of the free motions of one without a kind, and the frame in the closure's whose z axis stays free."""
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


def _shapes(mechanism: Mechanism, key: Id) -> Iterator[m.Shape]:
    for view in mechanism.shapes.get(key, ()):
        kind, size = _geometry(view.shape.geometry)
        if kind != "none":
            yield m.Shape(kind, m.Role(view.shape.role.value), _matrix(view.pose), size, view.shape.name, _mesh(mechanism, view))


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


def _mesh(mechanism: Mechanism, view: ShapeView) -> m.Surface | m.MeshFile | None:
    if view.mesh is None:
        return None
    mesh = mechanism.vertex(view.mesh, parts.Mesh)
    if mesh.vertices and mesh.faces:
        points = np.array(mesh.vertices).reshape(-1, 3) * np.array(mesh.scale)
        return m.Surface(points, np.array(mesh.faces, dtype=np.intp).reshape(-1, 3))
    return m.MeshFile(mesh.uri or mesh.name or "", None, mesh.scale)


# ---- tendons ---------------------------------------------------------------------------------------------------------


def _tendons(mechanism: Mechanism, dofs: Mapping[tuple[Id, str], int], sites: Placed, numbers: Mapping[Id, int]) -> Iterator[Tendon]:
    """Every tendon of whose steps all targets are there, and those on which transmissions of two joints are written."""
    found = list(mechanism.edges(parts.Tendon))
    found += [(key, parts.Tendon(roles.FIXED), arcs) for key, arcs in combinations(mechanism).items()]
    bodies = [(key, views) for key, views in mechanism.shapes.items() if found and key in numbers]
    shapes = {view.id: (numbers[key], _matrix(view.pose)) for key, views in bodies for view in views}
    for key, tendon, arcs in found:
        steps = [_step(mechanism, arc, dofs, sites, shapes) for arc in arcs]
        path = tuple(step for step in steps if step is not None)
        if len(path) == len(steps):
            yield _tendon(key.name, tendon, path)


def _tendon(name: str, tendon: parts.Tendon, path: tuple[Step, ...]) -> Tendon:
    parameters = dict(tendon.parameters)
    lower, upper = tendon.limits.lower, tendon.limits.upper
    force = parameters.get("actuatorfrcrange")
    limits_force = isinstance(force, tuple) and len(force) == 2 and parameters.get("actuatorfrclimited", "auto") != "false"
    return Tendon(
        name,
        path,
        (tendon.stiffness, tendon.damping, tendon.friction, tendon.armature),
        None if lower is None and upper is None else (_or(lower, -INF), _or(upper, INF)),
        (force[0], force[1]) if limits_force and isinstance(force, tuple) else None,
        _spring(parameters.get("springlength")) if tendon.stiffness else m.RELAXED,
    )


def _spring(value: Parameter) -> m.SpringRange:
    """One length, or two; -1 and nothing are the length at rest."""
    lengths = value if isinstance(value, tuple) else (value,) if isinstance(value, float) else ()
    if not lengths or lengths[0] == -1.0:
        return m.RELAXED
    return m.SpringRange((lengths[0], lengths[-1]), at_rest=False)


def _step(mechanism: Mechanism, arc: RobotArc, dofs: Mapping[tuple[Id, str], int], sites: Placed, shapes: Placed) -> Step | None:
    """The step of an arc; None where its target is missing."""
    if arc.role == roles.PULLEY:
        return Step(m.PULLEY, number=numbers_weight(arc)[0])
    if arc.target in sites:
        body, at = sites[arc.target]
        return Step(m.SIDE if arc.role == roles.SIDE else m.SITE, body, point=point_of(at[:3, 3]))
    if arc.target in shapes:
        body, at = shapes[arc.target]
        match mechanism.graph.edges[arc.target].data:
            case parts.Shape(parts.Sphere(radius)):
                return Step(m.SPHERE, body, radius, point_of(at[:3, 3]))
            case parts.Shape(parts.Cylinder(radius, _)):
                return Step(m.CYLINDER, body, radius, point_of(at[:3, 3]), point_of(at[:3, 2]))
            case _:
                return None
    dof = dofs.get((arc.target, arc.role))
    return None if dof is None else Step(m.JOINT, dof, numbers_weight(arc)[0])
