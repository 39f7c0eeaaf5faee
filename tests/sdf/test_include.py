"""<include>: models of other files, in the place where they are included."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report

PART = '<sdf version="1.7"><model name="part"><link name="l"><pose>0 0 1 0 0 0</pose></link><link name="k"/></model></sdf>'


def load(tmp_path: Path, inside: str) -> tuple[hx.Mechanism, list[str]]:
    """The robot of a file beside a folder `part` with a model, and the codes of what was reported."""
    folder = tmp_path / "part"
    folder.mkdir(exist_ok=True)
    (folder / "model.config").write_text('<model><sdf version="1.4">old.sdf</sdf><sdf version="1.7">part.sdf</sdf></model>', "utf-8")
    (folder / "part.sdf").write_text(PART, "utf-8")
    (tmp_path / "r.sdf").write_text(f'<sdf version="1.9"><model name="r"><link name="a"/>{inside}</model></sdf>', "utf-8")
    report = Report()
    robot = hx.load(str(tmp_path / "r.sdf"), report=report, lenient=True).mechanism
    return robot, [diagnostic.code.id for diagnostic in report if diagnostic.code.id != "HX009"]  # which says that reading went on


@pytest.mark.parametrize("uri", ["model://part", "model://part/", "part", "part/", "part/part.sdf", "package://part/part.sdf"])
def test_a_model_is_found_by_folder_and_by_file(tmp_path: Path, uri: str) -> None:
    robot, codes = load(tmp_path, f"<include><uri>{uri}</uri><name>p</name><pose>1 0 0 0 0 0</pose></include>")
    assert codes == []
    poses = {joint.child.name: joint.parent_pose.xyz for joint in robot.joints.values()}
    assert poses == {"a": (0.0, 0.0, 0.0), "p::l": (1.0, 0.0, 1.0), "p::k": (1.0, 0.0, 0.0)}


def test_a_merged_model_has_no_scope(tmp_path: Path) -> None:
    robot, codes = load(tmp_path, '<include merge="true"><uri>part</uri><pose>1 0 0 0 0 0</pose></include>')
    assert codes == []
    poses = {joint.child.name: joint.parent_pose.xyz for joint in robot.joints.values()}
    assert poses == {"a": (0.0, 0.0, 0.0), "l": (1.0, 0.0, 1.0), "k": (1.0, 0.0, 0.0)}


@pytest.mark.parametrize("uri", ["https://fuel.gazebosim.org/1.0/a/models/b", "nowhere", "model://../..", ""])
def test_what_is_not_there_is_reported_and_kept(tmp_path: Path, uri: str) -> None:
    robot, codes = load(tmp_path, f"<include><uri>{uri}</uri></include>")
    assert codes == ["HX053"]
    assert any("<include>" in extra.text for extras in robot.extras.values() for extra in extras)


def test_a_folder_without_a_config_is_reported(tmp_path: Path) -> None:
    """Source: libsdformat: Could not find model.config or manifest.xml."""
    (tmp_path / "bare").mkdir()
    (tmp_path / "bare" / "model.sdf").write_text(PART, "utf-8")
    robot, codes = load(tmp_path, "<include><uri>model://bare</uri><name>p</name></include>")
    assert codes == ["HX045"]
    assert "p::l" in [key.name for key in robot.graph.vertices]


def test_a_placement_frame_without_a_pose_is_reported(tmp_path: Path) -> None:
    """Source: libsdformat: <pose> is required when specifying the placement_frame element."""
    _, codes = load(tmp_path, "<include><uri>part</uri><placement_frame>l</placement_frame></include>")
    assert codes == ["HX045"]


def test_what_an_include_says_besides_is_kept_in_its_model(tmp_path: Path) -> None:
    params = '<experimental:params xmlns:experimental="y"><link element_id="l" action="remove"/></experimental:params>'
    robot, codes = load(tmp_path, f'<include><uri>part</uri><a:b xmlns:a="x">1</a:b>{params}</include>')
    assert codes == ["HX027"]
    texts = [extra.text for extras in robot.extras.values() for extra in extras]
    assert '<a:b xmlns:a="x">1</a:b>' in texts
    assert params in texts


def test_drake_finds_models_that_included_models_include(tmp_path: Path) -> None:
    pytest.importorskip("pydrake")
    outer = '<sdf version="1.9"><model name="outer"><include><uri>model://part/</uri></include></model></sdf>'
    (tmp_path / "outer").mkdir()
    (tmp_path / "outer" / "model.config").write_text('<model><sdf version="1.9">model.sdf</sdf></model>', "utf-8")
    (tmp_path / "outer" / "model.sdf").write_text(outer, "utf-8")
    robot, codes = load(tmp_path, "<include><uri>model://outer</uri></include>")
    assert codes == []
    verdict = hx.verify(tmp_path / "r.sdf", robot, samples=5)
    assert verdict.is_same, [*verdict.failed, verdict.reason]


def test_a_model_that_includes_itself_is_reported(tmp_path: Path) -> None:
    (tmp_path / "part").mkdir()
    (tmp_path / "loop.sdf").write_text('<sdf version="1.9"><model name="m"><include><uri>loop.sdf</uri></include></model></sdf>', "utf-8")
    _, codes = load(tmp_path, "<include><uri>loop.sdf</uri></include>")
    assert codes == ["HX043"]


def test_frames_in_a_circle_are_reported(tmp_path: Path) -> None:
    circle = '<link name="x"><pose relative_to="y"/></link><link name="y"><pose relative_to="x"/></link>'
    _, codes = load(tmp_path, circle)
    assert codes == ["HX043"]


def test_files_that_include_each_other_twice_end_at_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hymeko_x.frontends.sdf.include.MOST_FILES", 50)
    for number in range(20):
        inside = f"<include><uri>{number + 1}.sdf</uri></include>" * 2
        (tmp_path / f"{number}.sdf").write_text(f'<sdf version="1.9"><model name="m"><link name="l"/>{inside}</model></sdf>', "utf-8")
    (tmp_path / "20.sdf").write_text('<sdf version="1.9"><model name="m"><link name="l"/></model></sdf>', "utf-8")
    report = Report()
    hx.load(tmp_path / "0.sdf", report=report, lenient=True)
    assert "HX007" in [diagnostic.code.id for diagnostic in report]
