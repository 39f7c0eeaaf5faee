"""Robots with tendons, and one change to a tendon of theirs: which check has to see it, and at which tendon."""

from __future__ import annotations

from collections.abc import Callable

from hypothesis import strategies as st
from msgspec.structs import replace

from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, RobotArc, mount_edge, shape_edge
from hymeko_x.ir.names import rename
from hymeko_x.ir.values import Pose, X, Y, Z, add, pose, quat_about
from hymeko_x.testing import arms
from tests.verify.one_change import Change, Planter

SUM, CABLE, DRUM = Id("tendon", "sum"), Id("tendon", "cable"), Id("shape", "drum")
SITES = tuple(Id("frame", f"site {name}") for name in "abc")
_BY = st.sampled_from([-0.5, -0.05, 1e-3, 0.05, 0.5])
_NUMBERS = st.integers(1, 40).map(lambda number: number / 16)
_PLACES = st.tuples(*[st.integers(-40, 40).map(lambda number: number / 16)] * 3)


@st.composite
def cabled(draw: st.DrawFn) -> Mechanism:
    """An arm with a sum of its joints, and a cable from the world over a pulley, through sites and around a ball or a cylinder."""
    robot = draw(arms())
    bodies = [WORLD, *robot.parent_joint]
    places = {site: draw(st.sampled_from(bodies)) for site in SITES}
    edges = {Id("mount", site.name): mount_edge(body, site, Pose(draw(_PLACES))) for site, body in places.items()}
    geometry = draw(st.builds(parts.Sphere, _NUMBERS) | st.builds(parts.Cylinder, _NUMBERS, _NUMBERS))
    at = pose(draw(_PLACES), quat_about(draw(st.sampled_from([X, Y])), draw(st.sampled_from([0.0, 0.5, 2.0]))))
    edges[DRUM] = shape_edge(parts.Shape(geometry, parts.Role.VISUAL, "drum"), draw(st.sampled_from(bodies)), at)
    first, second, third = SITES
    side = (Arc(third, 0, None, "side"),) if draw(st.booleans()) else ()
    pulley = Arc(CABLE, 0, (draw(_NUMBERS) + 2.0,), "pulley")
    path = (Arc(first), Arc(DRUM, 0, None, "wrap"), *side, Arc(second), pulley, Arc(second), Arc(third))
    edges[CABLE] = Edge(draw(_tendons("spatial", armature=0.0)), path)
    moving = [view.id for view in robot.joints.values() if view.joint.dofs]
    edges[SUM] = Edge(draw(_tendons("fixed", armature=draw(_NUMBERS))), tuple(Arc(joint, 1, (draw(_NUMBERS),)) for joint in moving))
    return robot.replace(vertices=dict.fromkeys(SITES, parts.Frame()), edges=edges)


@st.composite
def _tendons(draw: st.DrawFn, kind: str, *, armature: float) -> parts.Tendon:
    lower, force = draw(_NUMBERS), draw(_NUMBERS)
    limits = parts.Limits(lower, lower + draw(_NUMBERS))
    spring = draw(_NUMBERS)
    springs = (spring, spring + 0.5) if draw(st.booleans()) else spring
    parameters = (("springlength", springs), ("actuatorfrcrange", (-force, force)))
    return parts.Tendon(kind, limits, draw(_NUMBERS), draw(_NUMBERS), draw(_NUMBERS), armature, parameters=parameters)


# ---- changes ------------------------------------------------------------------------------------------------------------------


def _with(robot: Mechanism, key: Id, tendon: parts.Tendon, arcs: tuple[RobotArc, ...]) -> Mechanism:
    return robot.replace(edges={key: Edge(tendon, arcs)})


def _of(robot: Mechanism, key: Id) -> tuple[parts.Tendon, tuple[RobotArc, ...]]:
    edge = robot.graph.edges[key]
    assert isinstance(edge.data, parts.Tendon)
    return edge.data, edge.arcs


def _change(quantity: str, key: Id, robot: Mechanism) -> Change:
    return Change(robot, f"tendons, {quantity}" if quantity else "tendons", (f"tendon '{key.name}'",))


