"""Mechanisms: views of the tree, order, equality, names."""

from __future__ import annotations

from itertools import pairwise

import pytest
from msgspec.structs import replace

from hymeko_x.diagnostics import Origin
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import (
    ROOT,
    WORLD,
    Extra,
    Id,
    Mechanism,
    coupling_edge,
    joint_edge,
    layer_edge,
    mount_edge,
    numbers_weight,
    pose_weight,
    shape_edge,
)
from hymeko_x.ir.names import Names
from hymeko_x.ir.notations import word
from hymeko_x.ir.values import IDENTITY, Pose
from hymeko_x.source import file_stem

A, B, C, D, E = (Id("body", name) for name in "abcde")
HINGE = parts.Joint((parts.Dof(),))


def tree(*joints: tuple[str, Id, Id], world: bool = False, bodies: tuple[Id, ...] = (A, B, C, D, E)) -> Mechanism:
    vertices: dict[Id, parts.VertexPart] = {key: parts.Body() for key in bodies}
    if world:
        vertices[WORLD] = parts.World()
    return Mechanism("t", Hypergraph(vertices, {Id("joint", name): joint_edge(HINGE, above, below) for name, above, below in joints}))


def test_parents_come_before_children_and_siblings_in_joint_order() -> None:
    robot = tree(("1", D, E), ("2", A, C), ("3", A, B), ("4", C, D))
    assert list(robot.depth_first()) == [A, C, D, E, B]
    assert robot.roots == (A,)
    assert [joint.child for joint in robot.children[A]] == [C, B]
    assert robot.parent_joint[E].id == Id("joint", "1")


def test_children_of_the_world_and_open_bases_are_roots() -> None:
    robot = tree(("1", WORLD, B), ("2", B, A), world=True, bodies=(A, B, C))
    assert robot.roots == (B, C)
    assert list(robot.depth_first()) == [B, A, C]


def test_of_two_parents_the_first_one_counts_and_nothing_comes_twice() -> None:
    robot = tree(("1", A, C), ("2", B, C), bodies=(A, B, C))
    assert robot.parent_joint[C].parent == A
    assert list(robot.depth_first()) == [A, C, B]


def test_a_cycle_has_no_root_and_ends() -> None:
    robot = tree(("1", A, B), ("2", B, A), bodies=(A, B))
    assert robot.roots == ()
    assert list(robot.depth_first()) == []


def test_a_chain_of_a_hundred_thousand_bodies_is_walked_without_recursion() -> None:
    count = 100_000
    bodies = [Id("body", str(number)) for number in range(count)]
    edges = {Id("joint", above.name): joint_edge(HINGE, above, below) for above, below in pairwise(bodies)}
    robot = Mechanism("chain", Hypergraph({key: parts.Body() for key in bodies}, edges))
    assert list(robot.depth_first()) == bodies


def test_a_joint_without_both_ends_is_no_joint_of_the_tree() -> None:
    lost = Edge(HINGE, (Arc(A, 1),))
    robot = Mechanism("t", Hypergraph({A: parts.Body()}, {Id("joint", "lost"): lost}))
    assert dict(robot.joints) == {}
    assert [key.name for key, _, _ in robot.edges(parts.Joint)] == ["lost"]


def test_shapes_stand_at_their_bodies_with_mesh_and_material() -> None:
    mesh, steel = Id("mesh", "m"), Id("material", "steel")
    first = shape_edge(parts.Shape(parts.MeshShape(), parts.Role.VISUAL), A, Pose((0.0, 0.0, 1.0)), mesh, steel)
    second = shape_edge(parts.Shape(parts.Sphere(1.0), parts.Role.BOTH), A)
    vertices: dict[Id, parts.VertexPart] = {A: parts.Body(), mesh: parts.Mesh("m.stl"), steel: parts.Material()}
    robot = Mechanism("t", Hypergraph(vertices, {Id("shape", "2"): second, Id("shape", "1"): first}))
    views = robot.shapes[A]
    assert [(view.id.name, view.pose, view.mesh, view.material) for view in views] == [
        ("2", IDENTITY, None, None),
        ("1", Pose((0.0, 0.0, 1.0)), mesh, steel),
    ]


