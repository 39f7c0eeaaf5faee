"""Texts as the language's authors publish them: meta-models by import, arcs as fields, and the dialect of 2026."""

from __future__ import annotations

import math
from pathlib import Path
from textwrap import dedent

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism
from hymeko_x.ir.parts import DofKind
from hymeko_x.ir.values import Pose, quat_from_rpy
from hymeko_x.language.parser import parse

META = """
meta_arms
arms {
  units { length "m" angle "degree" mass "kg" }
  elements { thing {} link : -> thing {} frame : -> thing {} control : -> thing {} @joint { @control {} } @plugin {} }
  sensors { eye : elements.sensor { type "camera" } sensor {} }
  bounds { lower -90 upper 90 effort 50 velocity 2 }
  stroke [0.0, 0.5]
  attributes { position velocity }
  @fixed_joint : -> elements.joint {}
  @rev_joint : -> elements.joint { limit -> bounds }
  @conti_joint : -> elements.joint {}
  @prismatic_joint : -> elements.joint { limit -> stroke }
  geometry { box {} cylinder {} sphere {} }
  axes { axis_definition {} AXIS_X : -> axis_definition { ax [1, 0, 0] } AXIS_Z : -> axis_definition { ax [0, 0, 1] } }
}
"""

FIRST = """
little_arm
  import "meta_arms.hymeko"

robot use arms.elements use arms.geometry use arms.axes
{
    world : arms.elements.frame {}
    paint [0.0, 0.0, 1.0, 1.0]
    rate_control : arms.elements.control { update_rate 100 }
    base_link : arms.elements.link {
        mass 25.0
        link_geometry : box { dimension [0.7, 0.5, 0.2] }
        visual -> link_geometry
        collision -> link_geometry
        color -> robot.paint
        origin [0.0, 0.0, 0.1]
    }
    upper : arms.elements.link { mass 2 }
    lower_arm : arms.link { mass 1 }
    own_limit { lower -180.0 upper 180.0 effort 500.0 velocity 4.0 }
    @holder : arms.fixed_joint { + world, [0, 0, 0.3] - base_link }
    @j0 : arms.rev_joint { + base_link, [[0, 0, 0.2], [0, 0, 90]] - upper, -> AXIS_Z, limit -> own_limit }
    @j1 : arms.rev_joint { + upper, [0, 0, 0.4] - lower_arm, - AXIS_X }
    @spread : arms.plugin { plugin "some/Plugin", -> j0, ["right"] -> j1, + attributes.velocity }
}
"""

