"""What Newton makes of stages `--for newton`, beside what it makes of their sources. `make peers` installs it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import hymeko_x as hx
from peers import NEWTON
from tests.usd.test_peers import LIMITS_BY_MAGIC, NEWTON_ROBOTS, TOTAL_MASS, files_of, is_no_effort, near, need, plain, without_meshes

pytestmark = [pytest.mark.peers, pytest.mark.slow, pytest.mark.corpus]

NUMBERS = ("lower", "upper", "velocity", "effort", "armature", "friction", "damping", "stiffness of drive", "damping of drive")

BEHIND_GEARS = {"single_spherical_pendulum_position"}
"""Newton's MJCF reader takes the gains of a servo without its gear."""

BY_TRANSMISSIONS = {"tiago_dual", "tiago_pro", "talos_full_v2_box"}
"""Their transmissions command positions, which are servos of the stage; Newton's URDF reader does not read transmissions."""


@pytest.mark.parametrize("format", ["urdf", "mjcf"])
def test_newton_sees_the_same_joints_and_masses_as_in_the_source(format: str, tmp_path: Path) -> None:
    """Limits, armature, friction, damping, drives and masses of 44 robots; effort limits of actuators are there in addition."""
    need(NEWTON)
    sources = files_of(format, NEWTON_ROBOTS[format])
    if format == "urdf":
        sources = [without_meshes(path, tmp_path) for path in sources]
    jobs = []
    for number, path in enumerate(sources):
        stage = tmp_path / str(number) / "robot.usda"
        stage.parent.mkdir()
        hx.convert(path, stage, target="newton")
        jobs += [{"source": str(path)}, {"source": str(stage)}]
    answers = NEWTON.run(jobs)
    assert [answer["error"] for answer in answers if "error" in answer] == []
    found = {path.stem: differences(answers[2 * number], answers[2 * number + 1]) for number, path in enumerate(sources)}
    for name in LIMITS_BY_MAGIC & found.keys():
        found[name] -= {"lower", "upper"}
    for name in TOTAL_MASS & found.keys():
        found[name] -= {"mass"}
    for name in BEHIND_GEARS & found.keys():
        found[name] -= {"stiffness of drive"}
    for name in BY_TRANSMISSIONS & found.keys():
        found[name] -= {"stiffness of drive", "damping of drive"}
    assert {name: sorted(wrong) for name, wrong in found.items() if wrong} == {}


def differences(source: Any, ours: Any) -> set[str]:
    """What differs of joints with dofs, each paired by its child, and of bodies with mass."""
    found = set()
    bodies = {plain(body["name"]): body for body in ours["bodies"]}
    joints = {plain(ours["bodies"][joint["child"]]["name"]): joint for joint in ours["joints"]}
    for body in source["bodies"]:
        other = bodies.get(plain(body["name"]))
        if body["mass"] > 0.0 and (other is None or not near(body["mass"], other["mass"])):
            found.add("mass")
    for joint in source["joints"]:
        if not joint["axes"] or joint["type"] == "FREE":
            continue
        other = joints.get(plain(source["bodies"][joint["child"]]["name"]))
        found |= {f"joint {joint['name']}"} if other is None or len(other["axes"]) != len(joint["axes"]) else differing(joint, other)
    return found


def differing(joint: Any, other: Any) -> set[str]:
    """The numbers of a joint that differ; an effort limit that only an actuator of the source has is none."""
    return {
        name
        for name in NUMBERS
        for a, b in zip(joint[name], other[name], strict=True)
        if not near(a, b) and not is_no_effort(name, a, b) and not (name == "effort" and a is None)
    }
