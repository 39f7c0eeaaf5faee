"""PutGet: what was edited in a file that carries a residue survives the way back, and everything else is restored."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x import codes, formats, pipeline
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import ROOT, Id, Mechanism
from hymeko_x.ir.parts import Mesh, Tendon
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from tests.residue.edits import Edit, applied, applied_to_stage, mjcf_edits, urdf_edits, usd_edits, xacro_edits
from tests.residue.exactness import unequal
from tests.residue.samples import MJCF, PLAIN_MJCF, URDF

_NEARLY = Tolerance(1e-9, 1e-9)


def _native(data: bytes, format: str) -> Mechanism:
    """What the format itself says, without what the file carries."""
    return pipeline.reader(formats.by_name(format))(Source("<text>", data, NoFiles()), Report()).mechanism


def _written_again(robot: Mechanism, format: str) -> Mechanism:
    return _native(pipeline.write(robot, formats.by_name(format), Options(), NoFiles(), Report()).main, format)


@pytest.fixture(scope="module")
def walker() -> str:
    return hx.dumps(hx.loads(PLAIN_MJCF, "mjcf"), "urdf", keep="inside")


@pytest.fixture(scope="module")
def arm() -> str:
    return hx.dumps(hx.loads(URDF, "urdf"), "mjcf", keep="inside")


@pytest.fixture(scope="module")
def macros() -> str:
    return hx.dumps(hx.loads(PLAIN_MJCF, "mjcf"), "xacro", keep="inside")


def _back_from(carrier: str, format: str, edits: list[Edit], source: Mechanism) -> Mechanism:
    """The robot that an edited file gives back, when it has all edits and misses nothing else."""
    text, done = applied(carrier, edits)
    back = hx.loads(text, format).mechanism
    _expect_same(_native(text.encode(), format), _written_again(back, format), done)
    _expect_only_edits(source, back, done)
    return back


@settings(max_examples=40, deadline=None)
@given(st.lists(urdf_edits(), min_size=1, max_size=3))
@pytest.mark.unread("HX104")
def test_edits_of_a_urdf_survive_and_the_rest_of_the_mjcf_is_restored(walker: str, edits: list[Edit]) -> None:
    back = _back_from(walker, "urdf", edits, hx.loads(PLAIN_MJCF, "mjcf").mechanism)
    mujoco.MjModel.from_xml_string(hx.dumps(back, "mjcf"))


@settings(max_examples=40, deadline=None)
@given(st.lists(mjcf_edits(), min_size=1, max_size=3))
def test_edits_of_an_mjcf_survive_and_the_rest_of_the_urdf_is_restored(arm: str, edits: list[Edit]) -> None:
    _back_from(arm, "mjcf", edits, hx.loads(URDF, "urdf").mechanism)


@pytest.mark.full
@settings(max_examples=25, deadline=None)
@given(st.lists(xacro_edits(), min_size=1, max_size=3))
def test_edits_of_a_xacro_survive_and_the_rest_of_the_mjcf_is_restored(macros: str, edits: list[Edit]) -> None:
    _back_from(macros, "xacro", edits, hx.loads(PLAIN_MJCF, "mjcf").mechanism)


@settings(max_examples=40, deadline=None)
@given(st.lists(usd_edits(), min_size=1, max_size=3))
@pytest.mark.parametrize(("source", "own"), [pytest.param(PLAIN_MJCF, "mjcf", marks=pytest.mark.full), (URDF, "urdf")])
@pytest.mark.unread("HX009", "HX040")
def test_edits_of_a_stage_survive_and_the_rest_is_restored(source: str, own: str, edits: list[Edit]) -> None:
    robot = hx.loads(source, own).mechanism
    text, done = applied_to_stage(hx.dumps(robot, "usd", keep="inside"), edits)
    back = hx.loads(text, "usd", lenient=True).mechanism
    _expect_same(_tidied(_native(text.encode(), "usd")), _tidied(_written_again(back, "usd")), done)
    _expect_only_edits(robot, back, done)


def _tidied(stage: Mechanism) -> Mechanism:
    """A stage without what has no use when bodies are gone: a friction, an empty group, an actuator, an articulation root, the ball
    of a site whose cable is gone."""
    used = {arc.target for edge in stage.graph.edges.values() for arc in edge.arcs}
    idle = [key for key in stage.graph.vertices if key.kind == "material" and key not in used]
    cables = {arc.target for _, _, arcs in stage.edges(Tendon) for arc in arcs}
    extras = {
        key: found if key in cables else tuple(extra for extra in found if not _BALL.fullmatch(extra.text))
        for key, found in stage.extras.items()
        if key != ROOT
    }
    return replace(stage, graph=stage.graph.replace(without=idle), extras=extras)


_BALL = re.compile(r'def Sphere .*MjcSiteAPI.*\n\)\n\{\n.* extent = .*\n.* purpose = "guide"\n.* radius = .*\n\}', re.DOTALL)


def _expect_same(edited: Mechanism, again: Mechanism, done: list[str]) -> None:
    """The same robot; shapes may come in another order, and generated files may be called after another body."""
    found = [difference for difference in diff(edited, again, _NEARLY) if difference.element.kind not in ("shape", "mesh")]
    assert list(map(str, found)) == [], done
    assert _shapes(edited) == _shapes(again), done


def _shapes(robot: Mechanism) -> list[str]:
    views = [view for views in robot.shapes.values() for view in views]
    return sorted(f"{view.body} {view.shape.role} {view.shape.geometry} {[round(x, 6) + 0.0 for x in view.pose.xyz]}" for view in views)


def _expect_only_edits(source: Mechanism, back: Mechanism, done: list[str]) -> None:
    """Nothing is missing but what was removed or renamed, or was on it."""
    takes_along = {"call", "remove", "rename link", "rename joint", "rename body", "move", "shift"}
    missing = [difference for difference in diff(source, back) if difference.after is None and difference.field == ""]
    if not any(edit.partition(":")[0] in takes_along for edit in done):
        assert missing == [], done


# ---- what MJCF cannot say ------------------------------------------------------------------------------------------------

_LINK = '<link name="tool"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
_JOINT = '<joint name="tool" type="{type}"><parent link="{parent}"/><child link="{child}"/>{more}</joint>'


def _tool(type: str, more: str = "", izz: float = 1.0) -> str:
    return _LINK.format(izz=izz) + _JOINT.format(type=type, parent="torso", child="tool", more=more)


@pytest.mark.parametrize(
    "added",
    [
        pytest.param(_tool("planar"), id="two slides and a hinge"),
        pytest.param(_tool("floating"), id="a body that floats below another"),
        pytest.param(_tool("continuous", '<mimic joint="left_knee" multiplier="2"/>'), id="a mimic"),
        pytest.param(_tool("revolute", '<limit lower="2" upper="-1" effort="1" velocity="1"/>'), id="limits the wrong way round"),
        pytest.param(_tool("fixed", izz=9.0), id="a tensor of no body"),
        pytest.param(_LINK.format(izz=1.0), id="another root"),
        pytest.param('<link name="torso"/>', id="a name twice"),
        pytest.param(_JOINT.format(type="fixed", parent="torso", child="left_shin", more=""), id="a second parent, fixed"),
        pytest.param(_JOINT.format(type="continuous", parent="torso", child="left_shin", more=""), id="a second parent, a hinge"),
        pytest.param(_JOINT.format(type="fixed", parent="left_shin", child="torso", more=""), id="a cycle without a root"),
        pytest.param('<link name=""/>' + _JOINT.format(type="fixed", parent="torso", child="", more=""), id="no names"),
        pytest.param(
            '<link name="left_sole"/>' + _JOINT.format(type="fixed", parent="torso", child="left_sole", more=""), id="a site's name"
        ),
    ],
)
@pytest.mark.unread  # generated or damaged input: any
def test_what_an_editor_adds_becomes_legal_mjcf(walker: str, added: str) -> None:
    """What came from MJCF goes back as it was; what was added in a URDF goes through the rules that every URDF goes through."""
    back = hx.loads(walker.replace("<hymeko:residue", f"{added}<hymeko:residue"), "urdf", lenient=True).mechanism
    mujoco.MjModel.from_xml_string(hx.dumps(back, "mjcf", keep="inside"))


@pytest.mark.unread("HX042", "HX045", "HX104")
def test_a_shape_without_a_geometry_is_left_out_of_mjcf_and_a_height_field_is_not() -> None:
    field = '<hfield name="hill" nrow="2" ncol="2" size="1 1 1 1" elevation="0 1 1 0"/>'
    source = f'<mujoco><asset>{field}</asset><worldbody><geom name="hill" type="hfield" hfield="hill"/></worldbody></mujoco>'
    bare = '<link name="base"><visual name="bare"><geometry/></visual></link>'
    carrier = hx.dumps(hx.loads(source, "mjcf"), "urdf", keep="inside").replace("<hymeko:residue", f"{bare}<hymeko:residue")
    model = mujoco.MjModel.from_xml_string(hx.dumps(hx.loads(carrier, "urdf"), "mjcf", keep="inside"))
    assert [model.geom(number).name for number in range(model.ngeom)] == ["hill"]


# ---- one by one ------------------------------------------------------------------------------------------------------------


@pytest.mark.unread("HX204")
def test_a_limit_on_a_chain_of_joints_changes_the_joint_of_several_dofs() -> None:
    source = hx.loads(MJCF, "mjcf").mechanism
    text = hx.dumps(source, "urdf", keep="inside")
    assert 'name="left_hip_y"' in text
    upper = repr(110 * 3.141592653589793 / 180)
    assert text.count(f'upper="{upper}"') == 1
    back = hx.loads(text.replace(f'upper="{upper}"', 'upper="1.5"'), "urdf").mechanism
    (found,) = diff(source, back)
    assert (found.element, found.field, found.after) == (Id("joint", "left_thigh"), "dofs[1].limits.upper", "1.5")
    mujoco.MjModel.from_xml_string(hx.dumps(back, "mjcf", keep="inside"))


_PLANAR = """<mujoco model="planar">
  <worldbody>
    <body name="torso" pos="0 0 1">
      <joint name="x" type="slide" axis="1 0 0" damping="0.5"/>
      <joint name="z" type="slide"/>
      <joint name="y" axis="0 1 0"/>
      <geom name="t" type="sphere" size="0.1"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="m" joint="z"/>
  </actuator>
