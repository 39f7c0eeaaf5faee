"""Factoring is exact on whatever it is given, and finds what was planted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from hymeko_x.factor.forms import Call, Dialect, Factored, FormElement, Hole, Item, Macro, MacroParameter, Piece, Signed, Text, expand
from hymeko_x.factor.rounds import factor
from tests.pace import assert_at_most

if TYPE_CHECKING:
    from collections.abc import Callable

CHEAP = Dialect(macro=4, call=1, argument=1, hole=1, default=1, least=1)
"""Under which nearly everything that repeats becomes a macro."""

WORDS = st.sampled_from(["left", "right", "hip", "knee", "L", "R", "1", "2", "_", "-", " ", "Foot"])
NUMBERS = st.sampled_from(
    ["0", "-0", "1", "-1", "0.5", "-0.5", "1e-05", "-1e-05", "0.10", "1.5707963267948966", "-1.5707963267948966", "007"]
)
TEXTS = (
    NUMBERS
    | st.lists(WORDS, max_size=4).map("".join)
    | st.lists(NUMBERS, min_size=2, max_size=3).map(" ".join)
    | st.sampled_from(["", " ", "package://robot/meshes/hip.stl", "package://robot/meshes/knee.stl", "${x}", "x${", "$", "ü", "\n", "<a>"])
)
LEAVES = st.lists(st.tuples(st.sampled_from(["name", "xyz", "value"]), TEXTS), max_size=3, unique_by=lambda leaf: leaf[0]).map(tuple)


def element(tag: str, leaves: tuple[tuple[str, str], ...], children: list[FormElement] | None = None) -> FormElement:
    return FormElement(tag, leaves, tuple(children or ()))


FORMS = st.recursive(
    st.builds(element, st.sampled_from(["link", "joint", "origin"]), LEAVES, st.none()),
    lambda inner: st.builds(element, st.sampled_from(["link", "visual"]), LEAVES, st.lists(inner, max_size=3)),
    max_leaves=6,
)


@st.composite
def repetitive(draw: st.DrawFn) -> tuple[FormElement, ...]:
    """Forms of which many are equal or nearly equal."""
    stock = draw(st.lists(FORMS, min_size=1, max_size=4))
    picked = draw(st.lists(st.sampled_from(stock), max_size=14))
    return tuple(_changed(form, draw(st.sampled_from(["", "", "left", "right"])), draw(st.booleans())) for form in picked)


def _changed(form: FormElement, word: str, flip: bool) -> FormElement:
    leaves = tuple(
        (name, _flipped(text) if flip and name == "xyz" else f"{word}{text}" if name == "name" else text) for name, text in form.leaves
    )
    return form._replace(leaves=leaves, children=tuple(_changed(kid, word, flip) for kid in form.children if isinstance(kid, FormElement)))


def _flipped(text: object) -> str:
    return " ".join(word.removeprefix("-") if word.startswith("-") else f"-{word}" for word in str(text).split(" "))


@pytest.mark.parametrize(
    "dialect",
    [Dialect(), CHEAP, replace(CHEAP, signs=False), replace(CHEAP, cut=lambda text: (text,)), replace(CHEAP, values=True, value=1, hole=0)],
    ids=["xml", "cheap", "unsigned", "whole", "values"],
)
@given(repetitive())
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_expanding_gives_back_exactly_what_was_factored(dialect: Dialect, forms: tuple[FormElement, ...]) -> None:
    found = factor(forms, dialect)
    assert expand(found) == forms
    assert factor(forms, dialect) == found


@given(repetitive())
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_what_is_factored_is_never_longer(forms: tuple[FormElement, ...]) -> None:
    assert size(factor(forms, Dialect())) <= size(Factored(forms))


def size(factored: Factored) -> int:
    """Characters of the whole as XML."""
    total = sum(45 + len(macro.name) for macro in factored.macros)
    total += sum(len(parameter.name) + len(parameter.default or "") + 2 for macro in factored.macros for parameter in macro.parameters)
    stack: list[Item] = [*factored.items, *(item for macro in factored.macros for item in macro.body)]
    while stack:
        item = stack.pop()
        parts = item.arguments if isinstance(item, Call) else item.leaves
        total += 9 + len(item.macro) if isinstance(item, Call) else 3 + len(item.tag)
        total += sum(len(name) + 3 + sum(map(letters, (text,) if isinstance(text, str) else text)) for name, text in parts)
        if isinstance(item, FormElement) and item.children:
            total += 2 + len(item.tag)
            stack += item.children
    return total


def letters(piece: Piece) -> int:
    """Characters of a piece of a text."""
    match piece:
        case Hole(name):
            return 3 + len(name)
        case Signed(factors, negative, magnitude):
            return 3 + sum(len(name) + 1 for name in factors) + negative + len(magnitude)
        case _:
            return len(piece.replace(" ", ""))


@st.composite
def limb(draw: st.DrawFn) -> list[tuple[str, float, float]]:
    """The segments of a limb: a name, a mass and an offset to the side."""
    names = draw(st.lists(st.sampled_from(["hip", "thigh", "knee", "shank", "ankle", "foot", "toe"]), min_size=3, max_size=7, unique=True))
    masses, offsets = (draw(st.permutations(range(1, 9))) for _ in range(2))
    return [(name, mass / 7, offset / 9) for name, mass, offset in zip(names, masses, offsets, strict=False)]


def instance(segments: list[tuple[str, float, float]], prefix: str, side: int) -> list[FormElement]:
    """A limb, its names with a prefix and its offsets mirrored."""
    forms = []
    for name, mass, offset in segments:
        inertial = FormElement(
            "inertial", (), (FormElement("mass", (("value", repr(mass)),)), FormElement("com", (("xyz", f"0 {side * offset!r} 0.25"),)))
        )
        forms.append(FormElement("link", (("name", f"{prefix}_{name}"),), (inertial,)))
        forms.append(
            FormElement(
                "joint",
                (("name", f"{prefix}_{name}_joint"), ("type", "revolute")),
                (FormElement("child", (("link", f"{prefix}_{name}"),)),),
            )
        )
    return forms


def macro(segments: list[tuple[str, float, float]]) -> Macro:
    """The macro that a person would have written for a limb."""
    marked = instance(segments, "PREFIX", -1)

    def open_up(form: FormElement) -> FormElement:
        leaves = tuple((name, opened(str(text))) for name, text in form.leaves)
        return FormElement(form.tag, leaves, tuple(open_up(kid) for kid in form.children if isinstance(kid, FormElement)))

    def opened(text: str) -> Text:
        if text.startswith("PREFIX"):
            return (Hole("prefix"), text.removeprefix("PREFIX"))
        words = text.split(" ")
        return ("0 ", Signed(("side",), False, words[1].removeprefix("-")), " 0.25") if len(words) == 3 else text

    return Macro("limb", (MacroParameter("prefix"), MacroParameter("side")), tuple(map(open_up, marked)))


@given(
    limb(),
    st.lists(
        st.tuples(st.sampled_from(["fl", "fr", "hl", "hr", "ml", "mr"]), st.sampled_from([1, -1])),
        min_size=2,
        max_size=6,
        unique_by=lambda leg: leg[0],
    ),
    st.data(),
)
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_planted_limbs_are_found(segments: list[tuple[str, float, float]], legs: list[tuple[str, int]], data: st.DataObject) -> None:
    """The result is about as short as with the macro that was planted, wherever other forms stand between the limbs."""
    forms: list[FormElement] = []
    planted: list[Item] = []
    for number, (prefix, side) in enumerate(legs):
        if data.draw(st.booleans()):
            forms.append(FormElement(f"other{number}", (("text", "between"),)))
            planted.append(forms[-1])
        planted.append(Call("limb", (("prefix", prefix), ("side", str(side)))))
        forms += instance(segments, prefix, side)
    found = factor(tuple(forms), Dialect())
    assert expand(found) == tuple(forms)
    assert size(found) <= 1.1 * size(Factored(tuple(planted), (macro(segments),)))
    assert size(found) < size(Factored(tuple(forms)))


@pytest.mark.full
@pytest.mark.slow
def test_the_time_is_near_linear_in_the_number_of_links() -> None:
    def factoring(links: int) -> Callable[[], object]:
        limbs = [(f"s{number}", 0.1 + number / 7, 0.3) for number in range(10)]
        forms = tuple(form for number in range(links // 10) for form in instance(limbs, f"leg{number}", 1 - number % 2 * 2))
        assert len(factor(forms, Dialect()).items) <= links // 10
        return lambda: factor(forms, Dialect())

    assert_at_most(1.5, factoring(5000), factoring(1000), count=5)