def _weight(key: Id, wanted: Callable[[RobotArc], bool]) -> Planter:
    def plant(draw: st.DrawFn, robot: Mechanism) -> Change:
        tendon, arcs = _of(robot, key)
        place = draw(st.sampled_from([place for place, arc in enumerate(arcs) if wanted(arc)]))
        arc = arcs[place]
        assert isinstance(arc.weight, tuple)
        weight = (arc.weight[0] * (1.0 + draw(_BY)),)
        return _change("coefficients", key, _with(robot, key, tendon, (*arcs[:place], replace(arc, weight=weight), *arcs[place + 1 :])))

    return plant


def _number(name: str, *keys: Id) -> Planter:
    def plant(draw: st.DrawFn, robot: Mechanism) -> Change:
        key = draw(st.sampled_from(keys))
        tendon, arcs = _of(robot, key)
        other = replace(tendon, **{name: getattr(tendon, name) * (1.0 + draw(_BY))})  # type: ignore[arg-type]
        return _change(name, key, _with(robot, key, other, arcs))

    return plant


def _limits(change: Callable[[st.DrawFn, parts.Limits], parts.Limits]) -> Planter:
    def plant(draw: st.DrawFn, robot: Mechanism) -> Change:
        key = draw(st.sampled_from([SUM, CABLE]))
        tendon, arcs = _of(robot, key)
        return _change("limits", key, _with(robot, key, replace(tendon, limits=change(draw, tendon.limits)), arcs))

    return plant


def _wider(name: str, sign: float) -> Callable[[st.DrawFn, parts.Limits], parts.Limits]:
    def widen(draw: st.DrawFn, limits: parts.Limits) -> parts.Limits:
        return replace(limits, **{name: getattr(limits, name) + sign * draw(st.sampled_from([1e-3, 0.05]))})

    return widen


def _parameter(quantity: str, name: str) -> Planter:
    """All numbers of a parameter grow alike, or it is gone."""

    def plant(draw: st.DrawFn, robot: Mechanism) -> Change:
        key = draw(st.sampled_from([SUM, CABLE]))
        tendon, arcs = _of(robot, key)
        factor = draw(st.none() | _BY)
        changed = [(word, value if word != name else _scaled(value, factor)) for word, value in tendon.parameters]
        parameters = tuple((word, value) for word, value in changed if value is not None)
        return _change(quantity, key, _with(robot, key, replace(tendon, parameters=parameters), arcs))

    return plant


def _scaled(value: float | str | tuple[float, ...], by: float | None) -> float | tuple[float, ...] | None:
    assert not isinstance(value, str)
    if by is None:
        return None
    return tuple(number * (1.0 + by) for number in value) if isinstance(value, tuple) else value * (1.0 + by)


def _site_moved(draw: st.DrawFn, robot: Mechanism) -> Change:
    site = draw(st.sampled_from(SITES))
    body, at = _mounted(robot, site)
    x, y, z = (draw(_BY) * part for part in draw(st.sampled_from([X, Y, Z])))
    edge = mount_edge(body, site, replace(at, xyz=add(at.xyz, (x, y, z))))
    return _change("path", CABLE, robot.replace(edges={Id("mount", site.name): edge}))


def _site_on_another_body(draw: st.DrawFn, robot: Mechanism) -> Change:
    site = draw(st.sampled_from(SITES))
    body, at = _mounted(robot, site)
    other = draw(st.sampled_from([other for other in (WORLD, *robot.parent_joint) if other != body]))
    return _change("", CABLE, robot.replace(edges={Id("mount", site.name): mount_edge(other, site, at)}))


def _mounted(robot: Mechanism, site: Id) -> tuple[Id, Pose]:
    arc = robot.graph.edges[Id("mount", site.name)].arcs[0]
    assert isinstance(arc.weight, Pose | None)
    return arc.target, arc.weight or Pose()


def _drum_resized(draw: st.DrawFn, robot: Mechanism) -> Change:
    shape, arc = _drum(robot)
    assert isinstance(shape.geometry, parts.Sphere | parts.Cylinder)
    geometry = replace(shape.geometry, radius=shape.geometry.radius * (1.0 + draw(_BY)))
    return _change("path", CABLE, _with_drum(robot, replace(shape, geometry=geometry), arc))


