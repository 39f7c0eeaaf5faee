"""The printed MJCF, whole and in detail, and that MuJoCo moves bodies as the formula of the IR says."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hymeko_x as hx
from hymeko_x.backends import mjcf
from hymeko_x.diagnostics import Report
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, coupling_edge, joint_edge, layer_edge, mount_edge, shape_edge
from hymeko_x.ir.parts import (
    Box,
    Camera,
    Capsule,
    Contact,
    Dof,
    DofKind,
    Ellipsoid,
    Frame,
    Inertial,
    Joint,
    Light,
    Limits,
    Loop,
    Material,
    Mesh,
    MeshShape,
    Plane,
    Role,
    Shape,
    Texture,
)
from hymeko_x.ir.values import (
    IDENTITY,
    Pose,
    X,
    Y,
    Z,
    apply,
    compose,
    inverse,
    pose,
    pose_from_rpy,
    quat_about,
    rotation_angle,
    scaled,
    unit,
)
from hymeko_x.rewrite import Options, choose, legalize
from tests.robots import SOLID, body, chain, hinge, joint


def printed(mechanism: Mechanism, options: Options = Options(base="fixed")) -> str:  # noqa: B008 - a frozen value
    report = Report()
    return mjcf.write(legalize(choose(mechanism, options, report), "mjcf", report), options, report).main.decode()


def compiled(mechanism: Mechanism, options: Options = Options(base="fixed")) -> mujoco.MjModel:  # noqa: B008 - a frozen value
    return mujoco.MjModel.from_xml_string(printed(mechanism, options))


WHOLE = """<mujoco model="chain">
  <compiler angle="radian" autolimits="true"/>

  <default>
    <default class="visual">
      <geom contype="0" conaffinity="0" group="2"/>
    </default>
    <default class="collision">
      <geom group="3"/>
    </default>
  </default>

  <asset>
    <material name="red" rgba="1 0 0 1"/>
  </asset>

  <worldbody>
    <body name="b0">
      <inertial pos="0 0 0.1" mass="1" diaginertia="0.1 0.1 0.1"/>
      <geom name="skin" class="visual" type="box" size="0.5 1 1.5" pos="0 0 1" material="red"/>
      <geom class="collision" type="capsule" size="0.1 0.25" quat="0.5 0.5 0.5 0.5"/>
      <body name="b1" pos="0 0 1">
        <inertial pos="0 0 0.1" mass="1" diaginertia="0.1 0.1 0.1"/>
        <joint name="j1" axis="0 0 1" range="-1 2" damping="0.5" frictionloss="0.25" actuatorfrcrange="-10 10"/>
        <body name="b2" pos="0 0 1">
          <inertial pos="0 0 0.1" mass="1" diaginertia="0.1 0.1 0.1"/>
          <joint name="j2" type="slide" axis="1 0 0"/>
        </body>
      </body>
    </body>
  </worldbody>

  <equality>
    <joint name="follow" joint1="j2" joint2="j1" polycoef="0.1 2"/>
  </equality>

  <actuator>
    <motor name="j1" joint="j1" ctrlrange="-10 10"/>
  </actuator>
