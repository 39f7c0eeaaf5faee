# ruff: noqa: E501 - a message stands in one piece
"""Bad input gets a diagnostic with code, file and line and what is done about it, or a clean refusal. Never a traceback."""

from __future__ import annotations

import re

import pytest

from hymeko_x.diagnostics import Refusal
from tests.urdf.samples import LIMIT, TWO_LINKS, again, joint, load, reported, robot, visual

pytestmark = pytest.mark.unread  # one test reads what each input reports; the others look at the robot
LINK = '<link name="a"/>'
THREE_LINKS = f'{TWO_LINKS}<link name="c"/>'
SPHERE = '<geometry><sphere radius="1"/></geometry>'
RED = '<material name="red"><color rgba="1 0 0 1"/></material>'

REPORTED: dict[str, tuple[str | bytes, list[str]]] = {
    "an XML version that does not exist": (
        f'<?xml version="0.0" ?>\n{robot(LINK)}',
        [
            "1: warning[HX005]: the version in the XML declaration is '0.0'; read as 1.0",
        ],
    ),
    "an XML declaration behind a comment": (
        f'<!-- c -->\n<?xml version="1.0"?>\n{robot(LINK)}',
        [
            "2:1: warning[HX005]: the XML declaration does not stand at the start; read as if it did",
        ],
    ),
    "line ends of three systems in one file": (
        robot(f'{LINK}\r<drake:x y="1"/>\r\n<drake:z/>\n<visual:x/>'),
        [
            "3: warning[HX005]: undeclared prefix 'drake'; read as if the root declared it",
            "5: warning[HX005]: undeclared prefix 'visual'; read as if the root declared it",
        ],
    ),
    "an undeclared prefix": (
        robot(LINK + '<drake:x y="1"/>'),
        [
            "2: warning[HX005]: undeclared prefix 'drake'; read as if the root declared it",
        ],
    ),
    "NUL bytes after the end": (
        robot(LINK) + "\n\0\0",
        [
            "4:1: warning[HX005]: NUL bytes after the end left out",
        ],
    ),
    "no blank between attributes": (
        robot('<link name="a"type="x"/>'),
        [
            "2:15: warning[HX005]: attributes without a blank between them; read as if there was one",
        ],
    ),
    "a bare ampersand": (
        robot('<link name="a & b"/>'),
        [
            "2:16: warning[HX005]: '&' stands where '&amp;' is needed; read as '&'",
        ],
    ),
    "a control character": (
        robot('<link name="a\x01b"/>'),
        [
            "2:14: warning[HX005]: 1 control character left out",
        ],
    ),
    "words after the end": (
        robot(LINK) + "\nbye",
        [
            "4:1: warning[HX005]: text after the last element left out",
        ],
    ),
    "a second root element": (
        robot(LINK) + "<robot/>",
        [
            "3:9: error[HX010]: not well-formed: ...; what could be read was read, and what could not is missing",
        ],
    ),
    "an element that is not closed": (
        robot('<link name="a">'),
        [
            "3:3: error[HX010]: not well-formed: ...; what could be read was read, and what could not is missing",
        ],
    ),
    "an attribute twice": (
        robot('<link name="a" name="b"/>'),
        [
            "2:16: error[HX010]: not well-formed: ...; what could be read was read, and what could not is missing",
        ],
    ),
    "hyphens in a comment": (
        robot(LINK + "<!-- a -- b -->"),
        [
            "2:26: warning[HX005]: '--' within a comment; read as '- -'",
        ],
    ),
    "lines of hyphens in comments": (
        robot(LINK + "<!------ a ----->"),
        [
            "2:23: warning[HX005]: '---' within a comment; read as '==='",
        ],
    ),
    "latin letters in no known encoding": (
        robot('<link name="café"/>').encode("latin-1"),
        [
            "2:16: warning[HX005]: the text is not utf-8; read as latin-1",
        ],
    ),
    "another encoding than declared": (
        ('<?xml version="1.0" encoding="ascii"?>\n' + robot('<link name="café"/>')).encode(),
        [
            "3:16: warning[HX005]: the text is not ascii, as declared; read as utf-8",
        ],
    ),
    "a document type": (
        "<!DOCTYPE robot>" + robot(LINK),
        [
            "1: warning[HX005]: '<!DOCTYPE robot>' is left out: robot files have no document type",
        ],
    ),
    "a robot without a name": (
        robot(LINK, ""),
        [
            "1: warning[HX022]: the robot has no name; it is called 'robot' after its file",
        ],
    ),
    "a robot without links": (
        robot(""),
        [
            "1: error[HX045]: the robot has no links; the result has no bodies",
        ],
    ),
    "an unknown version": (
        robot(LINK, ' name="r" version="7"'),
        [
            "1: warning[HX027]: <robot version> is '7', known are 1.0, 1.1, 1.2; read as 1.0, and the text is kept as written",
        ],
    ),
    "text left over from xacro": (
        robot(
            '<link name="${ns}a"><inertial><mass value="${m}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
        ),
        [
            "2: error[HX024]: link '${ns}a': <mass value> is '${m}', expected one finite number; the mass is unspecified, and the text is kept as written",
            "1: warning[HX024]: the name '${ns}a' is text for xacro; it is kept as it is",
        ],
    ),
    "a xacro file": (
        robot('<xacro:macro name="x"/>' + LINK, ' name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"'),
        [
            "1: error[HX024]: <xacro:macro> is text for xacro; what it stands for is missing, and the text is kept as it is",
        ],
    ),
    "a link without a name": (
        robot("<link/>"),
        [
            "2: error[HX022]: a <link> has no name; it is called 'link'",
        ],
    ),
    "a transmission without a name": (
        robot(LINK + "\n<transmission/>"),
        [
            "3: warning[HX022]: a <transmission> has no name; it is called 'transmission'",
        ],
    ),
    "two transmissions of one name": (
        robot(LINK + '\n<transmission name="t"/>\n<transmission name="t"/>'),
        [
            "4: warning[HX023]: there are two <transmission> called 't' (the other one: robot.urdf:3); this one is called 't#2'",
        ],
    ),
    "two links of one name": (
        robot(LINK + "\n" + LINK),
        [
            "3: error[HX023]: there are two <link> called 'a' (the other one: robot.urdf:2); this one is called 'a#2'",
            "1: warning[HX042]: 2 links have no parent joint ('a', 'a#2'); each is kept as the root of a tree of its own",
        ],
    ),
    "two joints of one name": (
        robot(THREE_LINKS + joint() + joint(child="c")).replace("revolute", "fixed"),
        [
            "2: error[HX023]: there are two <joint> called 'j' (the other one: robot.urdf:2); this one is called 'j#2'",
        ],
    ),
    "a joint without a parent": (
        robot(LINK + '<joint name="j" type="fixed"><child link="a"/></joint>'),
        [
            "2: error[HX045]: joint 'j' has no <parent link>; it is kept as written and is not part of the tree",
        ],
    ),
    "a child that is not defined": (
        robot(LINK + joint("", "fixed")),
        [
            "2: error[HX040]: joint 'j': <child link> is 'b', which is not defined; an empty link of this name was added",
        ],
    ),
    "two parents": (
        robot(THREE_LINKS + joint("", "fixed", parent="c") + joint("", "fixed", "k") + joint("", "fixed", "l", child="c")),
        [
            "2: error[HX041]: link 'b' is the child of 2 joints ('j', 'k'); all are kept, the first one gives its place in the tree",
        ],
    ),
    "two roots": (
        robot(TWO_LINKS),
        [
            "1: warning[HX042]: 2 links have no parent joint ('a', 'b'); each is kept as the root of a tree of its own",
        ],
    ),
    "a cycle": (
        robot(THREE_LINKS + joint("", "fixed", child="c") + joint("", "fixed", "k", "c", "a")),
        [
            "2: error[HX043]: no root leads to link 'a' and 1 more: their joints form a cycle, which is kept",
        ],
    ),
    "a joint of unknown type": (
        robot(TWO_LINKS + joint(LIMIT, "revolut")),
        [
            "2: error[HX027]: joint 'j' has type 'revolut', which is kept as written; read as fixed; known: fixed, revolute, continuous, prismatic, floating, planar, spherical, ball",
        ],
    ),
    "an axis of zero": (
        robot(TWO_LINKS + joint(f'<axis xyz="0 0 0"/>{LIMIT}')),
        [
            "2: error[HX026]: joint 'j': <axis xyz> is '0 0 0', which has no direction; 1 0 0 is used, and the text is kept as written",
        ],
    ),
    "an axis with commas": (
        robot(TWO_LINKS + joint(f'<axis xyz="0,0,1"/>{LIMIT}')),
        [
            "2: error[HX020]: joint 'j': <axis xyz> is '0,0,1', expected 3 finite numbers separated by blanks; 1 0 0 is used, and the text is kept as written",
        ],
    ),
    "an axis that is not unit": (
        robot(TWO_LINKS + joint(f'<axis xyz="0 0 2"/>{LIMIT}')),
        [
            "2: note[HX025]: joint 'j': the axis was normalised; its numbers are kept for writing URDF again",
        ],
    ),
    "too few numbers": (
        robot(TWO_LINKS + joint('<origin xyz="1 2"/>', "fixed")),
        [
            "2: error[HX020]: joint 'j': <origin xyz> is '1 2', expected 3 finite numbers separated by blanks; 0 0 0 is used, and the text is kept as written",
        ],
    ),
    "numbers that are none": (
        robot(
            '<link name="a"><inertial><mass value="nan"/><inertia ixx="inf" ixy="0" ixz="1_0" iyy="1e999" iyz="0" izz="0x10"/></inertial></link>'
        ),
        [
            "2: error[HX020]: link 'a': <mass value> is 'nan', expected one finite number; the mass is unspecified, and the text is kept as written",
            "2: error[HX020]: link 'a': <inertia ixx> is 'inf', expected one finite number; 0 is used, and the text is kept as written",
            "2: error[HX020]: link 'a': <inertia iyy> is '1e999', expected one finite number; 0 is used, and the text is kept as written",
            "2: error[HX020]: link 'a': <inertia izz> is '0x10', expected one finite number; 0 is used, and the text is kept as written",
            "2: error[HX020]: link 'a': <inertia ixz> is '1_0', expected one finite number; 0 is used, and the text is kept as written",
        ],
    ),
    "no limit": (
        robot(TWO_LINKS + joint()),
        [
            "2: warning[HX044]: joint 'j' has no <limit>; read as unlimited, and written with 1e9 (urdfdom refuses the file as it is)",
        ],
    ),
    "a limit without effort and velocity": (
        robot(TWO_LINKS + joint('<limit lower="0" upper="1"/>')),
        [
            "2: warning[HX044]: joint 'j': <limit> has no effort and no velocity; read as unlimited (urdfdom refuses the file as it is)",
        ],
    ),
    "an infinite limit": (
        robot(TWO_LINKS + joint('<limit lower="-inf" upper="1" effort="1" velocity="1"/>')),
        [
            "2: error[HX020]: joint 'j': <limit lower> is '-inf', expected one finite number; unlimited is used, and the text is kept as written",
        ],
    ),
    "limits that contradict": (
        robot(TWO_LINKS + joint('<limit lower="1" upper="-1" effort="-1" velocity="1"/>')),
        [
            "2: warning[HX028]: joint 'j': the lower limit is above the upper one; both are kept",
            "2: warning[HX028]: joint 'j': the limit of effort or velocity is negative; it is kept",
        ],
    ),
    "mimic of an absent joint": (
        robot(TWO_LINKS + joint(LIMIT + '<mimic joint="x"/>')),
        [
            "2: warning[HX040]: joint 'j' mimics 'x', which is not a joint of this robot; the <mimic> is kept as written",
        ],
    ),
    "mimic of itself": (
        robot(TWO_LINKS + joint(LIMIT + '<mimic joint="j"/>')),
        [
            "2: warning[HX040]: joint 'j' mimics itself; the <mimic> is kept as written",
        ],
    ),
    "mimic of a fixed joint": (
        robot(THREE_LINKS + joint(LIMIT + '<mimic joint="k"/>') + joint("", "fixed", "k", child="c")),
        [
            "2: warning[HX040]: joint 'j' mimics 'k', which is fixed; the <mimic> is kept as written",
        ],
    ),
    "an inertial without mass": (
        robot('<link name="a"><inertial><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0"/></inertial></link>'),
        [
            "2: warning[HX045]: link 'a': <inertial> has no <mass>; its mass is unspecified",
            "2: warning[HX021]: link 'a': <inertia> has no izz; 0 is used",
        ],
    ),
    "an inertial without inertia": (
        robot('<link name="a"><inertial><mass value="1"/></inertial></link>'),
        [
            "2: warning[HX045]: link 'a': <inertial> has no <inertia>; its tensor is unspecified (urdfdom then drops the mass as well)",
        ],
    ),
    "two inertials": (
        robot(
            '<link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial><inertial/></link>'
        ),
        [
            "2: warning[HX047]: link 'a': <link> contains <inertial> more than once; the first one counts, the others are kept as written",
        ],
    ),
    "a visual without geometry": (
        robot(visual("")),
        [
            "2: warning[HX045]: visual 'a/visual': <visual> has no <geometry>; the shape has no geometry",
        ],
    ),
    "an unknown geometry": (
        robot(visual("<geometry><cone/></geometry>")),
        [
            "2: warning[HX045]: visual 'a/visual': <geometry> contains <cone>, expected one of <mesh>, <box>, <cylinder>, <sphere>, <capsule>; the shape has no geometry",
        ],
    ),
    "two geometries": (
        robot(visual('<geometry><box size="1 1 1"/><sphere radius="1"/></geometry>')),
        [
            "2: warning[HX047]: visual 'a/visual': <geometry> contains more than one shape; the first one counts, the others are kept as written",
        ],
    ),
    "a box of two numbers": (
        robot(visual('<geometry><box size="1 1"/></geometry>')),
        [
            "2: error[HX020]: visual 'a/visual': <box size> is '1 1', expected 3 finite numbers separated by blanks; the shape has no geometry, and the text is kept as written",
        ],
    ),
    "a cylinder without radius": (
        robot(visual('<geometry><cylinder length="1"/></geometry>')),
        [
            "2: error[HX021]: visual 'a/visual': <cylinder> has no radius; the shape has no geometry, and the text is kept as written",
        ],
    ),
    "a mesh without file": (
        robot(visual("<geometry><mesh/></geometry>")),
        [
            "2: warning[HX021]: visual 'a/visual': <mesh> has no filename; it stays empty",
        ],
    ),
    "a mesh scale of two numbers": (
        robot(visual('<geometry><mesh filename="a.stl" scale="2 2"/></geometry>')),
        [
            "2: error[HX020]: visual 'a/visual': <mesh scale> is '2 2', expected 3 finite numbers separated by blanks; 1 1 1 is used, and the text is kept as written",
        ],
    ),
    "a mesh scale of one number": (
        robot(visual('<geometry><mesh filename="a.stl" scale="2"/></geometry>')),
        [
            "2: warning[HX020]: visual 'a/visual': <mesh scale> is one number; read as the same in all directions (urdfdom drops such a shape)",
        ],
    ),
    "a material that is not defined": (
        robot(visual(f'{SPHERE}<material name="red"/>')),
        [
            "2: warning[HX040]: the material 'red' is not defined anywhere; it has no appearance (urdfdom shows a default grey)",
        ],
    ),
    "a material with two appearances": (
        robot(f"{RED}\n{visual(SPHERE + RED.replace('1 0 0 1', '0 0 1 1'))}"),
        [
            "3: warning[HX046]: the material 'red' is defined again with another appearance (before: robot.urdf:2); both are kept, this one as 'red#2'",
        ],
    ),
    "a material twice": (
        robot(f"{RED}\n{RED}{LINK}"),
        [
            "3: warning[HX023]: the material 'red' is defined twice at robot level, in the same way; the second one is kept as written",
        ],
    ),
    "a material without a name": (
        robot('<material><color rgba="1 0 0 1"/></material>' + LINK),
        [
            "2: warning[HX022]: a <material> of robot level has no name, so that no visual can refer to it; it is kept as written",
        ],
    ),
    "a visual with an unnamed material": (
        robot(visual(f'{SPHERE}<material><color rgba="1 0 0 1"/></material>')),
        [
            "2: warning[HX022]: visual 'a/visual': <material> has no name; the appearance is the shape's own (urdfdom drops such a visual)",
        ],
    ),
    "a colour of three numbers": (
        robot('<material name="m"><color rgba="1 0 0"/></material>' + LINK),
        [
            "2: error[HX020]: material 'm': <color rgba> is '1 0 0', expected 4 finite numbers separated by blanks; no colour is used, and the text is kept as written",
        ],
    ),
    "a transmission to nowhere": (
        robot(LINK + '<transmission name="t"><joint name="x"/><actuator/></transmission>'),
        [
            "2: warning[HX040]: transmission 't' names joint 'x', which is not defined; the reference is kept as written",
            "2: warning[HX022]: transmission 't' has an <actuator> without a name; it is kept as written",
        ],
    ),
    "a safety controller without gain": (
        robot(TWO_LINKS + joint(f"{LIMIT}<safety_controller/>")),
        [
            "2: warning[HX021]: joint 'j': <safety_controller> has no k_velocity; 0 is used",
        ],
    ),
}

