"""Tendons for MJCF: which paths MuJoCo follows, and what becomes of the others."""

from __future__ import annotations

from typing import Any

import mujoco
import pytest

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, joint_edge, mount_edge, shape_edge
from hymeko_x.ir.parts import (
    Actuator,
    Body,
    Box,
    Dof,
    Drive,
    Frame,
    Inertial,
    Joint,
    Limits,
    Role,
    Sense,
    Sensor,
    Shape,
    Sphere,
    Tendon,
)
from hymeko_x.ir.values import Pose
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles

A, B = Id("body", "a"), Id("body", "b")
HINGE = Id("joint", "hinge")
S, T, LOST = (Id("frame", name) for name in ("s", "t", "lost"))
ROUND, BOX, TENDON = Id("shape", "round"), Id("shape", "box"), Id("tendon", "cord")
CABLE = (Arc(S), Arc(T))


def robot(tendon: Tendon, *arcs: RobotArc) -> Mechanism:
    heavy = Body(Inertial(1.0, tensor=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0)))
    actuator, sensor = Id("actuator", "pull"), Id("sensor", "length")
    vertices: dict[Id, Any] = {A: heavy, B: heavy, S: Frame(), T: Frame(), LOST: Frame(), actuator: Actuator(), sensor: Sensor("tendonpos")}
    edges: dict[Id, Any] = {
        HINGE: joint_edge(Joint((Dof(),)), A, B, Pose((0.0, 0.0, 1.0))),
        Id("mount", "s"): mount_edge(A, S, Pose((0.5, 0.0, 0.0))),
        Id("mount", "t"): mount_edge(B, T),
        ROUND: shape_edge(Shape(Sphere(0.1), Role.BOTH), A),
        BOX: shape_edge(Shape(Box((1.0, 1.0, 1.0)), Role.BOTH), A),
        TENDON: Edge(tendon, arcs),
        Id("drive", "pull"): Edge(Drive(), (Arc(actuator, 1), Arc(TENDON, -1))),
        Id("sense", "length"): Edge(Sense(), (Arc(TENDON, 1), Arc(sensor, -1))),
    }
    return Mechanism("r", Hypergraph(vertices, edges))


def compiled(mechanism: Mechanism) -> tuple[Any, list[str]]:
    """The model that MuJoCo makes of it, and the diagnostics on the way."""
    report = Report()
    main = pipeline.convert(mechanism, formats.by_name("mjcf"), Options(), NoFiles(), report).package.main
    return mujoco.MjModel.from_xml_string(main.decode()), [item.message for item in report if "tendon" in item.message]


@pytest.mark.parametrize(
    ("kind", "arcs", "why"),
    [
        ("fixed", (), "is empty"),
        ("fixed", (Arc(HINGE, 1, (1.0,)), Arc(HINGE, 1, (2.0,))), "has the joint 'hinge' twice"),
        ("fixed", (Arc(HINGE, 1),), "has no coefficient for 'hinge'"),
        ("fixed", (Arc(S, 1, (1.0,)),), "has the joint 's', expected a hinge or a slide"),
        ("spatial", (), "is empty"),
        ("spatial", (Arc(S),), "has less than two steps"),
        ("spatial", (*CABLE, Arc(TENDON, 0, (2.0,), "pulley")), "ends with a pulley"),
        ("spatial", (Arc(TENDON, 0, (0.0,), "pulley"), *CABLE), "leads through tendon 'cord', which is no step of a cable"),
        ("spatial", (Arc(S), Arc(ROUND, 0, None, "wrap")), "has a geom that does not stand between two sites"),
        ("spatial", (Arc(S), Arc(BOX, 0, None, "wrap"), Arc(T)), "wraps around a geom that is neither a sphere nor a cylinder"),
        ("spatial", (Arc(S), Arc(T, 0, None, "side")), "leads through frame 't', which is no step of a cable"),
        ("spatial", (Arc(S), Arc(LOST)), "leads through frame 'lost', which is on no body"),
        ("rope", CABLE, "is neither fixed nor spatial"),
    ],
)
def test_a_tendon_that_mujoco_refuses_is_left_out_with_what_acts_on_it(kind: str, arcs: tuple[RobotArc, ...], why: str) -> None:
    model, reported = compiled(robot(Tendon(kind), *arcs))
    assert (model.ntendon, model.nu, model.nsensor) == (0, 0, 0)
    assert reported == [f"tendon 'cord' is left out: its path {why}"]


@pytest.mark.parametrize(
    ("tendon", "reported", "span"),
    [
        (Tendon(limits=Limits(0.1, 0.5)), [], (0.1, 0.5)),
        (Tendon(limits=Limits(None, 0.5)), ["has no lower limit; 1e+10 stands for the missing bound"], (-1e10, 0.5)),
        (Tendon(limits=Limits(0.5, 0.1)), ["lower limit 0.5 is above upper limit 0.1; it is written without position limits"], (0.0, 0.0)),
        (Tendon(armature=-1.0), ["armature -1.0 is left out: it is negative, or the cable leads around a shape"], (0.0, 0.0)),
    ],
)
def test_numbers_that_mujoco_refuses_are_put_right(tendon: Tendon, reported: list[str], span: tuple[float, float]) -> None:
    model, messages = compiled(robot(tendon, *CABLE))
    assert messages == [f"tendon 'cord': {text}" for text in reported]
    assert (model.ntendon, model.nu, tuple(model.tendon_range[0])) == (1, 1, span)


def test_a_cable_around_a_shape_without_a_name_gives_it_one_and_has_no_armature() -> None:
    model, reported = compiled(robot(Tendon(armature=1.0), Arc(S), Arc(ROUND, 0, None, "wrap"), Arc(T, 0, None, "side"), Arc(T)))
    assert reported == ["tendon 'cord': armature 1.0 is left out: it is negative, or the cable leads around a shape"]
    assert [model.geom(int(model.wrap_objid[1])).name, model.tendon_num[0]] == ["round", 3]
    assert model.geom_type[model.wrap_objid[1]] == mujoco.mjtGeom.mjGEOM_SPHERE
