"""The grammar and the two programs that read it: lark, and our machine on lark's tables."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lark import Lark
from lark.exceptions import UnexpectedInput

from hymeko_x.backends.hymeko import write
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends.hymeko import read
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Id
from hymeko_x.language.grammar import TOKENS, grammar_text, tables_text
from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_document
from hymeko_x.language.syntax import ArcItem, Field, Node, Query, Ref
from hymeko_x.language.templates import standard_templates
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source
from hymeko_x.testing import DOCUMENTS

CORPUS = sorted((Path(__file__).parents[2] / "corpus").glob("*/*.hymeko"))
TABLES = Path(__file__).parents[2] / "hymeko_x" / "language" / "tables.json"


@pytest.fixture(scope="module")
def lark() -> Lark:
    return Lark(grammar_text(), parser="lalr", maybe_placeholders=False)


def test_the_grammar_has_no_conflict() -> None:
    Lark(grammar_text(), parser="lalr", strict=True)


def test_the_tables_are_those_of_the_grammar() -> None:
    assert TABLES.read_text(encoding="utf-8") == tables_text()


# ---- the machine and lark ----------------------------------------------------------------------------------------------------


def _accepts(lark: Lark, text: str) -> bool:
    try:
        lark.parse(text)
    except UnexpectedInput:
        return False
    return True


def _agree(lark: Lark, text: str) -> bool:
    """Whether our machine and lark both accept or both refuse. What a token means is not the grammar's business."""
    try:
        parse(text)
    except Refusal as refusal:
        return "is not a number" in str(refusal) or "is not a character" in str(refusal) or not _accepts(lark, text)
    return _accepts(lark, text)


@settings(max_examples=30, deadline=None)
@given(DOCUMENTS, st.randoms(use_true_random=False))
def test_lark_and_the_machine_accept_the_same_texts(lark: Lark, document: object, chance: random.Random) -> None:
    words = _words(print_document(document))  # type: ignore[arg-type]
    for _ in range(4):
        mutated = " ".join(_mutated(words, chance))
        assert _agree(lark, mutated), mutated


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_lark_and_the_machine_accept_the_same_damaged_files(lark: Lark, path: Path) -> None:
    words = _words(path.read_text(encoding="utf-8"))[:120]
    chance = random.Random(0)
    assert _agree(lark, " ".join(words))
    for _ in range(8):
        mutated = " ".join(_mutated(words, chance))
        assert _agree(lark, mutated), mutated


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("post [4] { a 1 }", "post [4] /* four */ { a 1 }"),
        ("a { x=b.c }", "a { x=b /* */ .c }"),
        ("a { x=b y [1 2] z 'w' v=-1 }", "a { x = b, y = [1 2] z 'w' v /* */ -1 }"),
        ("@e : b { [0 0 1] + c - d.e }", "@ e:b{[0 0 1]+c-d . e}"),
        ("@e { mimic - a [1] role + b { x 1 } + c }", "@e { mimic -a, [1]role +b{x 1}+c}"),
        ("a : b(h=1 k=c) { used { } }", "a:b(h = 1,k = c){used{}}"),
        ("t(h=0.5 k=x) : link { as1 1 }", "t ( h = 0.5 k = x ):link{as1 1}"),
        ("a : t, b { }", "a : t,b{}"),
        ("a { urdf { g(r=x) { m 1 } } }", "a { urdf { g ( r=x ) {m 1}}}"),
        ("a use s { x 1 }", "a use s{x 1}"),
        ("a { (+ b [1 2], - c) }", "a{(+b [1 2],-c)}"),
        ("p() { m 1 } q ( ) : b.c { } @r() : s.t { }", "p /* */ () { m 1 } q( /* */ ):b . c{} @ r ( ) : s . t {}"),
        ("@e { at - a.b, [1 2] at -c.d, x-y }", "@e { at /* */ -a . b, [1 2] /* */ at - c . d, x /* */ - y }"),
        ("a { x inf y=nan }", "a { x=inf y nan }"),
    ],
)
def test_statements_mean_the_same_whole_and_in_parts(lark: Lark, text: str, same: str) -> None:
    first, second = (re.sub(r"//[^\n]*|\s", "", print_document(parse(written))) for written in (text, same))
    assert first == second
    assert _accepts(lark, text)


def _words(text: str) -> list[str]:
    """Roughly the tokens of a text, without its comments."""
    pieces = [match[0] for match in re.finditer(TOKENS.pattern + r"|[^\s{}()\[\],:=]+|[,:=]", text)]
    return [piece for piece in pieces if not piece.startswith(("#", "//", "/*"))]


def _mutated(words: list[str], chance: random.Random) -> list[str]:
    """The words with one of them lost, doubled, exchanged with its neighbour, or replaced."""
    result = list(words)
    if not result:
        return ["{"]
    place = chance.randrange(len(result))
    match chance.randrange(4):
        case 0:
            del result[place]
        case 1:
            result.insert(place, result[place])
        case 2:
            result[place - 1], result[place] = result[place], result[place - 1]
        case _:
            signs = ["{", "}", "[", "]", "(", ")", ",", ":", "=", "+", "->", "@", "${", ";", "<"]
            result[place] = chance.choice([*signs, "use", "import", "1", "'a'", "x"])
    return result


