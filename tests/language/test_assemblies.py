"""Elements side by side whose names begin alike are printed in an assembly, and mean the same there."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hymeko_x as hx
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism
from hymeko_x.ir.names import Names, rename
from hymeko_x.testing import mechanisms
from tests.language.printed import canonical, read_text, text_of

LEG = """
robot : robot {
  pelvis {}
  %s {}
  @left_hip { + pelvis - left_thigh axis=Y }
  left_thigh { mass 2 collision { sphere 0.1 material=left_skin } }
  // the lower leg
  left_shin { mass 1 collision "meshes/shin.stl" }
  @left_knee { [0 0 -0.4] + left_thigh - left_shin axis=Y }
  @left_ankle : fixed { [0 0 -0.4] + left_shin - %s }
  left_skin : material { rgba [1 0 0] }
  @off : exclude { ~ pelvis ~ left_shin }
}
"""


def test_what_begins_alike_stands_in_an_assembly() -> None:
    assert canonical(LEG % ("foot", "foot")) == (
        "robot : robot {\n"
        "  pelvis {}\n"
        "  foot {}\n"
        "  left : assembly {\n"
        "    @hip { + pelvis - thigh axis=Y }\n"
        "    thigh { mass 2 collision { sphere 0.1 material=skin } }\n"
        "    // the lower leg\n"
        '    shin { mass 1 collision "meshes/shin.stl" }\n'
        "    @knee { [0 0 -0.4] + thigh - shin axis=Y }\n"
        "    @ankle : fixed { [0 0 -0.4] + shin - foot }\n"
        "    skin : material { rgba [1 0 0] }\n"
        "  }\n"
        "  @off : exclude { ~ pelvis ~ left.shin }\n"
        "}\n"
    )


def test_there_is_no_assembly_where_a_name_from_outside_would_mean_something_in_it() -> None:
    assert "assembly" not in canonical(LEG % ("thigh", "thigh"))


def test_a_name_of_another_kind_is_no_obstacle() -> None:
    """Inside of `left`, the mesh `shin` is not taken for the body."""
    text = LEG.replace('collision "meshes/shin.stl"', 'visual "meshes/shin.stl" collision { mesh=shin at [0 0 1] }') % ("foot", "foot")
    assert 'shin { mass 1 visual "meshes/shin.stl" collision { mesh=shin at [0 0 1] } }' in canonical(text)
    assert "left : assembly" in canonical(text)


def test_an_assembly_may_stand_in_pieces() -> None:
    """As in files that list all links before all joints."""
    names = ("thigh", "shin", "foot_link", "toe_link")
    bodies = [f"{side}_{name} {{}}" for side in ("left", "right") for name in names]
    joints = [
        f"@{side}_{name} {{ + {side}_{names[place]} - {side}_{names[place + 1]} }}"
        for side in ("left", "right")
        for place, name in enumerate(("first", "second", "ball"))
    ]
    assert canonical("\n".join(("r : robot {", *bodies, *joints, "}"))) == (
        "r : robot {\n"
        "  left : assembly { thigh {} shin {} foot_link {} toe_link {} }\n"
        "  right : assembly { thigh {} shin {} foot_link {} toe_link {} }\n"
        "  left : assembly { @first { + thigh - shin } @second { + shin - foot_link } @ball { + foot_link - toe_link } }\n"
        "  right : assembly { @first { + thigh - shin } @second { + shin - foot_link } @ball { + foot_link - toe_link } }\n"
        "}\n"
    )


@pytest.mark.parametrize("prefix", ["joint", "world", "urdf"])
def test_words_with_a_meaning_in_references_are_no_assemblies(prefix: str) -> None:
    assert "assembly" not in canonical((LEG % ("foot", "foot")).replace("left_", f"{prefix}_"))


def test_comments_inside_elements_stay() -> None:
    text = (LEG % ("foot", "foot")).replace("left_thigh { mass 2", "left_thigh { // as weighed\n mass 2")
    assert "// as weighed" in canonical(text)


def test_comments_of_shapes_stay() -> None:
    text = 'r : robot {\n  a { collision { sphere 1 extra ["comment" "" "as scanned"] } }\n}\n'
    assert canonical(text) == "r : robot { a { collision { /* as scanned */ sphere 1 } } }\n"


def test_comments_of_a_template_are_not_repeated() -> None:
    text = "r : robot { leg() : assembly { // thigh\n thigh {} } left : leg { // mine\n } right : leg {} }"
    assert [extra.text for extra in read_text(text).extras[Id("mechanism", "")]] == ["thigh", "mine"]


@st.composite
def _mechanisms(draw: st.DrawFn) -> Mechanism:
    """Any mechanism under names that begin alike, in which the same words come back."""
    mechanism = draw(mechanisms())
    names = Names()
    renamed: dict[Id, Id] = {}
    start = st.sampled_from(("left_", "left_", "left_", "left_arm_", "right_", "joint_", "left_left_", ""))
    for key in (*mechanism.graph.vertices, *mechanism.graph.edges):
        if key != WORLD and key.kind not in ("shape", "coupling"):
            renamed[key] = names.take(key.kind, draw(start) + draw(st.sampled_from(("a", "b", "left", "world", "X", "arm_a"))))
    return rename(mechanism, renamed)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(_mechanisms())
def test_whatever_names_begin_alike_reads_back_equal(mechanism: Mechanism) -> None:
    printed = text_of(mechanism)
    back = read_text(printed)
    assert back == mechanism
    assert back.layout[: len(mechanism.layout)] == mechanism.layout
    assert text_of(back) == printed


def test_a_template_is_not_named_like_a_type_of_the_vocabulary() -> None:
    names = [f"{side}_{number}_actuator" for side in ("left", "right") for number in range(1, 6)]
    robot = hx.loads(
        f"r : robot {{ base {{ mass 1 }} {' '.join(f'{name} : actuator.geared {{}}' for name in names)} }}", "hymeko"
    ).mechanism
    text = hx.dumps(robot, "hymeko")
    assert "actuator2() : assembly" in text
    assert hx.loads(text, "hymeko").mechanism == robot
