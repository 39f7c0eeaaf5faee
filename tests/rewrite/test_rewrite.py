"""What MuJoCo cannot represent, rule by rule: what is rewritten, what is reported, and that a second run changes nothing."""

from __future__ import annotations

import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hymeko_x.diagnostics import Report, Severity
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, coupling_edge, joint_edge, shape_edge
from hymeko_x.ir.parts import (
    Actuator,
    Body,
    Box,
    Capsule,
    Coupling,
    Cylinder,
    Dof,
    DofKind,
    Drive,
    Frame,
    Inertial,
    Joint,
    Limits,
    Loop,
    Mesh,
    MeshShape,
    NoShape,
    Plane,
    Role,
    Shape,
    Sphere,
)
from hymeko_x.ir.values import X, Y, Z, pose
from hymeko_x.rewrite import Options, choose, legalize
from hymeko_x.rewrite.inertia import LEAST, physical, principal_moments
from hymeko_x.testing import mechanisms
from tests.robots import SOLID, body, chain, hinge, joint

FREE = Joint((Dof(DofKind.FREE),))


def legal(mechanism: Mechanism, options: Options | None = None) -> tuple[Mechanism, list[str]]:
    """The mechanism for MuJoCo, and what was reported (about open bases only where options are given); a second run changes nothing."""
    report = Report()
    chosen = choose(mechanism, options or Options(), report)
    assert choose(chosen, options or Options(), Report()) == chosen
    result = legalize(chosen, "mjcf", report)
    assert legalize(result, "mjcf", Report()) == result
    reported = [f"{d.severity.value} {d.code.id} {d.message}" for d in report]
    return result, reported if options else [words for words in reported if "has no parent joint; it is fixed" not in words]


def dofs_of(mechanism: Mechanism, name: str) -> tuple[Dof, ...]:
    return mechanism.joints[joint(name)].joint.dofs


def inertial_of(mechanism: Mechanism, name: str) -> Inertial | None:
    return mechanism.vertex(body(name), Body).inertial


# ---- all rules ---------------------------------------------------------------------------------------------------------------


def test_a_legal_mechanism_stays_as_it_is_and_nothing_is_reported() -> None:
    mechanism = chain(hinge(axis=Z, limits=Limits(-1.0, 1.0, 2.0, 3.0)), hinge(axis=X))
    assert legal(mechanism) == (mechanism, [])


def test_a_target_without_rules_takes_every_mechanism_as_it_is() -> None:
    mechanism = chain(hinge(limits=Limits(1.0, -1.0)))
    assert legalize(mechanism, "hymeko", Report()) is mechanism


OPTIONS = st.builds(Options, st.sampled_from([None, "fixed", "free"]), st.sampled_from([None, "none", "motor", "position", "velocity"]))


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(mechanisms(), OPTIONS)
@pytest.mark.unread("HX101")
def test_legalizing_twice_is_legalizing_once(mechanism: Mechanism, options: Options) -> None:
    legal(mechanism, options)


# ---- names -------------------------------------------------------------------------------------------------------------------


def test_an_empty_name_and_one_that_xml_cannot_hold_are_replaced() -> None:
    mechanism = chain(hinge(), vertices={Id("frame", ""): Frame(), Id("frame", "a\0b"): Frame()})
    result, reported = legal(mechanism)
    assert Id("frame", "frame") in result.graph.vertices
    assert Id("frame", "a_b") in result.graph.vertices
    assert reported == [
        "warning HX102 the name of a frame is empty; it is written as 'frame'",
        "warning HX102 the name of a frame 'a\\x00b' has characters that XML cannot hold; it is written as 'a_b'",
    ]


def test_meshes_of_the_same_name_are_told_apart() -> None:
    one, two = Mesh("one.stl", name="part"), Mesh("two.stl", name="part")
    result, reported = legal(chain(vertices={Id("mesh", "a"): one, Id("mesh", "b"): two}))
    assert result.vertex(Id("mesh", "b"), Mesh).name == "part#2"
    assert reported == ["note HX102 another mesh is called 'part' already; this one is written as 'part#2'"]


