"""`<inertial auto="true">`: what the collisions weigh, meshes among them, where the robot goes to another format."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh

import hymeko_x as hx
from hymeko_x.ir.parts import Body

MODEL = """<sdf version="1.12"><model name="m"><link name="a"><inertial auto="true">{}</inertial>
<collision name="c"><pose>0.5 0 0 0 0 0</pose><density>500</density>
<geometry><mesh><uri>box.stl</uri><scale>2 1 1</scale></mesh></geometry></collision>
<collision name="d"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link></model></sdf>"""
BALL = 4.0 / 3.0 * 3.141592653589793 * 0.1**3


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    trimesh.creation.box((1.0, 2.0, 3.0)).export(tmp_path / "box.stl")
    return tmp_path


def converted(folder: Path, content: str, target: str) -> hx.Robot:
    (folder / "m.sdf").write_text(MODEL.format(content), "utf-8")
    hx.convert(folder / "m.sdf", folder / target)
    return hx.load(folder / target)


def test_a_mesh_weighs_its_volume(folder: Path) -> None:
    inertial = next(converted(folder, "", "m.urdf").mechanism.vertices(Body))[1].inertial
    assert inertial is not None
    assert inertial.mass == pytest.approx(500.0 * 12.0 + 1000.0 * BALL, rel=1e-6)
    assert inertial.com[0] == pytest.approx(500.0 * 12.0 * 0.5 / (500.0 * 12.0 + 1000.0 * BALL), rel=1e-6)


@pytest.mark.parametrize("target", ["m.xml", "m.hymeko", "m.json"])
def test_every_format_has_the_same_mass(folder: Path, target: str) -> None:
    verdict = hx.verify(converted(folder, "", "m.urdf"), converted(folder, "", target))
    assert verdict.is_same, verdict.failed


def test_a_mass_of_the_author_counts(folder: Path) -> None:
    inertial = next(converted(folder, "<mass>3</mass>", "m.urdf").mechanism.vertices(Body))[1].inertial
    assert inertial is not None
    assert inertial.mass == pytest.approx(3.0)


def test_collisions_without_weight_have_no_inertial(folder: Path) -> None:
    text = MODEL.format("<mass>3</mass>").replace("<density>500</density>", "<density>0</density>")
    (folder / "m.sdf").write_text(text[: text.index('<collision name="d">')] + "</link></model></sdf>", "utf-8")
    hx.convert(folder / "m.sdf", folder / "m.urdf")
    assert "<inertial" not in (folder / "m.urdf").read_text("utf-8").partition("<gazebo")[0]


def test_an_inertial_that_is_not_finite_is_refused(folder: Path) -> None:
    (folder / "m.sdf").write_text(MODEL.format("").replace("500", "1e308"), "utf-8")
    with pytest.raises(hx.Refusal, match="body 'a': the inertial of its collisions is not finite"):
        hx.convert(folder / "m.sdf", folder / "m.urdf")
    assert not (folder / "m.urdf").exists()


@pytest.mark.unread("HX103", "HX201")
def test_a_mesh_that_is_not_there_is_reported(folder: Path) -> None:
    (folder / "box.stl").unlink()
    (folder / "m.sdf").write_text(MODEL.format(""), "utf-8")
    report = hx.convert(folder / "m.sdf", folder / "m.urdf").report
    assert [item.message.split(";")[0] for item in report if item.code.id == "HX103"] == ["mesh 'box' is flat, missing or unreadable"]


@pytest.mark.parametrize("keep", ["beside", "inside"])
def test_it_is_computed_again_on_the_way_home(folder: Path, keep: str) -> None:
    (folder / "m.sdf").write_text(MODEL.format(""), "utf-8")
    hx.convert(folder / "m.sdf", folder / "m.urdf", keep=keep)  # type: ignore[arg-type]
    hx.convert(folder / "m.urdf", folder / "home.sdf")
    text = (folder / "home.sdf").read_text("utf-8")
    assert '<inertial auto="true"></inertial>' in text
    assert "<mass>" not in text