REFUSED: dict[str, tuple[str | bytes, str]] = {
    "entities": (
        f'<!DOCTYPE robot [<!ENTITY a "b">]>{robot(LINK)}',
        "1: error[HX008]: the file defines XML entities, which are never expanded",
    ),
    "elements within elements without end": (
        robot("<x>" * 3000 + "</x>" * 3000),
        "2: error[HX007]: the elements are nested more than 2048 deep",
    ),
    "an empty file": ("\n", " error[HX004]: the file is empty"),
    "text": ("hello", "1:1: error[HX004]: not XML: ..."),
    "another format": ("<mujoco/>", "1: error[HX006]: the root element is <mujoco>, not <robot>"),
}


def ours(message: str) -> str:
    """The first line of a message without the file's name, and without libxml2's words, which differ between its versions."""
    line = message.split("\n")[0].removeprefix("robot.urdf:")
    return re.sub(r"(not well-formed|not XML): .*?(;|$)", r"\1: ...\2", line)


@pytest.mark.parametrize("case", REPORTED)
@pytest.mark.unread("HX005", "HX010")
def test_bad_input_is_reported_with_its_place_and_what_is_done(case: str) -> None:
    text, expected = REPORTED[case]
    assert [ours(message) for message in reported(text)] == expected


@pytest.mark.parametrize("case", REPORTED)
@pytest.mark.unread  # generated or damaged input: any
def test_bad_input_is_the_same_robot_after_writing_it(case: str) -> None:
    text, _ = REPORTED[case]
    assert load(again(text)) == load(text)


@pytest.mark.parametrize("case", REPORTED)
@pytest.mark.unread  # generated or damaged input: any
def test_what_is_written_is_well_formed(case: str) -> None:
    text, _ = REPORTED[case]
    assert not [message for message in reported(again(text)) if "HX005" in message]


@pytest.mark.parametrize("case", REFUSED)
@pytest.mark.unread("HX005")
def test_hopeless_input_is_refused(case: str) -> None:
    text, expected = REFUSED[case]
    with pytest.raises(Refusal) as refusal:
        load(text)
    assert ours(str(refusal.value)) == expected


@pytest.mark.parametrize("text", ["\ufeff" + robot(LINK), robot(f"{LINK}\r\n<foo/>"), ("\ufeff" + robot(LINK)).encode("utf-16-le")])
def test_byte_order_marks_and_line_ends_of_other_systems_are_nothing_special(text: str | bytes) -> None:
    assert reported(text) == []
    assert load(again(text)) == load(text)
