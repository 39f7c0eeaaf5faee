"""Joints over more than two bodies: one edge, one coordinate, several children."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal
from hymeko_x.ir.mechanism import Id, Mechanism, numbers_weight
from hymeko_x.ir.parts import DofKind, Limits
from hymeko_x.ir.values import IDENTITY, Pose
from hymeko_x.testing.values import POSES

BODY = "{ mass 1 inertia [0.1 0.1 0.1] }"
GRIPPER = f"""
gripper : robot {{
  palm {BODY} left {BODY} right {BODY} thumb {BODY} nail {BODY}
  // they move together
  @fingers : prismatic {{
    [0 0.02 0.06] + palm - left, [0 -0.02 0.06] - right {{ ratio -1 }} [[0.02 0 0.06] [0 0 90]] - thumb {{ ratio 0.5 }} - nail
    axis=Y limit [0 0.04] velocity 0.5 effort 10 damping 2
  }}
  // behind
  case {BODY} lid {BODY}
  @covers : fixed {{ [0 0 -1] + palm - case [0 1 0] - lid }}
}}
"""


def read(text: str) -> Mechanism:
    """The mechanism of a text, which comes back from its print."""
    found = hx.loads(text, "hymeko").mechanism
    printed = hx.dumps(found, "hymeko")
    assert hx.loads(printed, "hymeko").mechanism == found
    assert hx.dumps(hx.loads(printed, "hymeko"), "hymeko") == printed
    return found


def coefficients(robot: Mechanism) -> dict[str, tuple[str, tuple[float, ...]]]:
    couplings = {key: edge for key, edge in robot.graph.edges.items() if key.kind == "coupling"}
    return {edge.arcs[0].target.name: (edge.arcs[1].target.name, numbers_weight(edge.arcs[1])) for edge in couplings.values()}


def test_every_child_has_a_joint_that_follows_the_first_one() -> None:
    robot = read(GRIPPER)
    views = {key.name: view for key, view in robot.joints.items()}
    assert [(name, view.parent.name, view.child.name) for name, view in views.items()] == [
        ("fingers", "palm", "left"),
        ("fingers_2", "palm", "right"),
        ("fingers_3", "palm", "thumb"),
        ("fingers_4", "palm", "nail"),
        ("covers", "palm", "case"),
        ("covers_2", "palm", "lid"),
    ]
    assert views["fingers_2"].parent_pose == Pose((0.0, -0.02, 0.06))
    assert views["fingers_4"].parent_pose == views["fingers"].parent_pose == Pose((0.0, 0.02, 0.06))
    limits = {name: view.joint.dofs[0].limits for name, view in views.items() if view.joint.dofs}
    assert limits == {
        "fingers": Limits(0.0, 0.04, 0.5, 10.0),
        "fingers_2": Limits(-0.04, 0.0, 0.5, 10.0),
        "fingers_3": Limits(0.0, 0.02, 0.25, 10.0),
        "fingers_4": Limits(0.0, 0.04, 0.5, 10.0),
    }
    assert {view.joint.dofs[0].kind for view in views.values() if view.joint.dofs} == {DofKind.SLIDE}
    assert coefficients(robot) == {
        "fingers_2": ("fingers", (0.0, -1.0)),
        "fingers_3": ("fingers", (0.0, 0.5)),
        "fingers_4": ("fingers", (0.0, 1.0)),
    }


def test_the_printer_makes_one_edge_of_them() -> None:
    printed = hx.dumps(hx.loads(GRIPPER, "hymeko"), "hymeko")
    arcs = "[0 0.02 0.06] + palm - left [0 -0.02 0.06] - right { ratio -1 } [[0.02 0 0.06] [0 0 90]] - thumb { ratio 0.5 } - nail"
    assert arcs in " ".join(printed.split())
    assert "@covers : fixed { [0 0 -1] + palm - case [0 1 0] - lid }" in printed
    assert printed.index("move together") < printed.index("@fingers") < printed.index("behind") < printed.index("case")


def test_a_joint_that_something_else_refers_to_stands_by_itself() -> None:
    robot = read(f"r : robot {{ a {BODY} b {BODY} c {BODY} @j {{ + a - b - c }} m : motor {{ - j_2 }} }}")
    assert "@j_2 { + a - c mimic - j }" in hx.dumps(robot, "hymeko")


def test_fixed_joints_that_something_tells_apart_stand_by_themselves() -> None:
    edge = "@j : fixed {{ + a - b {} - c }}".format
    assert "@j_2" not in hx.dumps(read(f"r : robot {{ a {{}} b {{}} c {{}} {edge('')} }}"), "hymeko")
    assert "@j_2" in hx.dumps(read("r : robot { a {} b {} c {} @j : fixed { + a - b } x {} @j_2 : fixed { + a - c } }"), "hymeko")
    assert "@j_2" in hx.dumps(read("r : robot { a {} b {} c {} @j : fixed { + a - b } @j_2 : fixed { + b - c } }"), "hymeko")
    assert "@j_2" in hx.dumps(read('r : robot { a {} b {} c {} @j : fixed { + a - b } @j_2 : fixed { + a - c urdf "<x/>" } }'), "hymeko")


def test_the_published_arrows_and_roles() -> None:
    robot = read(f"r : robot {{ a {BODY} b {BODY} c {BODY} d {BODY} @j {{ -> a, -> b, -> c }} @k {{ + b PRI - d }} }}")
    assert [(view.parent.name, view.child.name) for view in robot.joints.values()] == [("a", "b"), ("a", "c"), ("b", "d")]
    slides = read(f"r : robot {{ a {BODY} b {BODY} c {BODY} @j {{ + a PRI - b - c }} }}")
    assert [view.joint.dofs[0].kind for view in slides.joints.values()] == [DofKind.SLIDE] * 2


def test_in_assemblies_and_templates_names_are_those_of_the_place() -> None:
    hand = f"palm {BODY} left {BODY} right {BODY} @fingers {{ + palm - left - right {{ ratio=${{sign}} }} }}"
    robot = read(f"hand(sign) : assembly {{ {hand} }} r : robot {{ a : hand(sign=-1) {{}} b : hand(sign=2) {{}} }}")
    assert coefficients(robot) == {"a_fingers_2": ("a_fingers", (0.0, -1.0)), "b_fingers_2": ("b_fingers", (0.0, 2.0))}


@pytest.mark.parametrize("suffix", [".urdf", ".xml"])
@pytest.mark.unread("HX103")
def test_other_formats_have_the_same_robot(tmp_path: Path, suffix: str) -> None:
    source, target = tmp_path / "a.hymeko", tmp_path / f"b{suffix}"
    source.write_text(GRIPPER)
    hx.convert(source, target)
    assert str(hx.verify(source, target).verdict).startswith("same")
    assert coefficients(hx.load(target).mechanism) == coefficients(hx.load(source).mechanism)


FACTORS = st.floats(0.01, 100).flatmap(lambda number: st.sampled_from([number, -number, 1.0]))


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.sampled_from(["revolute", "prismatic", "screw", "fixed"]),
    st.lists(st.tuples(POSES, FACTORS, st.booleans()), min_size=1, max_size=4),
    POSES,
)
def test_any_edge_comes_back(kind: str, others: list[tuple[Pose, float, bool]], shared: Pose) -> None:
    def pose(value: Pose) -> str:
        return f"[[{' '.join(map(repr, value.xyz))}] [{' '.join(map(repr, value.quat))}]]"

    names = [f"c{number}" for number in range(len(others))]
    is_fixed = kind == "fixed"
    arcs = [
        f"{pose(place)} {'at' if framed else ''} - {name}" + ("" if is_fixed else f" {{ ratio {ratio!r} }}")
        for name, (place, ratio, framed) in zip(names, others, strict=True)
    ]
    bodies = " ".join(f"{name} {{}}" for name in ("a", "b", *names))
    motion = "" if is_fixed else "axis [0 3 4] limit [-0.5 0.25] ref 0.1"
    robot = read(f"r : robot {{ {bodies} @j : {kind} {{ {pose(shared)} + a - b, {' '.join(arcs)} {motion} }} }}")
    assert [ratio for _, (_, ratio) in coefficients(robot).values()] == [ratio for _, ratio, _ in others if not is_fixed]
    for number, (place, _, framed) in enumerate(others, 2):
        view = robot.joints[Id("joint", f"j_{number}")]
        assert (view.parent_pose, view.child_pose) == ((shared, place) if framed else (place, IDENTITY))
    assert "@j_2" not in hx.dumps(robot, "hymeko")


REFUSED = {
    "@j { + a - b - c { ratio 0 } }": "a ratio of 0 would not move 'c'",
    "@j : fixed { + a - b - c { ratio 2 } }": "'j' holds its children without motion, and a 'ratio' needs one",
    "@j { + a - b - c { mass 1 } }": "the block of the arc to 'c' holds a 'ratio' alone",
    "@j { + a - b { ratio 2 } - c }": "the first child of 'j' moves by the joint's own coordinate; 'ratio' is for the others",
    "@j : ball { + a - b - c }": "'j' has several children, and they can share one angle or one length, not a motion of several numbers",
    "@j { + a - b - c } @j_2 { + c - d }": "joint 'j_2' is defined twice",
    "@j { + a + d - b - c }": "joint 'j' has 2 parents and 1 children",
}


@pytest.mark.parametrize("edge", REFUSED)
def test_what_cannot_be_shared_is_refused(edge: str) -> None:
    with pytest.raises(Refusal) as caught:
        hx.loads(f"r : robot {{ a {{}} b {{}} c {{}} d {{}} {edge} }}", "hymeko")
    assert REFUSED[edge] in str(caught.value)


def test_a_comment_stays_beside_the_child_at_which_it_stands() -> None:
    text = f"r : robot {{ palm {BODY} left {BODY} right {BODY} thumb {BODY}\n// first\n@m : fixed {{\n+ palm // palm\n- left\n"
    text += "// on the right\n[0 0 1] - right // behind it\n/* at last */ [0 0 2] - thumb } }"
    printed = hx.dumps(read(text), "hymeko")
    assert printed.partition("// first\n")[2].split("\n") == [
        "  @m : fixed {",
        "    // palm",
        "    + palm - left",
        "    // on the right",
        "    // behind it",
        "    [0 0 1] - right",
        "    // at last",
        "    [0 0 2] - thumb",
        "  }",
        "}",
        "",
    ]


def test_joints_with_a_comment_between_them_are_edges_of_their_own() -> None:
    joints = "@m : fixed { + palm - left }\n@m_2 : fixed { + palm - right }\n// the thumb\n@m_3 : fixed { + palm - thumb }\n// behind"
    printed = hx.dumps(read(f"r : robot {{ palm {BODY} left {BODY} right {BODY} thumb {BODY}\n{joints}\n}}"), "hymeko")
    assert printed.partition("@m")[2].split("\n") == [
        " : fixed { + palm - left - right }",
        "  // the thumb",
        "  @m_3 : fixed { + palm - thumb }",
        "  // behind",
        "}",
        "",
    ]
