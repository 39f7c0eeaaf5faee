"""What URDF has no word for is rewritten so that every link stays where it was, for the same coordinates."""

from __future__ import annotations

import random

import pytest
from msgspec.structs import replace

from hymeko_x.diagnostics import Report
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, coupling_edge, joint_edge, shape_edge
from hymeko_x.ir.parts import (
    Body,
    Box,
    Capsule,
    Cylinder,
    Dof,
    DofKind,
    Ellipsoid,
    Joint,
    Limits,
    Mesh,
    MeshShape,
    Plane,
    Role,
    Shape,
    Sphere,
    World,
)
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse, plane_axes, pose_from_rpy, quat_about, rotation_angle, scaled, unit
from hymeko_x.rewrite import Options, choose, legalize
from tests.urdf.samples import dump, load, robot, visual

A, B, C, J = Id("body", "a"), Id("body", "b"), Id("body", "c"), Id("joint", "j")
AXIS = unit((1.0, 2.0, -2.0))


def legal(mechanism: Mechanism, **options: str) -> Mechanism:
    return legalize(choose(mechanism, Options(**options), Report()), "urdf", Report())  # type: ignore[arg-type]


def pair(joint: Joint, parent: Pose = IDENTITY, child: Pose = IDENTITY, above: Id = A) -> Mechanism:
    vertices = {A: Body(), B: Body()} if above == A else {WORLD: World(), B: Body()}
    return Mechanism("r", Hypergraph(vertices, {J: joint_edge(joint, above, B, parent, child)}))


def moved(dof: Dof, q: float) -> Pose:
    """Tr(a) M(q - ref) Tr(-a)."""
    turn = Pose((0.0, 0.0, 0.0), quat_about(dof.axis, q - dof.ref)) if dof.kind is DofKind.HINGE else Pose(scaled(dof.axis, q - dof.ref))
    return compose(compose(Pose(dof.anchor), turn), Pose(scaled(dof.anchor, -1.0)))


def place(mechanism: Mechanism, body: Id, coordinates: dict[str, float]) -> Pose:
    """The pose of a body in the root for coordinates by joint name, or by dof name where a joint has several."""
    joint = mechanism.parent_joint.get(body)
    if joint is None:
        return IDENTITY
    at = compose(place(mechanism, joint.parent, coordinates), joint.parent_pose)
    for dof in joint.joint.dofs:
        at = compose(at, moved(dof, coordinates[dof.name or joint.id.name]))
    return compose(at, inverse(joint.child_pose))


def assert_same_place(a: Pose, b: Pose) -> None:
    assert a.xyz == pytest.approx(b.xyz, abs=1e-12)
    assert rotation_angle(a.quat, b.quat) < 1e-7


PARENT, CHILD = pose_from_rpy((1.0, 2.0, 3.0), (0.1, 0.2, 0.3)), pose_from_rpy((0.5, 0.0, -1.0), (0.4, 0.0, 1.0))


@pytest.mark.parametrize(
    "joint",
    [
        Joint((Dof(DofKind.HINGE, AXIS, anchor=(1.0, -2.0, 0.5)),)),
        Joint((Dof(DofKind.HINGE, AXIS, ref=0.7, anchor=(1.0, -2.0, 0.5)),)),
        Joint((Dof(DofKind.SLIDE, AXIS, ref=0.7),)),
        Joint((Dof(DofKind.SLIDE, AXIS, name="s"), Dof(DofKind.HINGE, AXIS, name="h", ref=-0.3, anchor=(0.0, 1.0, 0.0)))),
        Joint(tuple(Dof(DofKind.HINGE, axis, name=name) for axis, name in (((1.0, 0.0, 0.0), "x"), ((0.0, 1.0, 0.0), "y"), (AXIS, "z")))),
        Joint(()),
    ],
)
@pytest.mark.parametrize("child", [IDENTITY, CHILD])
def test_links_stay_where_they_were(joint: Joint, child: Pose) -> None:
    before = pair(joint, PARENT, child)
    after = load(dump(legal(before)))
    rng = random.Random(0)
    for _ in range(5):
        q = {name: rng.uniform(-3.0, 3.0) for name in ("j", "s", "h", "x", "y", "z")}
        assert_same_place(place(after, B, q), place(before, B, q))


