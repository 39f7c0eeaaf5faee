"""What every verb has in common: where it prints, how much, in which colours, and how a shell completes it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hymeko_x.cli import VERBS, exits, main, parser_of
from hymeko_x.cli.terminal import is_coloured
from hymeko_x.codes import CODES

ROOT = Path(__file__).parents[2]
ARM = """<robot name="arm"><link name="base"/><link name="tip"/>
  <joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/></joint></robot>"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arm.urdf").write_text(ARM)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_one_robot_without_a_place_goes_to_standard_output(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "arm.urdf", "--to", "mjcf", "--lenient", "-q"]) == exits.DONE
    printed = capfd.readouterr().out
    assert main(["convert", "arm.urdf", "-o", "arm.xml", "--lenient", "-q"]) == exits.DONE
    assert (folder / "arm.xml").read_text().endswith(printed)  # a file begins with what made it
    assert printed.startswith("<mujoco")


@pytest.mark.parametrize("verb", [verb for verb in VERBS if verb not in ("corpus", "completion")])
def test_every_verb_takes_a_place_for_what_it_prints_and_a_choice_of_colours(verb: str) -> None:
    options = parser_of(verb)._option_string_actions
    assert {"-o", "--output", "--color"} <= {*options}


def test_what_a_verb_prints_goes_into_a_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", "arm.urdf", "--lenient", "-q"]) == exits.DONE
    printed = capsys.readouterr().out
    assert main(["info", "arm.urdf", "--lenient", "-q", "-o", "info.txt"]) == exits.DONE
    assert capsys.readouterr().out == ""
    assert (folder / "info.txt").read_text() == printed


def test_quiet_shows_errors_alone_and_verbose_shows_each_place(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    twice = ARM.replace(
        "</robot>", "".join(f'<joint name="j{i}" type="revolute"><parent link="base"/><child link="l{i}"/></joint>' for i in (1, 2))
    )
    (folder / "arm.urdf").write_text(twice + '<link name="l1"/><link name="l2"/></robot>')
    printed = {}
    for option in ("-q", "-v", "--color=auto"):
        assert main(["info", "arm.urdf", "--lenient", option]) == exits.DONE
        printed[option] = capsys.readouterr().err.splitlines()
    assert {line.split(": ")[1].partition("[")[0] for line in printed["-q"] if ": " in line and line.startswith("arm")} <= {"error"}
    assert len(printed["-q"]) < len(printed["--color=auto"]) < len(printed["-v"])


def test_colours_can_be_forced_and_forbidden(folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    assert not is_coloured(sys.stderr)
    assert main(["info", "arm.urdf", "--lenient", "--color", "always"]) == exits.DONE
    assert "\x1b[" in capsys.readouterr().err
    assert main(["info", "arm.urdf", "--lenient", "--color", "never"]) == exits.DONE
    assert "\x1b[" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("hymeko-x con", {"convert"}),
        ("hymeko-x convert --ver", {"--verbose", "--verify"}),
        ("hymeko-x convert --to mj", {"mjcf"}),
        ("hymeko-x corpus st", {"stats"}),
        ("hymeko-x convert --base ", {"fixed", "free"}),
        ("hymeko-x convert arm.urdf --for mj", {"mjx"}),
        ("hymeko-x explain HX04", {f"HX04{digit}" for digit in range(10) if f"HX04{digit}" in CODES}),
        ("hymeko-x verify ar", {"arm.urdf"}),
    ],
)
def test_a_shell_is_told_how_the_words_go_on(line: str, expected: set[str], folder: Path) -> None:
    pytest.importorskip("argcomplete")
    answers = folder / "answers"
    asked = {"COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE": "1", "_ARGCOMPLETE_STDOUT_FILENAME": str(answers)}
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "_ARGCOMPLETE_IFS": "\n", **asked}
    subprocess.run([sys.executable, "-m", "hymeko_x"], env=environment, cwd=folder, timeout=60, check=False)
    assert {word.strip() for word in answers.read_text().split("\n")} == expected


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_text_for_a_shell_names_the_program(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("argcomplete")
    assert main(["completion", shell]) == exits.DONE
    printed = capsys.readouterr().out
    assert "hymeko-x" in printed
    if shell == "bash":
        subprocess.run(["bash", "-n"], input=printed, text=True, check=True)