# ---- world and base ------------------------------------------------------------------------------------------------------------


def with_world_link(inertial: Inertial | None) -> Mechanism:
    mechanism = chain(hinge(axis=Z))
    link = {body("world"): Body(inertial)}
    fixed = {joint("stand"): joint_edge(Joint(), body("world"), body("b0"))}
    return mechanism.replace(vertices=link, edges=fixed)


def test_a_root_link_called_world_is_the_world() -> None:
    result, reported = legal(with_world_link(None), Options())
    assert body("world") not in result.graph.vertices
    assert result.joints[joint("stand")].parent == WORLD
    assert reported == []


def test_a_root_link_called_world_with_a_mass_is_renamed() -> None:
    result, reported = legal(with_world_link(SOLID))
    assert inertial_of(result, "world_link") == SOLID
    assert reported == [
        "warning HX102 link 'world' has a mass, so it is not the world itself, which alone may have this name; "
        "it is written as 'world_link'"
    ]


def test_a_link_called_world_inside_the_tree_is_renamed() -> None:
    mechanism = chain(hinge(axis=Z))
    child = {joint("j2"): joint_edge(Joint(), body("b1"), body("world"))}
    result, reported = legal(mechanism.replace(vertices={body("world"): Body()}, edges=child))
    assert result.joints[joint("j2")].child == body("world_link")
    assert [line.split(",")[0] for line in reported] == ["warning HX102 link 'world' is not the root"]


def test_an_open_base_is_fixed_by_default_and_that_is_reported() -> None:
    mechanism = chain(hinge(axis=Z))
    assert legal(mechanism, Options()) == (mechanism, ["note HX101 body 'b0' has no parent joint; it is fixed to the world"])


def test_an_open_base_floats_where_the_user_wants_it() -> None:
    result, reported = legal(chain(hinge(axis=Z)), Options(base="free"))
    view = result.parent_joint[body("b0")]
    assert (view.parent, [dof.kind for dof in view.joint.dofs]) == (WORLD, [DofKind.FREE])
    assert reported == []


@pytest.mark.unread("HX101")
def test_a_base_that_the_source_fixes_does_not_float_and_that_is_reported() -> None:
    _, reported = legal(with_world_link(None), Options(base="free"))
    assert reported == ["warning HX101 body 'b0' does not float: joint 'stand' fixes it to the world"]


# ---- joints --------------------------------------------------------------------------------------------------------------------


def test_a_screw_becomes_a_hinge_and_a_coupled_slide() -> None:
    screw = Joint((Dof(DofKind.SCREW, Z, Limits(-1.0, 1.0), pitch=0.02, ref=0.5),))
    result, reported = legal(chain(screw))
    turn, slide = dofs_of(result, "j1")
    assert (turn.kind, turn.name, turn.limits, turn.ref) == (DofKind.HINGE, "j1", Limits(-1.0, 1.0), 0.5)
    assert (slide.kind, slide.name, slide.axis) == (DofKind.SLIDE, "j1_slide", Z)
    ((_, _, arcs),) = result.edges(Coupling)
    assert [(arc.role, arc.weight) for arc in arcs] == [("j1_slide", (1.0,)), ("j1", (-0.01, 0.02))]
    assert reported == ["note HX101 joint 'j1' is a screw; it is written as hinge 'j1' and slide 'j1_slide', coupled by the pitch"]


def test_what_follows_a_screw_follows_its_hinge() -> None:
    follow = {Id("coupling", "c"): coupling_edge(joint("j2"), ((joint("j1"), (0.0, 2.0)),))}
    result, _ = legal(chain(Joint((Dof(DofKind.SCREW, Z, pitch=0.02),)), hinge(axis=Z), edges=follow))
    arcs = result.graph.edges[Id("coupling", "c")].arcs
    assert (arcs[1].target, arcs[1].role) == (joint("j1"), "j1")