</mujoco>
"""


def test_no_zero_has_a_sign_whichever_was_written_first() -> None:
    shapes = {
        Id("shape", f"s{number}"): shape_edge(Shape(Box((1.0, 1.0, 1.0)), Role.VISUAL), body("b0"), pose((zero, 0.5, 0.0)))
        for number, zero in enumerate((-0.0, 0.0, -0.0))
    }
    text = printed(chain(hinge(axis=Z), edges=shapes))
    assert text.count('pos="0 0.5 0"') == 3
    assert "-0 " not in text


def test_a_small_robot_reads_as_if_written_by_hand() -> None:
    turn = hinge(axis=Z, limits=Limits(-1.0, 2.0, 3.0, 10.0), damping=0.5, friction=0.25)
    red = Id("material", "red")
    mechanism = chain(
        turn,
        Joint((Dof(DofKind.SLIDE, X),)),
        vertices={red: Material("red", (1.0, 0.0, 0.0, 1.0))},
        edges={
            Id("shape", "v"): shape_edge(Shape(Box((1.0, 2.0, 3.0)), Role.VISUAL, "skin"), body("b0"), pose((0.0, 0.0, 1.0)), None, red),
            Id("shape", "c"): shape_edge(Shape(Capsule(0.1, 0.5), Role.COLLISION), body("b0"), pose(quat=(0.5, 0.5, 0.5, 0.5))),
            Id("coupling", "follow"): coupling_edge(joint("j2"), ((joint("j1"), (0.1, 2.0)),)),
        },
    )
    text = printed(mechanism, Options("fixed", "motor"))
    assert text == WHOLE
    assert mujoco.MjModel.from_xml_string(text).nbody == 4


def test_the_same_mechanism_gives_the_same_bytes() -> None:
    assert printed(chain(hinge(axis=Z))) == printed(chain(hinge(axis=Z)))


# ---- kinematics ------------------------------------------------------------------------------------------------------------------


def test_the_frame_of_a_joint_in_the_child_moves_the_child_back() -> None:
    model = compiled(chain(hinge(axis=Z), child_pose=Pose((0.25, 0.0, 0.5))))
    assert (list(model.body_pos[2]), list(model.jnt_pos[0])) == ([-0.25, 0.0, 0.5], [0.25, 0.0, 0.5])


LENGTH = st.floats(-2.0, 2.0)
POINTS = st.tuples(LENGTH, LENGTH, LENGTH)
TURNS = st.tuples(LENGTH, LENGTH, LENGTH, LENGTH).filter(lambda q: max(map(abs, q)) > 0.1)
POSES = st.builds(pose, POINTS, TURNS)
AXES = POINTS.filter(lambda v: max(map(abs, v)) > 0.1).map(unit)
DOFS = st.builds(
    lambda kind, axis, anchor, ref: Dof(kind, axis, anchor=anchor, ref=ref),
    st.sampled_from([DofKind.HINGE, DofKind.SLIDE]),
    AXES,
    POINTS,
    LENGTH,
)


def motion(dof: Dof, coordinate: float) -> Pose:
    """Tr(a) M(q - ref) Tr(-a) in the joint frame."""
    if dof.kind is DofKind.SLIDE:
        return Pose(scaled(dof.axis, coordinate - dof.ref))
    turn = Pose(quat=quat_about(dof.axis, coordinate - dof.ref))
    return compose(compose(Pose(dof.anchor), turn), Pose(scaled(dof.anchor, -1.0)))


@settings(max_examples=150, deadline=None)
@given(POSES, POSES, st.lists(DOFS, min_size=1, max_size=6), st.lists(LENGTH, min_size=6, max_size=6))
@pytest.mark.unread("HX102")
def test_bodies_move_as_the_formula_of_the_ir_says(above: Pose, below: Pose, dofs: list[Dof], q: list[float]) -> None:
    mechanism = chain(Joint(tuple(dofs)))
    edges = {joint("j1"): joint_edge(Joint(tuple(dofs)), body("b0"), body("b1"), above, below)}
    model = compiled(mechanism.replace(edges=edges))
    data = mujoco.MjData(model)
    data.qpos[:] = q[: len(dofs)]
    mujoco.mj_kinematics(model, data)
    expected = above
    for dof, coordinate in zip(dofs, q, strict=False):
        expected = compose(expected, motion(dof, coordinate))
    expected = compose(expected, inverse(below))
    found = model.body("b1").id
    assert np.abs(data.xpos[found] - expected.xyz).max() < 1e-12
    assert rotation_angle(tuple(data.xquat[found]), expected.quat) < 1e-12


def test_a_ball_turns_about_its_anchor() -> None:
    model = compiled(chain(Joint((Dof(DofKind.BALL, anchor=(0.0, 1.0, 0.0)),))))
    data = mujoco.MjData(model)
    data.qpos[:] = (math.cos(0.5), math.sin(0.5), 0.0, 0.0)
    mujoco.mj_kinematics(model, data)
    expected = apply(Pose((0.0, 0.0, 1.0)), apply(motion(Dof(DofKind.HINGE, X, anchor=(0.0, 1.0, 0.0)), 1.0), (0.0, 0.0, 0.0)))
    assert np.abs(data.xpos[model.body("b1").id] - expected).max() < 1e-12


def test_a_screw_advances_by_its_pitch() -> None:
    screw = Dof(DofKind.SCREW, Z, pitch=0.5, ref=0.25)
    model = compiled(chain(Joint((screw,))))
    assert model.eq_data[0, :2] == pytest.approx([0.0, 0.5])
    assert [model.joint(n).qpos0[0] for n in ("j1", "j1_slide")] == [0.25, 0.0]


# ---- couplings -----------------------------------------------------------------------------------------------------------------


def residual(mechanism: Mechanism, **coordinates: float) -> float:
    """How far the first equality is from being kept."""
    model = compiled(mechanism)
    data = mujoco.MjData(model)
    for name, value in coordinates.items():
        data.qpos[model.joint(name).qposadr[0]] = value
    mujoco.mj_forward(model, data)
    return float(abs(data.efc_pos[0]))


@settings(max_examples=60, deadline=None)
@given(LENGTH, LENGTH, st.lists(LENGTH, min_size=2, max_size=5), LENGTH)
def test_a_polynomial_holds_between_coordinates_whatever_their_references_are(r1: float, r2: float, c: list[float], q: float) -> None:
    leader, follower = hinge(axis=Z, ref=r1), hinge(axis=Z, ref=r2)
    edges = {Id("coupling", "c"): coupling_edge(joint("j2"), ((joint("j1"), tuple(c)),))}
    value = sum(coefficient * q**power for power, coefficient in enumerate(c))
    assert residual(chain(leader, follower, edges=edges), j1=q, j2=value) < 1e-9
    assert residual(chain(leader, follower, edges=edges), j1=q, j2=value + 0.5) == pytest.approx(0.5, abs=1e-9)


def test_a_follower_of_a_fixed_joint_is_held_at_the_constant() -> None:
    edges = {Id("coupling", "c"): coupling_edge(joint("j2"), ((joint("j1"), (0.3, 7.0)),))}
    mechanism = chain(Joint(), hinge(axis=Z, ref=0.1), edges=edges)
    assert residual(mechanism, j2=0.3) < 1e-12
    assert 'joint1="j2" polycoef="0.2 0"' in printed(mechanism).replace("0.19999999999999998", "0.2")


def test_a_coupling_that_is_switched_off_stays_switched_off() -> None:
    edges = {Id("coupling", "c"): coupling_edge(joint("j2"), ((joint("j1"), (0.0, 1.0)),), active=False)}
    assert not compiled(chain(hinge(axis=Z), hinge(axis=Z), edges=edges)).eq_active0[0]


# ---- inertia ---------------------------------------------------------------------------------------------------------------------


def test_a_tensor_with_products_arrives_as_it_was() -> None:
    tensor = (1.0, 1.1, 1.2, 0.1, -0.2, 0.05)
    model = compiled(chain(inertial=Inertial(2.0, (0.1, 0.2, 0.3), tensor)))
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.body_iquat[1])
    axes = rotation.reshape(3, 3)
    found = axes @ np.diag(model.body_inertia[1]) @ axes.T
    assert found == pytest.approx(np.array([[1.0, 0.1, -0.2], [0.1, 1.1, 0.05], [-0.2, 0.05, 1.2]]), abs=1e-12)
    assert (model.body_mass[1], list(model.body_ipos[1])) == (2.0, [0.1, 0.2, 0.3])


def test_geoms_invent_no_mass() -> None:
    shapes = {Id("shape", role.value): shape_edge(Shape(Box((1.0, 1.0, 1.0)), role), body("b0")) for role in Role}
    assert compiled(chain(inertial=None, edges=shapes)).body_mass.tolist() == [0.0, 0.0]


COMPONENT = st.floats(-1.0, 1.0)


@settings(max_examples=400, deadline=None)
@given(st.tuples(*[COMPONENT] * 6), st.sampled_from([1.0, 1e-3, 1e-6, 1e-9, 1e-12]))
@pytest.mark.unread("HX103")
def test_every_tensor_compiles_after_repair(tensor: tuple[float, ...], size: float) -> None:
    xx, yy, zz, xy, xz, yz = (size * value for value in tensor)
    compiled(chain(hinge(axis=Z), inertial=Inertial(1.0, (0.0, 0.0, 0.0), (xx, yy, zz, xy, xz, yz))))


# ---- geoms, assets, mounts ---------------------------------------------------------------------------------------------------------


def geom_line(shape: Shape) -> str:
    text = printed(chain(edges={Id("shape", "s"): shape_edge(shape, body("b0"))}))
    return next(line.strip() for line in text.splitlines() if " type=" in line)


@pytest.mark.parametrize(
    ("shape", "line"),
    [
        (Shape(Box((1.0, 2.0, 3.0)), Role.BOTH), '<geom type="box" size="0.5 1 1.5"/>'),
        (Shape(Ellipsoid((1.0, 2.0, 3.0)), Role.BOTH), '<geom type="ellipsoid" size="1 2 3"/>'),
        (Shape(Plane(), Role.COLLISION), '<geom class="collision" type="plane" size="0 0 0.05"/>'),
        (
            Shape(Capsule(0.1, 1.0), Role.VISUAL, "skin", (1.0, 0.5, 0.0, 1.0)),
            '<geom name="skin" class="visual" type="capsule" size="0.1 0.5" rgba="1 0.5 0 1"/>',
        ),
        (
            Shape(Box((1.0, 1.0, 1.0)), Role.BOTH, mass=2.0, friction=(1.0, 0.1, 0.01)),
            '<geom type="box" size="0.5 0.5 0.5" mass="2" friction="1 0.1 0.01"/>',
        ),
    ],
)
def test_a_shape_is_one_geom(shape: Shape, line: str) -> None:
    assert geom_line(shape) == line


def test_textures_materials_and_meshes_are_assets() -> None:
    skin, image, normal, mesh = Id("material", "skin"), Id("texture", "image"), Id("texture", "bumps"), Id("mesh", "part")
    mechanism = chain(
        vertices={
            skin: Material("skin", (1.0, 1.0, 1.0, 0.5), specular=0.25),
            image: Texture("textures/image.png"),
            normal: Texture("textures/bumps.png"),
            mesh: Mesh("meshes/part.stl", (-1.0, 1.0, 1.0)),
        },
        edges={
            Id("layer", "1"): layer_edge(image, skin),
            Id("layer", "2"): layer_edge(normal, skin, "normal"),
            Id("shape", "s"): shape_edge(Shape(MeshShape(), Role.VISUAL), body("b0"), IDENTITY, mesh, skin),
        },
    )
    text = printed(mechanism)
    assert text[text.index("  <asset>") : text.index("  <worldbody>")] == (
        "  <asset>\n"
        '    <texture name="image" type="2d" file="textures/image.png"/>\n'
        '    <texture name="bumps" type="2d" file="textures/bumps.png"/>\n'
        '    <material name="skin" rgba="1 1 1 0.5" specular="0.25">\n'
        '      <layer role="rgb" texture="image"/>\n'
        '      <layer role="normal" texture="bumps"/>\n'
        "    </material>\n"
        '    <mesh name="part" file="meshes/part.stl" scale="-1 1 1"/>\n'
        "  </asset>\n\n"
    )
    assert '<geom class="visual" type="mesh" mesh="part" material="skin"/>' in text


def test_sites_cameras_and_lights_sit_on_their_bodies_and_in_the_world() -> None:
    site, camera, lamp = Id("frame", "tip"), Id("camera", "eye"), Id("light", "lamp")
    mechanism = chain(
        vertices={site: Frame((0.01,)), camera: Camera(math.radians(60.0), (640, 480)), lamp: Light("directional")},
        edges={
            Id("mount", "1"): mount_edge(body("b0"), site, pose_from_rpy((0.0, 0.0, 1.0), (math.pi, 0.0, 0.0))),
            Id("mount", "2"): mount_edge(body("b0"), camera),
            Id("mount", "3"): mount_edge(WORLD, lamp, pose((0.0, 0.0, 3.0))),
        },
    )
    text = printed(mechanism)
    assert '    <light name="lamp" type="directional" pos="0 0 3"/>' in text
    model = mujoco.MjModel.from_xml_string(text)
    assert (model.cam_fovy[0], list(model.cam_resolution[0]), model.site_pos[0, 2]) == (pytest.approx(60.0), [640, 480], 1.0)


# ---- relations -------------------------------------------------------------------------------------------------------------------


def test_exclusions_welds_and_connections_compile_and_hold_at_the_start() -> None:
    mechanism = chain(
        hinge(axis=Z),
        hinge(axis=Y),
        edges={
            Id("contact", "x"): Edge(Contact(), (Arc(body("b0")), Arc(body("b2")))),
            Id("loop", "w"): Edge(Loop("weld"), (Arc(body("b0"), 0, Pose((0.0, 0.0, 2.0))), Arc(body("b2"), 0, IDENTITY))),
            Id("loop", "c"): Edge(Loop("connect"), (Arc(body("b0"), 0, Pose((0.5, 0.0, 2.0))), Arc(body("b2"), 0, Pose((0.5, 0.0, 0.0))))),
        },
    )
    model = compiled(mechanism)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert (model.nexclude, model.neq, data.ne) == (1, 2, 9)
    assert np.abs(data.efc_pos[:9]).max() < 1e-12


def test_a_weld_of_turned_frames_holds_where_they_coincide() -> None:
    one, two = pose((0.1, 0.2, 0.3), (1.0, 2.0, 3.0, 4.0)), pose((-0.5, 0.0, 0.25), (1.0, -1.0, 0.5, 0.0))
    mechanism = chain(Joint((Dof(DofKind.BALL),)))
    meeting = {
        joint("j1"): joint_edge(Joint((Dof(DofKind.BALL),)), body("b0"), body("b1"), compose(one, inverse(two))),
        Id("loop", "w"): Edge(Loop("weld"), (Arc(body("b0"), 0, one), Arc(body("b1"), 0, two))),
    }
    model = compiled(mechanism.replace(edges=meeting))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert np.abs(data.efc_pos[:6]).max() < 1e-12


def test_a_weld_that_is_not_kept_at_the_start_shows_its_gap() -> None:
    loop = {Id("loop", "w"): Edge(Loop("weld"), (Arc(body("b0")), Arc(body("b1"), 0, Pose((0.0, 0.0, 0.25)))))}
    model = compiled(chain(hinge(axis=Z), edges=loop))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert np.linalg.norm(data.efc_pos[:3]) == pytest.approx(1.25)


def test_a_floating_base_is_a_freejoint() -> None:
    text = printed(chain(hinge(axis=Z)), Options(base="free"))
    assert '      <freejoint name="b0_free"/>' in text
    assert mujoco.MjModel.from_xml_string(text).nq == 8


def test_names_with_quotes_slashes_line_breaks_and_angle_brackets_arrive() -> None:
    name = "left/arm \"one\" <&> 'two'\n\t\r end"
    frame = Id("frame", name)
    mechanism = chain(vertices={frame: Frame()}, edges={Id("mount", "m"): mount_edge(body("b0"), frame)})
    assert compiled(mechanism).site(0).name == name


def test_a_chain_of_many_bodies_is_printed_without_recursion() -> None:
    count = 5000
    text = printed(chain(*[hinge(axis=Z)] * count))
    assert text.count("<body ") == text.count("</body>") == count + 1
    assert SOLID.mass is not None


@pytest.mark.unread("HX061", "HX201")
def test_a_layer_without_a_texture_says_nothing() -> None:
    text = "r : robot { steel : material {} weave : texture {} b { shape { box [1 1 1], -> steel } } @layered : layer { - steel } }"
    robot = hx.loads(text, "hymeko").mechanism
    assert "texture=" not in hx.dumps(robot, "mjcf")
