"""A format is one row: a toy format of a dozen lines goes through every verb without any other edit."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

import hymeko_x as hx
from hymeko_x import formats
from hymeko_x.cli import exits, main
from hymeko_x.corpus.lengths import lengths
from hymeko_x.diagnostics import Report
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism, joint_edge
from hymeko_x.ir.parts import Body, Joint
from hymeko_x.rewrite import Options
from hymeko_x.source import Package, Reading, Source

ARM = "arm\nbase upper\nupper fore\n"


def read(source: Source, report: Report) -> Reading:
    """The name in the first line, then a fixed joint per line: parent and child."""
    name, *lines = source.data.decode().splitlines()
    pairs = [line.split() for line in lines if line and not line.startswith("#")]
    bodies = {Id("body", body): Body() for pair in pairs for body in pair}
    joints = {Id("joint", b): joint_edge(Joint(), Id("body", a), Id("body", b)) for a, b in pairs}
    carried = "".join(line.removeprefix("#") + "\n" for line in lines if line.startswith("#"))
    return Reading(Mechanism(name, Hypergraph(bodies, joints)), carried)


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """Bodies and joints only."""
    lines = [mechanism.name, *(f"{view.parent.name} {view.child.name}" for view in mechanism.joints.values())]
    return Package(_text(lines), with_residue=lambda residue: _text([*lines, *(f"#{line}" for line in residue.splitlines())]))


def _text(lines: list[str]) -> bytes:
    return "".join(f"{line}\n" for line in lines).encode()


@pytest.fixture(autouse=True)
def toy(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """The format in the table, and a folder with a robot in it and one in URDF."""
    module = ModuleType("toy_format")
    module.read, module.write = read, write  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "toy_format", module)
    row = formats.Format("toy", "Toy pairs", (".toy",), "toy_format", "toy_format")
    monkeypatch.setattr(formats, "FORMATS", (*formats.FORMATS, row))
    monkeypatch.chdir(tmp_path)
    Path("arm.toy").write_text(ARM)
    joint = '<joint name="{1}" type="{2}"><parent link="{0}"/><child link="{1}"/></joint>'
    joints = joint.format("base", "upper", "continuous") + joint.format("upper", "fore", "fixed")
    Path("arm.urdf").write_text(f'<robot name="arm"><link name="base"/><link name="upper"/><link name="fore"/>{joints}</robot>')
    return tmp_path


def test_it_is_imported_and_exported(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "arm.toy", "-o", "arm.hymeko"]) == exits.DONE
    assert main(["export", "arm.hymeko", "--to", "toy"]) == exits.DONE
    assert capsys.readouterr().out == ARM


def test_its_losses_are_measured_and_kept_and_restored(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "arm.urdf", "out.toy", "--json", "--keep=inside"]) == exits.DONE
    losses = json.loads(capsys.readouterr().out)["losses"]
    assert [(loss["element"], loss["field"], loss["fate"]) for loss in losses] == [("joint 'upper'", "dofs[0]", "kept")]
    assert Path("out.toy").read_text().startswith("arm\nbase upper\nupper fore\n#kept : residue {\n")
    assert hx.load("out.toy").mechanism == hx.load("arm.urdf").mechanism
    arm = Path("arm.urdf").read_text()
    Path("more.urdf").write_text(arm.replace("<link", "<plugin/><link", 1))
    assert {(loss.element, loss.field) for loss in hx.convert("more.urdf", "more.toy").losses or ()} == {
        ("joint 'upper'", "dofs[0]"),
        ("mechanism", "urdf content"),
    }
    hx.convert("arm.urdf", "clean.toy")
    assert Path("clean.toy").read_text() == ARM


def test_it_is_compared(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diff", "arm.toy", "arm.urdf"]) == exits.DIFFERENT
    assert "joint 'upper' dofs[0]: added" in capsys.readouterr().out
    assert main(["diff", "arm.toy", "arm.toy"]) == exits.DONE


def test_the_verifier_names_the_missing_reference_reader(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", "arm.toy", "arm.urdf"]) == exits.FAILED
    assert "toy" in capsys.readouterr().err


def test_its_length_is_counted() -> None:
    found = lengths(ARM.encode(), "toy")
    assert (found.bytes, found.code, found.tokens) == (26, 21, 5)


def test_the_command_line_lists_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formats"]) == exits.DONE
    assert capsys.readouterr().out.partition("\n\n")[0].splitlines()[-1].split() == ["toy", "yes", "yes", "no", ".toy", "Toy", "pairs"]
    assert main(["formats", "--json"]) == exits.DONE
    assert json.loads(capsys.readouterr().out)[-1]["name"] == "toy"
    assert main(["convert", "arm.toy", "arm.step"]) == exits.FAILED
    assert ".toy" in capsys.readouterr().err
