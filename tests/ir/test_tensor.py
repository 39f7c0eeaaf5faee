"""The tensor of a graph with its weights, and the graph of a tensor."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from msgspec.structs import replace
from scipy.sparse import coo_array

import hymeko_x as hx
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.tensor import from_tensor, to_tensor
from hymeko_x.ir.values import Pose
from hymeko_x.testing import mechanisms

GRAPH: Hypergraph[str, int, str, parts.Weight] = Hypergraph(
    dict.fromkeys("abc", 0),
    {
        "e": Edge("e", (Arc("a", 1, (0.5, 2.0)), Arc("b", -1, Pose((1.0, 2.0, 3.0))))),
        "f": Edge("f", (Arc("b", 0, ("word", 1.0), "role"), Arc("c", -1, ()), Arc("e", 1), Arc("nowhere", 1, (0.0,)))),
        "g": Edge("g", (Arc("a", 1), Arc("a", -1))),
        "h": Edge("h"),
    },
)

ARM = """
arm : robot {
  base { mass 1 }
  tip { mass 2 }
  @turn : revolute { [0.5 0 0.25] + base - tip axis=Z }
}
"""


def without_zeros(array: coo_array) -> coo_array:
    kept = array.data != 0
    return coo_array((array.data[kept], [axis[kept] for axis in array.coords]), shape=array.shape)


def test_the_components_of_an_arc() -> None:
    tensor = to_tensor(GRAPH)
    assert tensor.elements == ("a", "b", "c", "e", "f", "g", "h", "nowhere")
    assert tensor.array.shape == (8, 4, 4, 9)
    dense = tensor.array.toarray()
    np.testing.assert_array_equal(dense[0, 0, 0], [1, 1, 0.5, 2, 0, 0, 0, 0, 0])
    np.testing.assert_array_equal(dense[1, 0, 1], [1, -1, 1, 2, 3, 1, 0, 0, 0])
    np.testing.assert_array_equal(dense[1, 1, 0], [1, 0, 0, 0, 0, 0, 0, 0, 0])
    assert dense[..., 0].sum() == sum(len(edge.arcs) for edge in GRAPH.edges.values())
    np.testing.assert_array_equal(dense[:7, :, :, 1].sum(axis=2), GRAPH.incidence_matrix().toarray())


def test_the_graph_of_a_tensor_is_the_graph_it_was_made_of() -> None:
    found = from_tensor(to_tensor(GRAPH))
    assert found == GRAPH
    assert [*found.edges] == [*GRAPH.edges]
    assert from_tensor(to_tensor(Hypergraph())) == Hypergraph()


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(mechanisms())
def test_a_mechanism_comes_back_from_its_tensor(mechanism: Mechanism) -> None:
    tensor = to_tensor(mechanism.graph)
    assert from_tensor(tensor) == mechanism.graph
    assert from_tensor(replace(tensor, array=without_zeros(tensor.array))) == mechanism.graph


def test_changed_numbers_are_changed_weights() -> None:
    arm = hx.loads(ARM, "hymeko")
    tensor = arm.to_tensor()
    row, column = (tensor.elements.index(key) for key in tensor.elements if key.name in ("base", "turn"))
    dense = tensor.array.toarray()
    dense[row, column - len(tensor.vertices), 0, 2:] = [1, 0, 0.5, 0, 0, 0, 2]
    moved = arm.with_tensor(replace(tensor, array=coo_array(dense)))
    assert moved.joints["turn"].pose == Pose.from_rpy((0.0, 0.0, math.pi), (1.0, 0.0, 0.5))
    assert arm.with_tensor(tensor) == arm != moved


def test_an_arc_that_is_gone_or_new() -> None:
    tensor = to_tensor(GRAPH)
    dense = tensor.array.toarray()
    dense[:, 2, 0] = 0
    dense[2, 3, 0, :3] = [1, -1, 0.75]
    found = from_tensor(replace(tensor, array=coo_array(dense)))
    assert found.edges["g"].arcs == (Arc("a", -1),)
    assert found.edges["h"].arcs == (Arc("c", -1, (0.75,)),)


def test_two_arcs_at_one_place_are_refused() -> None:
    tensor = to_tensor(GRAPH)
    dense = tensor.array.toarray()
    dense[2, 0, 0, 0] = 1
    with pytest.raises(ValueError, match="place 0 of edge e has two arcs"):
        from_tensor(replace(tensor, array=coo_array(dense)))
