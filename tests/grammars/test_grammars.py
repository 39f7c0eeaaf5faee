"""The grammars for models: every text that is printed is theirs, and what they allow is a text of the language."""

from __future__ import annotations

import random
import re
from collections import Counter
from pathlib import Path

import pytest
from lark import Lark

import hymeko_x as hx
from hymeko_x.cli import exits, main
from hymeko_x.diagnostics import Refusal
from hymeko_x.language.grammar import grammar_text
from hymeko_x.language.models.printing import PRINTERS, gbnf, llguidance
from hymeko_x.language.models.rules import plain_rules
from hymeko_x.language.models.terminals import _OTHER_LETTERS, DROPPED, PLAIN
from hymeko_x.language.parser import parse
from hymeko_x.language.terminals import KEYWORDS
from tests.grammars.masks import accepts, fault, walk

ROOT = Path(__file__).parents[2]
TEXTS = sorted((ROOT / "corpus").glob("*/*.hymeko"))
NAMES = ("llguidance", "gbnf")


def is_parsed(text: str) -> bool:
    try:
        parse(text)
    except Refusal:
        return False
    return True


@pytest.mark.parametrize("name", NAMES)
def test_a_grammar_is_valid(name: str) -> None:
    assert fault(name) == ""


# ---- what is printed is theirs ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.stem)
def test_the_listings_and_our_robots_are_of_the_grammars(path: Path) -> None:
    text = path.read_text("utf-8")
    canonical = hx.dumps(hx.load(path), "hymeko")
    assert [name for name in NAMES for one in (text, canonical) if not accepts(name, one)] == []


def test_a_number_with_exponent_and_unit_is_of_the_grammars() -> None:
    text = hx.dumps(hx.loads("r : robot { a {} b {} @j { [[0 0 0] [5e-8rad 61 7]] + a - b } }", "hymeko"), "hymeko")
    assert "[5e-8rad 61 7]" in text
    assert [name for name in NAMES if not accepts(name, text)] == []


@pytest.mark.full
@pytest.mark.robots("urdf", "mjcf", "usd", "xacro", "sdf")
def test_the_canonical_text_of_every_real_robot_is_of_the_grammar(robot: Path) -> None:
    text = hx.dumps(hx.load(robot, lenient=True), "hymeko", lenient=True)
    if len(text) > 200_000:
        pytest.skip("points of meshes: numbers alone")
    assert accepts("llguidance", text)


# ---- what they allow is a text -------------------------------------------------------------------------------------------------


def walks(name: str, seeds: range) -> Counter[str]:
    """How many random walks are texts; none may be refused by the parser of the language."""
    found: Counter[str] = Counter()
    for seed in seeds:
        text = walk(name, seed)
        found["endless" if text is None else "text"] += 1
        assert text is None or is_parsed(text), (seed, text)
    return found


@pytest.mark.parametrize("name", NAMES)
def test_random_walks_give_no_syntax_error(name: str) -> None:
    assert walks(name, range(60))["text"] > 50


@pytest.mark.full
@pytest.mark.parametrize("name", NAMES)
def test_ten_thousand_random_walks_give_no_syntax_error(name: str) -> None:
    assert walks(name, range(10_000))["text"] > 9_000


@pytest.mark.full
def test_a_thousand_random_walks_of_xgrammar_give_no_syntax_error() -> None:
    pytest.importorskip("xgrammar", reason="xgrammar needs torch, which is large; pip install xgrammar torch runs this test")
    assert walks("xgrammar", range(1000))["text"] > 900


@pytest.mark.parametrize("text", ["a : b(x /* y) */ = 1) {}", "a : b(x // y)\n = 1) {}", "a(x /* y) */) {}", "a(x /*/*0 y\n */){}"])
def test_a_comment_behind_the_first_name_in_parentheses_is_no_expression(text: str) -> None:
    assert accepts("llguidance", text)
    assert is_parsed(text)


# ---- mutated texts ---------------------------------------------------------------------------------------------------------------

SMALL = re.findall(r"```hymeko\n(.*?)```", (ROOT / "docs/language.md").read_text("utf-8"), re.DOTALL)
SHORTEST = sorted((hx.dumps(hx.loads(text, "hymeko"), "hymeko") for text in SMALL), key=len)[:8]
_PIECES = '{ } [ ] , = : + - @ a 1 2mm " ` . use import inf < // ('
PIECES = ["", " ", "\n", *_PIECES.split()]


def mutated(seed: int) -> str:
    """A text with one small change."""
    chance = random.Random(seed)
    text = chance.choice(SHORTEST)
    start = chance.randrange(len(text))
    return text[:start] + chance.choice(PIECES) + text[start + chance.choice((0, 0, 1, 1, 2)) :]


def judged_otherwise(name: str, seeds: range) -> list[tuple[int, str]]:
    """The mutated texts that the grammar and the parser judge differently."""
    return [(seed, text) for seed in seeds if accepts(name, text := mutated(seed)) != is_parsed(text)]


