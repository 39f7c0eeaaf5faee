"""MuJoCo weighs a body of solids alone as it weighs it in the whole robot, and where it might not, the whole robot is asked."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from mjmodels import read_text, write

from hymeko_x import formats, pipeline
from hymeko_x.corpus.catalog import development_files
from hymeko_x.diagnostics import Report
from hymeko_x.disk import open_source
from hymeko_x.frontends.mjcf import complete as complete_module
from hymeko_x.frontends.mjcf.complete import are_solids_alone, complete
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.ir.parts import Body
from hymeko_x.rewrite import legalize
from hymeko_x.source import Files, NoFiles

FILES = development_files("mjcf")
NAMES = ("ant.xml", "three_joint_link.xml", "walker2d_v5.xml", "tendon.xml", "01_humanoids.xml")
FEW = [file for file in FILES if Path(file.path).name in NAMES]


def unweighed(mechanism: Mechanism) -> list[Id]:
    return [key for key, body in mechanism.vertices(Body) if body.inertial is None and mechanism.shapes.get(key)]


def weighed_whole(mechanism: Mechanism, files: Files) -> Mechanism:
    native = legalize(mechanism, "mjcf", Report())
    return complete(mechanism, lambda: (native, write(native).encode()), files, Report())


def assert_same_alone(robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = open_source(str(robot))
    mechanism = pipeline.read(source, formats.MJCF, Report())
    alone = weighed_whole(mechanism, source.files)
    monkeypatch.setattr(complete_module, "are_solids_alone", lambda *_: False)
    assert repr(alone.graph.vertices) == repr(weighed_whole(mechanism, source.files).graph.vertices)


@pytest.mark.corpus
@pytest.mark.parametrize("robot", FEW, ids=lambda file: file.id, indirect=True)
def test_bodies_of_a_real_robot_weigh_alone_what_they_weigh_in_it_to_the_last_bit(robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = pipeline.read(open_source(str(robot)), formats.MJCF, Report())
    assert are_solids_alone(mechanism, unweighed(mechanism))
    assert_same_alone(robot, monkeypatch)


@pytest.mark.corpus
@pytest.mark.full
@pytest.mark.parametrize("robot", [file for file in FILES if file not in FEW], ids=lambda file: file.id, indirect=True)
def test_bodies_of_every_real_robot_weigh_alone_what_they_weigh_in_it(robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert_same_alone(robot, monkeypatch)


SOLID = '<geom size=".1"/>'


def robot_of(content: str = SOLID, head: str = "") -> Mechanism:
    return read_text(f'<mujoco>{head}<worldbody><body name="b"><freejoint/>{content}</body></worldbody></mujoco>')


@pytest.mark.parametrize(
    "place",
    [
        'euler="10 20 30"',
        'axisangle="1 2 3 40"',
        'xyaxes="1 2 3 -2 1 0"',
        'zaxis="1 2 3"',
        'quat="1 2 3 4"',
        'quat="0.5 0.5 0.5 0.5" mass="7"',
        'type="capsule" fromto=".1 .2 .3 .4 .5 .7"',
        'type="cylinder" euler="-.1 77 1e-9"',
        'type="ellipsoid" pos="0 0 1e9"',
        'type="sphere" density="1e-3"',
    ],
)
@pytest.mark.parametrize("angles", ['angle="radian" eulerseq="XyZ"', 'angle="degree"'])
def test_however_a_solid_is_placed_it_weighs_alone_what_it_weighs_in_the_robot(
    place: str, angles: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    position = "" if "fromto" in place or "pos" in place else 'pos="4 5 6"'
    head = f'<compiler {angles}/><default><geom type="box" density="5" size=".1 .2 .3"/></default>'
    robot = robot_of(f'<geom {place} {position}/><geom size="3 2 1"/>', head)
    assert are_solids_alone(robot, unweighed(robot))
    alone = weighed_whole(robot, NoFiles())
    monkeypatch.setattr(complete_module, "are_solids_alone", lambda *_: False)
    assert repr(alone.graph.vertices) == repr(weighed_whole(robot, NoFiles()).graph.vertices)


@pytest.mark.parametrize(
    ("content", "head"),
    [
        (SOLID, '<compiler inertiafromgeom="false"/>'),
        (SOLID, '<compiler inertiagrouprange="0 1"/>'),
        (SOLID, '<compiler inertiafromgeom="true" boundmass="1"/>'),
        (SOLID, '<default><geom shellinertia="true"/></default>'),
        ('<geom size=".1" shellinertia="true"/>', ""),
        (f'<frame euler="10 20 30">{SOLID}</frame>', ""),
        ('<geom size=".1"><plugin plugin="p"/></geom>', '<extension><plugin plugin="p"/></extension>'),
        ('<geom type="mesh" mesh="m"/>', '<asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>'),
        (SOLID + '<geom type="box" mesh="m"/>', '<asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>'),
    ],
)
def test_wherever_more_than_solids_counts_the_whole_robot_is_asked(content: str, head: str) -> None:
    plain, robot = robot_of(), robot_of(content, head)
    assert are_solids_alone(plain, unweighed(plain))
    assert not are_solids_alone(robot, unweighed(robot))


def test_without_mujoco_there_is_an_error_and_no_inertia(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    robot, report = robot_of(), Report()
    assert complete(robot, lambda: pytest.fail("it was printed"), NoFiles(), report) is robot
    assert [str(diagnostic)[:15] for diagnostic in report] == ["error[HX301]: M"]


def test_what_weighs_nothing_is_left_to_the_whole_robot_which_mujoco_refuses() -> None:
    robot, report = robot_of('<geom size=".1" mass="0"/>'), Report()
    assert complete(robot, lambda: (robot, write(robot).encode()), NoFiles(), report) == robot
    assert [str(diagnostic)[:15] for diagnostic in report] == ["error[HX302]: M"]


def test_nothing_is_printed_for_a_robot_of_solids() -> None:
    found = complete(robot_of(), lambda: pytest.fail("it was printed"), NoFiles(), Report())
    assert found.vertex(Id("body", "b"), Body).inertial is not None
