"""What the reader makes of stages that no public file shows: units, scales, frames, D6, loops, masses, composition."""

from __future__ import annotations

import math

import pytest

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends import usd
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, Mechanism
from hymeko_x.ir.parts import Body, Box, Coupling, Ellipsoid, Loop, Role, Sphere
from hymeko_x.ir.values import compose, inverse
from hymeko_x.source import Source
from tests.usd.stages import HEADER, Texts, again, read_text

BODY = 'def Xform "{name}" (prepend apiSchemas = ["PhysicsRigidBodyAPI"{more}])\n{{\n{content}\n}}\n'
PLACE = '    double3 xformOp:translate = ({x}, {y}, {z})\n    uniform token[] xformOpOrder = ["xformOp:translate"]\n'


def body(name: str, content: str = "", more: str = "") -> str:
    return BODY.format(name=name, content=content, more="".join(f', "{api}"' for api in more.split()))


def joint(kind: str, name: str, content: str, apis: str = "") -> str:
    listed = ", ".join(f'"{api}"' for api in apis.split())
    header = f"(prepend apiSchemas = [{listed}])" if listed else ""
    return f'def {kind} "{name}" {header}\n{{\n{content}\n}}\n'


def robot(*content: str, header: str = HEADER) -> str:
    return header + 'def Xform "robot"\n{\n' + "".join(content) + "}\n"


ENDS = "    rel physics:body0 = </robot/a>\n    rel physics:body1 = </robot/b>\n"


def the_joint(mechanism: Mechanism, name: str = "j"):  # type: ignore[no-untyped-def]
    return mechanism.joints[Id("joint", name)]


@pytest.mark.parametrize(
    ("order", "missing"),
    [
        ('token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]', "xformOp:scale, which is"),
        (
            'token[] xformOpOrder = ["!resetXformStack!", "!invert!xformOp:orient", "xformOp:rotateX"]',
            "xformOp:orient, xformOp:rotateX, which are",
        ),
        ('token[] xformOpOrder = ["!resetXformStack!", "!invert!xformOp:translate"]', None),
        ("int xformOpOrder = 3", None),
    ],
)
def test_a_step_to_a_place_that_is_named_and_not_there_is_reported(order: str, missing: str | None) -> None:
    report = Report()
    read_text(robot(body("a", f"    double3 xformOp:translate = (1, 2, 3)\n    uniform {order}\n")), report=report)
    reported = [diagnostic.message for diagnostic in report if diagnostic.code is codes.UNDEFINED_REFERENCE]
    assert reported == ([] if missing is None else [f"xformOpOrder names {missing} not there; passed over"])


# ---- units -------------------------------------------------------------------------------------------------------------------


def test_centimetres_and_y_up_become_metres_and_z_up() -> None:
    header = (
        HEADER.replace("metersPerUnit = 1", "metersPerUnit = 0.01")
        .replace('"Z"', '"Y"')
        .replace("kilogramsPerUnit = 1", "kilogramsPerUnit = 0.001")
    )
    cube = '    def Cube "c" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n    {\n        double size = 20\n    }\n'
    mass = "    float physics:mass = 500\n    float3 physics:diagonalInertia = (1, 2, 4)\n    point3f physics:centerOfMass = (0, 10, 0)\n"
    text = robot(
        body("a", PLACE.format(x=0, y=100, z=0) + mass + cube, "PhysicsMassAPI"),
        body("b", PLACE.format(x=0, y=150, z=0)),
        joint("PhysicsPrismaticJoint", "j", ENDS + "    point3f physics:localPos0 = (0, 50, 0)\n    float physics:upperLimit = 30\n"),
        header=header,
    )
    mechanism = read_text(text)
    assert mechanism.parent_joint[Id("body", "a")].parent_pose.xyz == pytest.approx((0.0, 0.0, 1.0))
    inertial = mechanism.vertex(Id("body", "a"), Body).inertial
    assert inertial is not None
    assert (inertial.mass, inertial.com) == (pytest.approx(0.5), pytest.approx((0.0, 0.1, 0.0)))
    assert inertial.tensor == pytest.approx((1e-7, 2e-7, 4e-7, 0.0, 0.0, 0.0))
    view = the_joint(mechanism)
    assert view.parent_pose.xyz == pytest.approx((0.0, 0.5, 0.0))
    assert view.joint.dofs[0].limits.upper == pytest.approx(0.3)
    (shape,) = mechanism.shapes[Id("body", "a")]
    assert shape.shape.geometry == Box(pytest.approx((0.2, 0.2, 0.2)))  # type: ignore[arg-type]