def test_identity_poses_are_left_out_so_that_equal_edges_are_equal() -> None:
    assert joint_edge(HINGE, A, B, IDENTITY) == joint_edge(HINGE, A, B)
    assert joint_edge(HINGE, A, B).arcs[0].weight is None
    turned = Pose((0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))
    assert pose_weight(joint_edge(HINGE, A, B, child_pose=turned).arcs[1]) == turned
    assert numbers_weight(coupling_edge(Id("joint", "f"), ((Id("joint", "l"), (0.5, 2.0)),)).arcs[1]) == (0.5, 2.0)
    assert [arc.sign for arc in mount_edge(A, Id("frame", "f")).arcs] == [1, -1]
    assert layer_edge(Id("texture", "t"), Id("material", "m")).data == parts.Layer("rgb")


def test_a_vertex_is_given_out_as_what_it_is() -> None:
    robot = tree(("1", A, B))
    assert robot.vertex(A, parts.Body) == parts.Body()
    with pytest.raises(TypeError, match="body 'a' carries Body, not Mesh"):
        robot.vertex(A, parts.Mesh)
    with pytest.raises(KeyError):
        robot.vertex(Id("body", "nobody"), parts.Body)


def test_places_notations_and_order_do_not_count_in_equality() -> None:
    robot = tree(("1", A, B), ("2", A, C))
    twin = Mechanism(
        "t",
        tree(("2", A, C), ("1", A, B), bodies=(E, D, C, B, A)).graph,
        origins={A: Origin("f", 1)},
        notations={A: {"k": "v"}},
        stereotypes={A: ("c",)},
        layout=(B,),
    )
    assert robot == twin
    assert twin.origin(A) == Origin("f", 1)
    assert twin.notation(A, word("k")) == "v"
    assert twin.notation(B, word("k")) is None
    assert robot.with_graph(Hypergraph()) != robot


def test_name_and_extras_count_in_equality() -> None:
    robot = tree()
    assert Mechanism("u", robot.graph) != robot
    marked = Mechanism("t", robot.graph, {ROOT: (Extra("urdf", "", "<x/>", 1), Extra("urdf", "a", "<y/>"))})
    assert marked != robot
    swapped = Mechanism("t", robot.graph, {ROOT: (Extra("urdf", "a", "<y/>"), Extra("urdf", "", "<x/>", 7))})
    assert marked == swapped, "the order of different places and the index are no difference"
    assert marked != Mechanism("t", robot.graph, {ROOT: (Extra("mjcf", "", "<x/>"), Extra("urdf", "a", "<y/>"))})


def test_names_that_are_taken_get_the_next_free_number() -> None:
    names = Names()
    assert [names.take("body", "a").name for _ in range(3)] == ["a", "a#2", "a#3"]
    assert names.take("joint", "a").name == "a"
    assert names.take("body", "b#2").name == "b#2"
    assert [names.take("body", "b").name for _ in range(2)] == ["b", "b#3"]
    assert names.free("body", "a") == names.free("body", "a") == Id("body", "a#4")


def test_many_equal_names_are_given_out_in_linear_time() -> None:
    names = Names()
    assert len({names.take("shape", "visual") for _ in range(50_000)}) == 50_000


@pytest.mark.parametrize(
    ("uri", "stem"),
    [
        ("package://a/b/hip.stl", "hip"),
        ("C:\\meshes\\hip.v2.obj", "hip.v2"),
        ("hip", "hip"),
        ("a/b/", "b"),
        ("", ""),
        (".obj", ".obj"),
        ("a.usdz[b/hip.png]", "hip"),
    ],
)
def test_an_asset_is_called_after_its_file(uri: str, stem: str) -> None:
    assert file_stem(uri) == stem


def test_an_id_is_shown_with_its_kind() -> None:
    assert str(Id("body", "a b")) == "body 'a b'"


def test_another_graph_changes_nothing_else() -> None:
    named = {name: object() for name in Mechanism.__struct_fields__ if name != "graph"}
    full = replace(Mechanism("r"), **named)  # type: ignore[arg-type]
    changed = full.replace(vertices={Id("body", "b"): parts.Body()})
    assert {name: getattr(changed, name) for name in named} == named


def test_a_note_stands_beside_others_of_its_element() -> None:
    robot = replace(tree(("j", A, B)), notations={A: {"frame": "2"}})
    assert robot.with_note([A, B], word("type"), "plane").notations == {A: {"frame": "2", "type": "plane"}, B: {"type": "plane"}}
    assert robot.with_note([], word("type"), "plane") is robot
