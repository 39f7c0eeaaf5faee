"""An engine that crashes costs a diagnostic, not the program."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal
from hymeko_x.verify.model import KinematicModel
from hymeko_x.verify.readers import apart
from hymeko_x.verify.readers.lookup import Lookup

BOX = "<link name='l{}'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision></link>"
PLANE = "<link name='floor'><collision name='c'><geometry><plane><size>4 4</size></plane></geometry></collision></link>"


def read(text: str) -> KinematicModel:
    Path("robot.sdf").write_text(text, "utf-8")
    return apart.read("tests.verify.crashing_reader", "the engine", Path("robot.sdf"), Lookup({"p": Path("p")}))


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_crash_is_a_refusal_and_the_next_file_is_read() -> None:
    for _ in range(2):
        with pytest.raises(Refusal) as caught:
            read("crash")
        assert str(caught.value) == "robot.sdf: error[HX302]: the engine ended with signal 11 (SIGSEGV) while it read robot.sdf"
        assert read("fine").name == "robot1"


def test_the_reader_has_the_environment_of_the_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROBOT", "arm")
    assert read("fine").name == "arm1"
    monkeypatch.delenv("ROBOT")
    assert read("fine").name == "robot1"


def test_refusals_and_bugs_of_the_reader_arrive() -> None:
    with pytest.raises(Refusal, match="not a robot"):
        read("refused")
    with pytest.raises(ZeroDivisionError, match="a bug") as caught:
        read("bug")
    assert "crashing_reader.py" in caught.value.__notes__[0]


def test_a_plane_for_contact_beside_many_shapes_is_read_by_drake() -> None:
    """On which Drake itself ends with signal 11."""
    links = "".join(map(BOX.format, range(18))) + PLANE
    Path("robot.sdf").write_text(f"<sdf version='1.9'><model name='m'>{links}</model></sdf>", "utf-8")
    assert hx.verify("robot.sdf", "robot.sdf", samples=2).is_same
    shapes = [shape for body in hx.verify.model_of("robot.sdf").bodies for shape in body.shapes]  # type: ignore[attr-defined]
    assert [(shape.kind, shape.role.value, shape.name) for shape in shapes[-2:]] == [("box", "collision", "c"), ("plane", "collision", "c")]


def test_a_plane_with_friction_is_compared_like_any_other(tmp_path: Path) -> None:
    floor = '<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1" friction="0.7 0.01 0.001"/>'
    (tmp_path / "r.xml").write_text(f"{floor}<body name='b'><freejoint/><geom size='1'/></body></worldbody></mujoco>")
    hx.convert(tmp_path / "r.xml", tmp_path / "r.sdf")
    assert "<surface>" in (tmp_path / "r.sdf").read_text()
    assert hx.verify(tmp_path / "r.xml", tmp_path / "r.sdf", samples=2).is_same


def test_an_exception_that_mujoco_did_not_expect_is_a_refusal_and_the_next_file_with_a_warning_is_read() -> None:
    """In one process that ends in time, which MuJoCo's handler of warnings would keep from ending."""
    text = '<mujoco><worldbody><body name="a"><geom size=".1"/></body></worldbody><equality><connect body1="a" {}/></equality></mujoco>'
    Path("empty.xml").write_text(text.format('anchor=""'), "utf-8")
    Path("warned.xml").write_text(text.format('anchor="0 0 0" solref="nan"'), "utf-8")
    program = "import hymeko_x as hx; print([hx.verify(name, name).reason for name in ('empty.xml', 'warned.xml')])"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True)
    assert run.stdout == "['MuJoCo refuses empty.xml: Caught an unknown exception!', '']\n"
