"""What a file carries may be damaged or made up: then the file is read without it, and that is reported once."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.ir.parts import Body

ROBOT = (
    '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    '<hymeko:residue xmlns:hymeko="urn:hymeko-x"><![CDATA[kept : residue {{ version 2 {} }}]]></hymeko:residue></robot>'
)


@pytest.mark.parametrize(
    "content",
    [
        "notations { body { of [a] x 3 } }",
        "notations { body { of [a] x [1 2] } }",
        "stereotypes { body { of [a] classes 3 } }",
        "stereotypes { body { of [a] classes [1 2] } }",
        "extras { body { of [a] urdf [1 2] } }",
        'extras { body { of [a] urdf ["" "<t/>" -inf] } }',
        "layout [1 2]",
        'layout [[a] "b"]',
        "unplaced [1]",
        "order { body { a [] } }",
        "source_only { a : link {} }",
        "source_only { x : body { inertial [1 2] } }",
        'source_only { x : contact { ["a"] + body.a } }',
        "frames { a [1 2 3 4 5 6 7] }",
        'frames { a ["x" 2 3 1 0 0 0] }',
        "frames { a [0 0 0 0 0 0 0] }",
        "frames { a [nan 0 0 1 0 0 0] }",
        "names { world { a=b } }",
        "version 3",
        "landmarks { body { a [b] } }",
        "values { body { of [a] inertial [source none file] } }",
    ],
)
@pytest.mark.unread("HX107")
def test_a_residue_that_holds_something_else_is_left_out(content: str) -> None:
    report = Report()
    robot = hx.loads(ROBOT.format(content), "urdf", report=report).mechanism
    assert [diagnostic.code.id for diagnostic in report] == ["HX107"]
    assert robot == hx.loads(ROBOT.replace("{{ version 2 {} }}", ""), "urdf").mechanism


@pytest.mark.parametrize("names", ["body { a=b }", "body { a=c b=c }"])
def test_a_name_that_another_element_has_by_now_is_not_given_again(names: str) -> None:
    """Two elements under one name would be one."""
    robot = hx.loads(ROBOT.format(f"names {{ {names} }}"), "urdf").mechanism
    assert len(list(robot.vertices(Body))) == 2


def test_a_residue_in_cdata_is_found_in_a_file_without_any_other_words() -> None:
    assert hx.loads(ROBOT.format('extras { body { of [a] mjcf ["x" "y"] } }'), "urdf").mechanism.extras