def test_joint_frames_are_given_in_the_scaled_space_of_their_bodies() -> None:
    scaled = '    double3 xformOp:scale = (2, 1, 3)\n    uniform token[] xformOpOrder = ["xformOp:scale"]\n'
    text = robot(body("a", scaled), body("b"), joint("PhysicsFixedJoint", "j", ENDS + "    point3f physics:localPos0 = (1, 1, 1)\n"))
    assert the_joint(read_text(text)).parent_pose.xyz == (2.0, 1.0, 3.0)


def test_a_joint_to_a_prim_below_a_body_is_a_joint_of_that_body() -> None:
    site = '    def Xform "site"\n    {\n    ' + PLACE.format(x=0, y=0, z=2) + "    }\n"
    ends = "    rel physics:body0 = </robot/a/site>\n    rel physics:body1 = </robot/b>\n"
    text = robot(body("a", site), body("b"), joint("PhysicsFixedJoint", "j", ends))
    view = the_joint(read_text(text))
    assert (view.parent, view.parent_pose.xyz) == (Id("body", "a"), (0.0, 0.0, 2.0))


def test_a_joint_to_a_prim_without_a_body_is_a_joint_to_the_world_there() -> None:
    """Position (0, 0, 5) on a prim at z = 7 with scale 2 is z = 17 in the world, as UsdPhysics' parser says."""
    place = (
        'def Xform "place"\n{\n    double3 xformOp:translate = (0, 0, 7)\n    double3 xformOp:scale = (2, 2, 2)\n'
        '    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]\n}\n'
    )
    ends = "    rel physics:body0 = </robot/place>\n    rel physics:body1 = </robot/b>\n    point3f physics:localPos0 = (0, 0, 5)\n"
    view = the_joint(read_text(robot(place, body("b"), joint("PhysicsFixedJoint", "j", ends))))
    assert (view.parent, view.parent_pose.xyz) == (WORLD, (0.0, 0.0, 17.0))


# ---- joints ------------------------------------------------------------------------------------------------------------------


def test_degrees_become_radians_and_an_upside_down_range_is_none() -> None:
    limits = "    float physics:lowerLimit = -90\n    float physics:upperLimit = 45\n"
    assert (
        the_joint(read_text(robot(body("a"), body("b"), joint("PhysicsRevoluteJoint", "j", ENDS + limits)))).joint.dofs[0].limits.lower
        == -math.pi / 2
    )
    swapped = limits.replace("-90", "90")
    dof = the_joint(read_text(robot(body("a"), body("b"), joint("PhysicsRevoluteJoint", "j", ENDS + swapped)))).joint.dofs[0]
    assert (dof.limits.lower, dof.limits.upper) == (None, None)


def test_a_generic_joint_has_the_axes_that_are_not_locked() -> None:
    axes = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
    locked = "".join(
        f"    float limit:{axis}:physics:low = 1\n    float limit:{axis}:physics:high = -1\n"
        for axis in axes
        if axis not in ("transZ", "rotX")
    )
    own = "    float limit:transZ:physics:low = -0.5\n    float limit:rotX:physics:high = 90\n"
    apis = " ".join(f"PhysicsLimitAPI:{axis}" for axis in axes)
    dofs = the_joint(read_text(robot(body("a"), body("b"), joint("PhysicsJoint", "j", ENDS + locked + own, apis)))).joint.dofs
    assert [(dof.kind.value, dof.axis, dof.limits.lower, dof.limits.upper) for dof in dofs] == [
        ("slide", (0.0, 0.0, 1.0), -0.5, None),
        ("hinge", (1.0, 0.0, 0.0), None, math.pi / 2),
    ]


def test_a_joint_that_leads_up_the_tree_is_turned_and_comes_back_as_it_was() -> None:
    """The world holds b, so that the joint from a to b leads from b to a; its coordinate keeps its sign."""
    held = joint("PhysicsFixedJoint", "base", "    rel physics:body1 = </robot/b>\n")
    text = robot(body("a"), body("b"), joint("PhysicsRevoluteJoint", "j", ENDS + "    float physics:upperLimit = 90\n"), held)
    mechanism = read_text(text)
    view = the_joint(mechanism)
    assert (view.parent, view.child, view.joint.dofs[0].axis) == (Id("body", "b"), Id("body", "a"), (-1.0, 0.0, 0.0))
    assert view.joint.dofs[0].limits.upper == math.pi / 2
    assert again(mechanism) == mechanism