def _drum_turned(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    shape, arc = _drum(robot)
    if not isinstance(shape.geometry, parts.Cylinder):
        return None
    assert isinstance(arc.weight, Pose)
    turned = Pose(arc.weight.xyz, quat_about(X, 1.25 + draw(_BY) / 2))
    return _change("axes", CABLE, _with_drum(robot, shape, replace(arc, weight=turned)))


def _drum_reshaped(draw: st.DrawFn, robot: Mechanism) -> Change:
    shape, arc = _drum(robot)
    is_ball = isinstance(shape.geometry, parts.Sphere)
    geometry: parts.Geometry = parts.Cylinder(1.0, 1.0) if is_ball else parts.Sphere(draw(_NUMBERS))
    return _change("", CABLE, _with_drum(robot, replace(shape, geometry=geometry), arc))


def _drum(robot: Mechanism) -> tuple[parts.Shape, RobotArc]:
    edge = robot.graph.edges[DRUM]
    assert isinstance(edge.data, parts.Shape)
    return edge.data, edge.arcs[0]


def _with_drum(robot: Mechanism, shape: parts.Shape, arc: RobotArc) -> Mechanism:
    at = arc.weight if isinstance(arc.weight, Pose) else Pose()
    return robot.replace(edges={DRUM: shape_edge(shape, arc.target, at)})


def _another_order(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    """The first and the last site of the cable change places."""
    del draw
    tendon, arcs = _of(robot, CABLE)
    first, last = (_mounted(robot, arcs[place].target) for place in (0, -1))
    if first == last:
        return None
    return _change("path" if first[0] == last[0] else "", CABLE, _with(robot, CABLE, tendon, (arcs[-1], *arcs[1:-1], arcs[0])))


def _other_side(draw: st.DrawFn, robot: Mechanism) -> Change:
    """A site beside the drum where there was none, or the other way round."""
    del draw
    tendon, arcs = _of(robot, CABLE)
    plain = tuple(arc for arc in arcs if arc.role != "side")
    other = plain if plain != arcs else (*arcs[:2], Arc(SITES[2], 0, None, "side"), *arcs[2:])
    return _change("", CABLE, _with(robot, CABLE, tendon, other))


def _joint_left_out(draw: st.DrawFn, robot: Mechanism) -> Change | None:
    tendon, arcs = _of(robot, SUM)
    place = draw(st.integers(0, len(arcs) - 1))
    other = (*arcs[:place], *arcs[place + 1 :])
    return _change("", SUM, _with(robot, SUM, tendon, other)) if other else None


def _gone(draw: st.DrawFn, robot: Mechanism) -> Change:
    key = draw(st.sampled_from([SUM, CABLE]))
    return _change("", key, robot.replace(without=[key]))


def _renamed(draw: st.DrawFn, robot: Mechanism) -> Change:
    key = draw(st.sampled_from([SUM, CABLE]))
    return _change("", key, rename(robot, {key: Id("tendon", "another")}))


TENDON_PLANTERS: dict[str, Planter] = {
    "coefficient": _weight(SUM, lambda arc: True),
    "divisor": _weight(CABLE, lambda arc: arc.role == "pulley"),
    "stiffness": _number("stiffness", SUM, CABLE),
    "damping": _number("damping", SUM, CABLE),
    "friction": _number("friction", SUM, CABLE),
    "armature": _number("armature", SUM),
    "lower limit": _limits(_wider("lower", -1.0)),
    "upper limit": _limits(_wider("upper", 1.0)),
    "limits gone": _limits(lambda draw, limits: parts.UNLIMITED),
    "force range": _parameter("force limits", "actuatorfrcrange"),
    "spring length": _parameter("spring lengths", "springlength"),
    "site moved": _site_moved,
    "site on another body": _site_on_another_body,
    "drum resized": _drum_resized,
    "drum turned": _drum_turned,
    "another kind of drum": _drum_reshaped,
    "another order": _another_order,
    "another side": _other_side,
    "joint left out": _joint_left_out,
    "tendon gone": _gone,
    "tendon renamed": _renamed,
}
"""Every kind of change to a tendon that MJCF, USD and HyMeKo can say."""