def test_a_joint_beside_its_childs_frame_gets_a_link_that_carries_its_frame() -> None:
    after = legal(pair(Joint((Dof(limits=Limits(-1.0, 1.0)),)), child=CHILD))
    assert [key.name for key, _ in after.vertices(Body)] == ["a", "b", "b_carrier"]
    assert [(view.id.name, view.parent.name, view.child.name) for view in after.joints.values()] == [
        ("j", "a", "b_carrier"),
        ("j_frame", "b_carrier", "b"),
    ]
    assert after.joints[J].joint.dofs[0].limits == Limits(-1.0, 1.0)


def test_a_ball_becomes_three_hinges_about_x_y_and_z() -> None:
    after = legal(pair(Joint((Dof(DofKind.BALL, damping=0.5, name="n"),))))
    assert [(view.id.name, view.joint.dofs[0].axis, view.joint.dofs[0].damping) for view in after.joints.values()] == [
        ("n_x", (1.0, 0.0, 0.0), 0.5),
        ("n_y", (0.0, 1.0, 0.0), 0.5),
        ("n_z", (0.0, 0.0, 1.0), 0.5),
    ]


def test_a_ball_that_urdf_has_is_left_alone() -> None:
    mechanism = load(robot('<link name="a"/><link name="b"/><joint name="j" type="ball"><parent link="a"/><child link="b"/></joint>'))
    assert legal(mechanism) == mechanism


def test_a_planar_joint_says_nothing_of_its_dofs_so_that_names_and_damping_make_a_chain() -> None:
    x, y = plane_axes(AXIS)
    plain = (Dof(DofKind.SLIDE, x), Dof(DofKind.SLIDE, y), Dof(DofKind.HINGE, AXIS))
    for dofs, count in (((*plain[:2], replace(plain[2], damping=0.1)), 3), ((replace(plain[0], name="x"), *plain[1:]), 3), (plain, 1)):
        assert len(legal(pair(Joint(dofs))).joints) == count


def test_what_hangs_on_a_dof_follows_it() -> None:
    mechanism = pair(Joint((Dof(DofKind.SLIDE, name="s"), Dof(DofKind.HINGE, name="h"))))
    follower = joint_edge(Joint((Dof(limits=Limits(0.0, 1.0)),)), B, C)
    coupling = coupling_edge(Id("joint", "k"), ((J, (0.0, 2.0)),))
    leader = coupling.arcs[1]
    coupling = type(coupling)(coupling.data, (coupling.arcs[0], type(leader)(leader.target, leader.sign, leader.weight, "h")))
    moved = mechanism.replace(vertices={C: Body()}, edges={Id("joint", "k"): follower, Id("coupling", "k"): coupling})
    assert '<mimic joint="h" multiplier="2" offset="0"/>' in dump(legal(moved))


def test_the_world_becomes_a_link_without_mass() -> None:
    after = load(dump(legal(pair(Joint((Dof(DofKind.SLIDE),)), above=WORLD))))
    assert [key.name for key, _ in after.vertices(Body)] == ["world", "b"]
    assert after.joints[J].parent == Id("body", "world")


def test_a_world_on_which_nothing_hangs_is_left_out() -> None:
    mechanism = Mechanism("r", Hypergraph({WORLD: World(), A: Body()}, {}))
    assert list(legal(mechanism).graph.vertices) == [A]


def test_a_world_without_bodies_is_a_link() -> None:
    assert legal(Mechanism("m", Hypergraph({WORLD: World()}))).graph.vertices == {Id("body", "world"): Body()}


def test_several_roots_are_fixed_to_one() -> None:
    report = Report()
    after = legalize(Mechanism("r", Hypergraph({A: Body(), B: Body()}, {})), "urdf", report)
    assert after.roots == (Id("body", "world"),)
    assert {view.child for view in after.joints.values()} == {A, B}
    assert [str(d) for d in report] == [
        "warning[HX101]: the format has one root, and 2 links have no parent; fixed to link 'world': 'a', 'b'"
    ]


