"""Hostile and very large texts: bounded time, a diagnostic instead of a crash, nothing that recurses."""

from __future__ import annotations

import warnings
from contextlib import suppress
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hymeko_x.backends.hymeko import write
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends.hymeko import read
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.language import expansion
from hymeko_x.language.expressions import ExpressionError, evaluate
from hymeko_x.language.parser import parse
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source
from tests.pace import assert_at_most, assert_within

if TYPE_CHECKING:
    from collections.abc import Callable


def read_text(text: str) -> Mechanism:
    return read(Source("a.hymeko", text.encode()), Report()).mechanism


def refusal_of(text: str) -> str:
    with pytest.raises(Refusal) as refusal:
        read_text(text)
    return str(refusal.value).split("\n")[0]


# ---- expressions -------------------------------------------------------------------------------------------------------------


VALUES = {
    "1 + 2*3": 7.0,
    "-2**2": -4.0,
    "2**-1": 0.5,
    "7 % 4": 3.0,
    "7 // 2": 3.0,
    "sqrt(2)**2": 2.0000000000000004,
    "pi/2": 1.5707963267948966,
    "max(1, x)": 3.0,
    "atan2(1, 0)": 1.5707963267948966,
    "+x": 3.0,
    "1e-3": 0.001,
    "s": "text",
}


@pytest.mark.parametrize(("text", "value"), VALUES.items())
def test_expressions_are_arithmetic(text: str, value: float | str) -> None:
    assert evaluate(text, {"x": 3.0, "s": "text"}) == value


def test_what_python_only_reads_with_a_warning_is_no_arithmetic_and_nothing_else_is_reported() -> None:
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        with pytest.raises(ExpressionError, match="^it is not arithmetic$"):
            evaluate("1or 2", {})
    assert warned == []


HOSTILE = [
    "__import__('os').system('true')",
    "().__class__.__bases__[0].__subclasses__()",
    "(lambda: 1)()",
    "[1 for _ in (1,)]",
    "x.real",
    "f'{x}'",
    "'a' * 9",
    "open('/etc/passwd')",
    "9**9**9",
    "9**9**9**9**9",
    "10**400",
    "inf",
    "inf - inf",
    "(-8)**(1/3)",
    "1/0",
    "sqrt(-1)",
    "log(0)",
    "True",
    "1j",
    "x if x else 1",
    "x := 2",
    "1; 2",
    "max()",
    "sin(1, 2)",
    "sin(x=1)",
    "s + 1",
    "unknown",
    "",
    "1 +",
    "(" * 400 + "1" + ")" * 400,
    "-" * 990 + "1",
    "1" + "+1" * 600,
    "9" * 900,
    "\0",
    "0x",
    "1if 1else 2",
]


@pytest.mark.parametrize("text", HOSTILE, ids=lambda text: text[:20])
def test_nothing_else_is_an_expression(text: str) -> None:
    def work() -> None:
        try:
            value = evaluate(text, {"x": 3.0, "s": "text"})
        except ExpressionError:
            value = None
        assert value is None or text.startswith(("(((", "---"))

    assert_within(0.5, work)


@settings(max_examples=200, deadline=None)
@given(st.text("0123456789.+-*/%() xepisqrt,'[]{}_abc\"\\", max_size=30))
def test_no_expression_raises_anything_else(text: str) -> None:
    with suppress(ExpressionError):
        evaluate(text, {"x": 3.0})


# ---- templates ----------------------------------------------------------------------------------------------------------------


def _doubling(line: str, levels: int, last: str) -> str:
    return "\n".join([*(line.format(this=number, before=number - 1) for number in range(1, levels + 1)), last])


ASSEMBLIES = "t0() : assembly {{ l : link {{}} }}\n" + _doubling(
    "t{this}() : assembly {{{{ a : t{before} {{{{}}}} b : t{before} {{{{}}}} }}}}", 40, "all : t40 {{}}"
)
TYPES = "t0() : link {{ mass 1 }}\n" + _doubling("t{this}() : t{before}, t{before} {{{{}}}}", 40, "all : t40 {{}}")


