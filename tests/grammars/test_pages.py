"""What language models are given to read: short, true, and with commands that run."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.cli import VERBS, exits, main
from hymeko_x.diagnostics import Report
from hymeko_x.language.parser import parse
from tests.grammars.masks import accepts

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "hymeko_x/language/models"
CARD = (FOLDER / "card.md").read_text("utf-8")
SKILL = (FOLDER / "SKILL.md").read_text("utf-8")
(LISTING,) = re.findall(r"```hymeko\n(.*?)```", CARD, re.DOTALL)
COMMANDS = re.findall(r"```sh\n(.*?)```", SKILL, re.DOTALL)[0].splitlines()


def tokens(text: str) -> int:
    """About as many as a tokenizer finds: words of up to six letters, each digit and each sign."""
    return len(re.findall(r"[A-Za-z]{1,6}|\d|[^\sA-Za-z\d]", text))


def test_the_card_has_at_most_1500_tokens() -> None:
    assert tokens(CARD) <= 1500
    assert len(CARD.split()) * 1.4 <= 1500


def test_the_robot_of_the_card_is_read_in_silence_and_is_of_the_grammar() -> None:
    report = Report()
    robot = hx.loads(LISTING, "hymeko", report=report).mechanism
    assert [str(one) for one in report] == []
    assert {key.name: len(view.joint.dofs) for key, view in robot.joints.items()} == {"shoulder": 1, "slide": 1}
    assert accepts("llguidance", LISTING)


def test_the_forms_that_the_card_names_are_read() -> None:
    bodies = "".join(f"b{number} {{}} " for number in range(10))
    words = ("revolute", "continuous", "prismatic", "fixed", "floating", "ball", "screw")
    joints = "".join(f"@j{number} : {word} {{ [0 0 1] + b{number} - b{number + 1} }} " for number, word in enumerate(words))
    mimic = "@k : revolute { + b7 - b8 axis=-Z [0.1 2] mimic - j0 } "
    shapes = "s { shape { capsule [0.1 0.2] } visual { sphere 5cm rgba [1 0 0 1] } inertia [1 1 1 0 0 0] mass 1 } "
    template = "leg(len=0.3) : link { mass 1 shape { box [${len} 0.05 0.05] } } left : leg(len=0.4) {} "
    text = f"r : robot {{ {bodies}{joints}{mimic}{shapes}{template}}}"
    assert len(hx.loads(text, "hymeko").mechanism.joints) == 8
    parse(text)


def test_the_commands_of_the_skill_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    text = LISTING.replace('visual { mesh "meshes/hand.stl" }', "visual { sphere 50mm }")
    hx.dump(hx.loads(text, "hymeko"), "arm.urdf")
    for command in COMMANDS:
        program, *words = shlex.split(command)
        assert program == "hymeko-x"
        assert main(words) in (exits.DONE, exits.DIFFERENT), command
    capsys.readouterr()


def test_the_pages_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["skill"]) == exits.DONE
    assert capsys.readouterr().out == SKILL
    assert main(["skill", "--card"]) == exits.DONE
    assert capsys.readouterr().out == CARD


def test_the_pages_name_verbs_and_files_that_exist() -> None:
    llms = (ROOT / "llms.txt").read_text("utf-8")
    page = (ROOT / "docs/llms.md").read_text("utf-8")
    assert [path for path in re.findall(r"\]\(([^)]+)\)", llms) if not (ROOT / path).is_file()] == []
    named = set(re.findall(r"hymeko-x ([a-z]+)", f"{CARD}{SKILL}{llms}{page}"))
    assert named <= {*VERBS, "prints"}
