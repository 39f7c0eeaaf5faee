"""The report of a conversion: at most a dozen lines for people, all of it as JSON and as SARIF."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import jsonschema
import pytest

import hymeko_x as hx
from hymeko_x import codes
from hymeko_x.cli import exits, main
from hymeko_x.cli.report import MOST_LINES, brief_lines
from hymeko_x.compare.ledger import Fate, Loss
from hymeko_x.corpus import catalog
from hymeko_x.diagnostics import Diagnostic, Origin, Severity
from hymeko_x.formats.usd.settings import settings
from hymeko_x.reporting.aspects import Aspect, aspect_of
from hymeko_x.reporting.document import document
from hymeko_x.reporting.summary import summary_lines
from hymeko_x.reporting.values import error_of, values_of
from tests.reporting.robots import biped

if TYPE_CHECKING:
    from tests.conftest import RealRobots

SCHEMA = json.loads(files("hymeko_x.reporting").joinpath("conversion.schema.json").read_text("utf-8"))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def real(real_robot: RealRobots, end: str) -> Path:
    return real_robot(next(file for file in catalog.development_files("mjcf") if file.path.endswith(end)))


def reported(source: Path | str, capsys: pytest.CaptureFixture[str], *options: str) -> list[str]:
    """The report of a conversion to URDF in the working folder."""
    assert main(["convert", str(source), "out.urdf", *options]) == exits.DONE
    return capsys.readouterr().err.replace(str(source), "IN").splitlines()


# ---- for people ----------------------------------------------------------------------------------------------------------


def test_a_walker_loses_its_loops_springs_and_motors_in_urdf(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "biped.xml").write_text(biped())
    assert reported("biped.xml", capsys) == [
        "wrote out.urdf (13 bodies, 13 joints) and 1 file in shapes/",
        "dropped: 4 loops: 'left-rod', 'left-plantar', ...",
        "dropped: 10 actuators: 'left-hip-roll', 'left-hip-yaw', ...",
        "dropped: armature of 8 joints, up to 0.09 kg m^2: 'left-hip', 'left-hip-pitch', ...",
        "dropped: stiffness of 4 joints, up to 1500 N m/rad: 'left-shin', 'left-heel-spring', ...",
        "approximated: 2 shapes by other shapes: 'left-foot/shape', 'right-foot/shape'",
        "approximated: kind of 2 joints (ball -> hinge): 'left-achilles-rod', 'right-achilles-rod'",
        "approximated: connection of 2 joints: 'left-achilles-rod', 'right-achilles-rod'",
        "no physics: 4 joints renamed ('left-hip-roll' -> no name); 8 shapes, 4 joints, 1 mesh described in another form",
        "note[HX101]: effort limits are what the actuators can exert: 'left-hip' 112.5, 'left-hip' 112.5, 'left-hip-pitch' 112.5,"
        " 'left-shin' 112.5, ...",
        "IN:6: note[HX101]: joint 'left-hip' has dofs or a frame that the format cannot represent; it is written as a chain of 2 joints"
        " (5 more alike: lines 12, 14, 22, 28, 30)",
        "5 more kinds; -v lists each with its place, --report FILE.json has all",
    ]


@pytest.mark.corpus
def test_the_panda_as_urdf(real_robot: RealRobots, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert reported(real(real_robot, "franka_emika_panda/panda_free_base.xml"), capsys) == [
        "wrote out.urdf (11 bodies, 11 joints) and 67 files in assets/",
        "dropped: 1 tendon: 'split'",
        "dropped: 8 actuators: 'actuator1', 'actuator2', ...",
        "dropped: armature of 9 joints, 0.1 kg or kg m^2: 'joint1', 'joint2', ...",
        "dropped: 7 settings that only mjcf has: <compiler>, <option>, <default>, <keyframe>, ...",
        "no physics: 11 meshes renamed ('link0_c' -> 'link0'); appearance of 5 materials, 1 light; 3 comments and declarations",
        "note[HX101]: effort limits are what the actuators can exert: 'joint1' 87, 'joint2' 87, 'joint3' 87, 'joint4' 87, ...",
        "note[HX101]: URDF requires limits that are not given: velocity of 9 joints; 1e9 is written, which is read as none",
        "-v lists each with its place, --report FILE.json has all",
    ]


@pytest.mark.corpus
def test_the_go2_as_urdf(real_robot: RealRobots, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert reported(real(real_robot, "go2/robot.xml"), capsys) == [
        "wrote out.urdf (19 bodies, 19 joints) and 16 files in meshes/",
        "dropped: 12 actuators: 'FR_hip_leg', 'FR_thigh_leg', ...",
        "dropped: 6 frames: 'imu', 'center', ...",
        "dropped: armature of 12 joints, 0.01 kg m^2: 'FR_hip_leg_joint', 'FR_thigh_leg_joint', ...",
        "dropped: friction of 56 shapes, up to 0.8: 'body/visual', 'body/visual#2', ...",
        "dropped: 5 settings that only mjcf has: <compiler>, <option>, <default>, <keyframe>",
        "no physics: 23 shapes described in another form; appearance of 5 frames; 5 comments and declarations",
        "note[HX101]: effort limits are what the actuators can exert: 'FR_hip_leg_joint' 23.7, 'FR_thigh_leg_joint' 23.7,"
        " 'FR_calf_leg_joint' 45.43, 'FL_hip_leg_joint' 23.7, ...",
        "note[HX101]: URDF requires limits that are not given: velocity of 12 joints; 1e9 is written, which is read as none",
        "-v lists each with its place, --report FILE.json has all",
    ]


@pytest.mark.corpus
def test_a_humanoid_as_urdf(real_robot: RealRobots, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Of Talos's kind and size."""
    assert reported(real(real_robot, "gr1/robot.xml"), capsys) == [
        "wrote out.urdf (45 bodies, 45 joints) and 31 files in meshes/",
        "dropped: 32 actuators: 'torso_waist_yaw', 'torso_waist_pitch', ...",
        "dropped: 2 meshes: 'l_hand_pitch', 'r_hand_pitch'",
        "dropped: 6 contacts: 'upper_lower_body', 'torso_head_1', ...",
        "dropped: 16 frames: 'pelvis', 'waist', ...",
        "dropped: 6 cameras: 'obs_hands', 'overshoulder', ...",
        "approximated: 1 shape by other shapes: 'world/shape'",
        "dropped: 95 settings that only mjcf has: <compiler>, <default>, contype, conaffinity, ...",
        "no physics: 3 meshes renamed ('torso_waist_yaw' -> 'waist_yaw'); 64 shapes, 1 body described in another form;"
        " appearance of 16 frames, 5 materials, 3 textures, 2 more",
        "note[HX101]: effort limits are what the actuators can exert: 'torso_waist_yaw' 20000, 'torso_waist_pitch' 20000,"
        " 'torso_waist_roll' 20000, 'head_yaw' 20000, ...",
        "IN:57: note[HX101]: shape 'world/shape' is a plane, which the format cannot represent; it is written as a thin box",
        "1 more kind; -v lists each with its place, --report FILE.json has all",
    ]