@pytest.mark.parametrize(("base", "name", "kind"), [("fixed", "a_base", "fixed"), ("free", "a_free", "floating")])
def test_the_user_decides_what_an_open_base_does(base: str, name: str, kind: str) -> None:
    text = dump(legal(Mechanism("r", Hypergraph({A: Body()}, {})), base=base))
    assert f'<joint name="{name}" type="{kind}">' in text
    assert '<parent link="world"/>' in text


def shaped(geometry: object, role: Role = Role.COLLISION) -> Mechanism:
    edges = {Id("shape", "s"): shape_edge(Shape(geometry, role), A, Pose((0.0, 0.0, 1.0)))}  # type: ignore[arg-type]
    return Mechanism("r", Hypergraph({A: Body()}, edges))


def test_a_capsule_becomes_a_cylinder_and_two_spheres() -> None:
    views = legal(shaped(Capsule(0.5, 2.0))).shapes[A]
    assert [(view.shape.geometry, view.pose.xyz) for view in views] == [
        (Cylinder(0.5, 2.0), (0.0, 0.0, 1.0)),
        (Sphere(0.5), (0.0, 0.0, 2.0)),
        (Sphere(0.5), (0.0, 0.0, 0.0)),
    ]


@pytest.mark.parametrize("geometry", [Capsule(0.5, 2.0), Plane((2.0, 2.0)), Ellipsoid((1.0, 2.0, 3.0))])
def test_what_is_seen_and_collides_is_rewritten_and_told_once(geometry: object) -> None:
    report = Report()
    after = legalize(shaped(geometry, Role.BOTH), "urdf", report)
    assert [(diagnostic.code.id, diagnostic.element) for diagnostic in report] == [("HX101", "shape 's'")]
    seen, touched = ([v for v in after.shapes[A] if v.shape.role is role] for role in (Role.VISUAL, Role.COLLISION))
    assert [(v.shape.geometry, v.pose, v.mesh) for v in seen] == [(v.shape.geometry, v.pose, v.mesh) for v in touched] != []


def test_a_capsule_that_urdf_has_is_left_alone() -> None:
    mechanism = load(robot(visual('<geometry><capsule radius="1" length="2"/></geometry>')))
    assert legal(mechanism) == mechanism


def test_planes_become_thin_boxes_below_their_surface() -> None:
    views = legal(shaped(Plane((2.0, 0.0)))).shapes[A]
    assert [(view.shape.geometry, view.pose.xyz) for view in views] == [(Box((4.0, 100.0, 1e-3)), (0.0, 0.0, 1.0 - 5e-4))]


def test_an_ellipsoid_becomes_a_mesh_of_a_sphere_in_a_file_of_its_own() -> None:
    from hymeko_x.backends.urdf import write

    after = legal(shaped(Ellipsoid((1.0, 2.0, 3.0))))
    assert after.shapes[A][0].shape.geometry == MeshShape()
    mesh = next(part for _, part in after.vertices(Mesh))
    assert mesh.scale == (1.0, 2.0, 3.0)
    points = [mesh.vertices[at : at + 3] for at in range(0, len(mesh.vertices), 3)]
    assert all(sum(x * x for x in point) == pytest.approx(1.0) for point in points)
    volume = sum(_determinant(*(points[corner] for corner in mesh.faces[at : at + 3])) for at in range(0, len(mesh.faces), 3)) / 6.0
    assert 4.0 < volume < 4.19
    package = write(after, Options(), Report())
    assert list(package.files) == ["shapes/a_ellipsoid.obj"]
    assert b'<mesh filename="shapes/a_ellipsoid.obj" scale="1 2 3"/>' in package.main


def test_ellipsoids_of_all_sizes_share_one_file() -> None:
    from hymeko_x.backends.urdf import write

    both = {
        Id("shape", name): shape_edge(Shape(Ellipsoid(radii), Role.BOTH), A) for name, radii in (("s", (1.0, 2.0, 3.0)), ("t", (1.0,) * 3))
    }
    assert list(write(legal(Mechanism("r", Hypergraph({A: Body()}, both))), Options(), Report()).files) == ["shapes/a_ellipsoid.obj"]


def _determinant(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...]) -> float:
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])


def test_a_shape_that_is_seen_and_collides_becomes_two() -> None:
    views = legal(shaped(Sphere(1.0), Role.BOTH)).shapes[A]
    assert [view.shape.role for view in views] == [Role.VISUAL, Role.COLLISION]
