"""The command line itself: verbs, exit codes, what goes where, and what a user sees when something is wrong."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from hymeko_x import codes, formats, targets
from hymeko_x.cli import GROUPS, VERBS, exits, main, terminal
from hymeko_x.diagnostics import Diagnostic, Origin, Severity, refuse


def hymeko_x(*words: str, stdin: bytes = b"", cwd: Path | None = None, **environ: str) -> subprocess.CompletedProcess[bytes]:
    """Run the program as a user does."""
    here = str(Path(__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": here, "PYTHONWARNINGS": "error", **environ}
    command = [sys.executable, "-m", "hymeko_x", *words]
    return subprocess.run(command, input=stdin, capture_output=True, cwd=cwd, env=environment, timeout=120, check=False)


# ---- verbs ---------------------------------------------------------------------------------------------------------------


def test_help_lists_every_verb_and_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == exits.DONE
    printed = capsys.readouterr().out
    assert [name for name, verb in VERBS.items() if f"  {name:<10} {verb.summary}\n" not in printed] == []
    assert [group for group in GROUPS if f"\n{group}:\n" not in printed] == []
    assert "70 a bug of ours" in printed


def test_no_words_at_all_are_a_usage_error_that_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == exits.USAGE
    assert capsys.readouterr().err.startswith("usage: hymeko-x VERB")


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main([verb, "--help"])
    assert stop.value.code == exits.DONE
    assert capsys.readouterr().out.startswith(f"usage: hymeko-x {verb}")


def test_a_mistyped_verb_is_a_usage_error_with_the_nearest_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["conver", "a", "b"]) == exits.USAGE
    assert capsys.readouterr().err == "hymeko-x: there is no verb 'conver'; did you mean 'convert'?\n"


def test_a_file_in_the_place_of_a_verb_is_met_with_the_verbs_for_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "r.urdf"
    file.write_text("<robot/>")
    assert main([str(file)]) == exits.USAGE
    meant = f"it is a file: 'hymeko-x info {file}' shows what is in it, 'hymeko-x convert {file} OUT' writes another format"
    assert capsys.readouterr().err == f"hymeko-x: there is no verb '{file}'; {meant}\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["formats", "--jsn"], "formats: there is no option '--jsn'; did you mean '--json'? (hymeko-x formats --help lists the options)"),
        (["convert", "--verfy", "a"], "convert: there is no option '--verfy'; did you mean '--verify'?"),
        (["corpus", "run", "--evry", "3"], "corpus: there is no option '--evry'; did you mean '--every'?"),
        (["verify", "a", "b", "--match", "nam"], "verify: --match: there is no 'nam'; did you mean 'name'?"),
        (["dh"], "dh: arguments are required: FILE"),
        (["fmt", "arm.urdf"], "fmt: it is for HyMeKo text, and arm.urdf is urdf; `hymeko-x import arm.urdf` prints it as HyMeKo"),
        (["diff", "a", "b", "c"], "diff: there are more words than it takes: c"),
        (["convert", "a", "b", "--keep", "inside"], "convert: there are more words than it takes: inside; did you mean '--keep=inside'?"),
    ],
)
def test_a_mistake_in_the_options_costs_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == exits.USAGE
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(f"hymeko-x {message}")
    assert printed.err.count("\n") == 1


def test_formats_prints_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formats"]) == exits.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["format", "read", "write", "verify", "suffixes", "title"]
    assert lines[1].split()[:6] == ["hymeko", "yes", "yes", "yes", ".hymeko", ".himeko"]
    assert lines[2].split()[:5] == ["urdf", "yes", "yes", "yes", ".urdf"]


def test_formats_prints_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formats", "--json"]) == exits.DONE
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)}
    assert rows["urdf"] == {
        "name": "urdf",
        "title": "Unified Robot Description Format (ROS)",
        "suffixes": [".urdf"],
        "read": True,
        "write": True,
        "verify": True,
        "targets": [target.name for target in targets.of_format(formats.URDF)],
    }


@pytest.mark.parametrize("word", ["HX044", "hx044", "hx44", "44"])
def test_explain_prints_what_a_code_means(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", word]) == exits.DONE
    assert capsys.readouterr().out.startswith("HX044: a limit is missing\n\nURDF requires <limit>")


def test_explain_without_a_code_lists_all(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain"]) == exits.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines == sorted(lines)
    assert {line.split()[0] for line in lines} == set(codes.CODES)


def test_explaining_an_unknown_code_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "HX999"]) == exits.USAGE
    assert capsys.readouterr().err == "hymeko-x explain: there is no code 'HX999'; `hymeko-x explain` lists all\n"


def test_the_codes_are_a_table_without_doubles() -> None:
    assert len(codes.CODES) == len([name for name in vars(codes) if isinstance(getattr(codes, name), codes.Code)])
    assert all(code.title and code.explanation.endswith(".") for code in codes.CODES.values())


def test_corpus_list_tells_what_is_here(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYMEKO_X_CACHE", str(tmp_path))
    assert main(["corpus", "list"]) == exits.DONE
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["newton", "1.8.0", "8.6", "no", "Apache-2.0"] in [row[:5] for row in rows]


def test_corpus_fetch_of_an_unknown_package_fails_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["corpus", "fetch", "no-such-robot"]) == exits.FAILED
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error[HX211]: the catalogue has no package 'no_such_robot'\n  hint: it has: example_robot_data, ")


def test_corpus_fetch_without_a_network_stops_at_the_first_package(tmp_path: Path) -> None:
    closed = {"PIP_CONFIG_FILE": os.devnull, "PIP_INDEX_URL": "http://127.0.0.1:9/simple", "PIP_RETRIES": "1"}
    run = hymeko_x("corpus", "fetch", "newton", "upkie_description", HYMEKO_X_CACHE=str(tmp_path), **closed)
    assert run.returncode == exits.FAILED
    assert run.stdout == b""
    assert run.stderr.decode() == (
        "error[HX213]: newton==1.8.0 cannot be downloaded: the package index cannot be reached\n"
        "  hint: are you online? what was fetched before stays usable\n"
    )


# ---- what goes wrong -----------------------------------------------------------------------------------------------------


def test_a_refusal_is_one_diagnostic_and_exit_1(capsys: pytest.CaptureFixture[str]) -> None:
    def body() -> int:
        raise refuse(codes.CANNOT_READ, "cannot be read: No such file", Origin("a.urdf", 3), hint="look again")

    assert exits.guarded("import", body) == exits.FAILED
    assert capsys.readouterr().err == "a.urdf:3: error[HX001]: cannot be read: No such file\n  hint: look again\n"


def test_a_bug_is_one_diagnostic_with_its_place_and_exit_70(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("HYMEKO_X_DEBUG", raising=False)
    assert exits.guarded("import", lambda: len(terminal.render(None, True))) == exits.BUG  # type: ignore[arg-type]
    printed = capsys.readouterr().err
    assert printed.startswith("error[HX901]: AttributeError at cli/terminal.py:")
    assert "Traceback" not in printed


def test_a_bug_shows_its_traceback_to_whoever_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYMEKO_X_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        exits.guarded("import", lambda: 1 // 0)


def test_an_interrupt_is_silent(capsys: pytest.CaptureFixture[str]) -> None:
    def body() -> int:
        raise KeyboardInterrupt

    assert exits.guarded("import", body) == exits.INTERRUPTED
    assert capsys.readouterr().err == ""


def test_a_reader_that_leaves_early_is_no_error() -> None:
    program = (
        "import sys; from hymeko_x.cli import exits; sys.exit(exits.guarded('x', lambda: [print('y' * 99) for _ in range(10000)] and 0))"
    )
    run = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=Path(__file__).parents[1])
    assert run.stdout is not None
    assert run.stderr is not None
    run.stdout.readline()
    run.stdout.close()
    assert run.stderr.read() == b""
    assert run.wait(30) == exits.DONE
    run.stderr.close()


# ---- what a diagnostic looks like ----------------------------------------------------------------------------------------


def test_a_diagnostic_in_colour_says_the_same_as_a_plain_one() -> None:
    diagnostic = Diagnostic(
        codes.ZERO_AXIS, Severity.WARNING, "an axis is zero", Origin("a.urdf", 7), hint="say which", excerpt=("  7 | <axis/>",)
    )
    coloured = terminal.render(diagnostic, True)
    assert coloured != str(diagnostic)
    for style in ("1;33", "1;32", "1", "0"):
        coloured = coloured.replace(f"\x1b[{style}m", "")
    assert coloured == str(diagnostic) == terminal.render(diagnostic, False)


def test_a_long_list_of_one_severity_is_cut_and_counted(capsys: pytest.CaptureFixture[str]) -> None:
    terminal.show([Diagnostic(codes.BAD_NUMBER, Severity.WARNING, f"number {'x' * i}") for i in range(50)])
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 41
    assert lines[-1] == "... and 10 more of severity warning (--report FILE.json lists all)"


def test_alike_diagnostics_of_any_severity_are_one_line_with_their_lines(capsys: pytest.CaptureFixture[str]) -> None:
    capsules = [Diagnostic(codes.REWRITTEN, Severity.NOTE, f"shape 'leg/{i}' is a capsule", Origin("a.xml", i + 1)) for i in range(20)]
    other = Diagnostic(codes.REWRITTEN, Severity.NOTE, "shape 'floor' is a plane", Origin("a.xml", 3))
    warnings = [Diagnostic(codes.MISSING_LIMIT, Severity.WARNING, f"joint 'j{i}' has no <limit>", Origin("a.xml", i)) for i in (4, 5)]
    wrong = (("1e", "a"), ("2e", "b"))
    errors = [Diagnostic(codes.BAD_NUMBER, Severity.ERROR, f"mass {mass} is no number", Origin(file, 7)) for mass, file in wrong]
    terminal.show([*capsules[:5], other, *warnings, *capsules[5:], *errors, Diagnostic(codes.BUG, Severity.NOTE, "no place")])
    assert capsys.readouterr().err.splitlines() == [
        "a.xml:1: note[HX101]: shape 'leg/0' is a capsule (19 more alike: lines 2, 3, 4, 5, 6, 7, 8, 9, ...)",
        "a.xml:3: note[HX101]: shape 'floor' is a plane",
        "a.xml:4: warning[HX044]: joint 'j4' has no <limit> (1 more alike: line 5)",
        "a:7: error[HX020]: mass 1e is no number (1 more alike: line b:7)",
        "note[HX901]: no place",
    ]


# ---- how fast it starts --------------------------------------------------------------------------------------------------

HEAVY = ("numpy", "scipy", "mujoco", "pinocchio", "pxr", "trimesh", "rich", "yourdfpy", "xacro", "lxml", "lark")


def test_the_small_verbs_load_nothing_heavy() -> None:
    program = f"import sys; from hymeko_x.cli import main; main(['formats']); main(['explain']); print({{*sys.modules}} & {{*{HEAVY}}})"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=Path(__file__).parents[1], check=True)
    assert run.stdout.splitlines()[-1] == "set()"