@pytest.mark.parametrize("name", NAMES)
def test_mutated_texts_are_judged_alike(name: str) -> None:
    assert judged_otherwise(name, range(40)) == []
    assert 5 < sum(accepts(name, mutated(seed)) for seed in range(40)) < 35


@pytest.mark.full
@pytest.mark.parametrize("name", NAMES)
def test_ten_thousand_mutated_texts_are_judged_alike(name: str) -> None:
    assert judged_otherwise(name, range(10_000)) == []


GOOD = """r{a -inf1} r{a=-info.b} r{a~infinite{}} r{a -import1} r{-a.inf1} r{[-inf 1]-inf2} r{a//x
.b{}} r{a/**/-b} r{x[.5,1.,-.5e3,]} r{x/**/2mm//y
} r{x#y
1e3rad-2} r{x[-a,+b]} r{x[-e +E]} r{"a"b{}} r{x<?>y"a"} r{m${a}n 1}"""
BAD = """r{a-1} r{a.5} r{x|2mm.5} r{x|1-a} r{x|2mm-|a} r{x|1->a} r{[0|0inf.3]} r{x|"a""b"} r{[,1]} r{[1,,2]} r{[a,,b]} use{} r{a-use}
r{as|1} r{import|1} r{x|1inf.3} r{x|inf-a} r{x|2e5e6}"""


@pytest.mark.parametrize("text", re.findall(r"r\{(?:[^{}]|\{[^{}]*\})*\}", GOOD))
def test_words_stand_side_by_side_where_no_blank_is_needed(text: str) -> None:
    assert is_parsed(text)
    assert [name for name in NAMES if accepts(name, text)] == ["llguidance", "gbnf"]


@pytest.mark.parametrize("text", [text.replace("|", " ") for text in BAD.split()])
def test_numbers_touch_no_word_and_words_of_the_language_are_no_names(text: str) -> None:
    assert not is_parsed(text)
    assert [name for name in NAMES if accepts(name, text)] == []


# ---- the notations -----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", PRINTERS)
def test_every_grammar_is_printed(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["grammar", "--to", name]) == exits.DONE
    assert capsys.readouterr().out == PRINTERS[name]()


def test_that_for_lark_is_the_grammar_itself() -> None:
    assert PRINTERS["lark"]() == grammar_text()
    Lark(PRINTERS["lark"](), parser="lalr")


def test_no_terminal_needs_what_the_programs_do_not_have() -> None:
    terminals = plain_rules()[1]
    assert [name for name, pattern in terminals.items() if re.search(r"\(\?[=!<]|\\[bdwsBDWS]|\*\?", pattern)] == []


def test_every_terminal_with_priority_or_look_around_has_a_plain_form() -> None:
    defined = re.findall(r"^([A-Z_]+)(\.\d)?: (.*)$", grammar_text(), re.MULTILINE)
    odd = {name for name, priority, text in defined if name != "COMMENT" and (priority or re.search(r"\(\?[=!]|\\[wd]", text))}
    assert odd - {*PLAIN, "NUMBER", "QUANTITY"} - DROPPED <= {"MODIFIER", "QUERY"}  # parts of their own, and fixed texts


def test_no_rule_begins_with_itself() -> None:
    """llama.cpp takes no left recursion."""
    rules = plain_rules()[0]
    empty = {"GAP"} | {name for name, choices in rules.items() if () in choices}
    first = {name: {symbol for choice in choices for symbol in heads(choice, empty)} & {*rules} for name, choices in rules.items()}
    for _ in rules:
        first = {name: found | {other for one in found for other in first[one]} for name, found in first.items()}
    assert [name for name, found in first.items() if name in found] == []


def heads(choice: tuple[str, ...], empty: set[str]) -> list[str]:
    """The symbols with which an alternative may begin."""
    for number, symbol in enumerate(choice):
        if symbol not in empty:
            return list(choice[: number + 1])
    return list(choice)


def test_names_without_quotes_are_names_of_the_language() -> None:
    pattern = re.compile(rf"(?:{PLAIN['NAME']})")
    letters = re.findall(f"[{_OTHER_LETTERS}]", "".join(map(chr, range(0xD800))))
    assert len(letters) > 30_000
    assert [letter for letter in letters if not re.fullmatch(r"[^\W\d]", letter)] == []
    for word in ("a", "_", "x1", "import_", "impor", "asx", "useful", "infinite", "nano", "sequel", "i", "関節"):
        assert pattern.fullmatch(word)
    assert [word for word in (*KEYWORDS, "1a", "a b", "a.b", "") if pattern.fullmatch(word)] == []


def test_rules_of_llama_cpp_are_dashed_words_of_small_letters() -> None:
    assert [name for name in re.findall(r"^(\S+) ::=", gbnf(), re.MULTILINE) if not re.fullmatch("[a-z][a-z0-9-]*", name)] == []


def test_the_notations_have_the_same_rules() -> None:
    assert len(re.findall(r"^\S+ ::=", gbnf(), re.MULTILINE)) == len(re.findall(r"^\w+:", llguidance(), re.MULTILINE)) + 1  # gap