def test_a_free_joint_inside_the_tree_becomes_three_slides_and_a_ball() -> None:
    result, reported = legal(chain(FREE))
    assert [(dof.kind, dof.name) for dof in dofs_of(result, "j1")] == [
        (DofKind.SLIDE, "j1_TX"),
        (DofKind.SLIDE, "j1_TY"),
        (DofKind.SLIDE, "j1_TZ"),
        (DofKind.BALL, "j1_R"),
    ]
    assert reported == [
        "note HX101 joint 'j1' floats below body 'b0', where only a child of the world may; it is written as three slides and a ball"
    ]


def test_the_dofs_of_a_planar_joint_get_names_of_their_own() -> None:
    planar = Joint((Dof(DofKind.SLIDE, X), Dof(DofKind.SLIDE, Y), Dof(DofKind.HINGE, Z)))
    other = Joint((Dof(DofKind.HINGE, Z, name="j1_TX"),))
    result, reported = legal(chain(planar, other))
    assert [dof.name for dof in dofs_of(result, "j1")] == ["j1_TX#2", "j1_TY", "j1_RZ"]
    assert reported == ["warning HX102 'j1_TX' would name two dofs; the one of joint 'j1' is written as 'j1_TX#2'"]


def test_seven_hinges_on_one_joint_are_spread_over_two_bodies() -> None:
    result, reported = legal(chain(Joint((Dof(DofKind.HINGE, Z),) * 7)))
    assert [len(view.joint.dofs) for view in result.joints.values()] == [1, 6]
    assert result.parent_joint[body("b1")].parent == body("b1_carrier")
    assert any("cannot all sit on one body; 1 body in between carries the first ones" in line for line in reported)


def test_a_rotation_below_a_ball_gets_a_body_of_its_own_and_arcs_follow_it() -> None:
    both = Joint((Dof(DofKind.BALL), Dof(DofKind.HINGE, Z, name="twist")))
    drive = {Id("drive", "d"): Edge(Drive(), (Arc(Id("actuator", "m"), 1), Arc(joint("j1"), -1, None, "1")))}
    mechanism = chain(both, edges=drive, vertices={Id("actuator", "m"): Actuator("motor")})
    result, _ = legal(mechanism)
    assert [view.joint.dofs[0].kind for view in result.joints.values()] == [DofKind.HINGE, DofKind.BALL]
    arc = result.graph.edges[Id("drive", "d")].arcs[1]
    assert dof_number(result.joints[arc.target].joint, arc.role) == 0
    assert result.joints[arc.target].joint.dofs[0].name == "twist"


# ---- loops ---------------------------------------------------------------------------------------------------------------------


def diamond(*closing: Dof) -> Mechanism:
    """Two branches from b0 that meet in b2."""
    mechanism = chain(hinge(axis=Z), hinge(axis=Z))
    second = {joint("again"): joint_edge(Joint(closing), body("b0"), body("b2"), pose((0.0, 1.0, 0.0)))}
    return mechanism.replace(edges=second)


def test_a_fixed_second_parent_becomes_a_weld() -> None:
    result, reported = legal(diamond())
    ((key, loop, arcs),) = result.edges(Loop)
    assert (key, loop.kind, [arc.target for arc in arcs]) == (Id("loop", "again"), "weld", [body("b0"), body("b2")])
    assert reported == ["note HX101 joint 'again' holds body 'b2', which has another parent; it is written as a closure of the loop"]


def test_a_second_hinge_becomes_two_points_that_stay_together() -> None:
    result, _ = legal(diamond(Dof(DofKind.HINGE, Z)))
    assert [loop.kind for _, loop, _ in result.edges(Loop)] == ["connect", "connect"]
    assert all(arc.target.kind == "frame" for _, _, arcs in result.edges(Loop) for arc in arcs)


