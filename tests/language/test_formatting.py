"""`hymeko-x fmt`: another layout, the same text."""

from __future__ import annotations

import random
import re
import subprocess
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hymeko_x.cli import main
from hymeko_x.diagnostics import Refusal
from hymeko_x.language.comments import comment_text
from hymeko_x.language.formatting import format_text
from hymeko_x.language.grammar import tokens
from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_document
from hymeko_x.language.syntax import ArcItem, Comment, Document, Item, Node
from hymeko_x.testing import DOCUMENTS

ROOT = Path(__file__).parents[2]
AUTHORS = ROOT.parent / "shared/corpora/himeko_lang"
BROKEN = ROOT / "tests/language/broken"
OWN = [path for path in ROOT.rglob("*.hymeko") if not {".venv", ".peers", "build"} & {*path.parts} and path.parent != BROKEN]
THEIRS = sorted(AUTHORS.rglob("*.h[iy]m*ko"))
COMMENT = re.compile(r'"""[\s\S]*?"""|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'|`(?:\\.|[^`\\])*`|(#[^\n]*|//[^\n]*|/\*[\s\S]*?\*/)')


def bare(item: Item) -> Item:
    """The item without its place."""
    if isinstance(item, Node | ArcItem):
        item = item._replace(items=tuple(map(bare, item.items)))
    return item._replace(line=0, column=0)


def meaning(text: str) -> Document:
    document = parse(text)
    return document._replace(items=tuple(map(bare, document.items)))


def comments(text: str) -> list[str]:
    return [comment_text(found[1]) for found in COMMENT.finditer(text) if found[1]]


def check_laws(text: str) -> None:
    formatted = format_text(text)
    assert format_text(formatted) == formatted
    assert repr(meaning(formatted)) == repr(meaning(text))  # nan is not itself
    assert comments(formatted) == comments(text)


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.name)
def test_own_files_keep_the_laws(path: Path) -> None:
    check_laws(path.read_text(encoding="utf-8"))


@pytest.mark.skipif(not THEIRS, reason="the authors' files are not here")
def test_published_files_keep_the_laws() -> None:
    readable = 0
    for path in THEIRS:
        text = path.read_text(encoding="utf-8", errors="replace")
        try:
            parse(text)
        except Refusal:
            continue
        check_laws(text)
        readable += 1
    assert readable >= 40


NOTES = (" // {} }}\n", " # {} [\n", " /* {}\n two */ ", "/*{}*/", "\n// {}\n", "\n\n\n  # {}\n\n")


@pytest.mark.parametrize("path", OWN[::4], ids=lambda path: path.name)
def test_comments_at_any_depth_keep_their_places(path: Path) -> None:
    chance = random.Random(path.name)
    pieces: list[str] = []
    for word in tokens(path.read_text(encoding="utf-8")):
        note = chance.choice(NOTES).format(len(pieces)) if chance.random() < 0.3 else " "
        pieces += [note, word]
    text = "".join(pieces)
    check_laws(text)
    assert neighbours(format_text(text)) == neighbours(text)


def neighbours(text: str) -> list[tuple[str, int]]:
    """Each comment with the number of tokens before it."""
    found = [(comment_text(match[1]), len(tokens(text[: match.start(1)]))) for match in COMMENT.finditer(text) if match[1]]
    return found[:20] + found[-20:]


SPACES = st.sampled_from([" ", "  ", "\n", "\n\n\n", "\t", " \n  ", " // note\n", " /* a\n  b */ ", " # {\n", "\r\n"])


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(DOCUMENTS, st.lists(SPACES, min_size=1, max_size=30))
def test_any_text_with_any_white_space_keeps_the_laws(document: Document, spaces: list[str]) -> None:
    words = tokens(print_document(document))
    check_laws("".join(word + spaces[number % len(spaces)] for number, word in enumerate(words)))


LAYOUTS = {
    "a:b{mass   1}": "a : b { mass 1 }\n",
    "a{b{}c{\n}}": "a {\n  b {} c {}\n}\n",
    "a{b{mass 1\n}}": "a {\n  b {\n    mass 1\n  }\n}\n",
    "// one\n\n\n\n// two\na {} // three": "// one\n\n// two\na {} // three\n",
    "a\n:\nb\n{\n}": "a\n  :\n  b {}\n",
    "a { x [1,2 , 3] y=- Z [ 1 ]+b, leg(h , r = 0.1):link{} @ j:fixed{} }": (
        "a { x [1, 2, 3] y=-Z [1] + b, leg(h, r=0.1) : link {} @j : fixed {} }\n"
    ),
    "a { x [1 2\n 3 4\n] }": "a {\n  x [1 2\n    3 4\n  ]\n}\n",
    "a {mass 2 ;b{x 1;}\nc{};}": "a {\n  mass 2; b { x 1; }\n  c {};\n}\n",
    "a{K=g\n;}": "a {\n  K=g\n    ;\n}\n",
    "a{v[1\n,2](+e,-b)}": "a {\n  v [1, 2] (+ e, - b)\n}\n",
    "a {\n\n\n  b {}\n\n\n  c {}\n\n}": "a {\n  b {}\n\n  c {}\n}\n",
    "@e{(a - b),(+ c)x(1 + 2)}": "@e { (a - b), (+ c) x (1 + 2) }\n",
    'f : r { e1 : - @>"n1" c : <string> <?> }': 'f : r { e1 : - @>"n1" c : <string> <?> }\n',
    "": "",
}


@pytest.mark.parametrize("text", LAYOUTS)
def test_the_layout(text: str) -> None:
    assert format_text(text) == LAYOUTS[text]
    check_laws(text)


def test_what_is_wider_than_the_page_is_broken_between_items() -> None:
    text = "r : robot { " + " ".join(f"body_{number} {{ mass {number} com [0 0 {number}] }}" for number in range(9)) + " }"
    lines = format_text(text).splitlines()
    assert lines[:2] == ["r : robot {", "  body_0 { mass 0 com [0 0 0] }"]
    assert len(lines) == 11
    fields = format_text("b { " + " ".join(f"field_{number} {number}.25" for number in range(20)) + " }").splitlines()
    assert [len(line) <= 120 for line in fields] == [True] * 5
    check_laws(text)


def test_a_long_list_is_formatted_in_linear_time() -> None:
    rows = "\n".join(f"{number} 0 1" for number in range(20_000))
    assert format_text(f"m : mesh {{ vertices [{rows}] }}").count("\n") == 20_003 - 1


# ---- the verb ------------------------------------------------------------------------------------------------------------------


def test_files_are_formatted_in_place_and_only_where_they_change(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good, bad, broken = (tmp_path / name for name in ("good.hymeko", "bad.himeko", "broken.hymeko"))
    good.write_text("a {}\n")
    bad.write_text("a{}\r\n", newline="")
    before = good.stat().st_mtime_ns
    assert main(["fmt", "--check", str(tmp_path)]) == 1
    printed = capsys.readouterr()
    assert printed.out == f"would reformat {bad}\n"
    assert printed.err == "1 file would be reformatted, 1 file left unchanged\n"
    assert main(["fmt", str(good), str(bad)]) == 0
    assert capsys.readouterr().err == "1 file reformatted, 1 file left unchanged\n"
    assert bad.read_bytes() == b"a {}\n"
    assert good.stat().st_mtime_ns == before
    assert main(["fmt", "--check", "--diff", str(tmp_path)]) == 0
    broken.write_text("a {")
    assert main(["fmt", str(tmp_path)]) == 1
    assert "error[HX060]" in capsys.readouterr().err
    assert broken.read_text() == "a {"
    assert main(["fmt", str(tmp_path / "none.hymeko")]) == 1
    (tmp_path / "empty").mkdir()
    assert main(["fmt", str(tmp_path / "empty")]) == 2


def test_the_difference_is_printed_as_a_patch_that_applies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.hymeko"
    file.write_text("a{}\nb   {\n}\n")
    assert main(["fmt", "--diff", str(file)]) == 1
    patch = capsys.readouterr().out
    assert file.read_text() == "a{}\nb   {\n}\n"
    subprocess.run(["patch", str(file)], input=patch, text=True, check=True, capture_output=True)
    assert main(["fmt", "--check", str(file)]) == 0


def test_a_comment_keeps_its_text() -> None:
    document = parse(format_text("/* two\n   lines */ a{}"))
    assert Comment("two\n   lines", 1, 1) in document.items
