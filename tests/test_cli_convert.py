"""Reading, writing, piping and comparing robots on the command line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import pipeline
from hymeko_x.cli import exits, main
from hymeko_x.compare.ledger import Loss
from hymeko_x.source import Package

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <link name="base">
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
    </inertial>
  </link>
  <link name="tip">
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
    </inertial>
  </link>
  <joint name="elbow" type="revolute">
    <origin xyz="0 0 0.5" rpy="0.1 0.2 0.3"/>
    <parent link="base"/>
    <child link="tip"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="10" velocity="2"/>
  </joint>
</robot>
"""


WARNED = ARM.replace(' velocity="2"', "")
"""The same robot with something to warn about."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with one small robot, `arm.urdf`."""
    (tmp_path / "arm.urdf").write_text(ARM)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def piped(*commands: list[str], stdin: str = "") -> subprocess.CompletedProcess[str]:
    """Run commands of hymeko-x as a pipe; the last one's outcome."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    data = stdin
    for words in commands:
        run = subprocess.run(
            [sys.executable, "-m", "hymeko_x", *words], input=data, capture_output=True, text=True, env=environment, check=False
        )
        data = run.stdout
    return run


# ---- import and export ---------------------------------------------------------------------------------------------------


def test_import_prints_hymeko(folder: Path) -> None:
    run = piped(["import", "arm.urdf"])
    assert (run.returncode, run.stderr) == (exits.DONE, "")
    assert run.stdout.startswith("arm : robot {\n")
    assert hx.loads(run.stdout, "hymeko").mechanism == hx.load("arm.urdf").mechanism


def test_import_into_a_file_prints_what_was_written(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "arm.urdf", "-o", "arm.hymeko"]) == exits.DONE
    assert capfd.readouterr() == ("", "wrote arm.hymeko (2 bodies, 1 joint)\n")
    assert hx.load("arm.hymeko").mechanism == hx.load("arm.urdf").mechanism


def test_a_robot_goes_through_a_pipe_and_comes_back_as_it_was(folder: Path) -> None:
    run = piped(["import", "-"], ["export", "--to", "urdf"], stdin=ARM)
    assert (run.returncode, run.stderr, run.stdout) == (exits.DONE, "", ARM)


def test_import_piped_into_export_is_mjcf(folder: Path) -> None:
    run = piped(["import", "arm.urdf"], ["export", "--to", "mjcf", "--base", "fixed"])
    assert run.returncode == exits.DONE
    assert "error" not in run.stderr
    assert "velocity limit of 1 joint" in run.stderr
    assert run.stdout.startswith('<mujoco model="arm">')


def test_export_takes_the_format_from_the_suffix(folder: Path) -> None:
    assert main(["export", "arm.urdf", "-o", "arm.xml", "--base", "free"]) == exits.DONE
    assert "<freejoint" in (folder / "arm.xml").read_text()


def test_export_without_a_format_is_a_usage_error(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "arm.urdf"]) == exits.USAGE
    assert capsys.readouterr().err == "hymeko-x export: say which format to write: --to FORMAT, or -o FILE with its suffix\n"


# ---- convert -------------------------------------------------------------------------------------------------------------


def test_convert_to_the_same_format_gives_the_same_file(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "arm.urdf", "again.urdf"]) == exits.DONE
    assert (folder / "again.urdf").read_text() == ARM
    assert capfd.readouterr() == ("", "wrote again.urdf (2 bodies, 1 joint)\n")


def test_the_report_names_source_target_diagnostics_and_losses(folder: Path) -> None:
    (folder / "arm.urdf").write_text(WARNED)
    assert main(["convert", "arm.urdf", "arm.hymeko", "--report", "report.json"]) == exits.DONE
    report = json.loads((folder / "report.json").read_text())
    assert report["source"] == {"path": "arm.urdf", "format": "urdf"}
    assert report["target"] == {"path": "arm.hymeko", "format": "hymeko"}
    assert report["losses"] == []
    assert [(item["code"], item["severity"], item["file"], item["line"]) for item in report["diagnostics"]] == [
        ("HX044", "warning", "arm.urdf", 20)
    ]
    assert set(report["diagnostics"][0]) == {"code", "severity", "message", "file", "line", "element", "hint"}


def test_convert_prints_the_same_report_as_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "arm.urdf", "arm.hymeko", "--json", "--report", "report.json"]) == exits.DONE
    assert json.loads(capsys.readouterr().out) == json.loads((folder / "report.json").read_text())


def test_json_and_the_result_do_not_share_standard_output(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "arm.urdf", "-", "--to", "hymeko", "--json"]) == exits.USAGE
    assert capsys.readouterr().out == ""


def test_a_loss_is_measured_by_reading_the_result_back(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    main_file = ARM.replace('effort="10"', 'effort="9"').encode()
    lossy = Package(main_file, with_residue=lambda residue: main_file)
    monkeypatch.setattr(pipeline, "writer", lambda _: lambda mechanism, options, report: lossy)
    assert main(["convert", "arm.urdf", "lossy.xacro", "--json", "--keep=inside"]) == exits.DONE
    printed = capsys.readouterr()
    assert json.loads(printed.out)["losses"] == [
        {
            "element": "joint 'elbow'",
            "target_element": "joint 'elbow'",
            "kind": "joint",
            "field": "dofs[0].limits.effort",
            "aspect": "physics",
            "before": 10,
            "after": 9,
            "unit": "N m",
            "error": 1,
            "fate": "kept",
            "file": "arm.urdf",
            "line": 15,
        }
    ]
    assert printed.err.splitlines() == [
        "wrote lossy.xacro (2 bodies, 1 joint)",
        "kept: effort limit of 1 joint, 1 field or element in all",
        "-v lists each with its place, --report FILE.json has all",
    ]


def test_a_long_value_is_shown_in_one_short_line() -> None:
    loss = Loss("body 'a'", "urdf content", "<a>\n" + "x" * 200, None, "dropped")
    assert str(loss) == f"loss: body 'a' urdf content dropped: <a> {'x' * 116}... -> nothing"
    assert str(Loss("body 'a'", "name", "", "b", "approximated")) == "loss: body 'a' name approximated: '' -> b"


def test_what_our_own_reader_refuses_is_a_bug_and_not_written(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipeline, "writer", lambda _: lambda mechanism, options, report: Package(b"<html/>"))
    assert main(["convert", "arm.urdf", "broken.xacro"]) == exits.BUG
    assert not (folder / "broken.xacro").exists()


@pytest.mark.parametrize(
    ("limit", "warned", "lost", "expected"),
    [
        ("error", True, True, exits.DONE),
        ("loss", True, False, exits.DONE),
        ("loss", False, True, exits.FAIL_ON),
        ("warning", False, False, exits.DONE),
        ("warning", True, False, exits.FAIL_ON),
        ("warning", False, True, exits.FAIL_ON),
    ],
)
@pytest.mark.unread("HX044")
def test_fail_on_stops_at_its_level_and_at_worse(
    limit: str, warned: bool, lost: bool, expected: int, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if warned:
        (folder / "arm.urdf").write_text(WARNED)
    if lost:
        lossy = Package((folder / "arm.urdf").read_text().replace('effort="10"', 'effort="9"').encode())
        monkeypatch.setattr(pipeline, "writer", lambda _: lambda mechanism, options, report: lossy)
    (folder / "out.xacro").write_text("before")
    assert main(["convert", "arm.urdf", "out.xacro", "--fail-on", limit, "--report", "report.json"]) == expected
    assert ((folder / "out.xacro").read_text() == "before") == (expected == exits.FAIL_ON)
    assert (folder / "report.json").exists()


def test_a_broken_input_leaves_the_old_output_alone(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "out.urdf").write_text("before")
    (folder / "broken.urdf").write_text("<<<")
    assert main(["convert", "broken.urdf", "out.urdf"]) == exits.FAILED
    assert (folder / "out.urdf").read_text() == "before"
    assert capsys.readouterr().err.startswith("broken.urdf:")


def test_an_input_that_is_not_there_is_exit_1(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "gone.urdf", "out.urdf"]) == exits.FAILED
    assert capsys.readouterr().err == "gone.urdf: error[HX001]: cannot be read: No such file or directory\n"


def test_an_output_that_cannot_be_written_is_exit_1(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "arm.urdf", "typo/out.urdf"]) == exits.FAILED
    assert capsys.readouterr().err == "typo/out.urdf: error[HX002]: cannot be written: there is no folder 'typo'\n"


@pytest.mark.parametrize(
    "words",
    [
        "convert gone.urdf typo/out.xml",
        "convert gone.urdf out.xml --report typo/out.json",
        "import gone.urdf -o typo/out.hymeko",
        "export gone.hymeko -o typo/out.xml",
        "attach gone.urdf gone.xml -o typo/out.xml",
        "update gone.urdf gone.xml -o arm.urdf/out.urdf",
        "report gone.urdf gone.xml -o arm.urdf/out.html",
        "graph gone.urdf -o arm.urdf/out.svg",
        "render gone.urdf -o arm.urdf/out.png",
        "dynamics gone.urdf -o arm.urdf/out.txt",
        "dynamics gone.urdf --bode typo/out.svg",
        "simulate gone.urdf --figure typo/out.svg",
        "info gone.urdf -o arm.urdf/out.txt",
    ],
)
def test_an_output_that_cannot_be_written_is_reported_before_anything_is_read(
    words: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words.split()) == exits.FAILED
    place = "typo" if "typo" in words else "arm.urdf"
    err = capsys.readouterr().err
    assert err.startswith(f"{place}/out.")
    assert "error[HX002]: cannot be written" in err
    assert "gone" not in err


def test_a_folder_is_no_output(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "out.svg").mkdir()
    assert main(["graph", "gone.urdf", "-o", "out.svg"]) == exits.FAILED
    assert capsys.readouterr().err == "out.svg: error[HX002]: cannot be written: 'out.svg' is a folder\n"


def test_a_format_that_can_only_be_written_is_refused_as_input(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from msgspec.structs import replace

    from hymeko_x import formats

    monkeypatch.setattr(formats, "FORMATS", (formats.HYMEKO, replace(formats.URDF, frontend=None)))
    with pytest.raises(hx.Refusal, match="urdf cannot be read\n  hint: readable: hymeko"):
        hx.load("arm.urdf")


def test_arguments_are_refused_where_the_format_takes_none(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "arm.urdf", "--arg", "side:=left"]) == exits.USAGE
    assert capsys.readouterr().err == "hymeko-x import: --arg is for formats that take arguments, and arm.urdf is urdf\n"


@pytest.mark.parametrize(
    "words", [["--package", "p"], ["--package", "p=nowhere"], ["--arg", "side"], ["--confine", "nowhere"], ["--base", "x"]]
)
def test_options_that_make_no_sense_are_usage_errors(words: list[str], folder: Path) -> None:
    assert main(["import", "arm.urdf", *words]) == exits.USAGE


def test_confined_reading_refuses_a_robot_outside(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "inside").mkdir()
    assert main(["import", "arm.urdf", "--confine", "inside"]) == exits.FAILED
    assert capsys.readouterr().err == "arm.urdf: error[HX001]: the file is outside 'inside', to which reading is confined\n"


# ---- meshes --------------------------------------------------------------------------------------------------------------

CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
TETRAHEDRON = "solid t\n" + "".join(
    "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in face) + "endloop\nendfacet\n"
    for face in (
        (CORNERS[0], CORNERS[2], CORNERS[1]),
        (CORNERS[0], CORNERS[1], CORNERS[3]),
        (CORNERS[0], CORNERS[3], CORNERS[2]),
        (CORNERS[1], CORNERS[2], CORNERS[3]),
    )
)
VISUAL = '<link name="base"><visual><geometry><mesh filename="package://shapes/meshes/t.stl"/></geometry></visual>'


@pytest.fixture
def meshed(folder: Path) -> Path:
    """A working folder whose `arm.urdf` has a mesh of the package `shapes`, which stands far away."""
    (folder / "arm.urdf").write_text(ARM.replace('<link name="base">', VISUAL))
    (folder / "far/shapes/meshes").mkdir(parents=True)
    (folder / "far/shapes/meshes/t.stl").write_text(TETRAHEDRON)
    (folder / "out").mkdir()
    return folder


def test_a_mesh_of_a_package_is_copied_beside_the_output(meshed: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "arm.urdf", "out/arm.xml", "--base", "fixed", "--package", "shapes=far/shapes"]) == exits.DONE
    assert (meshed / "out/meshes/t.stl").exists()
    assert 'file="meshes/t.stl"' in (meshed / "out/arm.xml").read_text()
    capfd.readouterr()
    assert main(["convert", "arm.urdf", "out/arm.hymeko", "--assets", "copy", "--package", "shapes=far/shapes"]) == exits.DONE
    assert "loss" not in capfd.readouterr().err


def test_ros_tells_where_a_package_is(meshed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(meshed / "far"))
    assert main(["convert", "arm.urdf", "out/arm.xml", "--base", "fixed"]) == exits.DONE
    assert (meshed / "out/meshes/t.stl").exists()


def test_a_mesh_that_is_not_found_is_a_warning_and_no_failure(meshed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "arm.urdf", "out/arm.xml", "--base", "fixed"]) == exits.DONE
    assert "warning[HX201]" in capsys.readouterr().err
    assert list((meshed / "out").iterdir()) == [meshed / "out/arm.xml"]


def test_that_a_copied_file_has_another_path_is_no_loss(meshed: Path) -> None:
    (meshed / "arm.urdf").write_text(ARM.replace('<link name="base">', VISUAL.replace("package://shapes", "far/shapes")))
    assert main(["convert", "arm.urdf", "out/arm.hymeko", "--assets", "copy", "--fail-on", "loss"]) == exits.DONE
    assert (meshed / "out/meshes/t.stl").exists()
    assert main(["convert", "arm.urdf", "out/arm.urdf", "--assets", "reference", "--fail-on", "loss"]) == exits.DONE
    assert 'filename="../far/shapes/meshes/t.stl"' in (meshed / "out/arm.urdf").read_text()


def test_standard_output_refers_to_files_where_they_are_and_says_which_it_cannot_carry(
    meshed: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (meshed / "arm.urdf").write_text(ARM.replace('<link name="base">', VISUAL.replace("package://shapes", "far/shapes")))
    assert main(["export", "arm.urdf", "--to", "urdf"]) == exits.DONE
    printed = capfd.readouterr()
    assert 'filename="far/shapes/meshes/t.stl"' in printed.out
    assert printed.err == ""
    assert main(["export", "arm.urdf", "--to", "mjcf", "--base", "fixed"]) == exits.DONE
    assert "warning[HX204]: standard output cannot carry meshes/t.stl\n" in capfd.readouterr().err
    assert sorted(path.name for path in meshed.iterdir()) == ["arm.urdf", "far", "out"]


def test_the_format_can_be_given_where_name_and_content_mislead(folder: Path) -> None:
    (folder / "arm.hymeko").write_text(ARM)
    assert main(["info", "arm.hymeko"]) == exits.FAILED
    assert main(["info", "arm.hymeko", "--from", "urdf"]) == exits.DONE


def test_diagnostics_go_to_standard_error_with_their_place(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (folder / "arm.urdf").write_text(WARNED)
    assert main(["import", "arm.urdf"]) == exits.DONE
    printed = capfd.readouterr()
    assert printed.err.startswith("arm.urdf:20: warning[HX044]: ")
    assert "HX044" not in printed.out


def test_what_vanishes_is_dropped_and_what_changes_is_approximated(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lossy = Package(
        ARM.replace('<link name="tip">', '<link name="tip"><visual><geometry><sphere radius="1"/></geometry></visual>').encode()
    )
    monkeypatch.setattr(pipeline, "writer", lambda _: lambda mechanism, options, report: lossy)
    assert [loss.fate for loss in hx.convert("arm.urdf", "more.xacro").losses or ()] == ["approximated"]
    (folder / "arm.urdf").write_bytes(lossy.main)
    monkeypatch.setattr(pipeline, "writer", lambda _: lambda mechanism, options, report: Package(ARM.encode()))
    assert [loss.fate for loss in hx.convert("arm.urdf", "less.xacro").losses or ()] == ["dropped"]


# ---- diff and info -------------------------------------------------------------------------------------------------------


def test_equal_robots_have_no_differences_whatever_their_formats(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["import", "arm.urdf", "-o", "arm.hymeko"])
    assert main(["diff", "arm.urdf", "arm.hymeko"]) == exits.DONE
    assert capsys.readouterr().out == ""


def test_different_robots_are_exit_4_with_one_line_per_difference(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "other.urdf").write_text(ARM.replace('mass value="1"', 'mass value="1.5"').replace('effort="10"', 'effort="9"'))
    assert main(["diff", "arm.urdf", "other.urdf"]) == exits.DIFFERENT
    assert capsys.readouterr().out.splitlines() == ["body 'tip' inertial.mass: 1 -> 1.5", "joint 'elbow' dofs[0].limits.effort: 10 -> 9"]
    assert main(["diff", "arm.urdf", "other.urdf", "--json"]) == exits.DIFFERENT
    assert json.loads(capsys.readouterr().out) == {
        "a": {"path": "arm.urdf", "format": "urdf"},
        "b": {"path": "other.urdf", "format": "urdf"},
        "differences": [
            {"element": "body 'tip'", "field": "inertial.mass", "before": "1", "after": "1.5"},
            {"element": "joint 'elbow'", "field": "dofs[0].limits.effort", "before": "10", "after": "9"},
        ],
    }


def test_a_tolerance_makes_near_robots_equal(folder: Path) -> None:
    (folder / "near.urdf").write_text(ARM.replace('mass value="1"', 'mass value="1.001"'))
    assert main(["diff", "arm.urdf", "near.urdf"]) == exits.DIFFERENT
    assert main(["diff", "arm.urdf", "near.urdf", "--tolerance", "0.01"]) == exits.DONE


def test_info_says_what_is_in_a_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", "arm.urdf", "--json"]) == exits.DONE
    assert json.loads(capsys.readouterr().out) == {
        "file": "arm.urdf",
        "format": "urdf",
        "name": "arm",
        "bodies": 2,
        "mass": 3.0,
        "no inertial": 0,
        "joints": {"hinge": 1},
        "dofs": 1,
        "bases": {"base": "open"},
        "depth": 1,
        "also": {},
        "extras": {},
    }
    assert main(["info", "arm.urdf"]) == exits.DONE
    assert "bases        base (open)\n" in capsys.readouterr().out