def test_the_joint_that_closes_a_cycle_last_or_is_excluded_is_a_loop() -> None:
    bodies = [body(name) for name in "abc"]
    ends = "    rel physics:body0 = </robot/{}>\n    rel physics:body1 = </robot/{}>\n"
    ring = [joint("PhysicsRevoluteJoint", f"{a}{b}", ends.format(a, b)) for a, b in ("ab", "bc", "ca")]
    mechanism = read_text(robot(*bodies, *ring))
    assert [key.name for key, _, _ in mechanism.edges(Loop)] == ["ca"]
    excluded = ring[0].replace("{\n", "{\n    bool physics:excludeFromArticulation = 1\n", 1)
    mechanism = read_text(robot(*bodies, excluded, *ring[1:]))
    assert [key.name for key, _, _ in mechanism.edges(Loop)] == ["ab"]
    assert again(mechanism) == mechanism


def test_a_distance_joint_is_a_loop_with_its_distances() -> None:
    mechanism = read_text(robot(body("a"), body("b"), joint("PhysicsDistanceJoint", "j", ENDS + "    float physics:maxDistance = 0.3\n")))
    assert [(loop.kind, loop.parameters) for _, loop, _ in mechanism.edges(Loop)] == [("distance", (("maxDistance", 0.3),))]


def test_several_joints_between_two_bodies_are_the_dofs_of_one() -> None:
    first = joint("PhysicsRevoluteJoint", "yaw", ENDS + '    uniform token physics:axis = "Z"\n')
    second = joint("PhysicsRevoluteJoint", "pitch", ENDS + '    uniform token physics:axis = "Y"\n')
    mechanism = read_text(robot(body("a"), body("b"), first, second))
    dofs = the_joint(mechanism, "yaw").joint.dofs
    assert [(dof.name, dof.axis) for dof in dofs] == [("yaw", (0.0, 0.0, 1.0)), ("pitch", (0.0, 1.0, 0.0))]
    assert again(mechanism) == mechanism


def test_a_mimic_of_newton_is_a_coupling_in_radians() -> None:
    third = body("c")
    follower = (
        ENDS.replace("/b>", "/c>")
        + "    rel newton:mimicJoint = </robot/j>\n    float newton:mimicCoef0 = 90\n    float newton:mimicCoef1 = -2\n"
    )
    text = robot(
        body("a"),
        body("b"),
        third,
        joint("PhysicsRevoluteJoint", "j", ENDS),
        joint("PhysicsRevoluteJoint", "f", follower, "NewtonMimicAPI"),
    )
    ((_, _, arcs),) = read_text(text).edges(Coupling)
    assert [(arc.target.name, arc.weight) for arc in arcs] == [("f", (1.0,)), ("j", (math.pi / 2, -2.0))]


def test_gains_per_degree_become_gains_per_radian() -> None:
    drive = "    float drive:angular:physics:stiffness = 2\n    float drive:angular:physics:maxForce = 7\n"
    mechanism = read_text(robot(body("a"), body("b"), joint("PhysicsRevoluteJoint", "j", ENDS + drive, "PhysicsDriveAPI:angular")))
    actuator = mechanism.graph.vertices[Id("actuator", "j")]
    assert actuator.kind == "position"  # type: ignore[union-attr]
    assert dict(actuator.parameters) == {"kp": pytest.approx(360 / math.pi), "forcerange": (-7.0, 7.0)}  # type: ignore[union-attr]


def test_a_joint_that_names_no_body_is_reported_and_kept() -> None:
    report = Report()
    mechanism = read_text(robot(body("b"), joint("PhysicsFixedJoint", "j", ENDS)), report)
    assert [item.code for item in report] == [codes.UNDEFINED_REFERENCE]
    assert any('PhysicsFixedJoint "j"' in extra.text for extra in mechanism.extras[ROOT])


# ---- mass and shapes -----------------------------------------------------------------------------------------------------------


def collider(content: str, apis: str = "") -> str:
    listed = "".join(f', "{api}"' for api in apis.split())
    return f'    def Cube "c" (prepend apiSchemas = ["PhysicsCollisionAPI"{listed}])\n    {{\n        double size = 1\n{content}    }}\n'


@pytest.mark.parametrize(
    ("content", "apis", "expected"),
    [
        (collider(""), "", 1000.0),
        ("    float physics:density = 10\n" + collider(""), "PhysicsMassAPI", 10.0),
        ("    float physics:density = 10\n" + collider("        float physics:density = 5\n", "PhysicsMassAPI"), "PhysicsMassAPI", 5.0),
        ("    float physics:mass = 3\n    float physics:density = 10\n" + collider(""), "PhysicsMassAPI", 3.0),
        (collider("        float physics:mass = 2\n        float physics:density = 5\n", "PhysicsMassAPI"), "", 2.0),
    ],
)
def test_mass_before_density_before_water(content: str, apis: str, expected: float) -> None:
    inertial = read_text(robot(body("a", content, apis))).vertex(Id("body", "a"), Body).inertial
    assert inertial is not None
    assert inertial.mass == pytest.approx(expected)
    assert inertial.tensor == pytest.approx((expected / 6, expected / 6, expected / 6, 0.0, 0.0, 0.0))