def test_a_second_slide_is_left_out_and_that_is_a_warning() -> None:
    result, reported = legal(diamond(Dof(DofKind.SLIDE, Z)))
    assert not list(result.edges(Loop))
    assert reported == [
        "warning HX104 joint 'again' holds body 'b2', which has another parent; a loop cannot be closed by such a joint, which is left out"
    ]


def test_bodies_in_a_ring_without_a_root_are_opened_once() -> None:
    mechanism = chain(hinge(axis=Z))
    ring = {joint("back"): joint_edge(Joint(), body("b1"), body("b0"))}
    result, _ = legal(mechanism.replace(edges=ring))
    assert list(result.depth_first()) == [body("b0"), body("b1")]
    assert [loop.kind for _, loop, _ in result.edges(Loop)] == ["weld"]


# ---- limits --------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given_limits", "written", "reported"),
    [
        (Limits(-math.inf, math.inf), Limits(), []),
        (Limits(1.0, -1.0), Limits(), ["warning lower limit 1.0 is above upper limit -1.0; it is written without position limits"]),
        (
            Limits(0.0, 0.0),
            Limits(),
            ["warning both limits are 0, as where URDF leaves them out; it is written without position limits"],
        ),
        (Limits(0.5, 0.5), Limits(0.5, 0.500000001), ["note both limits are 0.5; 1e-09 of play stands for a locked joint"]),
        (Limits(0.5), Limits(0.5, 1e10), ["note has no upper limit; 1e+10 stands for the missing bound"]),
        (Limits(None, 0.5), Limits(-1e10, 0.5), ["note has no lower limit; 1e+10 stands for the missing bound"]),
        (Limits(effort=0.0), Limits(), ["note effort limit 0 cannot be told from no limit; it is left out"]),
        (Limits(effort=-3.0), Limits(effort=3.0), ["warning effort limit -3.0 is negative; 3.0 is written"]),
        (Limits(effort=math.inf), Limits(), []),
        (Limits(-1.0, 1.0, 2.0, 3.0), Limits(-1.0, 1.0, 2.0, 3.0), []),
    ],
)
def test_limits_become_intervals(given_limits: Limits, written: Limits, reported: list[str]) -> None:
    result, lines = legal(chain(hinge(axis=Z, limits=given_limits)))
    assert dofs_of(result, "j1")[0].limits == written
    assert [line.replace("HX101 joint 'j1': ", "") for line in lines] == reported


# ---- couplings -----------------------------------------------------------------------------------------------------------------


def coupled(leader: Id, *coefficients: float, joints: tuple[Joint, ...] = (hinge(axis=Z), hinge(axis=Z))) -> Mechanism:
    return chain(*joints, edges={Id("coupling", "c"): coupling_edge(joint("j2"), ((leader, coefficients),))})


def test_a_coupling_to_a_joint_that_does_not_exist_is_left_out() -> None:
    result, reported = legal(coupled(joint("missing"), 0.0, 1.0))
    assert not list(result.edges(Coupling))
    assert reported == ["warning HX104 coupling 'c' is left out: joint 'missing' does not exist"]


def test_a_coupling_to_a_fixed_joint_stays_and_holds_the_follower() -> None:
    mechanism = coupled(joint("j1"), 0.3, 1.0, joints=(Joint(), hinge(axis=Z)))
    result, reported = legal(mechanism)
    assert result == mechanism
    assert reported == ["note HX101 coupling 'c' follows joint 'j1', which is fixed; the follower is held at the constant of the relation"]


def test_a_fixed_follower_and_a_joint_that_follows_itself_are_left_out() -> None:
    _, fixed = legal(coupled(joint("j1"), 0.0, 1.0, joints=(hinge(axis=Z), Joint())))
    assert fixed == ["warning HX104 coupling 'c' is left out: joint 'j2' is fixed and cannot follow"]
    _, itself = legal(coupled(joint("j2"), 0.0, 1.0))
    assert itself == ["warning HX104 coupling 'c' is left out: joint 'j2' follows itself"]


