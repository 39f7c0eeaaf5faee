"""Assemblies that are the same up to numbers, signs and words are printed as instances of a template, and mean the same."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, RobotArc, RobotEdge
from hymeko_x.ir.names import rename
from hymeko_x.ir.parts import VertexPart
from hymeko_x.ir.values import Pose
from hymeko_x.language.printer import print_text
from hymeko_x.testing import mechanisms
from tests.language.printed import canonical, read_text, text_of


def leg(side: str, sign: str, file: str = "shin", lower: str = "-10") -> str:
    return f"""
  {side}_thigh {{ mass 5 com [0.25 {sign}0.125 -0.2] inertia [0.07 0.07 0.01] }}
  {side}_shin {{ mass 3 com [0.5 {sign}0.0625 -0.3] inertia [0.04 0.04 0.005] visual "meshes/{file}_{side}.stl" }}
  @{side}_hip {{ [0 {sign}0.1 0] + pelvis - {side}_thigh axis=Y limit [{lower} 40] effort 90 velocity 500 }}
  @{side}_knee {{ [0 0 -0.4] + {side}_thigh - {side}_shin axis=Y limit [0 140] effort 90 velocity 500 }}
"""


def test_left_and_right_are_instances_of_one_template() -> None:
    text = canonical(f"biped : robot {{ pelvis {{}} {leg('left', '')} {leg('right', '-')} @off : exclude {{ ~ left_shin ~ right_shin }} }}")
    assert text == (
        "biped : robot {\n"
        "  leg(name, side=1) : assembly {\n"
        "    thigh { mass 5 com [0.25 ${side*0.125} -0.2] inertia [0.07 0.07 0.01] }\n"
        '    shin { mass 3 com [0.5 ${side*0.0625} -0.3] inertia [0.04 0.04 0.005] visual "meshes/shin_${name}.stl" }\n'
        "    @hip { [0 ${side*0.1} 0] + pelvis - thigh axis=Y limit [-10 40] velocity 500 effort 90 }\n"
        "    @knee { [0 0 -0.4] + thigh - shin axis=Y limit [0 140] velocity 500 effort 90 }\n"
        "  }\n"
        "  pelvis {}\n"
        "  left : leg(name=left) {}\n"
        "  right : leg(name=right side=-1) {}\n"
        "  @off : exclude { ~ left.shin ~ right.shin }\n"
        "}\n"
    )


HALVES = """
twins : robot {
  pelvis {}
  leftpaint : material { rgba [1 0 0] }
  rightpaint : material { rgba [0 0 1] }
  ball1 { [0 0 1] + world }
  ball2 { [0 0 2] + world }
"""
HALF = """
  {0}_torso {{ mass 5 com [0.25 0.125 -0.2] inertia [0.07 0.07 0.01] collision {{ sphere 0.1 material={0}paint }} childclass=body{1} }}
  @{0}_waist : compound {{ [0 0 0.25] + pelvis - {0}_torso bend{1} : hinge {{ axis=X limit [-10 40] }} turn{1} : hinge {{}} }}
  {0}_drive : motor {{ [40] turn{1} - {0}_waist ctrlrange [-1 1] ctrllimited=true }}
  {0}_ball : frame {{ [0.1 0 0] + ball{1} }}
"""


def test_names_in_elements_and_of_others_may_have_a_parameter() -> None:
    """Those of dofs, shapes, materials, default classes, parents, and of the dof that a motor drives."""
    text = canonical(f"{HALVES}{HALF.format('left', 1)}{HALF.format('right', 2)}}}")
    assert text.endswith(
        'left : torso_to_ball(material=leftpaint name="1") {}\n  right : torso_to_ball(material=rightpaint name="2") {}\n}\n'
    )
    assert "childclass=`body${name}`" in text
    assert "drive : motor { [40] `turn${name}` - waist " in text
    assert "collision { sphere 0.1 material=`${material}` }" in text


def test_a_word_of_the_language_is_no_parameter() -> None:
    """An axis that differs is no name that differs: no `axis=${name}`."""
    text = canonical(f"{HALVES}{HALF.format('left', 1)}{HALF.format('right', 2).replace('axis=X', 'axis=Y')}}}")
    assert "torso_to_ball" not in text


def test_a_template_is_not_named_like_a_default_class() -> None:
    halves = HALF.format("left", 1) + HALF.format("right", 2)
    section = 'written { mjcf "4.0" } main() : class { torso_to_ball() { motor { ctrlrange [-1 1] } } }'
    text = canonical(f"{HALVES} {section} {halves}}}")
    assert "torso_to_ball2(material, name) : assembly {" in text


def test_a_template_is_named_by_what_its_instances_are() -> None:
    part = (
        "{0}_base {{ mass 1 com [0.25 0.125 -0.2] }} {0}_tube {{ mass 2 com [0.25 0.125 -0.2] }} {0}_tip {{ mass 3 com [0.5 0.125 -0.2] }} "
    )
    text = canonical(f"hand : robot {{ {''.join(map(part.format, ('finger1', 'finger2', 'finger3')))} }}")
    assert "  finger() : assembly {" in text
    assert "finger2 : finger {}" in text


def test_a_template_is_not_named_like_an_element() -> None:
    text = canonical(f"biped : robot {{ leg {{}} pelvis {{}} {leg('left', '')} {leg('right', '-')} }}")
    assert "leg2(name, side=1) : assembly {" in text


def test_what_most_instances_give_is_the_default() -> None:
    legs = "".join(leg(side, "", lower=lower) for side, lower in (("a", "-20"), ("b", "-10"), ("c", "-10")))
    text = canonical(f"tripod : robot {{ pelvis {{}} {legs} }}")
    assert "leg(name, limit=-10) : assembly {" in text
    assert "a : leg(name=a limit=-20) {}\n  b : leg(name=b) {}" in text


@pytest.mark.parametrize(
    "other",
    [
        leg("right", "-").replace("right_thigh {", "right_thigh { // weighed\n"),
        leg("right", "-").replace("  @right_knee", "  // the knee\n  @right_knee"),
        leg("right", "-").replace("inertia [0.04 0.04 0.005]", ""),
        leg("right", "-", file="${shin}"),
    ],
    ids=["a comment in an element", "a comment between elements", "another structure", "a text like an expression"],
)
def test_what_a_template_could_not_say_is_written_out(other: str) -> None:
    assert "leg(name" not in canonical(f"biped : robot {{ pelvis {{}} {leg('left', '')} {other} }}")


@pytest.mark.parametrize("word", ["0.10", "1e-05", "007", "true", "in f", 'a"b', "-", "", "a\nb", "inf"])
def test_words_stay_words(word: str) -> None:
    first, second = (
        leg(side, "").replace("mass 3", f"mass 3 urdf {{ note {print_text(text)} }}") for side, text in (("left", "1"), ("right", word))
    )
    canonical(f"biped : robot {{ pelvis {{}} {first} {second} }}")


@pytest.mark.parametrize("numbers", [("0", "-0"), ("inf", "-inf"), ("1e-300", "-1e-300"), ("0.1", "0.30000000000000004"), ("7", "-7")])
def test_numbers_stay_the_same_to_the_last_bit(numbers: tuple[str, str]) -> None:
    first, second = (
        leg(side, "").replace("effort 90", f"effort {number}") for side, number in zip(("left", "right"), numbers, strict=True)
    )
    canonical(f"biped : robot {{ pelvis {{}} {first} {second} }}")


def _mirrored(pose: Pose) -> Pose:
    x, y, z = pose.xyz
    return pose if pose.written is not None else replace(pose, xyz=(x, -y, z))


def _under(mechanism: Mechanism, side: str) -> Mechanism:
    every = (*mechanism.graph.vertices, *mechanism.graph.edges)
    return rename(mechanism, {key: Id(key.kind, f"{side}_{key.name}") for key in every if key != WORLD and key.kind != "shape"})


def _other_side(key: Id, edge: RobotEdge) -> RobotEdge:
    def mirror(arc: RobotArc) -> RobotArc:
        return replace(arc, weight=_mirrored(arc.weight)) if isinstance(arc.weight, Pose) else arc

    return Edge(edge.data, tuple(map(mirror, edge.arcs))) if key.kind == "joint" else edge


@st.composite
def _twins(draw: st.DrawFn) -> Mechanism:
    """A mechanism and its other side: other masses, places mirrored."""
    one = draw(mechanisms())
    mass = draw(st.floats(0, 10))
    left, right = _under(one, "left"), _under(one, "right")
    vertices: dict[Id, VertexPart] = dict(left.graph.vertices)
    for key, part in right.graph.vertices.items():
        if isinstance(part, parts.Body) and part.inertial is not None and part.inertial.mass is not None:
            part = replace(part, inertial=replace(part.inertial, mass=mass))
        vertices[key] = part
    twin = rename(right, {key: Id("shape", f"{key.name}'") for key in right.graph.edges if key.kind == "shape"})
    edges = {**left.graph.edges, **{key: _other_side(key, edge) for key, edge in twin.graph.edges.items()}}
    layout = tuple(key for key in (*left.layout, *twin.layout) if key != WORLD)
    return Mechanism(
        one.name,
        Hypergraph(vertices, edges),
        {**left.extras, **twin.extras},
        notations={**left.notations, **twin.notations},
        layout=layout,
    )


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(_twins())
def test_whatever_repeats_reads_back_equal(mechanism: Mechanism) -> None:
    printed = text_of(mechanism)
    back = read_text(printed)
    assert back == mechanism
    assert text_of(back) == printed


def test_parameters_called_like_formats_keep_their_place() -> None:
    literals = (("urdf", 0.0), ("base", 0.0), ("limit", -1.7976931348623157e308))
    edges: dict[Id, RobotEdge] = {Id("relation", name): Edge(parts.Relation(literals), (Arc(Id("body", "a")),)) for name in "wxyz"}
    mechanism = Mechanism("r", Hypergraph({Id("body", "a"): parts.Body()}, edges))
    assert read_text(text_of(mechanism)) == mechanism