# ---- everything that the language can write ------------------------------------------------------------------------------------

HEXAPOD = """
spider import "std/kinematics.himeko" as std
units { length m angle deg mass kg }
limb(side, x, len=0.3) : std.assembly {
  coxa : std.link { mass 0.4 inertia [1e-3 1e-3 2e-3 0 0 0] visual -> skin { color -> white }
    skin : std.mesh { url "package://spider/coxa.stl" scale [1e-3 1e-3 1e-3] } }
  tibia : std.link { mass 200g visual { capsule [15mm ${len}] at [0 0 ${-len/2}] } }
  @swing : std.revolute {
    + trunk [[${x} ${0.1*side} 0] [0 0 ${90*side}]] - coxa, axis -> std.AXIS_Z,
    limit [-45deg 45deg] effort 6Nm velocity 5rad/s damping 0.05
  }
  @lift : std.revolute { + coxa, [0 0 ${-len}] - tibia axis [0 1 0], ref 10deg }
}
robot use std {
  white : material { color [1 1 1 1] }
  trunk : link { mass 3 }
  left : limb(side=1 x=0.2) {}   right : limb(side=-1 x=0.2 len=0.35) {}
  @closure : connect { [0 0 -0.1] ~ left.tibia [0 0 -0.1] ~ right.tibia solref [0.02 1] }
  @follow : coupling { [1] follower + right.lift, [2.0 0.1] leader - left.lift }
  push : motor { ctrlrange [-1 1] }
  @pushes : drive { + push [50] - left.swing }
  @spread : tendon { [1] + left.lift, [-2] + right.lift, type "fixed" limit [-1 1] }
  imu : sensor.imu { rate 200Hz } @imu_mount : mount { [[0 0 .05] [0 0 0]] + trunk - imu }
  home : pose {} @home_values : stance { + home [0.1] ~ left.swing }
  mjcf \"\"\"<option integrator="implicitfast"/>\"\"\"
}
"""


def test_one_text_uses_everything() -> None:
    robot = read(Source("spider.hymeko", HEXAPOD.encode()), Report()).mechanism
    assert robot.name == "spider"
    assert [key.name for key, _ in robot.vertices(parts.Body)] == ["trunk", "left_coxa", "left_tibia", "right_coxa", "right_tibia"]
    swing = robot.joints[Id("joint", "right_swing")]
    assert swing.parent_pose.xyz == (0.2, -0.1, 0.0)
    assert swing.joint.dofs[0].limits.upper == pytest.approx(0.7853981633974483, abs=1e-16)
    assert robot.joints[Id("joint", "right_lift")].parent_pose.xyz == (0.0, 0.0, -0.35)
    assert robot.graph.vertices[Id("sensor", "imu")] == parts.Sensor("imu", 200.0)
    assert robot.graph.vertices[Id("body", "left_tibia")] == parts.Body(parts.Inertial(0.2))
    ((_, loop, arcs),) = robot.edges(parts.Loop)
    assert loop == parts.Loop("connect", parameters=(("solref", (0.02, 1.0)),))
    assert [arc.target.name for arc in arcs] == ["left_tibia", "right_tibia"]
    text = write(robot, Options(), Report()).main
    assert read(Source("spider.hymeko", text), Report()).mechanism == robot


def test_forms_of_older_texts_are_read() -> None:
    tree = parse('[context]\nnode { color: <string> <?> age: <?> e1: - @>"n1", + @>"n2" rel part { <<copy>> + x } "kinematic" link {} }')
    assert tree.header == "context"
    (node,) = tree.items
    assert isinstance(node, Node)
    color, age, first, second, relation, typed = node.items
    assert (color, age) == (
        Field("color", Query(), "string", color.line, color.column),
        Field("age", Query(), "", age.line, age.column),
    )
    assert isinstance(first, ArcItem)
    assert (first.role, first.ref, second.ref) == ("e1", Ref(("n1",), "-"), Ref(("n2",), "+"))  # type: ignore[union-attr]
    assert isinstance(relation, Node)
    assert (relation.edge, relation.items[0].ref) == ("rel", Ref(("x",), "+", "<<copy>>"))  # type: ignore[union-attr]
    assert isinstance(typed, Node)
    assert (typed.edge, typed.name) == ("kinematic", "link")


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_the_printed_tree_of_a_file_is_a_fixed_point(path: Path) -> None:
    text = print_document(parse(path.read_text(encoding="utf-8")))
    assert print_document(parse(text)) == text


def test_every_type_of_the_vocabulary_has_a_kind() -> None:
    for name in standard_templates():
        if name in ("robot", "graph", "assembly"):
            continue
        kinds = [item.value for item in _chain(name) if isinstance(item, Field) and item.name == "kind"]
        assert len(kinds) == 1, name


def _chain(name: str) -> list[object]:
    node = standard_templates()[name]
    return [*node.items, *(item for kind in node.stereotypes for item in _chain(kind.ref.dotted))]