@pytest.mark.parametrize("body", [ASSEMBLIES, TYPES], ids=["assemblies", "types"])
def test_templates_that_double_forty_times_are_stopped(body: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(expansion, "MAX_ITEMS", 2000)
    monkeypatch.setattr(expansion, "EACH", 0)
    refusal = refusal_of("arm : robot {\n" + body.replace("{{", "{").replace("}}", "}") + "\n}")
    assert "error[HX007]: the templates make more than 2000 items" in refusal


def test_templates_stop_at_the_bound_and_not_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """The assembly takes one for itself and one for each item, and each item three: itself, and its template with one field."""
    text = "arm : robot {{ part() : link {{ mass 1 }} parts() : assembly {{ {} }} all : parts {{}} }}"
    monkeypatch.setattr(expansion, "MAX_ITEMS", 41)
    monkeypatch.setattr(expansion, "EACH", 0)
    assert len(read_text(text.format(" ".join(f"p{number} : part {{}}" for number in range(10)))).graph.vertices) == 10
    refusal = refusal_of(text.format(" ".join(f"p{number} : part {{}}" for number in range(11))))
    assert "error[HX007]: the templates make more than 41 items" in refusal


def test_elements_that_the_text_has_itself_may_have_types_however_many_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(expansion, "MAX_ITEMS", 5)
    parts = " ".join(f"p{number} : part {{}}" for number in range(1000))
    assert len(read_text(f"arm : robot {{ part() : link {{ mass 1 }} {parts} }}").graph.vertices) == 1000


def test_what_an_assembly_says_itself_is_bounded_by_the_text_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(expansion, "MAX_ITEMS", 5)
    monkeypatch.setattr(expansion, "EACH", 0)
    parts = " ".join(f"p{number} {{}}" for number in range(10))
    assert len(read_text(f"arm : robot {{ all : assembly {{ {parts} }} }}").graph.vertices) == 10


def test_texts_that_double_forty_times_are_stopped() -> None:
    line = 't{this}(x) : t{before}(x="${{x}}${{x}}") {{}}'
    body = 't0(x) : link { visual "${x}" }\n' + _doubling(line, 40, 'all : t40(x="ab") {}')
    assert "error[HX007]: a text grows to more than 100000 characters" in refusal_of("arm : robot {\n" + body + "\n}")


def test_the_bound_of_templates_is_far_above_a_large_robot() -> None:
    body = "segment() : assembly { body : link { mass 1 } @joint : revolute { + base - body limit [-90 90] } }\n"
    robot = read_text("snake : robot { base {}\n" + body + "\n".join(f"s{number} : segment {{}}" for number in range(2000)) + "}")
    assert len(robot.joints) == 2000
    assert expansion.MAX_ITEMS >= 200_000


# ---- depth --------------------------------------------------------------------------------------------------------------------

DEEP = 100_000


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("a {" * DEEP, "1:603"),
        ("a { b " + "[" * DEEP, "1:206"),
        ("a { b " + "[" * DEEP + "]" * DEEP + "}", "1:206"),
        ("a" + "(" * DEEP, "1:3"),
        ("a {" * DEEP + "}" * DEEP, "1:603"),
        ("a { - b {" * DEEP, None),
        ("a(b=" + "[" * DEEP, None),
    ],
    ids=["blocks", "lists", "closed lists", "parentheses", "closed blocks", "arcs", "arguments"],
)
def test_brackets_a_hundred_thousand_deep_are_a_diagnostic(text: str, place: str | None) -> None:
    refusal = refusal_of(text)
    assert "error[HX007]: brackets are nested more than 200 levels deep" in refusal or "error[HX060]" in refusal
    assert place is None or refusal.startswith(f"a.hymeko:{place}: ")


def test_everything_up_to_the_depth_is_handled_without_a_crash() -> None:
    text = "robot {" + "a { b 1 " * 190 + "}" * 190 + "}"
    robot = read_text(text)
    assert read_text(write(robot, Options(), Report()).main.decode()) == robot


@pytest.mark.parametrize("piece", ["a.", "a, ", "1 ", "[1] ", "'", '"', "`", "/*", "${", "((", "@ ", "+ a ", "[[1] ", "[1 [", "\\"])
def test_a_long_run_of_anything_takes_linear_time(piece: str) -> None:
    for text in (piece * 30_000, "a { b " + piece * 30_000 + "}"):

        def work(text: str = text) -> None:
            with suppress(Refusal):
                parse(text)

        assert_within(5.0, work)


# ---- size ---------------------------------------------------------------------------------------------------------------------


def _chain(count: int) -> str:
    links = [f"l{number} {{ mass 1 com [0 0 0.1] inertia [0.1 0.1 0.1] }}" for number in range(count + 1)]
    joints = [f"@j{number} {{ [0 0 0.2] + l{number} - l{number + 1} axis=Y limit [-1 1] }}" for number in range(count)]
    return "chain : robot { units { angle rad }\n" + "\n".join([*links, *joints]) + "\n}"


def _converting(count: int) -> Callable[[], object]:
    text = _chain(count)

    def work() -> None:
        robot = read_text(text)
        written = write(robot, Options(), Report()).main.decode()
        assert len(robot.joints) == count
        assert sum(1 for _ in robot.depth_first()) == count + 1
        assert len(written) < len(text)

    return work


@pytest.mark.full
def test_reading_and_writing_a_chain_is_linear() -> None:
    assert_at_most(1.5, _converting(4000), _converting(500), count=8)
