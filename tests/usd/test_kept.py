"""What a stage says comes back as its author wrote it: sizes, axes, scales, defaults that were spelt out, groups without a type."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pxr import Sdf, Usd, UsdGeom

from hymeko_x import formats, pipeline
from hymeko_x.compare.diff import diff
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism
from hymeko_x.ir.parts import Body, Box, Capsule, Coupling, DofKind, Joint
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles
from tests.usd.stages import HEADER, again, opened, parsed, read_text, written
from tests.usd.test_read import ENDS, PLACE, body, joint, robot, the_joint

SCALE = '    double3 xformOp:scale = (0.1, 0.2, 0.4)\n    uniform token[] xformOpOrder = ["xformOp:scale"]\n'


def authored(stage: Any) -> dict[str, str]:
    """Every authored property with its value, and the types and schemas of every prim; where prims are apart."""
    found = {}
    for prim in stage.TraverseAll():
        listed = prim.GetMetadata("apiSchemas") or Sdf.TokenListOp()
        found[str(prim.GetPath())] = str(prim.GetTypeName())
        found |= {f"{prim.GetPath()} {schema}": "applied" for schema in listed.GetAppliedItems()}
        for item in prim.GetAuthoredProperties():
            if not item.GetName().startswith(("xformOp", "hymeko:")):
                value = item.Get() if isinstance(item, Usd.Attribute) else item.GetTargets()
                found[str(item.GetPath())] = repr(value)
    return found


def missing(text: str, tmp_path: Path) -> dict[str, tuple[str, str | None]]:
    """What a stage says that the stage written of it does not say, or says otherwise."""
    source = opened(text.encode(), tmp_path, "source.usda")
    mechanism = read_text(text)
    result = opened(written(mechanism), tmp_path)
    assert [str(item) for item in diff(mechanism, again(mechanism))] == []
    assert parsed(result).shapes == parsed(source).shapes
    assert parsed(result).joints == parsed(source).joints
    before, after = authored(source), authored(result)
    return {key: (value, after.get(key)) for key, value in before.items() if after.get(key) != value}


def test_sizes_and_axis_of_a_primitive(tmp_path: Path) -> None:
    capsule = (
        '    def Capsule "c"\n    {\n        uniform token axis = "X"\n        double radius = 0.08\n        double height = 0.4\n    }\n'
    )
    cube = '    def Cube "d"\n    {\n        double size = 2\n        double3 xformOp:scale = (1, 2, 3)\n'
    text = robot(body("a", capsule + cube + '        uniform token[] xformOpOrder = ["xformOp:scale"]\n    }\n'))
    assert missing(text, tmp_path) == {}
    shapes = [view.shape.geometry for view in read_text(text).shapes[Id("body", "a")]]
    assert shapes == [Capsule(0.08, 0.4), Box((2.0, 4.0, 6.0))]


@pytest.mark.unread("HX027")
def test_an_axis_that_is_none_is_reported_and_kept(tmp_path: Path) -> None:
    report = Report()
    text = robot(body("a", '    def Capsule "c"\n    {\n        uniform token axis = "sideways"\n    }\n'))
    mechanism = read_text(text, report)
    assert [str(item).partition(": ")[2] for item in report] == ["warning[HX027]: /robot/a/c: axis is 'sideways'; Z instead"]
    assert b'token axis = "sideways"' in written(mechanism)


def test_where_a_stage_shows_a_body_that_its_joints_put_elsewhere_is_in_the_ledger() -> None:
    shown = PLACE.format(x=0, y=0, z=3)
    mechanism = read_text(robot(body("a"), body("b", shown), joint("PhysicsFixedJoint", "j", ENDS)))
    result = pipeline.convert(mechanism, formats.URDF, Options(keep="inside"), NoFiles(), Report())
    assert [(loss.element, loss.before) for loss in result.losses or () if loss.field == "pose on the stage"] == [
        ("body 'b'", "0 0 3 1 0 0 0")
    ]


def test_a_body_whose_prim_is_its_geometry_with_what_is_below_it_and_joints_in_its_scaled_space(tmp_path: Path) -> None:
    site = '    def Xform "tip" (prepend apiSchemas = ["MjcSiteAPI"])\n    {\n    ' + PLACE.format(x=0, y=0, z=0.5) + "    }\n"
    cube = body("a", "    double size = 1\n" + SCALE + site, "PhysicsCollisionAPI").replace("Xform", "Cube", 1)
    text = robot(cube, body("b"), joint("PhysicsRevoluteJoint", "j", ENDS + "    point3f physics:localPos0 = (0.5, 0.5, 0.5)\n"))
    assert missing(text, tmp_path) == {}
    mechanism = read_text(text)
    (view,) = mechanism.shapes[Id("body", "a")]
    assert (view.shape.geometry, the_joint(mechanism).parent_pose.xyz) == (Box((0.1, 0.2, 0.4)), (0.05, 0.1, 0.2))
    assert mechanism.graph.edges[Id("mount", "tip")].arcs[0].weight.xyz == pytest.approx((0, 0, 0.2))  # type: ignore[union-attr]


@pytest.mark.parametrize("schemas", ["MjcSiteAPI", "NewtonSiteAPI", "MjcSiteAPI NewtonSiteAPI"])
def test_a_site_has_the_schemas_that_its_author_gave_it(schemas: str) -> None:
    listed = ", ".join(f'"{schema}"' for schema in schemas.split())
    mechanism = read_text(robot(body("a", f'    def Xform "tip" (prepend apiSchemas = [{listed}])\n    {{\n    }}\n')))
    assert Id("frame", "tip") not in mechanism.extras
    assert f"prepend apiSchemas = [{listed}]\n" in written(mechanism).decode()
    losses = pipeline.convert(mechanism, formats.URDF, Options(), NoFiles(), Report()).losses or ()
    assert [loss.field for loss in losses if loss.element == "frame 'tip'"] == [""]


def test_values_that_say_no_more_than_the_default(tmp_path: Path) -> None:
    limits = (
        "    float physics:lowerLimit = -inf\n    float physics:upperLimit = 0\n    uniform double mjc:damping = 0\n"
        "    bool physics:jointEnabled = 1\n    bool physics:collisionEnabled = 0\n"
    )
    mass = "    float physics:mass = 0\n    float physics:density = 0\n"
    shape = '    def Cube "c" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n    {\n        bool physics:collisionEnabled = 1\n    }\n'
    text = robot(
        body("a", shape),
        body("b", mass, "PhysicsMassAPI"),
        joint("PhysicsPrismaticJoint", "j", ENDS + limits, "MjcJointAPI NewtonJointAPI"),
    )
    assert missing(text, tmp_path) == {}
    assert the_joint(read_text(text)).joint.dofs[0].limits.upper == 0.0


def test_groups_without_a_type_and_the_group_that_stands_for_the_world(tmp_path: Path) -> None:
    text = robot(
        'def "joints"\n{\n'
        + joint("PhysicsFixedJoint", "j", "    rel physics:body0 = </robot>\n    rel physics:body1 = </robot/a>\n")
        + "}\n",
        body("a"),
    )
    assert missing(text, tmp_path) == {}


@pytest.mark.parametrize("outer", ["", PLACE.format(x=1, y=0, z=0)])
@pytest.mark.parametrize("group", ["", PLACE.format(x=0, y=2, z=0)])
def test_a_group_of_joints_alone_stays_where_it_is(outer: str, group: str, tmp_path: Path) -> None:
    marker = f'def Xform "marker"\n{{\n    custom int number = 3\n{PLACE.format(x=0, y=0, z=4)}}}\n'
    ends = ENDS.replace("/robot", "/robot/cell")
    joints = f'def Xform "joints"\n{{\n{group}{joint("PhysicsFixedJoint", "j", ends)}{marker}}}\n'
    text = robot(f'def Xform "cell"\n{{\n{outer}', body("a"), body("b"), joints, "}\n")
    before, after = opened(text.encode(), tmp_path, "source.usda"), opened(written(read_text(text)), tmp_path)
    for path in ("joints", "joints/marker", "a"):
        poses = [UsdGeom.XformCache().GetLocalToWorldTransform(stage.GetPrimAtPath(f"/robot/cell/{path}")) for stage in (before, after)]
        assert poses[0] == poses[1] or (path, group) == ("joints", "")
    assert [str(item) for item in diff(read_text(text), again(read_text(text)))] == []


def test_how_far_the_bounds_of_a_locked_axis_are_crossed(tmp_path: Path) -> None:
    axes = ("transX", "transY", "transZ", "rotX", "rotY")
    locks = "".join(f"    float limit:{axis}:physics:low = 2\n    float limit:{axis}:physics:high = -2\n" for axis in axes)
    text = robot(body("a"), body("b"), joint("PhysicsJoint", "j", ENDS + locks, " ".join(f"PhysicsLimitAPI:{axis}" for axis in axes)))
    assert missing(text, tmp_path) == {}


# ---- what stands still, and what follows -----------------------------------------------------------------------------------------


def the_base(mechanism: Mechanism) -> Joint:
    view = mechanism.parent_joint[Id("body", "a")]
    assert view.parent == WORLD
    return view.joint


@pytest.mark.parametrize("flag", ["bool physics:kinematicEnabled = 1", "bool physics:rigidBodyEnabled = 0"])
def test_a_body_that_is_not_simulated_stands_still_without_a_joint_prim(flag: str, tmp_path: Path) -> None:
    text = robot(body("a", f"    {flag}\n"))
    assert the_base(read_text(text)).dofs == ()
    assert missing(text, tmp_path) == {}
    assert [dof.kind for dof in the_base(read_text(robot(body("a")))).dofs] == [DofKind.FREE]


def follower(content: str, apis: str) -> str:
    follows = ENDS.replace("/a>", "/b>", 1).replace("body1 = </robot/b>", "body1 = </robot/c>")
    return robot(
        body("a"),
        body("b"),
        body("c"),
        joint("PhysicsRevoluteJoint", "j", ENDS),
        joint("PhysicsRevoluteJoint", "k", follows + content, apis),
    )


@pytest.mark.parametrize(
    ("content", "apis", "coefficients"),
    [
        (
            "    rel newton:mimicJoint = </robot/j>\n    float newton:mimicCoef0 = 180\n    float newton:mimicCoef1 = 2\n"
            "    uniform double mjc:coef2 = 3\n    uniform double mjc:coef4 = 5\n",
            "NewtonMimicAPI MjcEqualityJointAPI",
            (3.141592653589793, 2.0, 3.0, 0.0, 5.0),
        ),
        (
            "    rel mjc:target = </robot/j>\n    uniform double mjc:coef0 = 0.5\n    uniform double mjc:coef1 = 1.5\n",
            "MjcEqualityJointAPI",
            (0.5, 1.5),
        ),
    ],
)
def test_a_joint_that_follows_by_a_polynomial(content: str, apis: str, coefficients: tuple[float, ...], tmp_path: Path) -> None:
    text = follower(content, apis)
    ((_, _, arcs),) = read_text(text).edges(Coupling)
    assert [(arc.target.name, arc.sign, arc.weight) for arc in arcs] == [("k", 1, (1.0,)), ("j", -1, coefficients)]
    assert missing(text, tmp_path) == {}


def test_the_second_prim_of_a_name_gets_no_other_name() -> None:
    group = 'def Xform "{0}"\n{{\n    def Xform "leg" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])\n    {{\n    }}\n}}\n'
    mechanism = read_text(HEADER + group.format("one") + group.format("two"))
    assert [key.name for key, _ in mechanism.vertices(Body)] == ["leg", "leg#2"]
    assert written(mechanism).count(b'displayName = "') == 1  # that of the robot
    assert again(mechanism) == mechanism


def test_what_leads_to_the_prim_itself_or_below_it_still_leads_there(tmp_path: Path) -> None:
    network = (
        "    token outputs:odd:surface.connect = </robot/looks/net/graph.outputs:out>\n"
        "    rel friends = [</robot/looks/net>, </net>]\n"
        'def NodeGraph "graph"\n{\n    token outputs:out\n}\n'
    )
    source = robot(body("a"), f'def Scope "looks"\n{{\ndef NodeGraph "net"\n{{\n{network}}}\n}}\n')
    stage = opened(written(read_text(source)), tmp_path)
    net = stage.GetPrimAtPath("/robot/looks/net")
    assert list(map(str, net.GetAttribute("outputs:odd:surface").GetConnections())) == ["/robot/looks/net/graph.outputs:out"]
    assert list(map(str, net.GetRelationship("friends").GetTargets())) == ["/robot/looks/net", "/net"]
