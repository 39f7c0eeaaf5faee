"""MJCF says more than URDF: what URDF has no word for is named as not compared, and everything else is compared all the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from lxml import etree

import hymeko_x as hx
from hymeko_x.verify.verdict import Verdict

Write = Callable[[str, str], Path]

ZOO = """<mujoco>
  <default><joint damping="0.25" stiffness="0.1"/><geom type="box" pos=".1 .2 .3" size=".1 .2 .3"/></default>
  <worldbody>
    <geom type="plane" size="0 0 1" pos="0 0 -1" euler="10 20 0"/>
    <body><joint type="free" damping="0.5" frictionloss="0.1"/><geom/></body>
    <body pos="1 0 0"><joint name="slide" type="slide" axis="1 2 3"/><joint type="ball" pos="0 0 0.1"/><geom/></body>
    <body pos="1 0 0"><joint name="turn" axis="1 2 3" pos="0 0.1 0" ref="20"/><geom/>
      <body pos="0 0 1"><joint name="x"/><joint name="y" axis="1 0 0"/><joint name="z" type="slide"/><geom/></body>
      <body pos="0 1 0"><geom type="ellipsoid" size="0.1 0.2 0.3" euler="10 20 30"/><geom type="capsule" size="0.1 0.2"/></body>
    </body>
    <body name="anchor" pos="4 0 0"><joint name="crank"/><geom/>
      <body name="rod" pos="1 0 0"><joint name="pin"/><joint name="follower" axis="1 0 0"/><geom/></body>
    </body>
  </worldbody>
  <equality>
    <connect name="closure" body1="anchor" body2="rod" anchor="1 0 0"/>
    <joint joint1="follower" joint2="crank" polycoef="0.1 2"/>
    <joint joint1="x" joint2="y" polycoef="0 1 0.5"/>
  </equality>
</mujoco>"""


@pytest.fixture
def pair(written: Write, tmp_path: Path) -> tuple[Path, Path]:
    """The same robot in MJCF and in URDF."""
    source, target = written("mjcf", ZOO), tmp_path / "zoo.urdf"
    hx.convert(source, target)
    return source, target


def failed(verdict: Verdict) -> list[str]:
    return [f"{check.quantity} at {check.at}" for check in verdict.failed]


def test_unnamed_bodies_balls_chains_and_shapes_without_a_word_are_the_same_robot(pair: tuple[Path, Path]) -> None:
    verdict = hx.verify(*pair, samples=20)
    assert failed(verdict) == []
    assert verdict.is_same


def test_what_urdf_has_no_word_for_is_named(pair: tuple[Path, Path]) -> None:
    verdict = hx.verify(*pair, samples=2)
    assert verdict.verdict == "same as far as urdf can say"
    assert [*map(str, verdict.gaps)] == [
        "loops: 1 ('closure')",
        "damping of free joints: 1 (the joint above the unnamed body 1)",
        "friction of free joints: 1 (the joint above the unnamed body 1)",
        "springs: 10 (the joint above the unnamed body 1, joint 'slide', ...)",
        "couplings that are no straight line of one leader: 1 (joint 'x')",
    ]
    assert [note for note in verdict.not_compared if "urdf has no" in note] == [
        "shapes: urdf has no plane; a box stands for a plane",
        "shapes: urdf has no ellipsoid; a mesh stands for an ellipsoid",
    ]


def test_a_loop_that_only_the_second_robot_has_is_a_difference(pair: tuple[Path, Path]) -> None:
    verdict = hx.verify(pair[1], pair[0], samples=2)
    assert "loops at loop 'closure' is new" in failed(verdict)


@pytest.mark.parametrize(
    ("path", "to", "check"),
    [
        ("//joint[@name='world_body#2_x']/dynamics/@damping", "0.3", "damping"),
        ("//joint[@name='y']/axis/@xyz", "0 1 0", "forward kinematics, rotation"),
        ("//link[@name='world_body#4']/inertial/mass/@value", "1", "mass"),
        ("//joint[@name='follower']/mimic/@multiplier", "3", "coupled coordinates"),
        ("//joint[@name='follower']/mimic", "", "couplings"),
        ("//link[@name='world']/collision/origin/@xyz", "0 0 -1", "collision shapes"),
        ("//link[@name='world']/collision/origin/@rpy", "0 0 0", "collision shapes"),
        ("//link[@name='world_body#5']/collision/geometry/mesh/@scale", "0.1 0.2 0.31", "collision shapes"),
        ("//link[@name='world_body#5']/collision[geometry/mesh]/origin/@xyz", "0 0 0", "collision shapes"),
        (
            "//link[@name='world_body#5']/collision[geometry/sphere]/geometry/sphere/@radius",
            "0.2",
            "collision shapes, size and pose",
        ),
    ],
)
def test_what_urdf_can_say_is_compared(pair: tuple[Path, Path], path: str, to: str, check: str) -> None:
    root = etree.fromstring(pair[1].read_bytes())
    where, _, attribute = path.partition("/@")
    (element, *_) = root.xpath(where)
    if attribute:
        element.set(attribute, to)
    else:
        element.getparent().remove(element)
    pair[1].write_bytes(etree.tostring(root))
    assert check in {found.quantity for found in hx.verify(*pair, samples=5).failed}


def test_the_effort_limits_of_the_urdf_are_compared_with_what_the_actuators_can_exert(written: Write, tmp_path: Path) -> None:
    motors = '<actuator><motor joint="crank" ctrlrange="-2 2" gear="5"/><position joint="turn" forcerange="-3 4"/></actuator></mujoco>'
    source, target = written("mjcf", ZOO.replace("</mujoco>", motors)), tmp_path / "zoo.urdf"
    hx.convert(source, target)
    assert hx.verify(source, target, samples=2).is_same
    target.write_text(target.read_text("utf-8").replace('effort="10"', 'effort="11"'), "utf-8")
    assert failed(hx.verify(source, target, samples=2)) == ["effort limits at joint 'crank'"]
