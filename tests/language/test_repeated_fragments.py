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
    assert 'gazebo(reference=[hip knee "left foot"]) { mu1 0.9 }\n' in text
    assert "gazebo(reference=toe) { mu2 1 }\n    gazebo(reference=hip) { mu1 0.9 }\n" in text


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
    assert text.count("gazebo(") == 4
    assert max(map(len, text.splitlines())) <= 120


def test_a_list_in_a_text_of_an_author_is_as_many_elements() -> None:
    robot = hx.loads("r : robot { a {} urdf { gazebo(reference=[a b c] kind=x) { mu1 0.9 } } }", "hymeko").mechanism
    assert [extra.text for extra in robot.extras[ROOT]] == [
        f'<gazebo reference="{name}" kind="x">\n    <mu1>0.9</mu1>\n  </gazebo>' for name in "abc"
    ]