</mujoco>
"""


def test_an_edit_of_a_chain_below_the_world_comes_home() -> None:
    """No shape and no other joint of the source says which link of the URDF the world is."""
    home = hx.dumps(hx.loads(_PLANAR, "mjcf"), "mjcf", keep="inside")
    text = hx.dumps(hx.loads(_PLANAR, "mjcf"), "urdf", keep="inside")
    assert hx.dumps(hx.loads(text, "urdf"), "mjcf", keep="inside") == home
    edited = text.replace('damping="0.5"', 'damping="0.75"')
    assert hx.dumps(hx.loads(edited, "urdf"), "mjcf", keep="inside") == home.replace('damping="0.5"', 'damping="0.75"') != home


def test_two_dofs_with_one_name_get_two_in_mjcf() -> None:
    other = '<body name="other" pos="0 0 2"><joint name="o" axis="1 0 0"/><geom type="sphere" size="0.1"/></body>'
    robot = hx.loads(_PLANAR.replace("  </worldbody>", f"{other}</worldbody>"), "mjcf").mechanism
    text = hx.dumps(robot, "hymeko").replace("z : slide", "o : slide").replace("{ z - torso }", "{ o - torso }")
    report = Report()
    model = mujoco.MjModel.from_xml_string(hx.dumps(hx.loads(text, "hymeko"), "mjcf", report=report, keep="inside"))
    assert [model.joint(number).name for number in range(model.njnt)] == ["x", "o", "y", "o#2"]
    assert [diagnostic.code for diagnostic in report if diagnostic.severity.rank] == [codes.RENAMED]


@pytest.mark.unread("HX204")
def test_a_renamed_link_of_a_chain_takes_along_what_was_carried_for_it() -> None:
    source = hx.loads(MJCF, "mjcf").mechanism
    report = Report()
    back = hx.loads(hx.dumps(source, "urdf", keep="inside").replace('"left_shin"', '"shank"'), "urdf", report=report).mechanism
    assert back.joints[Id("joint", "left_knee")].child == Id("body", "shank")
    assert [arc.target for arc in back.graph.edges[Id("tendon", "strap")].arcs] == [Id("frame", "left_sole"), Id("frame", "right_sole")]
    assert "shank" in str(list(report))


def test_a_deleted_link_takes_along_what_was_carried_on_it() -> None:
    source = hx.loads(PLAIN_MJCF, "mjcf").mechanism
    text, done = applied(
        hx.dumps(source, "urdf", keep="inside"),
        [lambda root: [root.remove(e) for e in root if e.get("name") in ("right_shin", "right_knee")] and ""],
    )
    report = Report()
    back = hx.loads(text, "urdf", report=report).mechanism
    gone = {difference.element for difference in diff(source, back) if difference.after is None and difference.field == ""}
    assert {
        Id("body", "right_shin"),
        Id("frame", "right_sole"),
        Id("tendon", "strap"),
        Id("drive", "right_knee"),
        Id("loop", "chained"),
    } <= gone
    assert not {Id("body", "left_shin"), Id("frame", "left_sole"), Id("sensor", "imu"), Id("drive", "left_knee")} & gone
    assert any("right_sole" in str(diagnostic) for diagnostic in report)
    assert done == [""]


def test_what_the_editor_names_like_something_carried_is_kept() -> None:
    source = hx.loads(PLAIN_MJCF.replace("</asset>", '<material name="paint" reflectance="0.1"/></asset>', 1), "mjcf").mechanism
    text = hx.dumps(source, "urdf", keep="inside")
    assert '<material name="paint"' not in text
    again = text.replace("</robot>", '<material name="paint"><color rgba="1 0 0 1"/></material></robot>')
    back = hx.loads(again, "urdf").mechanism
    paint = Id("material", "paint")
    assert back.graph.vertices[paint] != source.graph.vertices[paint]


@pytest.mark.unread("HX204")
def test_a_damaged_residue_is_one_warning_and_the_file_is_read_without() -> None:
    text = hx.dumps(hx.loads(MJCF, "mjcf"), "urdf", keep="inside")
    for broken in (
        text.replace("version 2", "version 3"),
        text.replace("kept : residue {", "kept : residue"),
        text.replace("dofs.1.ref", "dofs.x.ref"),
    ):
        report = Report()
        assert broken != text
        hx.loads(broken, "urdf", report=report)
        assert [diagnostic.code.id for diagnostic in report] == ["HX107"] or "dofs.x" in broken


@pytest.mark.unread("HX204")
def test_nothing_is_kept_unless_that_is_asked_for() -> None:
    for source, own, other in ((MJCF, "mjcf", "urdf"), (URDF, "urdf", "mjcf")):
        robot = hx.loads(source, own).mechanism
        assert "hymeko" in hx.dumps(robot, other, keep="inside")
        assert "hymeko" not in hx.dumps(robot, other)


@pytest.mark.parametrize(
    ("text", "own", "other"),
    [(MJCF, "mjcf", other) for other in ("urdf", "xacro", "usd")] + [(URDF, "urdf", other) for other in ("mjcf", "xacro", "usd")],
)
@pytest.mark.unread("HX204")
def test_there_and_back_is_the_same_to_the_last_bit(text: str, own: str, other: str) -> None:
    robot = hx.loads(text, own).mechanism
    assert unequal(robot, hx.loads(hx.dumps(robot, other, keep="inside"), other).mechanism) == []


def test_hymeko_says_everything_itself_but_where_a_line_stood() -> None:
    robot = hx.loads(URDF, "urdf").mechanism
    assert [
        fault for fault in unequal(robot, hx.loads(hx.dumps(robot, "hymeko"), "hymeko").mechanism) if not fault.startswith("layout: ")
    ] == []


def test_where_nothing_but_side_notes_differs_they_come_back() -> None:
    """A file may have no other text than what it carries."""
    robot = hx.loads('<robot name="r"><link name="base"/></robot>', "urdf").mechanism
    robot = replace(robot, stereotypes={Id("body", "base"): ("platform",)})
    for other in ("urdf", "xacro", "mjcf", "usd"):
        assert unequal(robot, hx.loads(hx.dumps(robot, other, keep="inside"), other).mechanism) == [], other


def test_a_file_that_was_copied_is_found_on_the_way_back(tmp_path: Path) -> None:
    """The source calls its mesh by a name that means nothing beside the file that carries it."""
    (tmp_path / "parts").mkdir()
    trimesh.creation.box((1.0, 1.0, 0.1)).export(tmp_path / "parts" / "plate.stl")
    (tmp_path / "a").mkdir()
    mesh = '<visual><geometry><mesh filename="../parts/plate.stl"/></geometry></visual>'
    (tmp_path / "a" / "robot.urdf").write_text(f'<robot name="r"><link name="base">{mesh}</link></robot>')
    (tmp_path / "b" / "c").mkdir(parents=True)
    hx.convert(tmp_path / "a" / "robot.urdf", tmp_path / "b" / "c" / "robot.xml", keep="beside")
    back = hx.load(tmp_path / "b" / "c" / "robot.xml").mechanism
    assert [mesh.uri for _, mesh in back.vertices(Mesh)] == ["../parts/plate.stl"]
    result = hx.convert(tmp_path / "b" / "c" / "robot.xml", tmp_path / "b" / "home.urdf")
    assert [diagnostic.code for diagnostic in result.report] == [codes.KEPT_USED]
    assert [(tmp_path / "b" / name).is_file() for name in (*result.package.files, *result.package.copies)] == [True]


def test_a_rotation_that_is_rounded_moves_no_frame_however_far_away() -> None:
    """URDF says rotations as angles; what that rounds moves a body at 10^12 m by more than a millimetre."""
    text = """
<mujoco><worldbody><body name="base"><geom size="1"/><body name="arm" quat="0.7 0.1 -0.5 0.3"><geom size="1"/>
<body name="hand" pos="1e12 0 0"><geom size="1"/></body></body></body></worldbody></mujoco>"""
    robot = hx.loads(text, "mjcf").mechanism
    carrying = hx.dumps(robot, "urdf", keep="inside")
    assert "frames {" not in carrying
    assert unequal(robot, hx.loads(carrying, "urdf").mechanism) == []
