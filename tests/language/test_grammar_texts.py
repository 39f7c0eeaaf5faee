"""Texts that the grammar itself makes, most of which mean nothing: mechanisms or diagnostics, and what parses is printed alike."""

from __future__ import annotations

import re
from functools import cache

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.lark import from_lark
from lark import Lark

from hymeko_x.diagnostics import Refusal
from hymeko_x.language.grammar import grammar_text
from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_document
from tests.fuzz.cases import run

FEW = settings(max_examples=settings.default.max_examples // 2, deadline=None, suppress_health_check=list(HealthCheck))
_WORDS = re.compile(r"\S+").findall(
    "a b j base arm tool world robot link body joint revolute prismatic fixed floating ball screw coupling loop weld "
    "connect tendon actuator motor servo sensor frame camera light material mesh texture shape visual collision box sphere "
    "cylinder capsule mass inertia com axis limit effort velocity damping at units length angle mm deg std assembly spring "
    "written mjcf urdf unnamed version residue carried names of x y len AXIS_Z `é/1` import as rel "
)


@cache
def _texts() -> st.SearchStrategy[str]:
    """Texts of the grammar, with the words that readers know, and a blank behind each of them: else two words would be one."""
    words = {
        "NAME": st.sampled_from([f"{word} " for word in (*_WORDS, "`a b`")])
        | st.from_regex(r"(?!(?:inf|nan)\b)[^\W\d]\w*", fullmatch=True).map("{} ".format),
        "NUMBER": st.sampled_from(["0 ", "1 ", "-2.5e-3 ", "1e400 ", "inf ", "nan ", "0.1 "]),
        "QUANTITY": st.sampled_from(["1mm ", "90deg ", "2kg*m^2 ", "1furlong ", "5% ", "1e308km "]),
        "EXPRESSION": st.sampled_from(["${x} ", "${1/0} ", "${2*pi} ", "${len+1} ", "${(} ", "${9**9**9} "]),
        "NUMBERS": st.sampled_from(["[1 2 3] ", "[] ", "[0 0 0] ", "[1e999] ", "[1 1 1 0 0 0] ", "[1,2] "]),
        "MATRIX": st.sampled_from(["[[1 2 3] [0 0 90]] ", "[[1]] ", "[[] []] "]),
        "STRING": st.sampled_from(['"a" ', "'b c' ", '"""x"y""" ', '"std/kinematics.himeko" ', '"" ', '"\\q" ']),
        "QUOTED_REF": st.sampled_from(['@>"a" ', '@>"" ']),
        "EDGE_WORD": st.sampled_from(["@", "rel ", "seq ", "concurrent "]),
        "LEGACY_HEADER": st.sampled_from(["[a] ", "[ robot ] "]),
    }
    return from_lark(Lark(grammar_text(), parser="lalr", maybe_placeholders=False), start="start", explicit=words)


@pytest.mark.unread
@FEW
@given(st.deferred(lambda: _texts()))
def test_a_text_of_the_grammar_is_a_mechanism_or_a_diagnostic(text: str) -> None:
    assert run("hymeko", text.encode("utf-8", "replace")) is None


@FEW
@given(st.deferred(lambda: _texts()))
def test_what_parses_is_printed_so_that_it_parses_alike(text: str) -> None:
    try:
        document = parse(text)
    except Refusal:
        return
    printed = print_document(document)
    assert print_document(parse(printed)) == printed


def test_an_infinite_weight_at_the_beginning_is_no_header() -> None:
    document = parse("[1e999] -> a")
    assert document.header == ""
    assert parse(print_document(document)) == document


@pytest.mark.parametrize("text", ["[a] // note\n -> b", "r { a, /* note */ + b }", "r { c { x 1 } a, // one\n// two\n + b }"])
def test_a_name_alone_stays_alone_where_a_comment_follows(text: str) -> None:
    printed = print_document(parse(text))
    assert "a," in printed
    assert print_document(parse(printed)) == printed
