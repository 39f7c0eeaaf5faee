"""A gearbox relates the angles of two links, seen from a third one: a relation of the two hinges between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Coupling
from tests.sdf.canonical import canonical

if TYPE_CHECKING:
    from pathlib import Path

HINGE = (
    '<joint name="{0}" type="revolute"><parent>{1}</parent><child>{2}</child><axis><xyz expressed_in="__model__">{3}</xyz></axis></joint>'
)


def gearbox(ends: str = "<parent>rotor</parent><child>arm</child>", axes: tuple[str, str] = ("0 0 1", "0 0 1"), **hinge: str) -> str:
    """A rotor and an arm on a base, each in a frame of its own; ``out`` is the axis of the arm, ``of`` and ``to`` are its ends."""
    text = "".join(f'<{tag}><xyz expressed_in="base">{axis}</xyz></{tag}>' for tag, axis in zip(("axis", "axis2"), axes, strict=True))
    return (
        '<sdf version="1.9"><model name="m"><link name="base"/><link name="rotor"><pose>0 0 1 0.3 0 0</pose></link>'
        '<link name="arm"><pose>1 0 1 0 0.5 0</pose></link>'
        + HINGE.format("in", "base", "rotor", "0 0 1")
        + HINGE.format("out", hinge.get("of", "base"), hinge.get("to", "arm"), hinge.get("out", "0 0 -2"))
        + f'<joint name="gear" type="gearbox"><pose>0 0 0.1 0 0 0</pose>{ends}<gearbox_reference_body>base</gearbox_reference_body>'
        + f"<gearbox_ratio>0.04</gearbox_ratio>{text}</joint></model></sdf>"
    )


def relation(robot: hx.Mechanism) -> tuple[str, str, tuple[float, ...]]:
    """The names of the follower and the leader, and the coefficients, of the only coupling."""
    ((_, _, (follower, leader)),) = robot.edges(Coupling)
    assert isinstance(leader.weight, tuple)
    return follower.target.name, leader.target.name, tuple(float(str(value)) for value in leader.weight)


def test_the_angle_of_the_child_is_minus_the_ratio_times_that_of_the_parent() -> None:
    assert relation(hx.loads(gearbox(out="0 0 2"), "sdf").mechanism) == ("out", "in", (0.0, -0.04))


def test_an_axis_that_points_the_other_way_turns_the_sign() -> None:
    assert relation(hx.loads(gearbox(), "sdf").mechanism) == ("out", "in", (0.0, 0.04))
    assert relation(hx.loads(gearbox(axes=("0 0 -1", "0 0 1")), "sdf").mechanism) == ("out", "in", (0.0, -0.04))


def test_a_hinge_that_leads_to_the_reference_body_counts_backwards() -> None:
    assert relation(hx.loads(gearbox(of="arm", to="base", out="0 0 2"), "sdf").mechanism) == ("out", "in", (0.0, 0.04))


def test_it_is_written_as_its_author_wrote_it() -> None:
    text = gearbox()
    assert canonical(hx.dumps(hx.loads(text, "sdf"), "sdf").encode()) == canonical(text.encode())


def test_another_ratio_is_written_in_its_place_and_another_relation_as_a_mimic() -> None:
    robot = hx.loads(gearbox(), "sdf").mechanism
    ((key, edge),) = [(key, edge) for key, edge in robot.graph.edges.items() if isinstance(edge.data, Coupling)]

    def with_coefficients(*numbers: float) -> str:
        arcs = edge.arcs[0], Arc(edge.arcs[1].target, -1, numbers)
        return hx.dumps(robot.replace(edges={key: Edge(edge.data, arcs)}), "sdf")

    assert "<gearbox_ratio>0.5</gearbox_ratio>" in with_coefficients(0.0, 0.5)
    assert "gearbox" not in with_coefficients(1.0, 0.5)
    assert "<multiplier>0.5</multiplier>" in with_coefficients(1.0, 0.5)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (gearbox(axes=("1 0 0", "0 0 1")), "no hinge between body 'rotor' and body 'base', from which its angles are measured,"),
        (gearbox("<parent>rotor</parent><child>rotor</child>"), "both of its angles are those of one joint"),
        (gearbox("<parent>wheel</parent><child>arm</child>"), "<parent> or <gearbox_reference_body> names no link"),
    ],
)
@pytest.mark.unread("HX045")
def test_one_that_is_no_relation_of_two_hinges_is_kept_as_written(text: str, problem: str) -> None:
    report = Report()
    robot = hx.loads(text, "sdf", report=report).mechanism
    (message,) = [diagnostic.message for diagnostic in report]
    assert message.startswith(f"joint 'gear': {problem}")
    assert message.endswith("the gearbox is kept as written")
    assert canonical(hx.dumps(robot, "sdf").encode()) == canonical(text.encode())


@pytest.mark.parametrize("name", ["gear.urdf", "gear.xml", "gear.usda", "gear.hymeko"])
def test_other_formats_have_the_same_robot_and_give_it_back(name: str, tmp_path: Path) -> None:
    pytest.importorskip("pydrake")
    (tmp_path / "gear.sdf").write_text(gearbox(), "utf-8")
    target = tmp_path / name
    hx.convert(str(tmp_path / "gear.sdf"), str(target), keep="beside")
    assert hx.verify(str(tmp_path / "gear.sdf"), str(target), samples=10).is_same
    back = tmp_path / "back.sdf"
    hx.convert(str(target), str(back))
    assert canonical(back.read_bytes()) == canonical((tmp_path / "gear.sdf").read_bytes())
