"""Macros are those that a person would write: no wrappers, and names that tell what they are."""

from __future__ import annotations

from hymeko_x.factor.flat import FactoringState, Form, OpenMacro
from hymeko_x.factor.forms import Dialect, FormElement, Hole, expand
from hymeko_x.factor.rounds import factor
from hymeko_x.factor.words import limb_of_most
from hymeko_x.factor.wrappers import tidy

DIALECT = Dialect(macro=10, call=3, argument=2, least=1)


def call(tag: str, *texts: object) -> Form:
    return Form(tag, ("at", "mass")[: len(texts)], texts, is_call=True)  # type: ignore[arg-type]


def test_a_macro_that_only_calls_another_one_is_inlined_and_the_number_of_that_one_goes() -> None:
    """Its calls, also those in other macros, are calls of the other macro with the same texts."""
    workspace = FactoringState([call("part", "0.1"), call("part2", "0 0.2", "3")])
    workspace.macros = {
        "part2": OpenMacro("part2", ("at", "mass"), (None, None), [Form("part", ("at",), ((Hole("at"),),))]),
        "part": OpenMacro("part", ("at",), (None,), [call("part2", ("0 ", Hole("at")), "1")]),
        "leg": OpenMacro("leg", ("y",), (None,), [call("part", (Hole("y"), "5")), Form("end", (), ())]),
    }
    tidy(workspace, DIALECT)
    assert [*workspace.macros] == ["part", "leg"]
    assert [(form.tag, form.texts) for form in workspace.items] == [("part", ("0 0.1", "1")), ("part", ("0 0.2", "3"))]
    inside, _ = workspace.macros["leg"].body
    assert (inside.tag, inside.texts) == ("part", (("0 ", Hole("y"), "5"), "1"))


def test_macros_of_one_tag_are_told_apart_by_what_is_in_them() -> None:
    def visual(kind: str, name: str, text: str) -> FormElement:
        shape = FormElement("geometry", (), (FormElement(kind, ((name, text),)),))
        return FormElement(
            "visual", (), (shape, FormElement("material", (("name", "black"),)), FormElement("layer", (("number", "12345"),)))
        )

    meshes = [visual("mesh", "file", f"{place}.stl") for place in "abcdef"]
    boxes = [visual("box", "size", f"0 0 {place}") for place in range(6)]
    forms = (FormElement("robot", (), (*meshes, *boxes)),)
    found = factor(forms, DIALECT)
    assert expand(found) == forms
    assert sorted(macro.name for macro in found.macros if "visual" in macro.name) == ["box_visual", "visual"]


def test_parts_of_a_limb_are_a_limb() -> None:
    assert limb_of_most(["hip_stator", "hip_rotor", "knee", "wheel", "ankle"]) == "leg"
    assert limb_of_most(["hip", "wheel", "anchor", "contact"]) == ""
    assert limb_of_most(["hip", "knee", "elbow"]) == ""
