"""One change to a robot: what makes it another one, which check has to see that, and at which of its elements."""

from __future__ import annotations

from collections.abc import Callable

from hypothesis import strategies as st
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotEdge, ShapeView, coupling_edge, joint_edge, shape_edge
from hymeko_x.ir.names import rename
from hymeko_x.ir.values import Pose, X, Y, Z, add, compose, quat_about
from hymeko_x.verify.features import Feature

POSITION, ROTATION = "forward kinematics, position", "forward kinematics, rotation"


class Change(Struct, frozen=True):
    """The changed robot, and the names one of which a failed check of this quantity has to say; ``feature`` where not all formats can."""

    robot: Mechanism
    quantity: str
    names: tuple[str, ...]
    feature: Feature | None = None


Planter = Callable[[st.DrawFn, Mechanism], Change | None]

_BY = st.sampled_from([-0.5, -0.05, 1e-3, 0.05, 0.5])
"""By how much something moves or turns, in m or rad, and by which part a number grows."""
_ALONG = st.sampled_from([X, Y, Z])


def _pick(draw: st.DrawFn, found: list[JointView]) -> JointView | None:
    return draw(st.sampled_from(found)) if found else None


def _joint(draw: st.DrawFn, robot: Mechanism) -> JointView | None:
    """A joint between two bodies."""
    return _pick(draw, [view for view in robot.joints.values() if view.parent.kind == "body"])


def _moving(draw: st.DrawFn, robot: Mechanism) -> JointView | None:
    return _pick(draw, [view for view in robot.joints.values() if view.joint.dofs])


def _free(draw: st.DrawFn, robot: Mechanism) -> JointView | None:
    """A joint that moves and neither follows nor leads."""
    bound = {arc.target for _, _, arcs in robot.edges(parts.Coupling) for arc in arcs}
    return _pick(draw, [view for view in robot.joints.values() if view.joint.dofs and view.id not in bound])


def _below(robot: Mechanism, body: Id) -> tuple[str, ...]:
    """A body and everything below it."""
    found = [body]
    for name in found:
        found += [view.child for view in robot.children.get(name, ())]
    return tuple(f"body '{name.name}'" for name in found)


def _with(robot: Mechanism, key: Id, edge: RobotEdge) -> Mechanism:
    return robot.replace(edges={key: edge})


def _placed(robot: Mechanism, view: JointView, pose: Pose) -> Mechanism:
    return _with(robot, view.id, joint_edge(view.joint, view.parent, view.child, pose))


def _with_dof(robot: Mechanism, view: JointView, dof: parts.Dof) -> Mechanism:
    return _with(robot, view.id, joint_edge(parts.Joint((dof,)), view.parent, view.child, view.parent_pose))


# ---- where things are ---------------------------------------------------------------------------------------------------------


