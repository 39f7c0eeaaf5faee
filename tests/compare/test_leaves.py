"""The leaves in which parts differ are all of them, to the last bit, and in the order of the fields."""

from __future__ import annotations

from msgspec import NODEFAULT

from hymeko_x.compare.leaves import Leaf, leaves_again, leaves_between, leaves_of
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism, joint_edge
from hymeko_x.ir.parts import Body, Dof, Inertial, Joint, Limits
from hymeko_x.ir.values import Pose, Written

A, B = Id("body", "a"), Id("body", "b")


def test_parts_that_say_the_same_have_no_leaves() -> None:
    a, b = (joint_edge(Joint((Dof(axis=(0.0, 0.0, float("1"))),)), A, B, Pose((0.0, float("0.5"), 0.0))) for _ in range(2))
    assert leaves_of(a, b) == []


def test_a_zero_of_the_other_sign_is_a_leaf() -> None:
    assert leaves_of(Dof(damping=0.0), Dof(damping=-0.0)) == [Leaf(("damping",), 0.0, -0.0, 0.0, True)]
    assert [leaf.path for leaf in leaves_of(Dof(axis=(0.0, 0.0, 1.0)), Dof(axis=(0.0, -0.0, 1.0)))] == [("axis",)]


def test_a_notation_is_a_leaf_that_does_not_count() -> None:
    written = Written("axis", (0.0, 0.0, 2.0))
    assert leaves_of(Dof(), Dof(written=written)) == [Leaf(("written",), None, written, None, False)]


def test_the_leaves_of_an_edge_are_in_its_data_and_on_its_arcs() -> None:
    a = joint_edge(Joint((Dof(limits=Limits(velocity=1.0)),)), A, B, Pose((0.0, 0.0, 1.0)))
    b = joint_edge(Joint((Dof(),)), A, B, Pose((0.0, 0.0, 2.0)))
    assert leaves_of(a, b) == [
        Leaf(("data", "dofs", 0, "limits", "velocity"), 1.0, None, None, True),
        Leaf(("arcs", 0, "weight", "xyz"), (0.0, 0.0, 1.0), (0.0, 0.0, 2.0), NODEFAULT, True),
    ]


def test_an_arc_to_another_element_is_a_leaf() -> None:
    a, b = joint_edge(Joint(), A, B), joint_edge(Joint(), A, Id("body", "c"))
    assert [leaf.path for leaf in leaves_of(a, b)] == [("arcs", 1, "target")]


def test_leaves_are_found_again_for_a_mechanism_that_shares_its_elements() -> None:
    joint = Id("joint", "j")
    a = Mechanism("a", Hypergraph({A: Body(Inertial(1.0)), B: Body(Inertial(2.0))}, {joint: joint_edge(Joint(), A, B)}))
    b = Mechanism("b", Hypergraph({A: Body(), B: Body()}, {joint: joint_edge(Joint((Dof(),)), A, B)}))
    for part in (Body(), Body(Inertial(3.0))):
        other = a.replace(vertices={A: part})
        again = leaves_again(other, a, b, leaves_between(a, b))
        assert list(again.items()) == list(leaves_between(other, b).items())
        assert again.keys() == leaves_between(other, b).keys() > {B}
