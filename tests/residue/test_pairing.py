"""Which shape of the image is which of the source, where neither has a name of its own."""

from __future__ import annotations

import pytest

from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism, shape_edge
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Joint, Mesh, MeshShape, Role, Shape, Sphere, Tendon
from hymeko_x.ir.values import Pose
from hymeko_x.residue.align import align
from hymeko_x.residue.alike import is_rounded
from hymeko_x.residue.pairing import other_names
from tests.robots import body, chain

HERE, ABOVE = Pose((0.0, 0.0, 0.1)), Pose((0.0, 0.0, 0.2))


def robot(*shapes: tuple[str, Shape, Pose, str | None]) -> Mechanism:
    """A body with shapes: id, content, pose, name of the mesh."""
    bare = chain()
    meshes = {Id("mesh", mesh): Mesh(f"{mesh}.stl") for _, _, _, mesh in shapes if mesh}
    edges = {
        Id("shape", name): shape_edge(shape, body("b0"), pose, Id("mesh", mesh) if mesh else None) for name, shape, pose, mesh in shapes
    }
    return bare.with_graph(Hypergraph({**bare.graph.vertices, **meshes}, {**bare.graph.edges, **edges}))


def visual(geometry: object = MeshShape()) -> Shape:
    return Shape(geometry, Role.VISUAL)  # type: ignore[arg-type]


def ids(names: dict[str, str]) -> dict[Id, Id]:
    return {Id("shape", old): Id("shape", new) for old, new in names.items()}


def test_a_mesh_behind_a_cylinder_is_no_cylinder() -> None:
    rod = Cylinder(0.01, 0.1)
    source = robot(("b0/shape", Shape(rod, Role.BOTH), HERE, None), ("b0/visual", visual(), ABOVE, "foot"))
    image = robot(
        ("b0/visual", visual(rod), HERE, None),
        ("b0/visual#2", visual(), ABOVE, "foot"),
        ("b0/collision", Shape(rod, Role.COLLISION), HERE, None),
    )
    alignment, aligned = align(image, source)
    assert dict(alignment.names) == ids({"b0/visual": "b0/shape", "b0/visual#2": "b0/visual"})
    assert aligned.graph == source.graph


def test_a_shape_without_a_name_is_no_shape_with_one() -> None:
    rod, cover = Capsule(0.05, 0.5), Shape(Cylinder(0.01, 0.1), Role.VISUAL, "cover")
    source = robot(("b0/shape", Shape(rod, Role.BOTH), HERE, None), ("b0/visual", cover, ABOVE, None))
    image = robot(
        ("b0/visual", visual(rod), HERE, None),
        ("b0/visual#2", cover, ABOVE, None),
        ("b0/collision", Shape(rod, Role.COLLISION), HERE, None),
    )
    alignment, aligned = align(image, source)
    assert dict(alignment.names) == ids({"b0/visual": "b0/shape", "b0/visual#2": "b0/visual"})
    assert aligned.graph == source.graph


def test_meshes_of_one_place_are_paired_by_their_files() -> None:
    source = robot(("b0/visual", visual(), HERE, "left"), ("b0/visual#2", visual(), HERE, "right"))
    image = robot(("b0/visual", visual(), HERE, "right"), ("b0/visual#2", visual(), HERE, "left"))
    assert other_names(image, source) == ids({"b0/visual": "b0/visual#2", "b0/visual#2": "b0/visual"})
    assert align(image, source)[1].graph == source.graph


def test_what_only_moved_or_grew_keeps_its_partner() -> None:
    source = robot(("b0/visual", visual(Sphere(1.0)), HERE, None), ("b0/visual#2", visual(Sphere(2.0)), HERE, None))
    image = robot(("b0/visual", visual(Sphere(1.5)), HERE, None), ("b0/visual#2", visual(Sphere(2.0)), ABOVE, None))
    assert other_names(image, source) == {}


def test_a_shape_of_another_sort_is_the_one_in_its_place() -> None:
    source = robot(("b0/visual", visual(Capsule(1.0, 2.0)), HERE, None))
    image = robot(("b0/visual", visual(Cylinder(1.0, 2.0)), HERE, None))
    assert other_names(image, source) == {}


def test_a_shape_whose_name_another_one_has_gets_a_free_one() -> None:
    source = robot(("b0/visual", visual(Box((1.0, 1.0, 1.0))), HERE, None))
    image = robot(("b0/visual", visual(Sphere(1.0)), HERE, None), ("b0/visual#2", visual(Box((1.0, 1.0, 1.0))), HERE, None))
    assert other_names(image, source) == ids({"b0/visual#2": "b0/visual", "b0/visual": "b0/visual#3"})
    assert align(image, source)[1].graph.edges.keys() == {Id("shape", "b0/visual"), Id("shape", "b0/visual#3")}


def test_shapes_of_a_tendon_are_paired_in_the_order_of_its_path() -> None:
    """A stage has other ids for them, by which nothing tells which of three alike is which."""
    robots = []
    for ids_of_shapes in (("a", "b", "c"), ("g1", "g2", "g3")):
        bare = chain(Joint(), Joint())
        shapes = [Id("shape", name) for name in ids_of_shapes]
        edges = {key: shape_edge(Shape(Sphere(1.0), Role.BOTH), body(f"b{number}"), Pose()) for number, key in enumerate(shapes)}
        path = tuple(Arc(key, 0, role="wrap") for key in shapes)
        tendon = {Id("tendon", "cable"): Edge(Tendon(), path)}
        robots.append(bare.with_graph(Hypergraph(bare.graph.vertices, {**bare.graph.edges, **edges, **tendon})))
    source, image = robots
    assert other_names(image, source) == ids({"g1": "a", "g2": "b", "g3": "c"})


@pytest.mark.parametrize(("now", "is_same"), [(6.25020920497, True), (6.250209, True), (6.2502091, False), (6.2503, False)])
def test_a_number_that_was_rounded_or_computed_again_is_no_edit(now: float, *, is_same: bool) -> None:
    assert is_rounded(now, 6.25020920502) is is_same
