"""The hypergraph and the matrices of the formalism, on listing 1 of the paper and on an example worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from hymeko_x.ir.graph import Arc, Edge, Hypergraph, Incidence

Graph = Hypergraph[str, int, str, float]

LISTING_1: Graph = Hypergraph(
    dict.fromkeys(("x1", "x2", "x3", "x4"), 0),
    {"e1": Edge("e1", (Arc("x1", 1), Arc("x2", 1), Arc("x3", -1), Arc("x4", -1)))},
)

# e leads from a to b; f from e (an edge!) to c, undirected at b; g from a to a; one arc of f leads nowhere.
MIXED: Graph = Hypergraph(
    dict.fromkeys("abc", 0),
    {
        "e": Edge("e", (Arc("a", 1), Arc("b", -1))),
        "f": Edge("f", (Arc("b", 0), Arc("c", -1), Arc("e", 1), Arc("nowhere", 1))),
        "g": Edge("g", (Arc("a", 1), Arc("a", -1))),
    },
)


def test_the_signed_incidence_matrix_of_listing_1() -> None:
    np.testing.assert_array_equal(LISTING_1.incidence_matrix().toarray(), [[1], [1], [-1], [-1], [0]])


def test_the_star_expansion_of_listing_1_is_its_two_factor_graph() -> None:
    expected = [
        [0, 0, 0, 0, 1],
        [0, 0, 0, 0, 1],
        [0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0],
        [0, 0, 1, 1, 0],
    ]
    np.testing.assert_array_equal(LISTING_1.star_expansion().toarray(), expected)


def test_the_clique_and_line_expansion_of_listing_1() -> None:
    expected = np.zeros((5, 5))
    expected[:4, :4] = 1 - np.eye(4)
    np.testing.assert_array_equal(LISTING_1.clique_expansion().toarray(), expected)
    np.testing.assert_array_equal(LISTING_1.line_expansion().toarray(), [[0]])


def test_the_adjacency_tensor_of_listing_1_leads_from_tails_to_heads() -> None:
    tensor = LISTING_1.adjacency_tensor()
    assert tensor.shape == (5, 5, 1)
    assert sorted(zip(*tensor.coords, strict=True)) == [(0, 2, 0), (0, 3, 0), (1, 2, 0), (1, 3, 0)]
    assert list(tensor.data) == [1, 1, 1, 1]


def test_the_incidence_matrices_of_the_mixed_example() -> None:
    signed = [[1, 0, 0], [-1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
    np.testing.assert_array_equal(MIXED.incidence_matrix().toarray(), signed)
    counted = [[1, 0, 2], [1, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
    np.testing.assert_array_equal(MIXED.incidence_matrix(signed=False).toarray(), counted)


def test_the_star_expansion_of_the_mixed_example() -> None:
    arcs = {("a", "e"), ("e", "b"), ("b", "f"), ("f", "b"), ("f", "c"), ("e", "f"), ("a", "g"), ("g", "a")}
    names = "abcefg"
    expected = [[int((start, end) in arcs) for end in names] for start in names]
    np.testing.assert_array_equal(MIXED.star_expansion().toarray(), expected)


def test_the_clique_expansion_of_the_mixed_example_counts_common_edges() -> None:
    common = {frozenset("ab"), frozenset("bc"), frozenset("be"), frozenset("ce")}
    expected = [[int(frozenset((row, column)) in common) for column in "abcefg"] for row in "abcefg"]
    np.testing.assert_array_equal(MIXED.clique_expansion().toarray(), expected)


def test_the_line_expansion_of_the_mixed_example_counts_common_elements() -> None:
    np.testing.assert_array_equal(MIXED.line_expansion().toarray(), [[0, 1, 1], [1, 0, 0], [1, 0, 0]])


def test_two_edges_between_the_same_elements_count_twice() -> None:
    twice: Graph = Hypergraph({"a": 0, "b": 0}, {name: Edge(name, (Arc("a", 1), Arc("b", -1))) for name in "ef"})
    np.testing.assert_array_equal(twice.clique_expansion().toarray()[:2, :2], [[0, 2], [2, 0]])
    np.testing.assert_array_equal(twice.line_expansion().toarray(), [[0, 2], [2, 0]])


def test_the_adjacency_tensor_of_the_mixed_example() -> None:
    tensor = MIXED.adjacency_tensor()
    row = {name: number for number, name in enumerate("abcefg")}
    steps = {("a", "b", 0), ("b", "c", 1), ("e", "b", 1), ("e", "c", 1)}
    assert {(int(i), int(j), int(k)) for i, j, k in zip(*tensor.coords, strict=True)} == {(row[i], row[j], k) for i, j, k in steps}
    np.testing.assert_array_equal(tensor.data, np.ones(4))


def test_the_tensor_is_the_star_expansion_walked_twice() -> None:
    star = LISTING_1.star_expansion().toarray()
    both = LISTING_1.adjacency_tensor().toarray().sum(axis=2)
    np.testing.assert_array_equal(both, star @ star)


def test_an_empty_graph_has_empty_matrices() -> None:
    empty: Graph = Hypergraph()
    assert empty.incidence_matrix().shape == (0, 0)
    assert empty.adjacency_tensor().shape == (0, 0, 0)


# ---- looking around and changing -------------------------------------------------------------------------------------------


def test_the_incidence_index_names_every_arc_of_an_element_in_edge_order() -> None:
    assert MIXED.incidence["a"] == (Incidence("e", 0), Incidence("g", 0), Incidence("g", 1))
    assert MIXED.incidence["e"] == (Incidence("f", 2),)
    assert "c" not in Hypergraph({"c": 0}, {}).incidence
    assert [(key, arc.sign) for key, _, arc in MIXED.edges_at("b")] == [("e", -1), ("f", 0)]


def test_arcs_that_lead_nowhere_are_found() -> None:
    assert [(key, arc.target) for key, arc in MIXED.dangling()] == [("f", "nowhere")]


def test_equality_does_not_look_at_the_order() -> None:
    backwards: Graph = Hypergraph(dict(reversed(MIXED.vertices.items())), dict(reversed(MIXED.edges.items())))
    assert backwards == MIXED
    assert list(backwards.vertices) == ["c", "b", "a"]
    assert MIXED.replace(vertices={"a": 1}) != MIXED
    assert LISTING_1 != MIXED


def test_replacing_keeps_places_and_leaves_the_original_alone() -> None:
    changed = MIXED.replace(vertices={"b": 7, "d": 8}, without=["a", "e"])
    assert dict(changed.vertices) == {"b": 7, "c": 0, "d": 8}
    assert list(changed.edges) == ["f", "g"]
    assert MIXED.vertices["b"] == 0


def test_a_graph_cannot_be_changed_in_place() -> None:
    given = {"a": 1}
    graph: Graph = Hypergraph(given, {})
    given["a"] = 2
    assert graph.vertices["a"] == 1
    with pytest.raises(TypeError, match="item assignment"):
        graph.vertices["a"] = 3  # type: ignore[index]