@pytest.mark.corpus
def test_cassie_as_urdf(real_robot: RealRobots, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From SDF, the format in which a package has it with its loops."""
    source = real_robot(next(file for file in catalog.development_files("sdf") if file.path.endswith("cassie_v2.sdf")))
    assert reported(source, capsys) == [
        "wrote out.urdf (23 bodies, 23 joints) and 12 files in meshes/",
        "dropped: 23 settings that only sdf has: <ambient>",
        "kept: 4 loops, stiffness of 4 joints, 8 fields and elements in all",
        "no physics: 2 joints described in another form",
        "IN:1034: note[HX101]: joint 'right-achilles-spring-joint' has dofs or a frame that the format cannot represent; it is written as a"
        " chain of 2 joints (1 more alike: line 1052)",
        "note[HX101]: URDF requires limits that are not given: effort of 16 joints and velocity of 16 joints; 1e9 is written,"
        " which is read as none",
        "-v lists each with its place, --report FILE.json has all",
    ]


def test_a_quiet_report_has_nothing_but_errors(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "biped.xml").write_text(biped())
    assert reported("biped.xml", capsys, "-q") == []


def test_a_verbose_report_has_each_loss_with_its_place(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "biped.xml").write_text(biped())
    lines = reported("biped.xml", capsys, "-v", "--report", "all.json")
    losses = json.loads((folder / "all.json").read_text())["losses"]
    assert sum(" loss: " in line or line.startswith("loss: ") for line in lines) == len(losses)
    assert "IN:9: loss: joint 'left-hip-pitch' dofs[0].armature dropped: 0.09 -> 0" in lines


def test_no_report_is_longer_than_a_dozen_lines() -> None:
    odd = [Diagnostic(codes.BAD_NUMBER, Severity.WARNING, "x" * i, hint="mend it") for i in range(20)]
    notes = [Diagnostic(codes.REWRITTEN, Severity.NOTE, "y" * i) for i in range(20)]
    losses = [loss(f"joint 'a{i}'", f"dofs[0].{'z' * i}", "1", "2") for i in range(30)]
    lines = brief_lines("wrote x", [*notes, *odd], losses)
    assert len(lines) == MOST_LINES
    assert [sum(part in line for line in lines) for part in ("wrote", "warning[", "approximated:", "note[")] == [1, 2, 4, 2]
    assert lines[-1] == "62 more kinds; -v lists each with its place, --report FILE.json has all"
    assert brief_lines("", odd[:1], ()) == ["warning[HX020]: ", "  hint: mend it"]


def test_the_most_frequent_warnings_come_first() -> None:
    rare = [Diagnostic(codes.BAD_NUMBER, Severity.WARNING, f"{'x' * i} is odd") for i in range(1, 5)]
    frequent = [Diagnostic(codes.ASSET_NOT_FOUND, Severity.WARNING, f"mesh 'm{i}' is not found") for i in range(20)]
    error = Diagnostic(codes.BAD_NUMBER, Severity.ERROR, "worse")
    lines = brief_lines("", [*rare, *frequent, error], ())
    assert [line.partition(":")[0] for line in lines[:3]] == ["error[HX020]", "warning[HX201]", "warning[HX020]"]
    assert "(19 more alike)" in lines[1]


def test_a_capsule_is_approximated_by_a_cylinder_and_two_spheres() -> None:
    cylinder = loss("shape 'shin'", "geometry", "capsule(radius 0.1, length 1)", "cylinder(radius 0.1, length 1)")
    ends = [loss(f"shape 'shin#{n}'", "", None, "shape(geometry sphere(radius 0.1), role collision, ...) {+ body 'shin'}") for n in (2, 3)]
    other = loss("shape 'box'", "geometry", "box(size [1 1 1])", "box(size [2 2 2])")
    assert summary_lines([cylinder, *ends]) == ["approximated: 1 shape by other shapes: 'shin'"]
    assert summary_lines([cylinder, *ends, *ends, other])[1:] == [
        "approximated: geometry of 1 shape: 'box'",
        "added: 2 shapes: 'shin#2', 'shin#3'",
    ]


def test_the_drive_of_an_actuator_of_another_kind_is_not_listed_beside_it() -> None:
    kind = loss("actuator 'a'", "kind", "'transmission'", "'motor'")
    drives = [loss("drive 'a_tran'", "", "drive()", None, "dropped"), loss("drive 'a'", "", None, "drive()")]
    assert summary_lines([kind, *drives]) == ["approximated: kind of 1 actuator (transmission -> motor): 'a'"]


def test_numbers_that_became_fewer_are_shown() -> None:
    found = loss("shape 'foot'", "friction", "[1.5 0.1 0.1]", "[1.5]")
    assert summary_lines([found]) == ["approximated: friction of 1 shape ([1.5 0.1 0.1] -> [1.5]): 'foot'"]


STAGE = "#usda 1.0\n(\n    timeCodesPerSecond = 24\n)"
SCENE = 'def PhysicsScene "scene"\n{\n    float physics:gravityMagnitude = 9.8\n}'
OVER = """over "leg" (
    prepend apiSchemas = ["PhysxLimitAPI:angular"]
)
{
    custom float newton:testScalar = 1 (
        customData = {
            string assignment = "model"
        }
    )
    rel physics:filteredPairs = </r/foot>
}"""


def test_settings_of_a_stage_are_called_by_types_schemas_and_properties() -> None:
    losses = [
        loss("mechanism", "usd /", STAGE, None),
        loss("mechanism", "usd scene", SCENE, None),
        loss("body 'leg'", "usd content", OVER, None),
    ]
    assert [setting for each in losses for setting in settings(each.before or "")] == [
        "timeCodesPerSecond of the stage",
        "PhysicsScene",
        "PhysxLimitAPI:angular",
        "newton:testScalar",
        "physics:filteredPairs",
    ]
    shown = "timeCodesPerSecond of the stage, PhysicsScene, PhysxLimitAPI:angular, newton:testScalar, ..."
    assert summary_lines(losses) == [f"dropped: 3 settings that only usd has: {shown}"]


# ---- what a loss is ------------------------------------------------------------------------------------------------------


ARM = """<robot name="u"><link name="a"/><link name="b"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"""


def test_the_frame_of_a_stage_is_no_loss(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The default prim with its kind, and the root of the articulation, are how a stage holds any robot."""
    (folder / "u.urdf").write_text(ARM, "utf-8")
    hx.convert(folder / "u.urdf", folder / "u.usda")
    assert "PhysicsArticulationRootAPI" in (folder / "u.usda").read_text("utf-8")
    assert [line for line in reported(folder / "u.usda", capsys) if line.startswith("dropped")] == []
    scene = '(\n    prepend apiSchemas = ["PhysicsArticulationRootAPI", "PhysxArticulationAPI"]'
    text = (folder / "u.usda").read_text("utf-8").replace('(\n    prepend apiSchemas = ["PhysicsArticulationRootAPI"]', scene)
    (folder / "u.usda").write_text(text, "utf-8")
    assert [line for line in reported(folder / "u.usda", capsys) if line.startswith("dropped")] != []


def loss(element: str, field: str, before: str | None, after: str | None, fate: Fate = "approximated") -> Loss:
    return Loss(element, field, before, after, fate)


@pytest.mark.parametrize(
    ("found", "aspect"),
    [
        (loss("joint 'a'", "dofs[0].armature", "1", "0"), Aspect.PHYSICS),
        (loss("joint 'a'", "mjcf @solref", "1 2", None), Aspect.SETTINGS),
        (loss("joint 'a'", "name", "'a'", "'b'"), Aspect.NAME),
        (loss("joint 'a'", "chain", "a", "a b c"), Aspect.FORM),
        (loss("body 'a'", "inertial", "none", "inertial(mass 1)"), Aspect.FORM),
        (loss("body 'a'", "comment content", "a leg", None), Aspect.TEXT),
        (loss("mechanism", "urdf @xmlns:xacro", "http://x", None), Aspect.TEXT),
        (loss("material 'a'", "", "material()", None), Aspect.APPEARANCE),
        (loss("shape 'a'", "[1]", "~ material 'a' as 'material'", None), Aspect.APPEARANCE),
        (loss("shape 'a'", "", "shape(...) {+ body 'b', ~ material 'a' as 'material'}", None), Aspect.PHYSICS),
        (loss("shape 'a'", "[2].target", "material 'white'", "material 'material_0'"), Aspect.APPEARANCE),
        (loss("shape 'a'", "[0].target", "body 'a'", "body 'b'"), Aspect.PHYSICS),
        (loss("shape 'a'", "rgba", "[1 0 0 1]", "none"), Aspect.APPEARANCE),
        (loss("frame 'a'", "", "frame()", None), Aspect.PHYSICS),
        (loss("frame 'a'", "size", "[0.1]", "[]"), Aspect.APPEARANCE),
        (loss("shape 'a'", "role", "both", "visual, and collision as 'b'"), Aspect.FORM),
        (loss("shape 'a'", "role", "collision", "visual"), Aspect.PHYSICS),
        (loss("mesh 'a'", "scale", "[1 1 1]", "[2 2 2]"), Aspect.PHYSICS),
        (loss("drive 'a'", "[1].role", "'0'", "'a_TX'"), Aspect.NAME),
        (loss("body 'a'", "inertial.mass", "0", "1e-10"), Aspect.FORM),
        (loss("mesh 'a'", "content.order of triangles", "0", "1"), Aspect.FORM),
        (loss("body 'a'", "inertial.mass", "0", "1e-3"), Aspect.PHYSICS),
        (loss("frame 'a'", "usd content", None, 'def Sphere "a" {}'), Aspect.FORM),
        (loss("drive 'a'", "[1].role", "'0'", "'1'"), Aspect.PHYSICS),
        (loss("shape 'a'", "geometry", "noshape()", "capsule(radius 1, length 1)"), Aspect.FORM),
        (loss("mesh 'a'", "content.texture coordinates", "0", "300"), Aspect.APPEARANCE),
        (loss("mesh 'a'", "content.distance", "0", "0.1"), Aspect.PHYSICS),
        (loss("mesh 'a_2'", "", None, "mesh(uri 'a_2.obj')"), Aspect.FORM),
        (loss("shape 'a#2'", "", None, "shape(geometry box(size [1 1 1]), role visual, name none) {+ body 'a'}"), Aspect.FORM),
        (loss("shape 'a#2'", "", None, "shape(geometry box(size [1 1 1]), role collision, name none) {+ body 'a'}"), Aspect.PHYSICS),
        (loss("shape 'a'", "", "shape(geometry box(size [1 1 1]), role visual, name none) {+ body 'a'}", None), Aspect.PHYSICS),
    ],
)
def test_a_loss_concerns_the_physics_or_something_else(found: Loss, aspect: Aspect) -> None:
    assert aspect_of(found) is aspect


@pytest.mark.parametrize(
    ("field", "before", "after", "values", "error"),
    [
        ("dofs[0].armature", "0.1", "0.25", (0.1, 0.25), 0.15),
        ("dofs[0].limits.upper", "inf", "none", (float("inf"), None), None),
        ("inertial.com", "[0 0 -1e-3]", "[0 0.5 0]", ([0.0, 0.0, -0.001], [0.0, 0.5, 0.0]), 0.5),
        ("[0].weight.rotation", "[1 0 0 0]", "[0 1 0 0]", ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]), 3.141592653589793),
        ("name", "'it\\'s'", '"x"', ("it's", "x"), None),
        ("active", "True", "False", (True, False), None),
        ("mjcf @solref", "1 2", None, ("1 2", None), None),
        ("[1]", "[0] + joint 'a'", "[x]", ("[0] + joint 'a'", "[x]"), None),
    ],
)
def test_values_of_a_loss_are_numbers_and_errors_have_a_size(
    field: str, before: str, after: str | None, values: tuple[object, object], error: float | None
) -> None:
    found = loss("joint 'a'", field, before, after)
    assert values_of(found) == values
    assert error_of(found) == pytest.approx(error)