SECOND = """
// everything that the dialect of 2026 has
spinner_description {
    @"meta_arms.hymeko";
    using arms.elements as el;
    using arms.geometry as geo;
    using arms.axes as ax;
    const RADIUS = 0.05;
    const LENGTH = HEIGHT * 2.0;
    const HEIGHT = 0.1;
}

spinner: el, geo, ax {
    paint [1.0, 0.5, 0.0, 1.0];
    base: el.link {
        mass RADIUS;
        body_geometry: geo.cylinder { dimension [RADIUS, (LENGTH / 2.0)]; }
        visual    -> body_geometry;
        collision -> body_geometry;
        color -> spinner.paint;
        origin [0.0, 0.0, HEIGHT];
    }
    arm: + <isa> el.link { mass 1.0; }
    slider: el.link { mass 0.5; }
    val0 <int> 56;
    tagged <abstract> { note "kept"; }
    @spin: arms.conti_joint {
        (+ base [[0.0, 0.0, 0.1], [0.0, 0.0, 90.0]],
         - arm,
         - ax.AXIS_Z);
    }
    @slide: arms.prismatic_joint { (+ arm [[0.3, 0.0, 0.0], [0.0, 0.0, 0.0]], - slider, - ax.AXIS_X,); }
    @watch { (+ tagged, - arms.attributes.velocity); }
}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in (("meta_arms", META), ("first", FIRST), ("second", SECOND)):
        (tmp_path / f"{name}.hymeko").write_text(text)
    return tmp_path


def load(path: Path) -> Mechanism:
    report = Report()
    found = hx.load(path, report=report).mechanism
    assert [str(diagnostic) for diagnostic in report] == []
    text = hx.dumps(found, "hymeko")
    again = hx.loads(text, "hymeko").mechanism
    assert again == found
    assert hx.dumps(again, "hymeko") == text
    return found


def test_a_description_may_have_blocks_of_data_beside_its_imports(folder: Path) -> None:
    text = SECOND.replace("    const RADIUS", '    about { author "me"; year 2026; }\n    const RADIUS', 1)
    assert "about" in text
    (folder / "second.hymeko").write_text(text)
    robot = load(folder / "second.hymeko")
    assert [key.name for key, _ in robot.vertices(parts.Body)] == ["base", "arm", "slider"]
    assert dict(robot.vertex(Id("datum", "spinner_description.about"), parts.Datum).parameters) == {"author": "me", "year": 2026.0}


def test_a_robot_of_an_imported_meta_model(folder: Path) -> None:
    robot = load(folder / "first.hymeko")
    j0, j1, holder = (robot.joints[Id("joint", name)] for name in ("j0", "j1", "holder"))
    assert j0.parent_pose == Pose((0.0, 0.0, 0.2), quat_from_rpy((0.0, 0.0, math.pi / 2)))
    assert j0.joint.dofs[0].axis == (0.0, 0.0, 1.0)
    assert j0.joint.dofs[0].limits == parts.Limits(-math.pi, math.pi, math.radians(4.0), 500.0)
    assert j1.joint.dofs[0].axis == (1.0, 0.0, 0.0)
    assert j1.joint.dofs[0].limits == parts.Limits(-math.pi / 2, math.pi / 2, math.radians(2.0), 50.0)
    assert (holder.parent, holder.joint.dofs) == (WORLD, ())
    base = Id("body", "base_link")
    assert robot.vertex(base, parts.Body).inertial == parts.Inertial(25.0, (0.0, 0.0, 0.1))
    visual, collision = robot.shapes[base]
    assert visual.shape.geometry == collision.shape.geometry == parts.Box((0.7, 0.5, 0.2))
    assert visual.pose == collision.pose == Pose((0.0, 0.0, 0.1))
    assert visual.material is not None
    assert robot.vertex(visual.material, parts.Material).rgba == (0.0, 0.0, 1.0, 1.0)
    assert collision.material is None


def test_what_is_no_robot_in_it_stays_data(folder: Path) -> None:
    robot = load(folder / "first.hymeko")
    assert robot.vertex(Id("datum", "rate_control"), parts.Datum) == parts.Datum((("update_rate", 100.0),))
    edge = robot.graph.edges[Id("relation", "spread")]
    assert edge.data == parts.Relation((("plugin", "some/Plugin"),))
    ends = [(str(arc.target), arc.sign, arc.weight) for arc in edge.arcs]
    assert ends == [
        ("joint 'j0'", -1, None),
        ("joint 'j1'", -1, ("right",)),
        ("datum 'meta_arms.arms.attributes.velocity'", 1, None),
    ]


def test_a_robot_with_every_construct_of_the_dialect_of_2026(folder: Path) -> None:
    robot = load(folder / "second.hymeko")
    assert robot.name == "spinner"
    base = Id("body", "base")
    assert robot.vertex(base, parts.Body).inertial == parts.Inertial(0.05, (0.0, 0.0, 0.1))
    assert [view.shape.geometry for view in robot.shapes[base]] == [parts.Cylinder(0.05, 0.1)] * 2
    spin, slide = (robot.joints[Id("joint", name)] for name in ("spin", "slide"))
    assert (spin.parent.name, spin.child.name, spin.joint.dofs) == ("base", "arm", (parts.Dof(DofKind.HINGE, (0.0, 0.0, 1.0)),))
    assert spin.parent_pose == Pose((0.0, 0.0, 0.1), quat_from_rpy((0.0, 0.0, math.pi / 2)))
    assert slide.joint.dofs == (parts.Dof(DofKind.SLIDE, (1.0, 0.0, 0.0), parts.Limits(0.0, 0.5)),)
    assert robot.vertex(Id("datum", "val0"), parts.Datum) == parts.Datum((("value", 56.0),))
    assert robot.vertex(Id("datum", "tagged"), parts.Datum) == parts.Datum((("note", "kept"),))


@pytest.mark.parametrize("name", ["first", "second"])
@pytest.mark.parametrize("suffix", [".urdf", ".xml"])
@pytest.mark.unread("HX045", "HX103")
def test_the_robots_convert_and_the_verifier_calls_them_the_same(folder: Path, name: str, suffix: str) -> None:
    source, target = folder / f"{name}.hymeko", folder / f"{name}{suffix}"
    hx.convert(source, target)
    assert str(hx.verify(source, target).verdict).startswith("same")


@pytest.mark.full
@pytest.mark.unread("HX045")  # of the written xacro: an <inertial> without <inertia>
@pytest.mark.parametrize("name", ["first", "second"])
@pytest.mark.parametrize("suffix", [".usda", ".sdf", ".xacro"])
def test_the_other_formats_are_the_same_as_well(folder: Path, name: str, suffix: str) -> None:
    source, target = folder / f"{name}.hymeko", folder / f"{name}{suffix}"
    hx.convert(source, target)
    assert str(hx.verify(source, target).verdict).startswith("same")


@pytest.mark.parametrize(
    ("published", "ours"),
    [
        ("a { x 1; y [1, 2]; }", "a { x 1 y [1 2] }"),
        ("@e { (+ a, - b [0.5], ~ c); }", "@e { + a [0.5] - b ~ c }"),
        ("@e { (role + a [1 2],) ; }", "@e { [1 2] role + a }"),
        ("@e { (role - a) }", "@e { role - a }"),
        ("@e { x (2 - 1); (role -a); (+b); (b + a) }", "@e { x (2 - 1), role - a, + b, b + a }"),
        ('@"m.hymeko";', 'import "m.hymeko"'),
        ('@"m.hymeko" as m;', 'import "m.hymeko" as m'),
        ("a : + <isa> b {}", "a : + b {}"),
        ("a <tag, other> { x 1; }", "a { x 1 }"),
        ("@e : b.c { (- a); };", "@e : b.c { - a }"),
    ],
)
def test_a_construct_is_the_same_as_ours(published: str, ours: str) -> None:
    def plain(text: str) -> str:
        from hymeko_x.language.printer import print_document

        return print_document(parse(text))

    assert plain(published) == plain(ours)


def test_the_root_is_found_beside_its_description_and_its_types(tmp_path: Path) -> None:
    path = tmp_path / "a.hymeko"
    path.write_text(
        dedent("""
            about { author "me" }
            primitives {
              Link { name<string>, length<real> }
              @JointEdge { axis<real> [<?>, <?>, <?>], origin<real> [<?>, <?>, <?>], rpy<real> [<?>, <?>, <?>] }
              @RotationalJoint : JointEdge { type "revolute" }
            }
            machine use primitives {
              base {} link1 {}
              @joint1 : RotationalJoint { axis [0, 1, 0], range [-90, 90], origin [0, 0, 0.4], rpy [0, 0, 0], -> base, -> link1 }
            }
        """)
    )
    robot = load(path)
    (joint,) = robot.joints.values()
    assert (joint.parent.name, joint.child.name, joint.parent_pose.xyz) == ("base", "link1", (0.0, 0.0, 0.4))
    assert joint.joint.dofs[0].axis == (0.0, 1.0, 0.0)
    assert robot.vertex(Id("datum", "about"), parts.Datum) == parts.Datum((("author", "me"),))


def test_joints_that_stand_in_data_are_relations_of_a_whole_graph() -> None:
    """Groups of bones, and edges between groups: nothing in it is a body."""
    skeleton = """
        meta { state { position [<?> <?> <?>] } elements { bone : -> state {} @joint {} } }
        skeleton use meta.elements {
          leg { femur : bone {} tibia : bone {} /* once */ @knee : joint { + femur, - tibia } }
          left : <<copy>> -> leg { toe {} @ankle : joint { + tibia, - toe } }
          hip : bone {}
          @left_hip : joint { + hip, - left, - left.femur }
          plain : -> leg {}
        }
    """
    place = "{ position [<?> <?> <?>] }"
    graph = hx.loads(skeleton, "hymeko").mechanism
    text = hx.dumps(graph, "hymeko")
    assert hx.loads(text, "hymeko").mechanism == graph
    assert " ".join(text.split()) == (
        f"skeleton : graph {{ leg : datum {{ // once femur {place} tibia {place} @knee {{ + femur - tibia }} }} "
        f"left : datum {{ femur {place} tibia {place} @knee {{ + femur - tibia }} toe @ankle {{ + tibia - toe }} }} "
        f"hip : datum {place} @left_hip : relation {{ + hip - left - left.femur }} plain }}"
    )


@pytest.mark.parametrize(
    ("text", "root"),
    [
        ("a { x {} y {} z {} @e { + x - y } @f { + x - z } }", "robot"),
        ("a { x {} y {} z {} @e { + x - z } @f { + y - z } }", "graph"),
        ("a { x {} y {} @e { -> x, <- y } @f { <- x, -> y } }", "graph"),
        ("a { x {} y {} z {} @e { + x - y - Z } @f { + x - z - Z } }", "robot"),
        ("a { x { mass 1 } y {} z {} @e { + x - z } @f { + y - z } }", "robot"),
    ],
)
def test_names_and_arrows_alone_are_a_robot_where_they_make_a_tree(text: str, root: str) -> None:
    assert hx.dumps(hx.loads(text, "hymeko"), "hymeko").startswith(f"a : {root} {{")


def test_a_limit_of_its_own_takes_the_place_of_that_of_the_type() -> None:
    robot = hx.loads(
        """
        arm {
          link {} @joint {} any [-180, 180] narrow [-90, 90]
          @rev_joint : joint { ["limit"] -> any }
          a : link {} b : link {} c : link {}
          @j : rev_joint { + a, - b, ["axis"] - AXIS_Y, ["limit"] - narrow }
          @k : rev_joint { + b, - c }
        }
        """,
        "hymeko",
    ).mechanism
    assert [view.joint.dofs[0].limits.upper for view in robot.joints.values()] == [math.pi / 2, math.pi]


def test_a_long_chain_of_constants_has_a_value() -> None:
    chain = " ".join(f"const a{n} = a{n + 1} + 1;" for n in range(5000))
    graph = hx.loads(f"d {{ {chain} const a5000 = 0; }}\ng : graph {{ b {{ x a0; }} }}", "hymeko").mechanism
    assert graph.vertex(Id("datum", "b"), parts.Datum) == parts.Datum((("x", 5000.0),))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("d { const A = A; }\ng : graph { a {} }", "1:5: error[HX067]: the value of 'A' leads back to itself: A -> A"),
        (
            "d { const A = B; const B = C; const C = B; }\ng : graph { a {} }",
            "1:18: error[HX067]: the value of 'B' leads back to itself: B -> C -> B",
        ),
        (
            "d { const A = B; const B = A; }\ng : graph { a { x A; } }",
            "1:5: error[HX067]: the value of 'A' leads back to itself: A -> B -> A",
        ),
        (
            "d { const A = UNKNOWN; }\ng : graph { a {} }",
            "1:5: error[HX064]: const A = UNKNOWN: 'UNKNOWN' is not known here; there is pi, tau, e, inf",
        ),
        ("d { const A = 1 / 0; }\ng : graph { a {} }", "1:5: error[HX064]: const A = 1 / 0: it divides by zero"),
        ('d { @"none.hymeko"; }\ng : graph { a {} }', "1:5: error[HX040]: the imported file 'none.hymeko' was not found"),
        ("g { a : nothing {} }", "1:5: error[HX061]: 'a' has the type 'nothing', which is not known"),
        ("a : b { x 1 }\nb : a { y 1 }", "1:1: error[HX063]: the type 'b' leads back to itself: b -> a -> b"),
        ("g { a { b : <<copy>> -> a {} } }", "1:9: error[HX063]: 'b' is nested more than 200 levels deep"),
        ("g : graph { @e { (+ a } }", "1:23: error[HX060]: unexpected '}'; expected a value, ')' or ','"),
    ],
)
def test_messages_name_the_construct(text: str, message: str) -> None:
    with pytest.raises(Refusal) as caught:
        hx.loads(text, "hymeko")
    assert str(caught.value).split("\n")[0].split(":", 1)[1] == message