def test_a_coupling_of_the_fifth_power_is_left_out() -> None:
    _, reported = legal(coupled(joint("j1"), 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))
    assert reported == ["warning HX104 coupling 'c' is left out: its polynomial has a power above 4"]


# ---- inertia -------------------------------------------------------------------------------------------------------------------


def test_a_moving_body_without_mass_gets_the_least_one() -> None:
    result, reported = legal(chain(hinge(axis=Z), inertial=None))
    assert inertial_of(result, "b1") == Inertial(LEAST, tensor=(LEAST, LEAST, LEAST, 0.0, 0.0, 0.0))
    assert inertial_of(result, "b0") is None
    assert reported == ["warning HX103 body 'b1': moves and has no mass; mass 1e-10 and inertia 1e-10 1e-10 1e-10 0 0 0 are written"]


def test_a_moving_body_with_a_mass_fixed_to_it_needs_none_of_its_own() -> None:
    mechanism = chain(hinge(axis=Z), Joint(), Joint(), inertial=None)
    heavy = mechanism.replace(vertices={body("b3"): Body(SOLID)})
    assert legal(heavy) == (heavy, [])


def test_a_mass_behind_another_moving_joint_does_not_count() -> None:
    mechanism = chain(hinge(axis=Z), hinge(axis=Z), inertial=None)
    heavy = mechanism.replace(vertices={body("b2"): Body(SOLID)})
    result, _ = legal(heavy)
    assert inertial_of(result, "b1") == Inertial(LEAST, tensor=(LEAST, LEAST, LEAST, 0.0, 0.0, 0.0))


def test_a_mass_without_extension_keeps_its_mass_and_gets_the_least_moments() -> None:
    result, _ = legal(chain(hinge(axis=Z), inertial=Inertial(2.0, (1.0, 0.0, 0.0), (0.0, 1.0, 1.0, 0.0, 0.0, 0.0))))
    assert inertial_of(result, "b1") == Inertial(2.0, (1.0, 0.0, 0.0), (1e-10, 1.0 + 1e-10, 1.0 + 1e-10, 0.0, 0.0, 0.0))
    assert inertial_of(result, "b0") == Inertial(2.0, (1.0, 0.0, 0.0), (0.0, 1.0, 1.0, 0.0, 0.0, 0.0))


def test_moments_that_break_the_triangle_inequality_are_repaired_by_the_smallest_change() -> None:
    result, reported = legal(chain(inertial=Inertial(1.0, tensor=(1.0, 1.0, 5.0, 0.0, 0.0, 0.0))))
    assert inertial_of(result, "b0") == Inertial(1.0, tensor=(2.0, 2.0, 4.0, 0.0, 0.0, 0.0))
    assert reported == [
        "warning HX103 body 'b0': of the principal moments 1.0, 1.0, 5.0 the last exceeds the sum of the others: "
        "1 1 5 0 0 0 becomes 2 2 4 0 0 0"
    ]


def test_a_flat_plate_is_physical_to_the_last_bit() -> None:
    plate = (0.1, 0.2, 0.1 + 0.2, 0.0, 0.0, 0.0)
    assert physical(plate) == plate


def test_a_change_by_rounding_alone_is_a_note() -> None:
    noise = Inertial(1.0, tensor=(0.0, 0.0, 0.0, 0.0, 2.4e-35, 0.0))
    _, reported = legal(chain(inertial=noise))
    assert [line.split(":")[0] for line in reported] == ["note HX103 body 'b0'"]


