"""The whole robot changed: merged, scaled, mirrored, randomised; and changes and their inverses, over generated mechanisms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import Phase, given, settings

import hymeko_x as hx
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.parts import Body
from hymeko_x.testing import arms, mechanisms
from tests.robot.robots import arm, claw, hand

FEW = settings(max_examples=15, deadline=None, phases=(Phase.generate,))


@FEW
@given(arms())
def test_twice_and_half_the_size_is_the_size(mechanism: Mechanism) -> None:
    robot = hx.Robot(mechanism)
    assert hx.diff(robot.scaled(2).scaled(0.5), robot) == ()


@FEW
@given(mechanisms())
def test_the_mirror_image_of_the_mirror_image_is_the_robot(mechanism: Mechanism) -> None:
    robot = hx.Robot(mechanism)
    assert hx.diff(robot.mirrored().mirrored(), robot) == ()


@FEW
@given(mechanisms())
def test_an_edit_and_its_inverse_are_none(mechanism: Mechanism) -> None:
    robot = hx.Robot(mechanism)
    body = next((key.name for key, part in mechanism.vertices(Body) if part.inertial and part.inertial.mass is not None), None)
    with robot.edit() as e:
        if body is not None:
            before = e.bodies[body].mass
            e.bodies[body].mass = 12.5
            e.bodies[body].mass = before
        e.add_frame("a new frame", on=e.bodies[next(iter(e.bodies))]) if len(e.bodies) else None
        e.remove("a new frame") if len(e.bodies) else None
        for name in [name for name in e.joints if name][:3]:
            e.rename(e.joints[name], f"{name} renamed")
            e.rename(e.joints[f"{name} renamed"], name)
    assert hx.diff(e.robot, robot) == ()


def test_kinematics_and_masses_scale_by_their_dimensions() -> None:
    robot = arm()
    big = robot.scaled(3)
    q = {"shoulder": 0.3, "elbow": -0.8}
    for name, pose in robot.fk(q).items():
        assert big.fk(q)[name].xyz == pytest.approx([3 * number for number in pose.xyz])
    assert big.to_mujoco().body_mass == pytest.approx(27 * robot.to_mujoco().body_mass)
    assert big.to_mujoco().body_inertia == pytest.approx(243 * robot.to_mujoco().body_inertia)
    assert hand().scaled(2).joints["left"].limits.upper == 0.08
    with pytest.raises(hx.EditError, match="robot 'arm': a factor is a positive number, found -1"):
        robot.scaled(-1)


def test_the_mirror_image_moves_as_its_original_seen_in_a_mirror() -> None:
    with arm().attach(claw(), at="flange", prefix="left_", pose=hx.Pose.from_rpy((0.1, 0.2, 0.3), (0, 0.1, 0))).edit() as e:
        e.joints["shoulder"].axis = (1, 2, 3)
    robot, q = e.robot, {"shoulder": 0.3, "elbow": -0.8, "left_close": 0.4}
    image = robot.mirrored(names=("left", "right"))
    flip = np.diag((1, -1, 1, 1))
    poses = image.fk({name.replace("left", "right"): value for name, value in q.items()})
    for name, pose in robot.fk(q).items():
        assert np.allclose(poses[name.replace("left", "right")].matrix(), flip @ np.array(pose.matrix()) @ flip, atol=1e-12)
    assert image.mass == pytest.approx(robot.mass)
    assert [*image.mirrored(names=("left", "right")).bodies] == [*robot.bodies]


def test_merging_keeps_mass_inertia_and_kinematics() -> None:
    whole = claw().attach(claw(), at="finger", prefix="b/", pose=hx.Pose.from_rpy((1, 2, 3), (0.1, 0.2, 0.3)))
    merged = whole.merge_fixed_joints()
    assert [*merged.bodies] == ["palm", "finger", "b/finger"]
    assert merged.mass == pytest.approx(whole.mass)
    q = {"close": 0.3, "b/close": 0.2}
    for name, pose in merged.fk(q).items():
        assert np.allclose(pose.matrix(), whole.fk(q)[name].matrix(), atol=1e-12)
    import pinocchio

    energies = []
    for robot in (whole, merged):
        model = robot.to_pinocchio()
        data = model.createData()
        energies.append(pinocchio.computeKineticEnergy(model, data, np.array((0.3, 0.2)), np.array((1.0, -2.0))))
    assert energies[0] == pytest.approx(energies[1], rel=1e-9)
    assert [*whole.merge_fixed_joints(keep=("b/palm",)).bodies] == [*whole.bodies]
    with pytest.raises(KeyError, match="there is no body 'b/plam'; did you mean 'b/palm'"):
        whole.merge_fixed_joints(keep=("b/plam",))


def test_variants_are_within_their_spreads_and_the_same_every_time() -> None:
    robot = arm()
    masses = [robot.randomized(seed, mass=0.1, damping=0.5) for seed in range(20)]
    for variant in masses:
        assert abs(variant.bodies["base"].mass / 4 - 1) <= 0.1
        assert abs(variant.joints["shoulder"].damping / 0.5 - 1) <= 0.5
        assert math.isclose(variant.bodies["base"].tensor[0] / 0.02, variant.bodies["base"].mass / 4)
    assert len({variant.bodies["base"].mass for variant in masses}) == 20
    assert robot.randomized(7, mass=0.1) == robot.randomized(7, mass=0.1)
    with pytest.raises(hx.EditError, match="the spread of mass is a number from 0 to 1, found 2"):
        robot.randomized(0, mass=2)
