"""Factoring: what repeats is written once, and expanding gives back exactly what was there."""

from __future__ import annotations

from hymeko_x.factor.forms import Call, Dialect, Factored, FormElement, Hole, Macro, MacroParameter, Signed, Value, expand
from hymeko_x.factor.rounds import factor

DIALECT = Dialect(macro=10, call=3, argument=2, least=1)


def leg(prefix: str, side: str) -> list[FormElement]:
    minus = "-" if side == "-1" else ""
    inertia = (("ixx", "0.0125"), ("ixy", f"{minus}0.00125"), ("iyy", "1.25e-05"), ("izz", "0.10"))
    hip = FormElement("link", (("name", f"{prefix}_hip"),), (FormElement("mass", (("value", "1.50"),)), FormElement("inertia", inertia)))
    joint = FormElement(
        "joint",
        (("name", f"{prefix}_knee"),),
        (FormElement("origin", (("xyz", f"0 {minus}0.1 0"),)), FormElement("child", (("link", f"{prefix}_hip"),))),
    )
    return [hip, joint]


def test_left_and_right_legs_become_calls_of_one_macro_with_prefix_and_side() -> None:
    forms = (FormElement("link", (("name", "torso"),)), *leg("left", "1"), *leg("right", "-1"))
    found = factor(forms, DIALECT)
    assert expand(found) == forms
    (macro,) = found.macros
    assert macro.parameters == (MacroParameter("prefix"), MacroParameter("side"))
    assert macro.body[0].children[1].leaves[1] == ("ixy", (Signed(("side",), False, "0.00125"),))
    assert macro.body[0].leaves == (("name", (Hole("prefix"), "_hip")),)
    calls = (Call(macro.name, (("prefix", "left"), ("side", "1"))), Call(macro.name, (("prefix", "right"), ("side", "-1"))))
    assert found.items == (forms[0], *calls)


def test_a_form_without_repetition_stays_as_it_is() -> None:
    forms = (FormElement("link", (("name", "a"),)), FormElement("joint", (("name", "b"),)))
    assert factor(forms, DIALECT) == Factored(forms)


def test_holes_are_filled_in_calls_inside_of_macros() -> None:
    inner = Macro("inner", (MacroParameter("x", "7"),), (FormElement("e", (("v", ("<", Hole("x"), ">")),)),))
    outer = Macro("outer", (MacroParameter("y"),), (Call("inner", (("x", (Hole("y"), "!")),)), Call("inner")))
    factored = Factored((FormElement("root", (), (Call("outer", (("y", "1"),)),)),), (inner, outer))
    assert expand(factored) == (FormElement("root", (), (FormElement("e", (("v", "<1!>"),)), FormElement("e", (("v", "<7>"),)))),)


def test_the_folder_of_many_files_has_a_name() -> None:
    folder = "package://some_robot_description/meshes/visual"
    forms = tuple(FormElement(tag, (("mesh", f"{folder}/{tag}.stl"),)) for tag in ("hip", "thigh", "shank", "foot"))
    found = factor(forms, Dialect(values=True))
    assert found.values == (Value("visual", folder),)
    assert found.items[0] == FormElement("hip", (("mesh", (Hole("visual"), "/hip.stl")),))
    assert expand(found) == forms


def test_a_macro_is_called_what_its_source_called_it() -> None:
    forms = tuple(form._replace(hint="shoulder") for prefix in ("l", "r") for form in leg(prefix, "1"))
    assert [macro.name for macro in factor(forms, DIALECT).macros] == ["shoulder"]


def test_the_result_does_not_depend_on_how_deep_forms_are_nested() -> None:
    form = FormElement("body", (("name", "b0"),))
    for number in range(1, 5000):
        form = FormElement("body", (("name", f"b{number}"),), (FormElement("geom", (("size", "0.1 0.2"), ("rgba", "0.5 0.5 0.5 1"))), form))
    found = factor((form,), DIALECT)
    (macro,) = found.macros
    assert [macro.parameters, len(found.items)] == [(), 1]


def test_a_macro_has_a_short_name_where_a_long_one_costs_more_than_it_saves() -> None:
    leaves = (("name", "package://robot/meshes/hip.stl"), ("xyz", "0"), ("value", "0"))
    (macro,) = factor((FormElement("link", leaves, (FormElement("link"),)),) * 3, Dialect()).macros
    assert macro.name == "link"