# ---- for programs --------------------------------------------------------------------------------------------------------


def test_the_json_report_follows_its_schema(folder: Path) -> None:
    (folder / "biped.xml").write_text(biped())
    assert main(["convert", "biped.xml", "out.urdf", "--report", "all.json"]) == exits.DONE
    found = json.loads((folder / "all.json").read_text())
    jsonschema.validate(found, SCHEMA)
    assert found["counts"] == {fate: sum(row["fate"] == fate for row in found["losses"]) for fate in ("kept", "approximated", "dropped")}
    knee = next(row for row in found["losses"] if row["element"] == "joint 'left-heel-spring'" and "stiffness" in row["field"])
    assert knee == {
        "element": "joint 'left-heel-spring'",
        "target_element": "joint 'left-heel-spring'",
        "kind": "joint",
        "field": "dofs[0].stiffness",
        "aspect": "physics",
        "before": 1250,
        "after": 0,
        "unit": "N m/rad",
        "error": 1250,
        "fate": "dropped",
        "file": "biped.xml",
        "line": 17,
    }
    motor = next(row for row in found["losses"] if row["element"] == "actuator 'left-knee'")
    assert (motor["target_element"], motor["fate"], motor["line"]) == (None, "dropped", 40)


def test_the_schema_refuses_what_is_no_report() -> None:
    found = document(("a", "urdf"), ("b", "mjcf"), (), (loss("joint 'a'", "x", "1", "2"),))
    jsonschema.validate(found, SCHEMA)
    found["losses"][0]["fate"] = "carried"  # type: ignore[index]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(found, SCHEMA)


