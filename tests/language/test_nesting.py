"""Nested graphs: what stands inside of data is vertices, edges and the edge that tells so, and comes back from its text."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.formats.hymeko.nesting import nest_edge, nest_key
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.testing import Knobs, mechanisms

PLAIN = Knobs(
    most_bodies=1,
    world=False,
    shapes=False,
    materials=False,
    meshes=False,
    couplings=False,
    loops=False,
    tendons=False,
    actuators=False,
    sensors=False,
    poses=False,
    lumped=False,
    extras=False,
    notations=False,
)


def read(text: str) -> Mechanism:
    report = Report()
    found = hx.loads(text, "hymeko", report=report).mechanism
    assert [str(diagnostic) for diagnostic in report] == []
    return found


def vertex(name: str) -> Id:
    return Id("datum", name)


def test_a_block_of_a_block_is_vertices_and_edges_and_the_edges_that_tell_so() -> None:
    graph = read("g : graph { a { x 1 b @e { + a - b } c { y [1 [2 'two'] <?>] } } }").graph
    assert dict(graph.vertices) == {
        vertex("a"): parts.Datum((("x", 1.0),)),
        vertex("a.b"): parts.Datum(),
        vertex("a.c"): parts.Datum((("y", (1.0, (2.0, "two"), None)),)),
    }
    edge = Id("relation", "a.e")
    assert dict(graph.edges) == {
        edge: Edge(parts.Relation(), (Arc(vertex("a"), 1), Arc(vertex("a.b"), -1))),
        nest_key(vertex("a")): nest_edge(vertex("a"), (vertex("a.b"), edge, vertex("a.c"))),
    }


def test_a_type_among_the_values_of_inner_data_comes_back() -> None:
    graph = read('g : graph { sensors { eye { type "camera" rate 30 } @e { type "link" + eye } } ear { type "microphone" } }')
    assert graph.vertex(vertex("sensors.eye"), parts.Datum) == parts.Datum((("type", "camera"), ("rate", 30.0)))
    assert hx.loads(hx.dumps(graph, "hymeko"), "hymeko").mechanism == graph


def test_edges_stand_inside_of_edges_and_weights_have_any_shape() -> None:
    graph = read("g : graph { a {} @e { [[1 2] [3 [4 5]]] + a @inner { [0.5 0.7] - a } } }").graph
    outer, inner = Id("relation", "e"), Id("relation", "e.inner")
    assert graph.edges[outer].arcs == (Arc(vertex("a"), 1, ((1.0, 2.0), (3.0, (4.0, 5.0)))),)
    assert graph.edges[inner].arcs == (Arc(vertex("a"), -1, (0.5, 0.7)),)
    assert graph.edges[Id("nest", "@e")] == nest_edge(outer, (inner,))


@pytest.mark.parametrize(
    ("path", "target"),
    [("a", "a"), ("b", "a.b"), ("a.b", "a.b"), ("other.b", "other.b"), ("g.b", "b"), ("``.b", "b"), ("datum.a", "a")],
)
def test_names_are_looked_up_from_the_block_outwards_and_from_the_root_by_its_name(path: str, target: str) -> None:
    graph = read(f"g : graph {{ b other {{ b }} a {{ b @e {{ + {path} }} }} }}").graph
    assert graph.edges[Id("relation", "a.e")].arcs == (Arc(vertex(target), 1),)


def test_the_text_has_blocks_again_with_the_shortest_references() -> None:
    text = "g : graph { b other : datum { b } a : datum { b @e { + b - g.b ~ other.b } deep { x 1 } `units` } }\n"
    assert hx.dumps(read(text), "hymeko") == text


def test_an_edge_that_no_block_tells_stays_an_edge() -> None:
    text = "g : graph { a b @n : nest { + a - b } }\n"
    graph = read(text)
    assert graph.graph.edges == {Id("nest", "n"): nest_edge(vertex("a"), (vertex("b"),))}
    assert hx.dumps(graph, "hymeko") == text


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(mechanisms(PLAIN))
def test_what_is_printed_reads_back_equal(graph: Mechanism) -> None:
    text = hx.dumps(graph, "hymeko")
    again = read(text)
    assert again == graph
    assert hx.dumps(again, "hymeko") == text


def test_a_body_does_not_stand_in_data() -> None:
    with pytest.raises(Refusal) as caught:
        hx.loads("g : graph { a { b : link {} } }", "hymeko")
    diagnostic = caught.value.diagnostic
    assert (diagnostic.code.id, diagnostic.message) == ("HX062", "'b' is a body, and data holds data and relations")


def test_two_elements_of_one_name_in_one_block_are_refused() -> None:
    with pytest.raises(Refusal, match="datum 'a.b' is defined twice"):
        hx.loads("g : graph { a { b {} b {} } }", "hymeko")