def test_a_negative_mass_becomes_none() -> None:
    result, reported = legal(chain(inertial=Inertial(-1.0, tensor=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))))
    assert inertial_of(result, "b0") == Inertial(0.0, tensor=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
    assert reported == ["warning HX103 body 'b0': mass -1.0 is negative; 0 is written"]


COMPONENT = st.floats(-2.0, 2.0)


@settings(max_examples=300, deadline=None)
@given(st.tuples(COMPONENT, COMPONENT, COMPONENT, COMPONENT, COMPONENT, COMPONENT))
def test_every_repaired_tensor_is_physical_and_no_physical_one_is_nearer(tensor: tuple[float, ...]) -> None:
    xx, yy, zz, xy, xz, yz = tensor
    repaired = physical((xx, yy, zz, xy, xz, yz))
    low, middle, high = principal_moments(repaired)
    assert low >= 0.0
    assert low + middle >= high * (1.0 - 1e-15)
    assert physical(repaired) == repaired
    shrunk = tuple(0.5 * a + 0.5 * b for a, b in zip(repaired, tensor, strict=True))
    half_low, half_middle, half_high = principal_moments(shrunk)  # type: ignore[arg-type]
    halfway_is_physical = half_low >= 1e-9 and half_low + half_middle >= half_high + 1e-9
    assert not halfway_is_physical or repaired == (xx, yy, zz, xy, xz, yz)


# ---- shapes --------------------------------------------------------------------------------------------------------------------


def shaped(geometry: object, *, on: str = "b0", name: str | None = None, mesh: Id | None = None) -> Mechanism:
    shape = Shape(geometry, Role.COLLISION, name)  # type: ignore[arg-type]
    return chain(hinge(axis=Z), edges={Id("shape", "s"): shape_edge(shape, body(on), mesh=mesh)})


@pytest.mark.parametrize(
    ("source", "written"),
    [
        (Box((0.0, 1.0, 2.0)), Box((1e-6, 1.0, 2.0))),
        (Box((-1.0, 1.0, 2.0)), Box((1.0, 1.0, 2.0))),
        (Sphere(0.0), Sphere(1e-6)),
        (Cylinder(0.1, 0.0), Cylinder(0.1, 1e-6)),
        (Capsule(0.1, 0.0), Capsule(0.1, 1e-6)),
    ],
)
def test_a_size_of_zero_becomes_a_very_small_one(source: object, written: object) -> None:
    result, reported = legal(shaped(source))
    assert result.shapes[body("b0")][0].shape.geometry == written
    assert [line.split(" has ")[0] for line in reported] == ["warning HX101 shape 's'"]


def test_a_shape_without_geometry_or_without_its_mesh_is_left_out() -> None:
    for mechanism in (shaped(NoShape()), shaped(MeshShape()), shaped(MeshShape(), mesh=Id("mesh", "gone"))):
        result, reported = legal(mechanism)
        assert not result.shapes
        assert [line.split(" has ")[0] for line in reported] == ["note HX104 shape 's'"]


def test_a_plane_on_a_moving_body_becomes_a_thin_box_or_is_left_out() -> None:
    finite, reported = legal(shaped(Plane((1.0, 2.0)), on="b1"))
    assert finite.shapes[body("b1")][0].shape.geometry == Box((2.0, 4.0, 1e-6))
    assert reported == ["note HX101 shape 's' is a plane on a body that moves; it is written as a thin box"]
    infinite, reported = legal(shaped(Plane(), on="b1"))
    assert not infinite.shapes
    assert reported == ["warning HX104 shape 's' is an infinite plane on a body that moves; it is left out"]
    assert legal(shaped(Plane(), on="b0"))[1] == []


def test_only_the_first_shape_of_a_name_keeps_it() -> None:
    shape = Shape(Sphere(1.0), Role.VISUAL, "skin")
    result, reported = legal(chain(edges={Id("shape", n): shape_edge(shape, body("b0")) for n in ("a", "b")}))
    assert [view.shape.name for view in result.shapes[body("b0")]] == ["skin", None]
    assert reported == ["note HX102 another shape is called 'skin' already; this one is written without a name"]


# ---- actuators -----------------------------------------------------------------------------------------------------------------

LIMITED = hinge(axis=Z, limits=Limits(-1.0, 2.0, 4.0, 10.0))


def actuators(mechanism: Mechanism) -> dict[str, tuple[str, object]]:
    return {key.name: (actuator.kind, dict(actuator.parameters)) for key, actuator in mechanism.vertices(Actuator)}


def test_each_kind_of_actuator_takes_its_ranges_and_gains_from_the_limits() -> None:
    mechanism = chain(LIMITED, hinge(axis=Z))
    assert actuators(legal(mechanism, Options("fixed", "motor"))[0]) == {
        "j1": ("motor", {"ctrlrange": (-10.0, 10.0)}),
        "j2": ("motor", {}),
    }
    assert actuators(legal(mechanism, Options("fixed", "position"))[0]) == {
        "j1": ("position", {"kp": 80.0, "kv": 8.0, "ctrlrange": (-1.0, 2.0)}),
        "j2": ("position", {"kp": 40.0, "kv": 4.0}),
    }
    assert actuators(legal(mechanism, Options("fixed", "velocity"))[0]) == {
        "j1": ("velocity", {"kv": 25.0, "ctrlrange": (-4.0, 4.0)}),
        "j2": ("velocity", {"kv": 10.0}),
    }


def test_followers_balls_and_fixed_joints_get_no_actuator() -> None:
    follow = {Id("coupling", "c"): coupling_edge(joint("j2"), ((joint("j1"), (0.0, 1.0)),))}
    mechanism = chain(LIMITED, hinge(axis=Z), Joint((Dof(DofKind.BALL),)), Joint(), edges=follow)
    assert list(actuators(legal(mechanism, Options("fixed", "motor"))[0])) == ["j1"]


def driven(kind: str) -> Mechanism:
    drive = {Id("drive", "d"): Edge(Drive(), (Arc(Id("actuator", "a"), 1), Arc(joint("j1"), -1, (50.0,))))}
    return chain(LIMITED, edges=drive, vertices={Id("actuator", "a"): Actuator(kind)})


def test_by_default_native_actuators_stay_and_transmissions_are_motors() -> None:
    assert actuators(legal(driven("motor"))[0]) == {"a": ("motor", {})}
    result, reported = legal(driven("transmission"))
    assert (actuators(result), len(list(result.edges(Drive)))) == ({"a": ("motor", {"ctrlrange": (-0.2, 0.2)})}, 1)
    assert reported == ["note HX101 1 transmission written as the actuators that the hardware interfaces name: 'j1' motor"]


def test_chosen_actuators_replace_those_of_the_source() -> None:
    result, reported = legal(driven("motor"), Options("fixed", "velocity"))
    assert actuators(result) == {"j1": ("velocity", {"kv": 25.0, "ctrlrange": (-4.0, 4.0)})}
    assert reported == ["note HX101 1 actuator of the source replaced by one velocity per driven dof, as asked"]
    assert actuators(legal(driven("motor"), Options("fixed", "none"))[0]) == {}


@pytest.mark.parametrize("sign", [-1, 1])
def test_an_actuator_that_drives_nothing_is_left_out(sign: int) -> None:
    drive = {Id("drive", "d"): Edge(Drive(), (Arc(Id("actuator", "a"), 1), Arc(joint("j1"), sign)))}
    mechanism = chain(LIMITED, edges=drive, vertices={Id("actuator", name): Actuator("motor") for name in "ab"})
    result, reported = legal(mechanism)
    idle = "b" if sign < 0 else "ab"
    assert actuators(result) == {name: ("motor", {}) for name in "ab" if name not in idle}
    assert reported == [f"warning HX104 actuator '{name}' drives nothing, and is left out" for name in idle]
    assert len(list(result.edges(Drive))) == (sign < 0)


def test_repairs_of_inertia_are_the_only_warnings_that_a_massless_chain_causes() -> None:
    report = Report()
    legalize(chain(*[hinge(axis=Z)] * 20, inertial=None), "mjcf", report)
    assert {d.code.id for d in report if d.severity is Severity.WARNING} == {"HX103"}
