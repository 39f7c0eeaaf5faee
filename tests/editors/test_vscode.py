"""The extension for VS Code: its grammar colours every token of every listing as what it is, and its manifest names files that exist."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import zipfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from lark import Lark, Token

from hymeko_x.cli import VERBS
from hymeko_x.language.grammar import grammar_text
from tests.editors.textmate import Scopes, scopes

ROOT = Path(__file__).parents[2]
EXTENSION = ROOT / "editors/vscode"
MANIFEST = json.loads((EXTENSION / "package.json").read_text("utf-8"))
GRAMMAR = json.loads((EXTENSION / "syntaxes/hymeko.tmLanguage.json").read_text("utf-8"))
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
LISTINGS = {path.stem: path.read_text("utf-8") for path in sorted((ROOT / "corpus").glob("*/*.hymeko"))}
LISTINGS |= {
    f"{path.stem}-{number}": text
    for path in PAGES
    for number, text in enumerate(re.findall(r"```hymeko\n(.*?)```", path.read_text("utf-8"), re.DOTALL))
}
SCOPES = {
    "NUMBER": "constant",
    "NUMBERS": "constant.numeric",
    "MATRIX": "constant.numeric",
    "QUANTITY": "(constant.numeric|keyword.other.unit)",
    "STRING": "string",
    "EXPRESSION": "(meta.expression|variable|constant.numeric|keyword.operator)",
    "NAME": "(entity.name|variable)",
    "COMMENT": "comment",
    "DIRECTION": "keyword.operator",
    "MODIFIER": "storage.modifier",
    "EDGE_WORD": "storage.type",
    "QUERY": "constant.language",
    "USE": "keyword.control",
    "IMPORT": "keyword.control",
    "AS": "keyword.control",
}
"""The scope of each terminal of the language; the characters of NUMBERS and MATRIX that are no brackets, commas or white space."""


@cache
def _parser() -> Lark:
    return Lark(grammar_text(), parser="lalr", keep_all_tokens=True, propagate_positions=True)


def tokens(text: str) -> list[Token]:
    tree = _parser().parse(text)
    return [one for one in tree.scan_values(lambda value: isinstance(value, Token)) if one.type in SCOPES]


def wrong(text: str, found: Scopes) -> list[tuple[str, str, tuple[str, ...]]]:
    """The tokens with a character of another scope, brackets and what separates left aside."""
    faults = []
    for token in tokens(text):
        start = token.start_pos or 0
        signs = " \t\n,[]()" if token.type in ("NUMBERS", "MATRIX", "EXPRESSION") else ""
        places = (place for place in range(start, start + len(token)) if text[place] not in signs)
        faults += [(token.type, str(token), found[place]) for place in places if not _is_of(found[place], token.type)][:1]
    return faults


def _is_of(names: tuple[str, ...], terminal: str) -> bool:
    return any(re.match(SCOPES[terminal], name) for name in names)


def test_there_are_listings() -> None:
    assert len(LISTINGS) > 20


@pytest.mark.parametrize("name", LISTINGS)
def test_every_token_of_a_listing_has_the_colour_of_its_kind(name: str) -> None:
    text = LISTINGS[name]
    assert wrong(text, scopes(GRAMMAR, text)) == []


# ---- what VS Code itself does with it --------------------------------------------------------------------------------------------


def by_vscode(texts: dict[str, str]) -> dict[str, Scopes]:
    """The scopes of each character by the tokenizer of VS Code."""
    words = ["node", str(EXTENSION / "scopes.js")]
    answer = subprocess.run(words, input=json.dumps(texts), capture_output=True, text=True, check=True, timeout=60)
    found = json.loads(answer.stdout)
    return {name: _of_characters(text, found[name]) for name, text in texts.items()}


def _of_characters(text: str, lines: list[list[tuple[int, int, list[str]]]]) -> Scopes:
    """The scopes of each character of a text without characters beyond 16 bits."""
    found: Scopes = []
    for line, parts in zip(text.split("\n"), lines, strict=True):
        here: Scopes = [()] * (len(line) + 1)
        for start, end, names in parts:
            here[start:end] = [tuple(names)] * (min(end, len(here)) - start)
        found += here[: len(line) + 1]
    return found[: len(text)]


@pytest.fixture(scope="module")
def node_modules() -> None:
    if shutil.which("node") is None or not (EXTENSION / "node_modules/vscode-textmate").is_dir():
        pytest.skip("needs node and the packages that `make vsix` installs")


@pytest.mark.usefixtures("node_modules")
def test_the_tokenizer_of_vs_code_colours_every_listing() -> None:
    found = by_vscode(LISTINGS)
    assert {name: faults for name, text in LISTINGS.items() if (faults := wrong(text, found[name]))} == {}


# ---- the manifest ----------------------------------------------------------------------------------------------------------------


def test_the_files_of_the_manifest_exist() -> None:
    given: dict[str, Any] = MANIFEST["contributes"]
    paths = [one[key] for one in (*given["languages"], *given["grammars"]) for key in ("configuration", "path") if key in one]
    assert len(paths) == 2
    assert [path for path in paths if not (EXTENSION / path).is_file()] == []
    assert {grammar["language"] for grammar in given["grammars"]} <= {language["id"] for language in given["languages"]}
    assert [grammar["scopeName"] for grammar in given["grammars"]] == [GRAMMAR["scopeName"]]
    for name in ("language-configuration.json", "package.json"):
        json.loads((EXTENSION / name).read_text("utf-8"))


def test_every_command_of_the_manifest_is_one_of_the_extension() -> None:
    code = (EXTENSION / "extension.js").read_text("utf-8")
    given = MANIFEST["contributes"]
    commands = {one["command"] for one in given["commands"]}
    assert commands == {f"hymeko-x.{name}" for name in re.findall(r'register\("(\w+)"', code)}
    assert {one["command"] for menu in given["menus"].values() for one in menu} <= commands
    settings = {f"hymeko-x.{name}" for name in re.findall(r'getConfiguration\("hymeko-x"\)\.get\("(\w+)"', code)}
    assert settings == {*given["configuration"]["properties"]}


def test_the_extension_runs_verbs_of_the_program() -> None:
    code = (EXTENSION / "extension.js").read_text("utf-8")
    verbs = {*re.findall(r'verb: "(\w+)"', code), *re.findall(r'args: \["(\w+)"\]', code)}
    assert len(verbs) == 3
    assert verbs <= {*VERBS}


@pytest.mark.full
@pytest.mark.usefixtures("node_modules")
def test_the_extension_is_packaged(tmp_path: Path) -> None:
    copy = tmp_path / "vscode"
    shutil.copytree(EXTENSION, copy, ignore=shutil.ignore_patterns("node_modules", "dist", "*.vsix"))
    shutil.copy(ROOT / "LICENSE", copy / "LICENSE")
    (copy / "node_modules").symlink_to(EXTENSION / "node_modules")
    subprocess.run(["npm", "run", "package"], cwd=copy, check=True, capture_output=True, timeout=120)
    with zipfile.ZipFile(copy / "hymeko-x.vsix") as packed:
        names = {*packed.namelist()}
    expected = {"dist/extension.js", "syntaxes/hymeko.tmLanguage.json", "language-configuration.json", "package.json"}
    assert {f"extension/{name}" for name in expected} <= names
    assert not any("node_modules" in name for name in names)


VIEWS = [
    pytest.param("graph", "Graph", ("image/svg+xml", "PHN2ZyB4"), id="graph"),
    pytest.param("picture", "Picture", ("image/png", "iVBORw0K"), id="picture", marks=pytest.mark.full),
]


@pytest.mark.skipif(shutil.which("node") is None, reason="needs node")
@pytest.mark.parametrize(("view", "title", "image"), VIEWS)
def test_a_view_is_drawn_anew_when_a_file_is_saved(view: str, title: str, image: tuple[str, str], tmp_path: Path) -> None:
    program = tmp_path / "hymeko-x"
    program.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m hymeko_x "$@"\n')
    program.chmod(0o755)
    robot = tmp_path / "arm.hymeko"
    robot.write_text("arm : robot { base { mass 1 inertia [1 1 1] shape { box [1 1 1] } } }")
    words = ["node", str(Path(__file__).parent / "drive.js"), str(EXTENSION / "extension.js"), str(program), str(robot), view]
    answer = subprocess.run(words, capture_output=True, text=True, check=True, timeout=120)
    done = json.loads(answer.stdout)
    assert done["server"]["command"] == str(program)
    assert (done["server"]["args"], done["errors"], done["title"]) == (["lsp"], [], f"{title} of arm.hymeko")
    assert re.findall(r"data:(\S+);base64,(\w{8})", done["first"]) == [image]
    assert re.findall(r"data:(\S+);base64,(\w{8})", done["second"]) == [image], "the last picture stays"
    assert "error[HX060]" in done["second"]
    assert "the text ends" in done["second"]
