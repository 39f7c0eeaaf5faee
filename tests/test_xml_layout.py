"""The layout of kept XML: the same content, whatever its white space was, and nothing left to do a second time; and of comments."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from hymeko_x.xml.layout import laid_out
from hymeko_x.xml.text import comment_markup

BLANK = st.sampled_from([" ", "  ", "\n", "\n  ", "\n\t", " \n    "])
NAMES = st.sampled_from(["a", "b", "gz:c", "d-e"])
TEXTS = st.sampled_from(["1 2 3", "x > y", "a\nb", "$(arg x)", "<![CDATA[<raw>]]>"])
VALUES = st.sampled_from(["1", "", "a  b", "&lt;", "it's", "x > y"])


@st.composite
def starts(draw: st.DrawFn) -> tuple[str, str]:
    """A start tag without its end, and its name."""
    name, keys = draw(NAMES), draw(st.lists(st.sampled_from("xyz"), unique=True, max_size=3))
    return f"<{name}" + "".join(f'{draw(BLANK)}{key}="{draw(VALUES)}"' for key in keys) + draw(st.just("") | BLANK), name


@st.composite
def elements(draw: st.DrawFn, depth: int = 3) -> str:
    start, name = draw(starts())
    kind = draw(st.integers(0, 3 if depth else 1))
    if kind == 0:
        return f"{start}/>"
    if kind == 1:
        return f"{start}>{draw(TEXTS)}</{name}>"
    inside = draw(st.lists(elements(depth - 1) | st.just("<!--note-->"), max_size=3))
    return f"{start}>{''.join(draw(BLANK) + child for child in inside)}{draw(BLANK)}</{name}>"


def content(text: str) -> list[tuple[str, object, str]]:
    """Tags, attributes and texts in order; white space between tags is left out."""
    root = etree.fromstring(f'<root xmlns:gz="urn:gz">{text}</root>')
    return [(str(node.tag), dict(node.attrib), (node.text or "").strip()) for node in root.iter()]


@given(elements(), st.integers(0, 3))
def test_the_content_stays_and_a_second_time_changes_nothing(text: str, depth: int) -> None:
    for spread in (False, True):
        found = laid_out(text, depth, spread=spread)
        assert content(found) == content(text)
        assert laid_out(found, depth) == found


@given(elements(), st.integers(0, 3), st.integers(0, 3))
def test_the_depth_at_which_a_text_stood_does_not_matter(text: str, before: int, depth: int) -> None:
    assert laid_out(laid_out(text, before), depth) == laid_out(text, depth)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ('<a  x = "1"\n y="2" />', '<a x="1" y="2"/>'),
        ('<a>\n<b x="1"/>\n      <c>1 2</c>\n</a >', '<a>\n    <b x="1"/>\n    <c>1 2</c>\n  </a>'),
        ("<a>\n    <b>\n      <c/>\n    </b>\n  </a>", "<a>\n    <b>\n      <c/>\n    </b>\n  </a>"),
        ("<a>\n    <b>\n    <c/>\n    </b>\n  </a>", "<a>\n    <b>\n      <c/>\n    </b>\n  </a>"),
        ("<a>\n      <b>\n        <c/>\n      </b>\n    </a>", "<a>\n    <b>\n      <c/>\n    </b>\n  </a>"),
        ("<a>word\n<b/></a>", "<a>word\n<b/></a>"),
        ("<a>\n<!--note--></a>", "<a>\n    <!-- note -->\n  </a>"),
    ],
)
def test_each_node_has_a_line_of_its_own_where_there_are_lines(text: str, wanted: str) -> None:
    assert laid_out(text, 1) == wanted


def test_a_text_on_one_line_is_spread_where_that_is_asked_for() -> None:
    assert laid_out("<a><b/><c>1 2</c></a>", 1) == "<a><b/><c>1 2</c></a>"
    assert laid_out("<a><b/><c>1 2</c></a>", 1, spread=True) == "<a>\n    <b/>\n    <c>1 2</c>\n  </a>"


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("---- links ----", "==== links ===="),
        ("|---|-----|", "|===|=====|"),
        ("--verbose", "- -verbose"),
        ("a --> b", "a - -> b"),
        ("a - b-", "a - b-"),
    ],
)
def test_a_line_of_hyphens_in_a_comment_keeps_its_length(text: str, wanted: str) -> None:
    assert comment_markup(text) == f"<!-- {wanted} -->"


@given(st.text("->!< a"))
def test_every_comment_is_well_formed_xml_and_reads_back_as_it_was_written(text: str) -> None:
    written = comment_markup(text)
    (comment,) = etree.fromstring(f"<root>{written}</root>")
    assert comment_markup(comment.text[1:-1]) == written
