"""A file may give a property another type than its schema: other precisions are the same numbers, anything else is reported."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from hymeko_x import codes
from hymeko_x.diagnostics import Report, Severity
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.parts import Body, Joint
from hymeko_x.ir.values import IDENTITY, Pose

STAGE = """#usda 1.0
(
    defaultPrim = "r"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "r" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) {
    def Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {
        %s
    }
    def Xform "b" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {
    }
    def PhysicsRevoluteJoint "j" {
        rel physics:body0 = </r/a>
        rel physics:body1 = </r/b>
        %s
    }
}
"""


def read(body: str, joint: str, report: Report | None = None) -> Mechanism:
    return hx.loads(STAGE % (body, joint), "usd", report=report, lenient=report is not None).mechanism


def frame(robot: Mechanism) -> Pose:
    """Where the joint is in its first body."""
    (weight,) = [arcs[0].weight for key, _, arcs in robot.edges(Joint) if key.name == "j"]
    return weight if isinstance(weight, Pose) else IDENTITY


@pytest.mark.parametrize("kind", ["quatf", "quatd", "quath", "float4", "double4", "float[]"])
def test_turns_are_the_same_in_any_type(kind: str) -> None:
    row = "[0.6, 0.8, 0, 0]" if kind.endswith("[]") else "(0.6, 0.8, 0, 0)"
    found = frame(read("", f"{kind} physics:localRot0 = {row}")).quat
    assert found == pytest.approx((0.6, 0.8, 0, 0), abs=1e-3 if kind == "quath" else 1e-12)


@pytest.mark.parametrize("kind", ["point3f", "float3", "double3", "half3", "int3", "color3f"])
def test_vectors_are_the_same_in_any_type(kind: str) -> None:
    robot = read(f"{kind} physics:centerOfMass = (1, 2, 3)", f"{kind} physics:localPos0 = (1, 2, 3)")
    assert frame(robot).xyz == (1.0, 2.0, 3.0)
    (body,) = [body for key, body in robot.vertices(Body) if key.name == "a"]
    assert body.inertial is not None
    assert body.inertial.com == (1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    "attribute",
    [
        'string physics:localPos0 = "abc"',
        'string[] physics:localPos0 = ["a", "b", "c"]',
        "float physics:localPos0 = 1",
        "float3[] physics:localPos0 = [(1, 2, 3), (1, 2, 3), (1, 2, 3)]",
        "matrix3d physics:localPos0 = ((1, 2, 3), (1, 2, 3), (1, 2, 3))",
        "float3 physics:localRot0 = (1, 2, 3)",
        'token physics:localRot0 = "abcd"',
    ],
)
def test_what_has_other_numbers_or_none_is_reported_and_not_used(attribute: str) -> None:
    report = Report()
    robot = read("", attribute, report)
    assert [found.code for found in report if found.severity == Severity.ERROR] == [codes.BAD_VALUE]
    assert frame(robot) == IDENTITY
    assert hx.loads(hx.dumps(robot, "usd"), "usd", lenient=True).mechanism == robot


TRIANGLE = (
    "float3[] extent = [(0, 0, 0), (1, 1, 0)]",
    "int[] faceVertexCounts = [3]",
    "int[] faceVertexIndices = [0, 1, 2]",
    "normal3f[] normals = [(0, 0, 1)]",
    "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]",
    "color3f[] primvars:displayColor = [(1, 0, 0)]",
    "float[] primvars:displayOpacity = [1]",
    'texCoord2f[] primvars:st = [(0, 0)] (interpolation = "faceVarying")',
    "int[] primvars:st:indices = [0, 0, 0]",
)
WRONG = ("int {} = 3", "float {} = 3", "int[] {} = [3]", "point3f[] {} = [(0, 0, 0)]", 'string[] {} = ["a", "b"]', "float2[] {} = [(1, 2)]")


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("place", range(len(TRIANGLE)), ids=[line.split()[1] for line in TRIANGLE])
@pytest.mark.unread("HX009", "HX203")
def test_rows_of_another_type_are_kept_and_not_used(place: int, wrong: str) -> None:
    lines = list(TRIANGLE)
    lines[place] = wrong.format(lines[place].split()[1])
    mesh = 'def Mesh "m" (prepend apiSchemas = ["PhysicsCollisionAPI"]) {\n' + "\n".join(lines) + "\n}"
    report = Report()
    robot = read(mesh, "", report)
    assert hx.loads(hx.dumps(robot, "usd", lenient=True), "usd", report=Report(), lenient=True).mechanism == robot
    is_needed = lines[place].split()[1] in ("points", "faceVertexCounts", "faceVertexIndices") and lines[place] != TRIANGLE[place]
    assert [found.code for found in report] == ([codes.ASSET_UNREADABLE, codes.PASSED_OVER] if is_needed else [])
