"""Elements of another format that differ in one name are printed as one, and mean the same."""

from __future__ import annotations

import pytest

import hymeko_x as hx
from hymeko_x.ir.mechanism import ROOT

LINKS = '<link name="a"/><link name="b"/><joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'


def printed(*fragments: str) -> str:
    """The HyMeKo text of a URDF with these fragments, which brings them back to the letter and in their places."""
    robot = hx.loads(f'<robot name="r">{LINKS}{"".join(fragments)}</robot>', "urdf").mechanism
    text = hx.dumps(robot, "hymeko")
    back = hx.loads(text, "hymeko").mechanism
    assert (back, back.extras[ROOT]) == (robot, robot.extras[ROOT])
    assert [extra.index for extra in back.extras[ROOT]] == [extra.index for extra in robot.extras[ROOT]]
    assert hx.dumps(back, "hymeko") == text
    return text


def gazebo(name: str, content: str = "<mu1>0.9</mu1>", attributes: str = 'reference="{}"') -> str:
    return f"<gazebo {attributes.format(name)}>\n    {content}\n  </gazebo>"


def test_neighbours_that_differ_in_one_name_are_one_element_with_a_list() -> None:
    text = printed(gazebo("hip"), gazebo("knee"), gazebo("left foot"), gazebo("toe", "<mu2>1</mu2>"), gazebo("hip"))
    assert "urdf { gazebo(hip, knee, `left foot`) { mu1 0.9 } gazebo(toe) { mu2 1 } gazebo(hip) { mu1 0.9 } }\n" in text


@pytest.mark.parametrize(
    "others",
    [
        (gazebo("1"), gazebo("2")),
        (gazebo("hip", "<kp>1</kp>"), gazebo("knee", "<kp>2</kp>")),
        tuple(gazebo(name, attributes='reference="{0}" version="{0}"') for name in ("hip", "knee")),
        (gazebo("hip"), gazebo("hip")),
        (gazebo("hip"), gazebo("knee", attributes='version="{}"')),
    ],
    ids=["numbers", "another content", "two differences", "twice the same", "another attribute"],
)
def test_others_stay_apart(others: tuple[str, str]) -> None:
    assert printed(*others).count("gazebo(") == 2


def test_a_list_is_not_wider_than_a_line() -> None:
    text = printed(*(gazebo(f"a_long_name_of_a_link_{number}") for number in range(10)))
    assert text.count("gazebo(") == 3
    assert max(map(len, text.splitlines())) <= 120


def test_comments_stand_in_the_element_and_between_elements() -> None:
    text = printed("<!-- feet -->", gazebo("hip", "<!-- rough -->\n    <mu1>0.9</mu1>"), "<!-- and -->", gazebo("knee"))
    assert (
        "  // feet\n  urdf {\n    gazebo(hip) {\n      // rough\n      mu1 0.9\n    }\n    // and\n    gazebo(knee) { mu1 0.9 }\n" in text
    )


def test_white_space_in_and_between_tags_is_not_kept() -> None:
    odd = """<gazebo reference = 'hip' ><!--rough-->
\t<mu1>0.9</mu1>

\t<sensor   name="s" /></gazebo >"""
    assert printed(odd) == printed(gazebo("hip", '<!-- rough -->\n    <mu1>0.9</mu1>\n    <sensor name="s"/>'))


@pytest.mark.parametrize("text", ["<gazebo>\n  two <b>words</b>\n</gazebo>", "<gazebo><mu1>0.9</mu1><mu2>1</mu2></gazebo>"])
def test_text_beside_elements_and_an_element_on_one_line_stay_as_they_are(text: str) -> None:
    assert hx.loads(f'<robot name="r"><link name="a"/>{text}</robot>', "urdf").mechanism.extras[ROOT][0].text == text


def test_namespaces_are_declared_once() -> None:
    spaces = 'xmlns:drake="http://drake.mit.edu" xmlns:gz="http://gazebosim.org/schema" xmlns:other="urn:other"'
    urdf = f'<robot name="r" {spaces}><link name="a"/><gazebo><drake:x/><other:y/></gazebo></robot>'
    robot = hx.loads(urdf, "urdf").mechanism
    text = hx.dumps(robot, "hymeko")
    assert 'urdf { xmlns [drake gz] `xmlns:other` "urn:other" }' in text
    assert 'urdf "<gazebo><drake:x/><other:y/></gazebo>"' in text
    assert hx.loads(text, "hymeko").mechanism.extras == robot.extras


def test_an_unknown_namespace_by_name_is_refused() -> None:
    with pytest.raises(hx.Refusal, match="the namespace of 'mine' is not known"):
        hx.loads("r : robot { a {} urdf { xmlns [drake mine] } }", "hymeko")


@pytest.mark.parametrize("names", ["reference=[a b c]", "a, b, c"])
def test_a_list_in_a_text_of_an_author_is_as_many_elements(names: str) -> None:
    robot = hx.loads(f"r : robot {{ a {{}} urdf {{ gazebo({names} kind=x) {{ mu1 0.9 }} }} }}", "hymeko").mechanism
    assert [extra.text for extra in robot.extras[ROOT]] == [
        f'<gazebo reference="{name}" kind="x">\n    <mu1>0.9</mu1>\n  </gazebo>' for name in "abc"
    ]
