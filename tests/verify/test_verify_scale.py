"""The verifier is fast on a humanoid, linear in links, and flat in samples."""

from __future__ import annotations

import tracemalloc
from typing import TYPE_CHECKING

import numpy as np
import pytest

from hymeko_x.verify.checks import compare
from hymeko_x.verify.model import Body, Dof, Joint, Kind, KinematicModel, world_body
from hymeko_x.verify.spatial import random_quats, rigid, rotation_from_quat
from tests.pace import assert_at_most, assert_within

if TYPE_CHECKING:
    from collections.abc import Callable


def robot(limbs: int, length: int, seed: int = 0) -> KinematicModel:
    """A floating torso with limbs of hinges at random poses."""
    rng = np.random.default_rng(seed)
    free = Dof(Kind.FREE, np.array([0.0, 0.0, 1.0]))
    bodies = [world_body(), Body("torso", 0, Joint("root", np.eye(4), (free,)), 10.0, np.zeros(3), np.eye(3))]
    turns = rotation_from_quat(random_quats(rng, limbs * length))
    for limb in range(limbs):
        parent = 1
        for k in range(length):
            place = rigid(turns[limb * length + k], rng.uniform(-0.2, 0.2, 3))
            name = f"limb{limb}_{k}"
            hinge = Dof(Kind.HINGE, np.array([0.0, 0.0, 1.0]), name=f"{name}_joint", lower=-2.0, upper=2.0)
            bodies.append(
                Body(name, parent, Joint(f"{name}_joint", place, (hinge,)), 1.0, rng.uniform(-0.1, 0.1, 3), np.diag([1e-2, 2e-2, 2e-2]))
            )
            parent = len(bodies) - 1
    return KinematicModel("robot", "test", "test", tuple(bodies))


def comparing(model: KinematicModel, samples: int) -> Callable[[], object]:
    def work() -> None:
        assert compare(model, model, samples=samples).verdict == "same"

    return work


def test_a_humanoid_of_40_links_takes_less_than_half_a_second() -> None:
    humanoid = robot(limbs=5, length=8)
    assert_within(0.5, comparing(humanoid, 100))


@pytest.mark.full
def test_time_is_linear_in_links() -> None:
    """Ten times the links take about ten times as long; dynamics are left to smaller robots."""
    small, large = robot(limbs=4, length=150), robot(limbs=40, length=150)
    assert_at_most(1.5, comparing(large, 3), comparing(small, 3), count=10)


def test_a_chain_of_5000_links_does_not_recurse() -> None:
    assert compare(chain := robot(limbs=1, length=5000), chain, samples=2).verdict == "same"


def test_memory_is_flat_in_samples() -> None:
    humanoid = robot(limbs=5, length=8)
    peaks = []
    for samples in (2_000, 8_000):
        tracemalloc.start()
        compare(humanoid, humanoid, samples=samples)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    coordinates = 6_000 * humanoid.width * 8 * 12  # what grows are the coordinates themselves, never the poses
    assert peaks[1] - peaks[0] < coordinates
