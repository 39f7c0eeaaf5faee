"""diff sees every field of every part, and nothing else."""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import Enum

import pytest
from hypothesis import HealthCheck, given, settings
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.compare.diff import Difference, Tolerance, diff
from hymeko_x.ir import lumped, parts
from hymeko_x.ir.fields import attributes_of
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import ROOT, Extra, Id, Mechanism, RobotEdge
from hymeko_x.ir.values import Pose, pose_from_rpy, quat_about
from hymeko_x.testing import mechanisms

LIMITS = parts.Limits(-1.0, 1.0, 2.0, 3.0, 4.0, 5.0)
DOF = parts.Dof(
    parts.DofKind.HINGE,
    (0.0, 0.0, 1.0),
    LIMITS,
    safety=parts.Safety(1.0, 2.0, 3.0, 4.0),
    calibration=parts.Calibration(1.0, 2.0, 3.0),
    name="d",
)
PARAMETERS = (("gain", 1.0), ("mode", "fast"), ("range", (0.0, 1.0)))
FULL: tuple[parts.VertexPart | parts.EdgePart, ...] = (
    parts.Body(parts.Inertial(1.0, (0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 0.0, 0.0, 0.0))),
    parts.World(),
    parts.Frame((0.1,)),
    parts.Material("m", (1.0, 0.0, 0.0, 1.0), 0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
    parts.Texture("t.png", "t"),
    parts.Mesh("m.stl", (1.0, 2.0, 3.0), "m", (0.0, 1.0, 2.0), (0, 1, 2), (0.0, 0.5), (0, 1, 2), (0.0, 0.0, 1.0), (0, 0, 0)),
    parts.Actuator("motor", PARAMETERS),
    parts.Sensor("imu", 100.0, PARAMETERS),
    parts.Camera(1.0, (640, 480), PARAMETERS),
    parts.Light("spot", (1.0, 1.0, 1.0), PARAMETERS),
    parts.PoseSet("arm", 1.0, PARAMETERS),
    lumped.Spring(100.0, 0.1),
    lumped.Damper(10.0),
    lumped.Mass(5.0),
    lumped.Port("effort", 2.0, "rotation", (("period", 1.0),)),
    parts.Datum(PARAMETERS),
    parts.Shape(parts.Box((1.0, 2.0, 3.0)), parts.Role.VISUAL, "s", (1.0, 1.0, 1.0, 1.0), 1.0, 1000.0, (1.0, 0.1)),
    parts.Mount(),
    parts.Layer("rgb"),
    parts.Subset((0, 2)),
    parts.Joint((DOF, DOF)),
    parts.Coupling(True),
    parts.Loop("joint", (DOF,), True, PARAMETERS),
    parts.Tendon("fixed", LIMITS, 1.0, 2.0, 3.0, 4.0, 0.01, (1.0, 0.0, 0.0, 1.0), PARAMETERS),
    parts.Drive("simple", PARAMETERS),
    parts.Sense(),
    parts.Stance(),
    parts.Contact("pair", PARAMETERS),
    lumped.Constitutive(),
    parts.Relation(PARAMETERS),
    parts.Nest(),
)
GEOMETRIES: tuple[parts.Geometry, ...] = (
    parts.Box((1.0, 2.0, 3.0)),
    parts.Sphere(1.0),
    parts.Cylinder(1.0, 2.0),
    parts.Capsule(1.0, 2.0),
    parts.Ellipsoid((1.0, 2.0, 3.0)),
    parts.Plane((1.0, 2.0)),
    parts.MeshShape(),
    parts.NoShape(),
)
ARC = Arc(Id("body", "a"), 1, pose_from_rpy((1.0, 2.0, 3.0), (0.1, 0.2, 0.3)), "role")


def with_part(part: object, arc: Arc[Id, parts.Weight] = ARC) -> Mechanism:
    key = Id(KINDS[type(part)], "x")
    if isinstance(part, parts.VertexPart):
        return Mechanism("m", Hypergraph({key: part}, {}))
    return Mechanism("m", Hypergraph({}, {key: Edge(part, (arc,))}))


def changed(value: object) -> Iterator[tuple[str, object]]:
    """Every way to change one leaf of a value, with the path to it."""
    match value:
        case None | Id():
            return
        case bool():
            yield "", not value
        case float() | int():
            yield "", value + 1
        case str():
            yield "", value + "?"
        case Enum():
            yield "", next(member for member in type(value) if member is not value)
        case tuple():
            yield "", value[:-1]
            yield "", (*value, value[-1]) if value else (1.0,)
            for number, item in enumerate(value):
                for path, new in changed(item):
                    yield path, (*value[:number], new, *value[number + 1 :])
        case Pose():
            yield "xyz", replace(value, xyz=(9.0, *value.xyz[1:]))
            yield "rotation", replace(value, quat=quat_about((1.0, 0.0, 0.0), 0.001))
        case Struct():
            for item in attributes_of(value):
                if item.compare:
                    yield from _changed_field(value, item.name, optional="None" in type(value).__annotations__[item.name])


def _changed_field(value: object, name: str, *, optional: bool) -> Iterator[tuple[str, object]]:
    old = getattr(value, name)
    if optional and old is not None:
        yield name, replace(value, **{name: None})  # type: ignore[type-var]
    for path, new in changed(old):
        yield f"{name}.{path}", replace(value, **{name: new})  # type: ignore[type-var]


def test_the_samples_cover_every_part_and_leave_no_field_at_none() -> None:
    assert {type(part) for part in FULL} == set(KINDS)
    assert {type(geometry) for geometry in GEOMETRIES} == set(parts.Geometry.__args__)  # type: ignore[attr-defined]
    for part in (*FULL, DOF, LIMITS):
        for item in attributes_of(part):
            assert getattr(part, item.name) is not None or not item.compare, f"{type(part).__name__}.{item.name}"


@pytest.mark.parametrize("part", FULL, ids=lambda part: type(part).__name__)
def test_every_field_of_a_part_is_compared(part: object) -> None:
    original = with_part(part)
    for path, new in changed(part):
        other = with_part(new)
        found = diff(original, other)
        assert found, f"{path} is not seen"
        assert found != diff(other, original)
        assert original != other
        assert {difference.element for difference in found} == {Id(KINDS[type(part)], "x")}
        assert path.split(".")[0] in found[0].field


@pytest.mark.parametrize("geometry", GEOMETRIES, ids=lambda geometry: type(geometry).__name__)
def test_every_field_of_a_geometry_is_compared_and_so_is_its_kind(geometry: parts.Geometry) -> None:
    original = with_part(parts.Shape(geometry, parts.Role.BOTH))
    for _, new in changed(geometry):
        assert diff(original, with_part(parts.Shape(new, parts.Role.BOTH)))  # type: ignore[arg-type]
    others = [other for other in GEOMETRIES if type(other) is not type(geometry)]
    assert all(diff(original, with_part(parts.Shape(other, parts.Role.BOTH))) for other in others)


@pytest.mark.parametrize(
    "arc",
    [
        replace(ARC, target=Id("body", "b")),
        replace(ARC, sign=-1),
        replace(ARC, role="other"),
        replace(ARC, weight=None),
        replace(ARC, weight=(1.0, 2.0)),
        *(replace(ARC, weight=new) for _, new in changed(ARC.weight)),
    ],
)
def test_every_field_of_an_arc_is_compared(arc: Arc[Id, parts.Weight]) -> None:
    original = with_part(parts.Mount())
    other: RobotEdge = Edge(parts.Mount(), (arc,))
    found = diff(original, Mechanism("m", Hypergraph({}, {Id("mount", "x"): other})))
    assert [difference.element for difference in found] == [Id("mount", "x")]


def test_arcs_and_elements_that_come_and_go_are_told() -> None:
    one = Mechanism("m", Hypergraph({}, {Id("mount", "x"): Edge(parts.Mount(), (ARC,))}))
    two = Mechanism("m", Hypergraph({}, {Id("mount", "x"): Edge(parts.Mount(), (ARC, ARC))}))
    (added,) = diff(one, two)
    assert (added.field, added.before) == ("[1]", None)
    (removed,) = diff(two, one)
    assert (removed.field, removed.after) == ("[1]", None)
    body = Id("body", "b")
    (gone,) = diff(with_part(parts.Frame()), Mechanism("m"))
    assert str(gone) == "frame 'x': removed frame(size [])"
    (new,) = diff(Mechanism("m"), Mechanism("m", Hypergraph({body: parts.Body()}, {})))
    assert str(new) == "body 'b': added body(inertial none)"


def test_the_name_and_extras_are_compared() -> None:
    assert [str(found) for found in diff(Mechanism("a"), Mechanism("b"))] == ["mechanism name: 'a' -> 'b'"]
    extra = Extra("urdf", "limit", "<limit/>")
    before, after = Mechanism("m", extras={ROOT: (extra, extra)}), Mechanism("m", extras={ROOT: (extra,)})
    assert diff(before, after) == (Difference(ROOT, "urdf limit", "<limit/>", None),)
    assert diff(after, before) == (Difference(ROOT, "urdf limit", None, "<limit/>"),)
    for other in (Extra("mjcf", "limit", "<limit/>"), Extra("urdf", "", "<limit/>"), Extra("urdf", "limit", "<l/>")):
        assert len(diff(after, Mechanism("m", extras={ROOT: (other,)}))) == 2
    assert diff(after, Mechanism("m", extras={ROOT: (replace(extra, index=5),)})) == ()


def test_notations_do_not_count() -> None:
    written = parts.Body(parts.Inertial(1.0, written=parts.InertialWritten(Pose(), (1.0, 1.0, 1.0, 0.0, 0.0, 0.0))))
    assert diff(with_part(written), with_part(parts.Body(parts.Inertial(1.0)))) == ()
    shown = Mechanism("m", notations={ROOT: {"a": "b"}}, layout=(ROOT,))
    assert diff(shown, Mechanism("m")) == ()


# ---- tolerance -----------------------------------------------------------------------------------------------------------------


def test_numbers_within_the_tolerance_are_equal_and_others_are_not() -> None:
    def masses(a: float, b: float, tolerance: Tolerance) -> int:
        return len(diff(with_part(lumped.Mass(a)), with_part(lumped.Mass(b)), tolerance))

    assert masses(1.0, 1.0 + 1e-9, Tolerance(absolute=1e-8)) == 0
    assert masses(1.0, 1.0 + 1e-7, Tolerance(absolute=1e-8)) == 1
    assert masses(1e9, 1e9 + 1.0, Tolerance(relative=1e-8)) == 0
    assert masses(1e9, 1e9 + 100.0, Tolerance(relative=1e-8)) == 1
    assert masses(math.inf, math.inf, Tolerance()) == 0
    assert masses(math.nan, math.nan, Tolerance()) == 0
    assert masses(math.inf, 1.0, Tolerance(absolute=1.0)) == 1
    assert masses(math.inf, 1.0, Tolerance(relative=1e-12)) == 1
    assert masses(-math.inf, math.inf, Tolerance(relative=1e-12)) == 1


def test_rotations_are_compared_by_their_angle() -> None:
    def turned(angle: float) -> Mechanism:
        arc = replace(ARC, weight=Pose((0.0, 0.0, 0.0), quat_about((0.0, 0.0, 1.0), angle)))
        return Mechanism("m", Hypergraph({}, {Id("mount", "x"): Edge(parts.Mount(), (arc,))}))

    assert diff(turned(1.0), turned(1.0 + 1e-9), Tolerance(absolute=1e-8)) == ()
    (found,) = diff(turned(1.0), turned(1.0 + 1e-6), Tolerance(absolute=1e-8))
    assert found.field == "[0].weight.rotation"
    assert diff(turned(math.pi), turned(-math.pi), Tolerance(absolute=1e-12)) == ()


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(mechanisms(), mechanisms())
def test_a_difference_is_found_exactly_where_mechanisms_are_not_equal(a: Mechanism, b: Mechanism) -> None:
    assert diff(a, a) == ()
    assert bool(diff(a, b)) == (a != b)
    assert len(diff(a, b)) == len(diff(b, a))


def test_of_the_numbers_of_a_mesh_those_from_the_first_difference_on_are_shown() -> None:
    key = Id("mesh", "m")
    points = tuple(float(number) for number in range(99))
    a, b = (Mechanism("m", Hypergraph({key: parts.Mesh(vertices=values)}, {})) for values in (points, (*points[:90], 0.5, *points[91:])))
    ((found),) = diff(a, b)
    assert (found.field, found.before) == ("vertices", "[... 90 91 92 93 94 95 96 97 ...] of 99")
    assert found.after == "[... 0.5 91 92 93 94 95 96 97 ...] of 99"
    assert diff(a, b, Tolerance(100.0)) == ()
    ((missing),) = diff(a, Mechanism("m", Hypergraph({key: parts.Mesh()}, {})))
    assert (missing.before, missing.after) == ("[0 1 2 3 4 5 6 7 ...] of 99", "[]")


def test_no_pose_and_nearly_none_are_the_same_within_a_tolerance() -> None:
    nearly = with_part(parts.Mount(), replace(ARC, weight=Pose((1e-12, 0.0, 0.0))))
    none = with_part(parts.Mount(), replace(ARC, weight=None))
    assert diff(nearly, none, Tolerance(1e-9)) == diff(none, nearly, Tolerance(1e-9)) == ()
    assert len(diff(nearly, none)) == 1
    assert len(diff(with_part(parts.Mount(), replace(ARC, weight=Pose((1e-3, 0.0, 0.0)))), none, Tolerance(1e-9))) == 1


def test_the_words_of_an_edge_say_the_roles_of_its_ends() -> None:
    ends = Id("body", "a"), Id("body", "b")
    edges = {Id("drive", "d"): Edge(parts.Drive(), (Arc(ends[0], 1, None, "first"), Arc(ends[1], -1)))}
    bodies = dict.fromkeys(ends, parts.Body())
    (found,) = diff(Mechanism("r", Hypergraph(bodies, edges)), Mechanism("r", Hypergraph(bodies)))
    assert found.before is not None
    assert found.before.endswith("{+ body 'a' as 'first', - body 'b'}")


def test_parameters_are_compared_by_name_wherever_they_stand() -> None:
    def with_parameters(*parameters: tuple[str, float | str | tuple[float, ...]]) -> Mechanism:
        return with_part(parts.Actuator("general", parameters))

    one = with_parameters(("ctrlrange", (-1.0, 1.0)), ("kp", 4.0), ("dyntype", "filter"), ("user", 1.0), ("user", 2.0))
    assert diff(one, with_parameters(("dyntype", "filter"), ("user", 1.0), ("kp", (4.0,)), ("user", 2.0), ("ctrlrange", (-1.0, 1.0)))) == ()
    other = with_parameters(
        ("kp", 5.0), ("gear", (1.0, 0.0)), ("ctrlrange", (-1.0, 2.0)), ("dyntype", "filter"), ("user", 1.0), ("user", 3.0)
    )
    assert [(found.field, found.before, found.after) for found in diff(one, other)] == [
        ("parameters.ctrlrange", "[-1 1]", "[-1 2]"),
        ("parameters.kp", "4", "5"),
        ("parameters.user[2]", "2", "3"),
        ("parameters.gear", None, "[1 0]"),
    ]
