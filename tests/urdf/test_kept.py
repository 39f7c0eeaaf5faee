"""Nothing gets lost: what has no word in the mechanism is kept verbatim and written back where it stood."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from hymeko_x.diagnostics import Refusal
from hymeko_x.ir.mechanism import ROOT, Extra, Id
from tests.urdf.samples import LIMIT, TWO_LINKS, again, dump, joint, load, robot, visual

A, J = Id("body", "a"), Id("joint", "j")


def extras(text: str, key: Id = ROOT) -> list[tuple[str, str]]:
    return [(extra.path, extra.text) for extra in load(text).extras.get(key, ())]


@pytest.mark.parametrize(
    "foreign",
    [
        '<gazebo reference="a">\n    <mu1>0.2</mu1>\n    <sensor name="s"/>\n  </gazebo>',
        '<mujoco><compiler meshdir="m"/></mujoco>',
        '<ros2_control name="c" type="system"><hardware><plugin>p/P</plugin></hardware></ros2_control>',
        '<anything at="all"><![CDATA[<raw> & text]]></anything>',
        "<?pi some data?>",
        '<frame name="f" link="a" xyz="0 0 1"/>',
    ],
)
def test_foreign_elements_are_kept_verbatim_at_their_place(foreign: str) -> None:
    source = robot(f'<link name="a"/>\n{foreign}\n<link name="b"/>{joint(LIMIT)}')
    assert load(source).extras[ROOT] == (Extra("urdf", "", foreign, 1),)
    assert f'<link name="a"/>\n  {foreign}\n  <link name="b"/>' in again(source)


def test_a_comment_is_kept_at_its_place_without_the_signs_of_its_format() -> None:
    source = robot(f'<link name="a"/>\n<!--a comment-->\n<link name="b"/>{joint(LIMIT)}')
    assert load(source).extras[ROOT] == (Extra("comment", "", "a comment", 1),)
    assert '<link name="a"/>\n  <!-- a comment -->\n  <link name="b"/>' in again(source)


def test_a_foreign_element_carries_the_namespaces_it_needs_and_the_root_is_not_repeated() -> None:
    spaces = ' name="r" xmlns:drake="http://drake.mit.edu" xmlns:xacro="http://www.ros.org/wiki/xacro"'
    source = robot('<link name="a"><drake:proximity><drake:mu value="1"/></drake:proximity></link>', spaces)
    needed = '<drake:proximity xmlns:drake="http://drake.mit.edu"><drake:mu value="1"/></drake:proximity>'
    assert extras(source, A) == [("", needed)]
    assert extras(source) == [("@xmlns:drake", "http://drake.mit.edu"), ("@xmlns:xacro", "http://www.ros.org/wiki/xacro")]
    assert '    <drake:proximity><drake:mu value="1"/></drake:proximity>\n' in again(source)
    assert load(again(source)) == load(source)


@pytest.mark.unread("HX045")
def test_comments_before_and_after_the_robot_are_kept() -> None:
    source = f"<!-- one -->\n<!-- two -->\n{robot('')}\n<!-- three -->"
    assert extras(source) == [("preceding", "one"), ("preceding", "two"), ("following", "three")]
    assert again(source) == '<?xml version="1.0"?>\n<!-- one -->\n<!-- two -->\n<robot name="r"/>\n<!-- three -->\n'


@pytest.mark.parametrize(
    ("body", "key", "path", "text"),
    [
        ('<link name="a" type="robot"/>', A, "@type", "robot"),
        ('<link name="a"><contact/></link>', A, "", "<contact/>"),
        ('<link name="a"><inertial><mass value="1" unit="kg"/></inertial></link>', A, "inertial/mass/@unit", "kg"),
        ('<link name="a">stray</link>', A, "text()", "stray"),
        (visual('<geometry name="g"><sphere radius="1"/></geometry>'), Id("shape", "a/visual"), "geometry/@name", "g"),
        (TWO_LINKS + joint(LIMIT.replace("/>", ' current="9"/>')), J, "limit/@current", "9"),
        (TWO_LINKS + joint(LIMIT.replace("/>", "><soft/></limit>")), J, "limit", "<soft/>"),
        (TWO_LINKS + joint('<safety_controller k_velocity="1"/>', "fixed"), J, "", '<safety_controller k_velocity="1"/>'),
        ('<link name="a" xml:base="b"/>', A, "@xml:base", "b"),
        (TWO_LINKS + joint('<axis xyz="0 0 1" rpy="0 0 0"/>' + LIMIT), J, "axis/@rpy", "0 0 0"),
    ],
)
@pytest.mark.unread("HX045")
def test_what_the_reader_does_not_use_belongs_to_the_element_it_stands_in(body: str, key: Id, path: str, text: str) -> None:
    source = robot(body)
    assert (path, text) in extras(source, key)
    assert load(dump(load(source))) == load(source)


@pytest.mark.unread("HX020")
def test_a_number_that_cannot_be_read_is_written_back_as_it_was() -> None:
    source = robot(TWO_LINKS + joint('<origin xyz="1 2" rpy="0 0 1"/>', "fixed"))
    assert extras(source, J) == [("origin/@xyz", "1 2")]
    assert '<origin xyz="1 2" rpy="0 0 1"/>' in again(source)


@pytest.mark.unread("HX045", "HX047")
def test_the_second_of_two_equal_elements_stays_the_second() -> None:
    source = robot('<link name="a"><inertial><mass value="1"/></inertial><inertial><mass value="2"/></inertial></link>')
    assert extras(source, A) == [("", '<inertial><mass value="2"/></inertial>')]
    written = again(source)
    assert written.index('value="1"') < written.index('value="2"')
    assert load(written) == load(source)


@pytest.mark.unread("HX047")
def test_the_first_of_two_axes_counts_also_after_writing_them_in_another_order() -> None:
    ends = '<parent link="a"/><child link="b"/>'
    source = robot(f'{TWO_LINKS}<joint name="j" type="continuous"><axis xyz="0 0 1"/><axis xyz="0 1 0"/>{ends}</joint>')
    assert load(source).joints[J].joint.dofs[0].axis == (0.0, 0.0, 1.0)
    assert load(again(source)) == load(source)


@pytest.mark.unread("HX045")
def test_a_joint_without_a_child_is_kept_outside_of_the_tree() -> None:
    source = robot('<link name="a"/><joint name="j" type="fixed"><parent link="a"/></joint>')
    assert extras(source) == [("", '<joint name="j" type="fixed"><parent link="a"/></joint>')]
    assert list(load(source).graph.edges) == []


def test_what_most_fixed_joints_say_in_vain_is_reported_once() -> None:
    vain = '<axis xyz="0 0 0"/>'
    body = TWO_LINKS + '<link name="c"/><link name="d"/>'
    body += joint(vain, "fixed") + joint(vain, "fixed", name="k", child="c") + joint('<axis xyz="0 0 1"/>', "fixed", name="l", child="d")
    mechanism = load(robot(body))
    assert mechanism.notations.get(ROOT, {}).get("urdf.fixed") == vain
    assert list(mechanism.extras) == [Id("joint", "l")]
    assert dump(mechanism).count(vain) == 2
    assert dump(mechanism).count('<axis xyz="0 0 1"/>') == 1


def test_what_few_fixed_joints_say_in_vain_stays_theirs() -> None:
    names = "bcdef"
    links = "".join(f'<link name="{name}"/>' for name in f"a{names}")
    vain = '<axis xyz="0 0 1"/>'
    joints = "".join(joint(vain if name in "bc" else "", "fixed", name=name, child=name) for name in names)
    mechanism = load(robot(links + joints))
    assert mechanism.notations.get(ROOT, {}).get("urdf.fixed") is None
    assert list(mechanism.extras) == [Id("joint", "b"), Id("joint", "c")]


@pytest.mark.unread("HX045")
def test_what_the_author_wrote_in_vain_is_written_again() -> None:
    body = (
        '<link name="a"><inertial><origin xyz="0 0 0"/><mass value="1"/></inertial>'
        '<visual><origin xyz="0 0 0" rpy="0 0 0"/><geometry><mesh filename="m.stl" scale="1 1 1"/></geometry></visual></link>'
        '<link name="b"/>' + joint('<origin xyz="0 0 0"/><dynamics damping="0.0" friction="0"/>' + LIMIT)
    )
    mechanism = load(robot(body, ' name="r" version="1.0"'))
    style = "dynamics inertial joint no-axis no-inertial-rpy no-joint-rpy scale version visual"
    assert mechanism.notations.get(ROOT, {}).get("urdf.style") == style
    written = dump(mechanism)
    assert written.count("<origin ") == 3
    assert '<dynamics damping="0" friction="0"/>' in written
    assert 'scale="1 1 1"' in written
    assert '<robot name="r" version="1.0">' in written


def test_what_the_author_left_out_is_left_out() -> None:
    body = '<link name="a"><visual><geometry><mesh filename="m.stl"/></geometry></visual></link><link name="b"/>' + joint(LIMIT)
    written = again(robot(body))
    assert "origin" not in written
    assert "dynamics" not in written
    assert "scale" not in written


MOVED = '<origin xyz="0 0 1"/>'
DRIVEN = '<dynamics damping="1"/>'
ONE_OF_TWO = [
    ('<origin xyz="0 0 0" rpy="0 0 0"/>', ""),
    (MOVED, '<origin xyz="0 0 1" rpy="0 0 0"/>'),
    ('<origin rpy="0 0 1"/>', '<origin xyz="0 0 0" rpy="0 0 1"/>'),
    ('<axis xyz="1 0 0"/>', ""),
    ('<dynamics damping="0" friction="0"/>', ""),
    (DRIVEN, '<dynamics damping="1" friction="0"/>'),
    ('<dynamics friction="1"/>', '<dynamics damping="0" friction="1"/>'),
]


def assert_comes_again(source: str) -> None:
    assert again(source).replace("\n", "").replace("  ", "") == '<?xml version="1.0"?>' + source.replace("\n", "")


@pytest.mark.parametrize(("one", "other"), ONE_OF_TWO)
@pytest.mark.parametrize("places", ["b", "cde", "bde"])
def test_each_joint_has_the_default_values_that_its_author_wrote(one: str, other: str, places: str) -> None:
    links = "".join(f'<link name="{name}"/>' for name in "abcde")
    ends = '<parent link="a"/><child link="{0}"/>'
    tags = [[one, other][name in places] for name in "bcde"]
    before, after = (0, 1) if "origin" in one else (1, 0)
    joints = [
        f'<joint name="{name}" type="continuous">{tag * after}{ends.format(name)}{tag * before}</joint>'
        for name, tag in zip("bcde", tags, strict=True)
    ]
    assert_comes_again(robot(links + "".join(joints)))


def test_each_shape_and_limit_has_the_default_values_that_its_author_wrote() -> None:
    mesh = '<visual>{0}<geometry><mesh filename="m.stl"{1}/></geometry></visual>'
    both, none = mesh.format('<origin xyz="0 0 0" rpy="0 0 0"/>', ' scale="1 1 1"'), mesh.format("", "")
    limits = ('<limit upper="1" effort="1" velocity="1"/>', '<limit lower="0" upper="1" effort="1" velocity="1"/>')
    mimics = ('<mimic joint="b"/>', '<mimic joint="b" multiplier="1" offset="0"/>', '<mimic joint="b" multiplier="2"/>')
    joints = "".join(
        f'<joint name="{name}" type="prismatic"><parent link="a"/><child link="{name}"/><axis xyz="0 0 1"/>{limits[at % 2]}{mimic}</joint>'
        for at, (name, mimic) in enumerate(zip("bcde", ("", *mimics), strict=True))
    )
    links = "".join(f'<link name="{name}"/>' for name in "bcde")
    assert_comes_again(robot(f'<link name="a">{both}{none}{none}</link>{links}{joints}'))


SPHERE = '<geometry><sphere radius="1"/></geometry>'
RED = '<material name="red"><color rgba="1 0 0 1"/></material>'
USE = '<material name="red"/>'


@pytest.mark.parametrize(
    ("at_robot", "uses"),
    [
        (RED, (USE, USE)),
        ("", (RED, RED)),
        ("", (RED, USE)),
        (RED, (RED, RED)),
        ("", (RED, USE, USE)),
        (RED, ()),
    ],
)
def test_materials_are_defined_where_their_author_defined_them(at_robot: str, uses: tuple[str, ...]) -> None:
    shapes = "".join(f"<visual>{SPHERE}{use}</visual>" for use in uses)
    source = robot(f'{at_robot}<link name="a">{shapes}</link>' if uses else f'{at_robot}<link name="a"/>')
    written = again(source).replace("\n", "").replace("  ", "")
    assert written == '<?xml version="1.0"?>' + source.replace("\n", "")


@pytest.mark.unread("HX046")
def test_a_material_that_is_defined_twice_with_other_looks_keeps_both_looks() -> None:
    blue = RED.replace("1 0 0 1", "0 0 1 1")
    source = robot(f'{RED}<link name="a"><visual>{SPHERE}{USE}</visual><visual>{SPHERE}{blue}</visual></link>')
    mechanism = load(source)
    assert [view.material for view in mechanism.shapes[A]] == [Id("material", "red"), Id("material", "red#2")]
    written = dump(mechanism).replace("\n", "").replace("  ", "")
    assert written == '<?xml version="1.0"?>' + source.replace("\n", "")


def test_the_order_of_the_author_is_kept() -> None:
    body = f'{joint(LIMIT)}\n<link name="b"/>\n<!-- x -->\n<link name="a"/>\n<material name="m"><color rgba="1 1 1 1"/></material>'
    written = again(robot(body))
    places = [written.index(text) for text in ("<joint", '<link name="b"', "<!-- x -->", '<link name="a"', "<material")]
    assert places == sorted(places)


@pytest.mark.parametrize(
    ("extra", "why"),
    [
        (Extra("urdf", "", "<a>"), "<a>"),
        (Extra("urdf", "", "a"), "a"),
        (Extra("urdf", "", "<a/><b/>"), "<a/><b/>"),
        (Extra("urdf", "", "<a/>b"), "<a/>b"),
        (Extra("urdf", "", "<x:a/>"), "<x:a/>"),
        (Extra("urdf", "limit/<", "<a/>"), "<a/>"),
        (Extra("urdf", "@a b", "c"), "c"),
        (Extra("urdf", "preceding", "text"), "text"),
        (Extra("urdf", "following", "<a/>"), "<a/>"),
    ],
)
def test_an_extra_that_is_not_xml_is_refused(extra: Extra, why: str) -> None:
    mechanism = replace(load(robot('<link name="a"/>')), extras={A if "/" in extra.path else ROOT: (extra,)})
    with pytest.raises(Refusal) as refusal:
        dump(mechanism)
    assert str(refusal.value).startswith(f"error[HX062]: the urdf extra '{why}' cannot be written into XML: ")
