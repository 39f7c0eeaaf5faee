"""References to values: in fields, in lists and as weights of arcs, and what they say where they lead nowhere or in a circle."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.ir.values import Pose, quat_from_rpy


def read(text: str) -> Mechanism:
    report = Report()
    found = hx.loads(text, "hymeko", report=report).mechanism
    assert [str(diagnostic) for diagnostic in report] == []
    assert hx.loads(hx.dumps(found, "hymeko"), "hymeko").mechanism == found
    return found


def datum(graph: Mechanism, name: str) -> dict[str, object]:
    return dict(graph.vertex(Id("datum", name), parts.Datum).parameters)


@pytest.mark.parametrize("reference", ["=a.v", " -> a.v", "=g.a.v", "=b.w", "=a.deep.v"])
def test_a_field_has_the_value_that_it_refers_to(reference: str) -> None:
    graph = read(f"g : graph {{ a {{ v [1 2] deep {{ v [1 2] }} }} b {{ w=a.v }} c {{ r{reference} }} }}")
    assert datum(graph, "c") == {"r": (1.0, 2.0)}


def test_values_in_lists_and_weights() -> None:
    graph = read("g : graph { k 3 a { v [1 2] u [a.v 7] @e { [|> -> v] + a [-> k -> v] - a.b } b } }")
    assert datum(graph, "a") == {"v": (1.0, 2.0), "u": ((1.0, 2.0), 7.0)}
    edge = graph.graph.edges[Id("relation", "a.e")]
    assert [arc.weight for arc in edge.arcs] == [(1.0, 2.0), (3.0, (1.0, 2.0))]


def test_what_leads_to_an_element_is_a_relation() -> None:
    graph = read("g : graph { a { b } c { r -> a.b s=a.b } }")
    a_b, c = Id("datum", "a.b"), Id("datum", "c")
    expected = Edge(parts.Relation(), (Arc(c, 1), Arc(a_b, -1)))
    assert {key.name: edge for key, edge in graph.graph.edges.items() if key.kind == "relation"} == {"c.r": expected, "c.s": expected}


def test_a_robot_has_its_numbers_from_a_vertex_of_data() -> None:
    robot = read(
        "arm : robot {\n  sizes : datum { length 0.4 place [0 0 0.3] turn [0 0 90] mass 2kg }\n"
        "  base {} fore { mass=sizes.mass shape { capsule [0.02 sizes.length] at [sizes.place sizes.turn] } }\n"
        "  @elbow { [sizes.place] + base - fore axis=Y }\n}\n"
    )
    fore = robot.vertex(Id("body", "fore"), parts.Body).inertial
    assert fore is not None
    assert fore.mass == 2.0
    (view,) = robot.shapes[Id("body", "fore")]
    assert view.shape.geometry == parts.Capsule(0.02, 0.4)
    assert view.pose == Pose((0.0, 0.0, 0.3), quat_from_rpy((0.0, 0.0, 1.5707963267948966)))
    assert robot.joints[Id("joint", "elbow")].parent_pose == Pose((0.0, 0.0, 0.3))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a { v=b.v } b { v=a.v }", "2:5: error[HX067]: the value of 'b.v' leads back to itself: b.v -> a.v -> b.v"),
        ("a { v=a.v }", "2:5: error[HX067]: the value of 'a.v' leads back to itself: a.v -> a.v"),
        ("a { v [a.v] }", "2:5: error[HX067]: the value of 'a.v' leads back to itself: a.v -> a.v"),
        ("a { v 1 } b { w=a.x }", "2:15: error[HX040]: 'a.x' is not defined; expected an element"),
        ("a { v 1 } b { w -> c }", "2:15: error[HX040]: 'c' is not defined; expected an element"),
        ("a { v 1 } @e { [a.x] + a }", "2:16: error[HX040]: 'a.x' is no value; expected a field, such as element.field"),
    ],
)
def test_circles_and_names_that_are_not_there_have_a_code_and_a_caret(text: str, message: str) -> None:
    with pytest.raises(Refusal) as caught:
        hx.loads(f"g : graph {{\n{text} }}", "hymeko")
    lines = str(caught.value).split("\n")
    place, caret = message.split(": ", 1)[0].split(":")[1], lines[2].index("^") - lines[1].index("|") - 1
    assert (lines[0].split(":", 1)[1], caret) == (message, int(place))


def test_a_unit_ends_before_a_comment() -> None:
    robot = read("r : robot { a { mass 5g/* heavy */ com [0 0 5mm/*up*/] } }")
    assert robot.vertex(Id("body", "a"), parts.Body).inertial == parts.Inertial(0.005, (0.0, 0.0, 0.005))


def test_the_role_of_an_arc_in_backticks_is_a_plain_text() -> None:
    text = """arm : robot {
  base {}
  tip {}
  @wrist : ball { + base - tip }
  turn : motor { `0` - wrist }
}"""
    (edge,) = [edge for edge in hx.loads(text, "hymeko").mechanism.graph.edges.values() if isinstance(edge.data, parts.Drive)]
    assert [type(arc.role) for arc in edge.arcs] == [str, str]


@pytest.mark.parametrize("name", ["sensor", "actuator"])
def test_a_robot_may_be_called_like_a_type(name: str) -> None:
    text = f"""<mujoco model="{name}"><worldbody><site name="a"/><camera name="eye" fovy="41" resolution="1920 1200"/>
<body><joint name="motor"/><geom size="1"/></body></worldbody>
<sensor><camprojection site="a" camera="eye"/><camprojection site="a" camera="eye"/></sensor>
<actuator><motor name="motor" joint="motor" gear="2"/><motor name="other" joint="motor" gear="3"/></actuator></mujoco>"""
    robot = hx.loads(text, "mjcf")
    assert hx.diff(robot, hx.loads(hx.dumps(robot, "hymeko"), "hymeko")) == ()