def test_the_sarif_report_has_a_result_for_each_diagnostic_and_each_loss(folder: Path) -> None:
    (folder / "a biped.xml").write_text(biped())
    assert main(["convert", "a biped.xml", "out.urdf", "--report", "all.json"]) == exits.DONE
    assert main(["convert", "a biped.xml", "out.urdf", "--report", "all.sarif"]) == exits.DONE
    flat = json.loads((folder / "all.json").read_text())
    found = json.loads((folder / "all.sarif").read_text())
    (run,) = found["runs"]
    assert (found["version"], run["tool"]["driver"]["name"]) == ("2.1.0", "hymeko-x")
    assert len(run["results"]) == len(flat["diagnostics"]) + len(flat["losses"])
    assert {result["ruleId"] for result in run["results"]} == {rule["id"] for rule in run["tool"]["driver"]["rules"]}
    gone = next(result for result in run["results"] if result["message"]["text"].startswith("loop 'left-rod'"))
    assert (gone["ruleId"], gone["level"]) == ("dropped", "warning")
    assert gone["locations"] == [{"physicalLocation": {"artifactLocation": {"uri": "a%20biped.xml"}, "region": {"startLine": 39}}}]
    assert gone["properties"] in flat["losses"]


def test_a_diagnostic_without_a_line_is_a_result_without_a_region() -> None:
    from hymeko_x.reporting.sarif import sarif

    reported = (
        Diagnostic(codes.BAD_NUMBER, Severity.WARNING, "odd", Origin("a.urdf"), hint="mend it"),
        Diagnostic(codes.BUG, Severity.NOTE, "x"),
    )
    (run,) = sarif(document(("a.urdf", "urdf"), ("b", "mjcf"), reported, None))["runs"]  # type: ignore[misc]
    first, second = run["results"]
    assert first["message"] == {"text": "odd (mend it)"}
    assert first["locations"] == [{"physicalLocation": {"artifactLocation": {"uri": "a.urdf"}}}]
    assert "locations" not in second