def origin_moved(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    view = _joint(draw, robot)
    if view is None:
        return None
    step = tuple(draw(_BY) * part for part in draw(_ALONG))
    pose = replace(view.parent_pose, xyz=add(view.parent_pose.xyz, step))  # type: ignore[arg-type]
    return Change(_placed(robot, view, pose), POSITION, _below(robot, view.child))


def origin_turned(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    view = _joint(draw, robot)
    if view is None:
        return None
    pose = compose(view.parent_pose, Pose(quat=quat_about(draw(_ALONG), draw(_BY))))
    return Change(_placed(robot, view, pose), ROTATION, _below(robot, view.child))


def axis_turned(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    """Another axis; the other way round it is another one as well."""
    view = _moving(draw, robot)
    if view is None:
        return None
    (dof,) = view.joint.dofs
    x, y, z = dof.axis
    axis = draw(st.sampled_from([(-x, -y, -z), (y, z, x), (z, x, y)]).filter(lambda other: other != dof.axis))
    quantity = POSITION if dof.kind is parts.DofKind.SLIDE else ROTATION
    return Change(_with_dof(robot, view, replace(dof, axis=axis)), quantity, _below(robot, view.child))


def another_parent(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    view = _joint(draw, robot)
    if view is None:
        return None
    own = set(_below(robot, view.child))
    others = [key for key, _ in robot.vertices(parts.Body) if key != view.parent and f"body '{key.name}'" not in own]
    if not others:
        return None
    edge = joint_edge(view.joint, draw(st.sampled_from(others)), view.child, view.parent_pose)
    return Change(_with(robot, view.id, edge), "joints", (f"body '{view.child.name}'",))


# ---- how things move ----------------------------------------------------------------------------------------------------------


def another_kind(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    """A hinge that slides, a slide that turns, or either of them fixed."""
    view = _free(draw, robot)
    if view is None:
        return None
    (dof,) = view.joint.dofs
    other = parts.DofKind.SLIDE if dof.kind is parts.DofKind.HINGE else parts.DofKind.HINGE
    joint = draw(st.sampled_from([parts.Joint(), parts.Joint((replace(dof, kind=other),))]))
    edge = joint_edge(joint, view.parent, view.child, view.parent_pose)
    return Change(_with(robot, view.id, edge), "joints", (f"joint '{view.id.name}'",))


def _limit(name: str, quantity: str, feature: Feature | None = None) -> Planter:
    def plant(draw: st.DrawFn, robot: Mechanism) -> Change | None:
        view = _moving(draw, robot)
        if view is None:
            return None
        (dof,) = view.joint.dofs
        limits = replace(dof.limits, **{name: getattr(dof.limits, name) * (1.0 + draw(_BY))})
        return Change(_with_dof(robot, view, replace(dof, limits=limits)), quantity, (f"joint '{view.id.name}'",), feature)

    return plant


def without_limits(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    view = _free(draw, robot)
    if view is None or view.joint.dofs[0].kind is not parts.DofKind.HINGE:
        return None
    (dof,) = view.joint.dofs
    limits = replace(dof.limits, lower=None, upper=None)
    return Change(_with_dof(robot, view, replace(dof, limits=limits)), "position limits", (f"joint '{view.id.name}'",))


def _mechanics(name: str, feature: Feature) -> Planter:
    def plant(draw: st.DrawFn, robot: Mechanism) -> Change | None:
        view = _moving(draw, robot)
        if view is None:
            return None
        (dof,) = view.joint.dofs
        value = getattr(dof, name) * (1.0 + draw(_BY))
        return Change(_with_dof(robot, view, replace(dof, **{name: value})), name, (f"joint '{view.id.name}'",), feature)

    return plant


def _coupling(change: Callable[[st.DrawFn, float, float], tuple[float, float]]) -> Planter:
    def plant(draw: st.DrawFn, robot: Mechanism) -> Change | None:
        for key, _, arcs in robot.edges(parts.Coupling):
            follower, leader = arcs
            assert isinstance(leader.weight, tuple)
            offset, factor = leader.weight
            edge = coupling_edge(follower.target, ((leader.target, change(draw, offset, factor)),))
            return Change(_with(robot, key, edge), "coupled coordinates", (f"joint '{follower.target.name}'",))
        return None

    return plant


def follows_nothing(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    for key, _, arcs in robot.edges(parts.Coupling):
        changed = robot.replace(without=[key])
        return Change(changed, "couplings", (f"joint '{arcs[0].target.name}'",))
    return None


# ---- what things weigh --------------------------------------------------------------------------------------------------------


def _inertial(quantity: str, change: Callable[[st.DrawFn, parts.Inertial], parts.Inertial]) -> Planter:
    def plant(draw: st.DrawFn, robot: Mechanism) -> Change | None:
        key, body = draw(st.sampled_from(list(robot.vertices(parts.Body))))
        assert body.inertial is not None
        changed = robot.replace(vertices={key: parts.Body(change(draw, body.inertial))})
        return Change(changed, quantity, (f"body '{key.name}'",))

    return plant


def _heavier(draw: st.DrawFn, inertial: parts.Inertial) -> parts.Inertial:
    assert inertial.mass is not None
    return replace(inertial, mass=inertial.mass * (1.0 + draw(_BY)))


def _off_centre(draw: st.DrawFn, inertial: parts.Inertial) -> parts.Inertial:
    x, y, z = (draw(_BY) * part for part in draw(_ALONG))
    return replace(inertial, com=add(inertial.com, (x, y, z)))


def _rounder(draw: st.DrawFn, inertial: parts.Inertial) -> parts.Inertial:
    """One entry of the tensor is another one, by little enough that it remains one of a body."""
    assert inertial.tensor is not None
    entry, by = draw(st.integers(0, 5)), draw(st.sampled_from([-0.02, -1e-3, 1e-3, 0.02]))
    entries = [value + by * (place == entry) for place, value in enumerate(inertial.tensor)]
    return replace(inertial, tensor=tuple(entries))  # type: ignore[arg-type]


# ---- what things look like ----------------------------------------------------------------------------------------------------


def _shape(change: Callable[[st.DrawFn, ShapeView], RobotEdge | None], words: str) -> Planter:
    """``words`` end the name of the check."""

    def plant(draw: st.DrawFn, robot: Mechanism) -> Change | None:
        found = [(body, view) for body, views in robot.shapes.items() for view in views]
        if not found:
            return None
        body, view = draw(st.sampled_from(found))
        edge = change(draw, view)
        if edge is None:
            return None
        return Change(_with(robot, view.id, edge), f"{view.shape.role.value} shapes{words}", (f"body '{body.name}'",))

    return plant


def without_a_shape(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    found = [(body, view) for body, views in robot.shapes.items() for view in views]
    if not found:
        return None
    body, view = draw(st.sampled_from(found))
    changed = robot.replace(without=[view.id])
    return Change(changed, f"{view.shape.role.value} shapes", (f"body '{body.name}'",))


def _resized(draw: st.DrawFn, view: ShapeView) -> RobotEdge:
    factor = 1.0 + draw(_BY)
    match view.shape.geometry:
        case parts.Box((x, y, z)):
            sizes = draw(st.sampled_from([(x * factor, y, z), (x, y * factor, z), (x, y, z * factor)]))
            geometry: parts.Geometry = parts.Box(sizes)
        case parts.Sphere(radius):
            geometry = parts.Sphere(radius * factor)
        case parts.Cylinder(radius, length):
            geometry = draw(st.sampled_from([parts.Cylinder(radius * factor, length), parts.Cylinder(radius, length * factor)]))
        case _:
            raise AssertionError(view)
    return shape_edge(replace(view.shape, geometry=geometry), view.body, view.pose)


def _reshaped(draw: st.DrawFn, view: ShapeView) -> RobotEdge:
    is_round = isinstance(view.shape.geometry, parts.Sphere)
    geometry: parts.Geometry = parts.Box((1.0, 1.0, 1.0)) if is_round else parts.Sphere(1.0)
    return shape_edge(replace(view.shape, geometry=geometry), view.body, view.pose)


def _shape_moved(draw: st.DrawFn, view: ShapeView) -> RobotEdge:
    x, y, z = (draw(_BY) * part for part in draw(_ALONG))
    return shape_edge(view.shape, view.body, replace(view.pose, xyz=add(view.pose.xyz, (x, y, z))))


def _shape_turned(draw: st.DrawFn, view: ShapeView) -> RobotEdge | None:
    if isinstance(view.shape.geometry, parts.Sphere):
        return None
    return shape_edge(view.shape, view.body, compose(view.pose, Pose(quat=quat_about(draw(st.sampled_from([X, Y])), draw(_BY)))))


# ---- what things are called ---------------------------------------------------------------------------------------------------


def body_renamed(draw: st.DrawFn, robot: Mechanism) -> Change:
    key, _ = draw(st.sampled_from(list(robot.vertices(parts.Body))))
    return Change(rename(robot, {key: Id("body", "another")}), "bodies", (f"body '{key.name}'",))


def joint_renamed(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    view = _free(draw, robot)
    if view is None:
        return None
    return Change(rename(robot, {view.id: Id("joint", "another")}), "joints", (f"joint '{view.id.name}'",))


def without_a_body(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    bound = {arc.target for _, _, arcs in robot.edges(parts.Coupling) for arc in arcs}
    ends = [view for view in robot.joints.values() if view.child not in robot.children and view.id not in bound]
    view = _pick(draw, ends)
    if view is None:
        return None
    gone = [view.id, view.child, *(shape.id for shape in robot.shapes.get(view.child, ()))]
    return Change(robot.replace(without=gone), "bodies", (f"body '{view.child.name}'",))


def another_body(draw: st.DrawFn, robot: Mechanism) -> Change:
    above, body = draw(st.sampled_from(list(robot.vertices(parts.Body))))
    changed = robot.replace(
        vertices={Id("body", "another"): body}, edges={Id("joint", "to another"): joint_edge(parts.Joint(), above, Id("body", "another"))}
    )
    return Change(changed, "bodies", ("body 'another'",))


PLANTERS: dict[str, Planter] = {
    "origin moved": origin_moved,
    "origin turned": origin_turned,
    "axis turned": axis_turned,
    "another parent": another_parent,
    "another kind of joint": another_kind,
    "lower limit": _limit("lower", "position limits"),
    "upper limit": _limit("upper", "position limits"),
    "limits gone": without_limits,
    "velocity limit": _limit("velocity", "velocity limits", Feature.VELOCITY_LIMITS),
    "effort limit": _limit("effort", "effort limits", Feature.EFFORT_LIMITS),
    "damping": _mechanics("damping", Feature.DAMPING),
    "friction": _mechanics("friction", Feature.FRICTION),
    "factor of a follower": _coupling(lambda draw, offset, factor: (offset, factor * (1.0 + draw(_BY)))),
    "offset of a follower": _coupling(lambda draw, offset, factor: (offset + draw(_BY), factor)),
    "follows nothing": follows_nothing,
    "mass": _inertial("mass", _heavier),
    "centre of mass": _inertial("centre of mass", _off_centre),
    "inertia tensor": _inertial("inertia tensor", _rounder),
    "shape gone": without_a_shape,
    "another kind of shape": _shape(_reshaped, ""),
    "size of a shape": _shape(_resized, ", size and pose"),
    "shape moved": _shape(_shape_moved, ", size and pose"),
    "shape turned": _shape(_shape_turned, ", size and pose"),
    "body renamed": body_renamed,
    "joint renamed": joint_renamed,
    "body gone": without_a_body,
    "body new": another_body,
}
"""Every kind of change that all formats can say, or all but those whose readers say that they cannot."""
