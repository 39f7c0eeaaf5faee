"""A robot of another size: every number by its dimension, where lengths grow by s, masses by s^3, and times stay."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats, pipeline
from hymeko_x.ir.geometry import Box, Capsule, Cylinder, Ellipsoid, Plane, Sphere
from hymeko_x.ir.graph import Edge, Hypergraph
from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import has_numbers
from hymeko_x.ir.parts import Body, Contact, Coupling, Dof, DofKind, Frame, Joint, Limits, Loop, Mesh, Shape, Stance, Tendon
from hymeko_x.ir.tendons import FIXED
from hymeko_x.ir.values import Pose, Written
from hymeko_x.robot.errors import EditError
from hymeko_x.states import with_states

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.geometry import Geometry
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import EdgePart, Inertial, Parameters, VertexPart


Parameter = float | str | tuple[float, ...]


def scale(mechanism: Mechanism, s: float) -> Mechanism:
    """The mechanism with lengths times ``s``. Raises: EditError unless the factor is a positive number."""
    if not (math.isfinite(s) and s > 0):
        raise EditError(f"robot '{mechanism.name}': a factor is a positive number, found {s!r}")
    mechanism = _with_extras(mechanism, s)
    vertices = {key: _vertex(part, s) for key, part in mechanism.graph.vertices.items()}
    edges = {key: _edge(edge, mechanism, s) for key, edge in mechanism.graph.edges.items()}
    big = replace(mechanism, graph=Hypergraph(vertices, edges))
    return with_states(big, mechanism, lambda word, key, numbers: (key, _state(word, key, numbers, mechanism, s)))


def _with_extras(mechanism: Mechanism, s: float) -> Mechanism:
    """The mechanism whose extras have the new size already, as far as their format gives their dimensions."""
    row = formats.native_format(mechanism)
    if row is None or row.resizes is None:
        return mechanism

    def factor(key: Id, number: int) -> float:
        edge = mechanism.graph.edges.get(key)
        if edge is not None and isinstance(edge.data, Joint | Coupling):
            found = edge.data.dofs[number : number + 1] if isinstance(edge.data, Joint) else ()
            return _length(found[0], s) if found else _length_of(edge.arcs[0], mechanism, s) if edge.arcs else 1.0
        return s

    resized: Mechanism | None = formats.loaded(row.resizes)(mechanism, s, factor)
    if resized is not None:
        return resized
    mechanism = pipeline.flattened(mechanism)
    return formats.loaded(row.resizes)(mechanism, s, factor) or mechanism


def _state(word: str, key: Id | None, numbers: tuple[float, ...], mechanism: Mechanism, s: float) -> tuple[float, ...]:
    """The numbers of a joint, or of a mocap body, in a named configuration."""
    if key is None:
        return _times(numbers, s) if word == "mpos" else numbers
    if key not in mechanism.joints:
        return numbers
    return tuple(_coordinates(mechanism.joints[key].joint, numbers, s, turns=3 if word == "qvel" else 4))


def _times(numbers: tuple[float, ...], factor: float) -> tuple[float, ...]:
    return tuple([number * factor for number in numbers])


def _vertex(part: VertexPart, s: float) -> VertexPart:
    if isinstance(part, Body) and part.inertial is not None:
        return replace(part, inertial=_inertial(part.inertial, s))
    if isinstance(part, Frame):
        return replace(part, size=_times(part.size, s))
    if isinstance(part, Mesh):
        return replace(part, scale=_times(part.scale, s))
    return part


def _inertial(inertial: Inertial, s: float) -> Inertial:
    mass = None if inertial.mass is None else inertial.mass * s**3
    tensor = None if inertial.tensor is None else _times(inertial.tensor, s**5)
    return replace(inertial, mass=mass, com=_times(inertial.com, s), tensor=tensor, written=None)


def _edge(edge: RobotEdge, mechanism: Mechanism, s: float) -> RobotEdge:
    data = _edge_part(edge.data, s)
    arcs = tuple([_arc(arc, edge.data, mechanism, s) for arc in edge.arcs])
    if isinstance(data, Tendon):
        lengths = [_length_of(arc, mechanism, s) for arc in arcs]
        is_angle = data.kind == FIXED and 1.0 in lengths
        data = _tendon(data, 1.0 if is_angle else s, s)
        arcs = tuple([_over(arc, length) for arc, length in zip(arcs, lengths, strict=True)]) if is_angle else arcs
    if isinstance(data, Coupling) and arcs:
        arcs = (arcs[0], *(_leader(arc, arcs[0], mechanism, s) for arc in arcs[1:]))
    return Edge(data, arcs)


def _edge_part(part: EdgePart, s: float) -> EdgePart:
    if isinstance(part, Joint):
        return replace(part, dofs=tuple([_dof(dof, s) for dof in part.dofs]))
    if isinstance(part, Loop):
        return replace(part, dofs=tuple([_dof(dof, s) for dof in part.dofs]), parameters=_parameters(part.parameters, s))
    if isinstance(part, Contact):
        return replace(part, parameters=_parameters(part.parameters, s, friction=s))
    if isinstance(part, Shape):
        mass = None if part.mass is None else part.mass * s**3
        friction = (*part.friction[:1], *_times(part.friction[1:], s))  # torsional and rolling ones are lengths
        return replace(part, geometry=_geometry(part.geometry, s), mass=mass, friction=friction)
    return part


def _parameters(parameters: Parameters, s: float, **rests: float) -> Parameters:
    """Parameters of constraints: margins, gaps and the widths of impedances are lengths, and so is what a torque is divided by.

    ``rests`` are the factors on further ones.
    """
    found = {"margin": s, "gap": s, "torquescale": s, "solimp": s, "solimplimit": s, **rests}
    return tuple([(name, _parameter(name, value, found[name]) if name in found else value) for name, value in parameters])


def _parameter(name: str, value: Parameter, factor: float) -> Parameter:
    """A parameter times a factor, of an impedance its width; one of MuJoCo's -1, which means that it is computed, stays."""
    if not isinstance(value, tuple):
        return value * factor if isinstance(value, float) and value != -1.0 else value
    first, end = _SCALED.get(name, (0, len(value)))
    inner = [number if number == -1.0 else number * factor for number in value[first:end]]
    return (*value[:first], *inner, *value[end:])