def test_what_collides_and_what_is_shown() -> None:
    content = (
        '    def Sphere "both" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n    {\n        double radius = 1\n    }\n'
        '    def Sphere "hull" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n    {\n        double radius = 1\n'
        '        uniform token purpose = "guide"\n    }\n'
        '    def Sphere "skin"\n    {\n        double radius = 1\n'
        '        double3 xformOp:scale = (1, 2, 3)\n        uniform token[] xformOpOrder = ["xformOp:scale"]\n    }\n'
    )
    shapes = read_text(robot(body("a", content))).shapes[Id("body", "a")]
    assert [(view.id.name, view.shape.role, view.shape.geometry) for view in shapes] == [
        ("both", Role.BOTH, Sphere(1.0)),
        ("hull", Role.COLLISION, Sphere(1.0)),
        ("skin", Role.VISUAL, Ellipsoid((1.0, 2.0, 3.0))),
    ]


# ---- composition -----------------------------------------------------------------------------------------------------------------


def test_payloads_references_and_instances_are_composed() -> None:
    part = (
        HEADER.replace('"robot"', '"part"')
        + 'def Xform "part" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])\n{\n    def Cube "c"\n    {\n    }\n}\n'
    )
    text = robot(
        'def "a" (instanceable = true prepend payload = @./parts/part.usda@)\n{\n}\n'.replace("true prepend", "true\n    prepend"),
        'def "b" (\n    prepend references = @parts/part.usda@\n)\n{\n' + PLACE.format(x=1, y=0, z=0) + "}\n",
    )
    mechanism = read_text(text, files={"parts/part.usda": part})
    assert [key.name for key, _ in mechanism.vertices(Body)] == ["a", "b"]
    assert [key.name for key in mechanism.shapes] == ["a", "b"]
    assert again(mechanism) == mechanism


def test_a_missing_layer_is_reported_and_the_rest_is_read() -> None:
    report = Report()
    text = robot(body("a"), 'def "b" (\n    prepend references = @gone.usda@\n)\n{\n}\n')
    mechanism = read_text(text, report)
    assert codes.ASSET_NOT_FOUND in [item.code for item in report]
    assert [key.name for key, _ in mechanism.vertices(Body)] == ["a"]


def test_layers_that_refer_to_each_other_in_a_circle_are_reported() -> None:
    report = Report()
    text = robot(body("a"), 'def "b" (\n    prepend references = @other.usda@\n)\n{\n}\n')
    other = HEADER.replace('"robot"', '"x"') + 'def "x" (\n    prepend references = @other.usda@\n)\n{\n}\n'
    read_text(text, report, {"other.usda": other})
    assert codes.UNDEFINED_REFERENCE in [item.code for item in report]


@pytest.mark.parametrize("data", [b"", b"#usda 1.0\ndef Xform {", b"PXR-USDC\0\0\0\0", b"PK\x03\x04 no zip", b"\xff\xfe\0"])
def test_what_is_no_stage_is_refused_with_a_code(data: bytes) -> None:
    with pytest.raises(Refusal) as refusal:
        usd.read(Source("robot.usd", data, Texts()), Report())
    assert refusal.value.diagnostic.code == codes.CANNOT_READ
    assert "/tmp" not in refusal.value.diagnostic.message


def test_nothing_of_an_unknown_prim_is_lost_and_its_place_stays() -> None:
    odd = (
        '    def BasisCurves "hair"\n    {\n        custom string who = "me" (\n            doc = "kept"\n        )\n'
        + PLACE.format(x=0, y=0, z=1)
        + "    }\n"
    )
    mechanism = read_text(robot(body("a", PLACE.format(x=5, y=0, z=0) + odd)))
    (extra,) = mechanism.extras[Id("body", "a")]
    assert extra.path == "hair"
    assert 'doc = "kept"' in extra.text
    assert again(mechanism) == mechanism


def test_a_tree_pose_follows_from_the_frames_of_the_joints() -> None:
    text = robot(
        body("a", PLACE.format(x=1, y=2, z=3)),
        body("b", PLACE.format(x=1, y=2, z=4)),
        joint(
            "PhysicsRevoluteJoint",
            "j",
            ENDS + "    point3f physics:localPos0 = (0, 0, 0.5)\n    point3f physics:localPos1 = (0, 0, -0.5)\n",
        ),
    )
    view = the_joint(read_text(text))
    assert compose(view.parent_pose, inverse(view.child_pose)).xyz == (0.0, 0.0, 1.0)
