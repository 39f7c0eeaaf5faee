"""What the frontend reads: macros, includes, arguments, yaml, variables; and that everything knows where it was written."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from hymeko_x import codes, formats, pipeline
from hymeko_x.diagnostics import Origin, Refusal, Report
from hymeko_x.frontends.xacro import read
from hymeko_x.ir.mechanism import ROOT, Id
from hymeko_x.rewrite import Options
from hymeko_x.source import Source
from tests.xacro.samples import Folder, robot

LEG = """<xacro:macro name="leg" params="side *block">
  <link name="${side}_leg">
    <xacro:insert_block name="block"/>
  </link>
  <joint name="${side}_hip" type="fixed">
    <parent link="base"/>
    <child link="${side}_leg"/>
  </joint>
</xacro:macro>"""


def body(name: str) -> Id:
    return Id("body", name)


def joint(name: str) -> Id:
    return Id("joint", name)


def test_an_element_comes_from_its_line_in_the_macro_or_the_included_file(folder: Folder) -> None:
    included = folder.put("parts/leg.xacro", f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n{LEG}\n</robot>')
    report = Report()
    mechanism = folder.read(
        '<xacro:include filename="parts/leg.xacro"/>\n<link name="base"/>\n'
        '<xacro:leg side="left">\n  <visual>\n    <geometry><sphere radius="1"/></geometry>\n  </visual>\n</xacro:leg>',
        report,
    )
    main = str(folder.path / "r.xacro")
    assert list(report) == []
    assert mechanism.origins[ROOT] == Origin(main, 1)
    assert mechanism.origins[body("base")] == Origin(main, 3)
    assert mechanism.origins[body("left_leg")] == Origin(str(included), 3)
    assert mechanism.origins[joint("left_hip")] == Origin(str(included), 6)
    shape = next(key for key in mechanism.origins if key.kind == "shape")
    assert mechanism.origins[shape] == Origin(main, 5)
    assert mechanism.stereotypes == {body("left_leg"): ("leg",), joint("left_hip"): ("leg",)}


@pytest.mark.unread("HX020", "HX023", "HX042")
def test_what_is_reported_of_the_urdf_points_at_the_xacro_file(folder: Folder) -> None:
    inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    reported = folder.reported(
        f'<xacro:macro name="arm" params="n">\n  <link name="${{n}}">\n    <inertial><mass value="x"/>{inertia}</inertial>\n  </link>\n'
        '</xacro:macro>\n<xacro:arm n="a"/>\n<xacro:arm n="a"/>'
    )
    assert [line.split(": ")[0:2] for line in reported] == [
        ["r.xacro:4", "error[HX020]"],
        ["r.xacro:3", "error[HX023]"],
        ["r.xacro:4", "error[HX020]"],
        ["r.xacro:1", "warning[HX042]"],
    ]
    assert "(the other one: r.xacro:3)" in reported[1]


def test_a_refusal_of_the_urdf_reader_points_at_the_xacro_file(folder: Folder) -> None:
    folder.put("r.xacro", '\n<a xmlns:xacro="http://www.ros.org/wiki/xacro"/>')
    assert (
        str(refused(folder.source()))
        == f"{folder.path}/r.xacro:2: error[HX055]: the file expands to <a>\n  hint: expected <robot> with links"
    )


def refused(source: Source) -> Refusal:
    with pytest.raises(Refusal) as refusal:
        read(source, Report())
    return refusal.value


@pytest.mark.unread("HX042")
def test_places_survive_dynamic_names_conditions_and_recursion(folder: Folder) -> None:
    mechanism = folder.read(
        '<xacro:macro name="row" params="n">\n  <xacro:element xacro:name="link" name="l${n}"/>\n  <xacro:if value="${n > 1}">\n'
        '    <xacro:row n="${n - 1}"/>\n  </xacro:if>\n</xacro:macro>\n<xacro:call macro="row" n="3"/>'
    )
    assert {key.name: origin.line for key, origin in mechanism.origins.items() if key.kind == "body"} == {"l3": 3, "l2": 3, "l1": 3}


def test_what_is_kept_of_other_formats_and_comments_is_that_of_the_expansion(folder: Folder) -> None:
    mechanism = folder.read(
        '<xacro:property name="w" value="2"/>\n<!-- kept -->\n<link name="a"/>\n<gazebo reference="a"><mu1>${w*2}</mu1></gazebo>'
    )
    written = pipeline.write(mechanism, formats.by_name("urdf"), Options(), folder.source().files, Report()).main.decode()
    assert written.split("\n", 1)[1] == (
        '<robot name="r">\n  <!-- kept -->\n  <link name="a"/>\n  <gazebo reference="a">\n    <mu1>4</mu1>\n  </gazebo>\n</robot>\n'
    )


def test_arguments_have_defaults_and_the_user_overrides_them(folder: Folder) -> None:
    text = '<xacro:arg name="n" default="a"/>\n<link name="$(arg n)${xacro.arg(\'n\')}$(eval n + \'x\')"/>'
    assert body("aaax") in folder.read(text).graph.vertices
    assert body("bbbx") in folder.read(text, arguments={"n": "b"}).graph.vertices


def test_an_argument_without_value_is_named_with_what_to_pass(folder: Folder) -> None:
    refusal = folder.refusal('<link name="a"/>\n<link name="$(arg side)_leg"/>')
    assert (refusal.code, refusal.message, refusal.origin) == (
        codes.ARGUMENT_MISSING,
        "the argument 'side' is needed here and has no value",
        Origin(str(folder.path / "r.xacro"), 3),
    )
    assert refusal.hint == "give it one: --arg side:=VALUE"


def test_a_default_that_comes_too_late_is_shown(folder: Folder) -> None:
    folder.put(
        "r.xacro", '<robot name="$(arg n)" xmlns:xacro="http://www.ros.org/wiki/xacro">\n<xacro:arg name="n" default="ur5"/>\n</robot>'
    )
    assert str(refused(folder.source())) == (
        f"{folder.path}/r.xacro:1: error[HX051]: the argument 'n' is needed here and has no value\n"
        "  hint: give it one: --arg n:=VALUE (the file gives it the default 'ur5' in line 2, which xacro evaluates later)"
    )


def test_a_given_argument_that_the_file_never_mentions_is_reported(folder: Folder) -> None:
    text = '<xacro:arg name="side" default="left"/>\n<link name="$(arg side)$(eval side)"/>'
    assert folder.reported(text, arguments={"sdie": "right"}) == [
        "r.xacro: warning[HX059]: the argument 'sdie' has no effect: the file does not mention it"
    ]
    assert folder.reported(text, arguments={"side": "right"}) == []


def test_yaml_is_read_beside_the_file_that_asks_for_it(folder: Folder) -> None:
    folder.put("parts/size.yaml", "arm: {mass: 1.5, turn: !degrees 180}\n")
    folder.put("parts/p.xacro", robot_with('<xacro:property name="size" value="${xacro.load_yaml(\'size.yaml\')}" scope="global"/>'))
    mechanism = folder.read("<xacro:include filename=\"parts/p.xacro\"/>\n<link name=\"m${size.arm.mass}_${size['arm']['turn']}\"/>")
    assert body("m1.5_3.141592653589793") in mechanism.graph.vertices


def robot_with(text: str) -> str:
    return f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n{text}\n</robot>'


def test_a_missing_file_is_named_where_it_is_asked_for(folder: Folder) -> None:
    folder.put("parts/p.xacro", robot_with('\n<xacro:include filename="deep.xacro"/>'))
    refusal = folder.refusal('<xacro:include filename="parts/p.xacro"/>')
    assert (refusal.code, refusal.message) == (
        codes.INCLUDE_NOT_FOUND,
        "the file 'parts/deep.xacro' cannot be read: no such file, or none that may be read",
    )
    assert str(refusal.origin) == f"{folder.path}/parts/p.xacro:3"
    assert refusal.excerpt == (f"  from {folder.path}/r.xacro:2: <xacro:include>",)
    refusal = folder.refusal("<link name=\"${xacro.load_yaml('no.yaml')}\"/>")
    assert (refusal.code, refusal.message) == (
        codes.INCLUDE_NOT_FOUND,
        "the file 'no.yaml' cannot be read: no such file, or none that may be read",
    )


@pytest.mark.unread("HX042")
def test_an_optional_include_may_be_missing_and_a_pattern_names_several_files(folder: Folder) -> None:
    for name in ("b", "a", ".hidden"):
        folder.put(f"parts/{name}.xacro", robot_with(f'<link name="{name}"/>'))
    mechanism = folder.read('<xacro:include filename="no.xacro" optional="true"/>\n<xacro:include filename="par*/*.xacro"/>')
    assert [key.name for key in mechanism.graph.vertices if key.kind == "body"] == ["a", "b"]


def test_the_environment_is_closed_unless_a_variable_is_passed_on(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ARM", "secret")
    assert folder.reported('<link name="$(env ARM)"/>') == [
        "r.xacro:2: error[HX057]: the environment variable 'ARM' is needed here, and the environment is closed to files"
    ]
    assert folder.reported('<link name="$(optenv ARM left arm)"/>') == [
        "r.xacro:2: note[HX057]: the environment variable 'ARM' is not passed on; its default 'left arm' is used"
    ]
    in_eval = '<xacro:property name="p" value="env(\'ARM\')"/><link name="$(eval ${p})"/>'
    assert folder.reported(in_eval)[0].startswith("r.xacro:2: error[HX057]")
    assert body("left") in folder.read('<link name="$(env ARM)"/>', environment={"ARM": "left"}).graph.vertices


def test_a_failure_shows_how_xacro_got_there(folder: Folder) -> None:
    refusal = folder.refusal(
        '<xacro:macro name="hand">\n  <link name="${nmae}"/>\n</xacro:macro>\n'
        '<xacro:macro name="arm">\n  <xacro:hand/>\n</xacro:macro>\n<xacro:arm/>'
    )
    assert refusal.code == codes.EXPANSION_FAILED
    assert refusal.message == "xacro: name 'nmae' is not defined when evaluating expression 'nmae'"
    place = folder.path / "r.xacro"
    assert str(refusal.origin) == f"{place}:3"
    assert refusal.excerpt == (f"  from {place}:6: <xacro:hand>", f"  from {place}:8: <xacro:arm>")


@pytest.mark.unread("HX045")
def test_warnings_of_xacro_and_messages_of_the_file_are_reported_once_each(folder: Folder) -> None:
    assert folder.reported(
        '<link name="a">\n  <visual name="${xacro.warning(\'old\')}">${xacro.message("hi")}</visual>\n</link>\n'
        '<xacro:property name="pi" value="3"/>'
    )[:3] == [
        "r.xacro:3: warning[HX056]: xacro: old",
        "r.xacro:3: note[HX056]: xacro: hi",
        "r.xacro:5: warning[HX056]: xacro: redefining global symbol: pi",
    ]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('<sdf xmlns:xacro="x" version="1.6"/>', "SDF (Gazebo): <sdf>"),
        ("<mujoco/>", "MJCF (MuJoCo): <mujoco>"),
        ('<robot name="r"><group name="arm"/></robot>', "SRDF, which describes the use of a robot and not the robot: <group>"),
        ("<plugin/>", "<plugin>"),
    ],
)
def test_what_is_no_urdf_is_refused_by_name(text: str, found: str) -> None:
    refusal = refused(Source("r.xacro", text.encode()))
    assert (refusal.diagnostic.code, refusal.diagnostic.message) == (codes.NOT_URDF, f"the file expands to {found}")


@pytest.mark.unread("HX045")
def test_a_library_of_macros_is_no_robot(folder: Folder) -> None:
    assert (
        folder.reported('<xacro:macro name="leg"><link name="a"/></xacro:macro>')[0]
        == "r.xacro: warning[HX055]: the expansion has no links"
    )


@pytest.mark.parametrize("name", ["<stdin>", "folder/r.XACRO"])
def test_text_without_a_file_around_it_expands(name: str) -> None:
    mechanism = read(Source(name, b'<robot name="r"><link name="${1 + 1}"/></robot>'), Report()).mechanism
    assert mechanism.origins == {ROOT: Origin(name, 1), body("2"): Origin(name, 1)}


def test_the_same_bytes_give_the_same_bytes(folder: Folder) -> None:
    text = "<xacro:property name=\"s\" value=\"${python.set(['a', 'b', 'c', 'd'])}\"/>\n<link name=\"${s} ${python.hash('a')}\"/>"
    assert len({folder.expand(text).text for _ in range(4)}) == 1


def test_thousands_of_links_take_a_time_that_grows_with_their_number(folder: Folder) -> None:
    """As a bound on time: each macro call of xacro alone would search thousands of siblings several times."""
    calls = "".join(f'<xacro:l n="{number}"/>' for number in range(4000))
    text = folder.expand(f'<xacro:macro name="l" params="n"><link name="l${{n}}"/><link name="m${{n}}"/></xacro:macro>{calls}').text
    assert text.count(b"<link") == 8000


def test_a_converted_file_is_the_expansion(folder: Folder) -> None:
    folder.put("r.xacro", robot('<link name="${2 * 3}"/>'))
    hx.convert(folder.path / "r.xacro", folder.path / "out.urdf")
    first, mark, rest = (folder.path / "out.urdf").read_text().split("\n", 2)
    assert (first, rest) == ('<?xml version="1.0"?>', '<robot name="r">\n  <link name="6"/>\n</robot>\n')
    assert mark == f"<!-- made by hymeko-x {hx.__version__} from r.xacro -->"