_SCALED: Mapping[str, tuple[int, int]] = MappingProxyType({"solimp": (2, 3), "solimplimit": (2, 3), "friction": (2, 5)})
"""Which numbers of parameters that have several are lengths: of a contact's friction the torsional and the rolling ones."""


def _tendon(part: Tendon, length: float, s: float) -> Tendon:
    """``length`` is the factor on what it measures: paths and combinations of slides are lengths, other combinations are angles."""
    moment = s**5 / length**2
    return replace(
        part,
        limits=_limits(part.limits, length, moment * length),
        damping=part.damping * moment,
        stiffness=part.stiffness * moment,
        friction=part.friction * moment * length,
        armature=part.armature * moment,
        width=None if part.width is None else part.width * s,
        parameters=_parameters(part.parameters, length, springlength=length),
    )


def _geometry(geometry: Geometry, s: float) -> Geometry:
    match geometry:
        case Box(size):
            return Box(_times(size, s))  # type: ignore[arg-type]
        case Sphere(radius):
            return Sphere(radius * s)
        case Cylinder(radius, length):
            return Cylinder(radius * s, length * s)
        case Capsule(radius, length):
            return Capsule(radius * s, length * s)
        case Ellipsoid(radii):
            return Ellipsoid(_times(radii, s))  # type: ignore[arg-type]
        case Plane(half_size):
            return Plane(_times(half_size, s))  # type: ignore[arg-type]
        case _:
            return geometry


def _limits(limits: Limits, length: float, force: float) -> Limits:
    def times(value: float | None, factor: float) -> float | None:
        return None if value is None else value * factor

    return Limits(
        times(limits.lower, length),
        times(limits.upper, length),
        times(limits.velocity, length),
        times(limits.effort, force),
        times(limits.acceleration, length),
        times(limits.jerk, length),
    )


def _dof(dof: Dof, s: float) -> Dof:
    """Coordinates of a slide are lengths and its efforts forces; those of other dofs are angles and torques."""
    length = _length(dof, s)
    moment = s**5 / length**2
    return replace(
        dof,
        limits=_limits(dof.limits, length, moment * length),
        damping=dof.damping * moment,
        friction=dof.friction * moment * length,
        stiffness=dof.stiffness * moment,
        spring_ref=dof.spring_ref * length,
        armature=dof.armature * moment,
        ref=dof.ref * length,
        anchor=_times(dof.anchor, s),
        pitch=dof.pitch * s,
    )


def _length(dof: Dof, s: float) -> float:
    """The factor on the coordinate of a dof."""
    return s if dof.kind is DofKind.SLIDE else 1.0


def _arc(arc: RobotArc, part: EdgePart, mechanism: Mechanism, s: float) -> RobotArc:
    if isinstance(arc.weight, Pose):
        return replace(arc, weight=_pose(arc.weight, s))
    if isinstance(part, Stance) and has_numbers(arc.weight) and arc.target in mechanism.joints:
        return replace(arc, weight=tuple(_coordinates(mechanism.joints[arc.target].joint, arc.weight, s)))
    return arc


def _pose(pose: Pose, s: float) -> Pose:
    written = pose.written
    if written is not None and written.kind == "fromto":
        written = Written("fromto", _times(written.numbers, s))
    return Pose(_times(pose.xyz, s), pose.quat, written)  # type: ignore[arg-type]


def _coordinates(joint: Joint, numbers: tuple[float, ...], s: float, *, turns: int = 4) -> list[float]:
    """The coordinates of a joint, or its velocities; ``turns`` is how many numbers a rotation has."""
    factors: list[float] = []
    for dof in joint.dofs:
        factors += [s] * 3 + [1.0] * turns if dof.kind is DofKind.FREE else [1.0] * turns if dof.kind is DofKind.BALL else [_length(dof, s)]
    return [number * factor for number, factor in zip(numbers, factors, strict=False)] + list(numbers[len(factors) :])


def _leader(arc: RobotArc, follower: RobotArc, mechanism: Mechanism, s: float) -> RobotArc:
    """Coefficient k of a coupling has the dimension of the follower divided by that of the leader to the power k."""
    own, other = (_length_of(end, mechanism, s) for end in (follower, arc))
    if not has_numbers(arc.weight):
        return arc
    return replace(arc, weight=tuple([number * own / other**power for power, number in enumerate(arc.weight)]))


def _over(arc: RobotArc, length: float) -> RobotArc:
    """The arc of a combination that stays an angle: what its coefficients are multiplied by has grown by ``length``."""
    return replace(arc, weight=tuple([number / length for number in arc.weight])) if has_numbers(arc.weight) else arc


def _length_of(arc: RobotArc, mechanism: Mechanism, s: float) -> float:
    found = dof_at(mechanism.graph.edges, arc)
    return 1.0 if found is None else _length(found[1], s)
