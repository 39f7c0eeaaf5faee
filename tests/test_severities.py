"""Each code has a severity for a reason, and errors end the command with nothing written."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from hymeko_x import codes
from hymeko_x.cli import exits, main
from hymeko_x.diagnostics import Code, Refusal, Report, Severity, Stopped
from hymeko_x.severities import ERRORS, NOTES, WARNINGS, reasons

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

ROOT = Path(__file__).parents[1] / "hymeko_x"
VERBS = {"error": Severity.ERROR, "refuse": Severity.ERROR, "warn": Severity.WARNING, "note": Severity.NOTE}
TABLES = {Severity.ERROR: ERRORS, Severity.WARNING: WARNINGS, Severity.NOTE: NOTES}


def uses() -> Mapping[Code, set[Severity]]:
    """With which severities the program makes diagnostics of each code, as far as the calls name both."""
    found: dict[Code, set[Severity]] = defaultdict(set)
    for path in ROOT.rglob("*.py"):
        for call in ast.walk(ast.parse(path.read_text())):
            if isinstance(call, ast.Call):
                name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
                for code in _codes_in(call):
                    if name in VERBS:
                        found[code].add(VERBS[name])
    return found


def _codes_in(call: ast.Call) -> Iterator[Code]:
    for argument in call.args[:2]:
        for node in ast.walk(argument):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "codes":
                yield getattr(codes, node.attr)


def test_every_severity_of_a_code_is_justified() -> None:
    missing = [(code.id, severity.value) for code, severities in uses().items() for severity in severities if code not in TABLES[severity]]
    assert missing == []


def test_every_code_has_a_reason_that_explain_prints(capsys: pytest.CaptureFixture[str]) -> None:
    for code in codes.CODES.values():
        assert list(reasons(code)), code.id
        assert main(["explain", code.id]) == exits.DONE
        text = " ".join(capsys.readouterr().out.split())
        assert [reason for severity, reason in reasons(code) if f"{severity.value}: {reason}" not in text] == []


# ---- errors stop -------------------------------------------------------------------------------------------------------------

ROBOT = '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="{type}"><parent link="a"/><child link="b"/></joint></robot>'
WRONG = ROBOT.format(type="revolut")
MESSAGE = "joint 'j' has type 'revolut', which is kept as written; read as fixed; known: "


@pytest.fixture
def wrong(tmp_path: Path) -> Path:
    path = tmp_path / "wrong.urdf"
    path.write_text(WRONG)
    return path


@pytest.mark.parametrize(
    "words",
    [
        ["convert", "{file}", "{out}"],
        ["import", "{file}", "-o", "{out}"],
        ["import", "{file}"],
        ["info", "{file}"],
        ["diff", "{file}", "{file}"],
    ],
)
def test_an_error_ends_the_command_with_exit_1_and_nothing_written(
    words: list[str], wrong: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = wrong.with_name("out.xml")
    assert main([word.format(file=wrong, out=out) for word in words]) == exits.FAILED
    printed = capsys.readouterr()
    assert printed.out == ""
    assert f"{wrong}:1: error[HX027]: {MESSAGE}" in printed.err
    assert printed.err.endswith(f"hymeko-x {words[0]}: stopped by errors, nothing was written; --lenient goes on with what they say\n")
    assert not out.exists()


def test_lenient_goes_on_and_says_so(wrong: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = wrong.with_name("out.xml")
    assert main(["convert", str(wrong), str(out), "--lenient"]) == exits.DONE
    printed = capsys.readouterr().err
    assert f"{wrong}:1: error[HX027]: {MESSAGE}" in printed
    assert "warning[HX009]: one error was passed over, as asked: the result is not what the input means" in printed
    assert out.is_file()


def test_every_diagnostic_is_shown_before_the_command_ends(wrong: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong.write_text(WRONG.replace('name="r"', ""))
    assert main(["info", str(wrong)]) == exits.FAILED
    shown = capsys.readouterr().err.splitlines()[:2]
    assert [line.partition(": ")[2].partition(":")[0] for line in shown] == ["warning[HX022]", "error[HX027]"]


def test_loading_an_error_raises_and_lenient_does_not(wrong: Path) -> None:
    for load in (lambda **how: hx.load(wrong, **how).mechanism, lambda **how: hx.loads(WRONG, "urdf", **how).mechanism):  # type: ignore[misc]
        with pytest.raises(Stopped, match="read as fixed") as caught:
            load()
        assert caught.value.diagnostic.code == codes.UNKNOWN_WORD
        report = Report()
        assert len(load(report=report, lenient=True).joints) == 1
        assert [diagnostic.code.id for diagnostic in report] == ["HX027", "HX009"]
    with pytest.raises(Refusal):
        hx.convert(wrong, wrong.with_name("out.xml"))
    assert not wrong.with_name("out.xml").exists()
    report = hx.convert(wrong, wrong.with_name("out.xml"), lenient=True).report
    assert [diagnostic.code.id for diagnostic in report][:2] == ["HX027", "HX009"]


def test_all_errors_are_in_the_message_of_the_exception() -> None:
    text = WRONG.replace("</robot>", '<link name="a"/></robot>')
    with pytest.raises(Stopped) as caught:
        hx.loads(text, "urdf")
    assert [line.partition("error[")[2][:5] for line in str(caught.value).splitlines()] == ["HX023", "HX027"]


# ---- what is an error, and what is only odd ----------------------------------------------------------------------------------


@pytest.mark.parametrize("text", [WRONG[:-20], WRONG.replace("</link>", "").replace("/><link", "><link"), "<robot name='r'"])
@pytest.mark.unread("HX005", "HX010")
def test_xml_that_is_cut_off_or_not_well_formed_is_an_error(text: str) -> None:
    with pytest.raises(Refusal) as caught:
        hx.loads(text.replace("revolut", "fixed"), "urdf")
    assert caught.value.diagnostic.code in (codes.NOT_WELL_FORMED, codes.NOT_XML)


@pytest.mark.parametrize("blank", ["\xa0", "\u202f", "\u2003", "\xa0\xa0 "])
@pytest.mark.unread("HX005")
def test_no_break_spaces_between_attributes_are_white_space_with_a_warning(blank: str) -> None:
    clean = '<robot name="r"><link name="a b"><visual><geometry><sphere radius="0.1" /></geometry></visual></link ></robot>'
    report = Report()
    copied = clean.replace(" n", f"{blank}n").replace(" r", f"{blank}r").replace(" /", f"{blank}/").replace(" >", f"{blank}>")
    assert hx.loads(copied, report=report).mechanism.graph == hx.loads(clean, "urdf").mechanism.graph
    assert [str(diagnostic) for diagnostic in report] == [
        "<text>:1:7: warning[HX005]: no-break or other typographic spaces between attributes; read as spaces"
    ]


@pytest.mark.unread("HX005")
def test_a_no_break_space_within_a_name_stays() -> None:
    [body] = hx.loads('<robot name="r"><link\xa0name="a\xa0b"/></robot>', "urdf").mechanism.roots
    assert body.name == "a\xa0b"


def test_a_robot_without_links_is_an_error() -> None:
    with pytest.raises(Stopped, match="the robot has no links"):
        hx.loads('<robot name="r"/>', "urdf")


def test_a_parent_called_world_needs_no_definition() -> None:
    report = Report()
    hx.loads(ROBOT.format(type="fixed").replace('<parent link="a"/>', '<parent link="world"/>'), "urdf", report=report)
    assert [(diagnostic.severity, diagnostic.code) for diagnostic in report][:1] == [(Severity.WARNING, codes.UNDEFINED_REFERENCE)]
