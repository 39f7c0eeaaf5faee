"""Denavit-Hartenberg tables are exact for every chain, and their canonical form depends on how a robot moves and nothing else."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hymeko_x.verify import dh
from hymeko_x.verify.checks.chains import signature
from hymeko_x.verify.dh import Convention
from hymeko_x.verify.dh.lines import AxisLine, DhFrame, DhLink
from hymeko_x.verify.model import Array, Body, Dof, Joint, Kind, KinematicModel, world_body
from hymeko_x.verify.pinocchio import build
from hymeko_x.verify.spatial import random_quats, rigid, rotation_about, rotation_from_quat

FAMILIES = ("skew", "parallel", "anti-parallel", "intersecting", "coincident", "nearly parallel", "nearly anti-parallel", "right angle")


def random_pose(rng: np.random.Generator) -> Array:
    return rigid(rotation_from_quat(random_quats(rng, 1)[0]), rng.uniform(-1, 1, 3))


def next_axis(family: str, point: Array, axis: Array, rng: np.random.Generator) -> tuple[Array, Array]:
    """A line that stands to a given line as the family says."""
    other = rng.normal(size=3)
    across = np.cross(axis, other / np.linalg.norm(other))
    across /= np.linalg.norm(across)
    away = point + rng.uniform(-1, 1, 3)
    match family:
        case "parallel":
            return away, axis
        case "anti-parallel":
            return away, -axis
        case "intersecting":
            return point, rotation_about(across, np.asarray(rng.uniform(0.3, 2.8))) @ axis
        case "coincident":
            return point + rng.uniform(-1, 1) * axis, axis * rng.choice([-1.0, 1.0])
        case "nearly parallel" | "nearly anti-parallel":
            tilted = rotation_about(across, np.asarray(10.0 ** rng.uniform(-13, -1.4))) @ axis
            return away, tilted if family == "nearly parallel" else -tilted
        case "right angle":
            return away, across
        case _:
            return away, rotation_about(across, np.asarray(rng.uniform(0.1, 3.0))) @ axis


def random_lines(rng: np.random.Generator, count: int) -> list[tuple[Kind, Array, Array]]:
    """Axes of hinges and slides in the base's frame, each in some relation to the one before."""
    place = random_pose(rng)
    point, axis = place[:3, 3], place[:3, 2]
    if rng.random() < 0.3:
        point, axis = np.array([0.0, 0.0, rng.uniform(-1, 1)]), np.array([0.0, 0.0, 1.0])
    found = []
    for _ in range(count):
        found.append((Kind.SLIDE if rng.random() < 0.25 else Kind.HINGE, point, axis))
        point, axis = next_axis(str(rng.choice(FAMILIES)), point, axis, rng)
    return found


def model_of(lines: list[tuple[Kind, Array, Array]], tip: Array, rng: np.random.Generator) -> KinematicModel:
    """A chain whose axes at rest are these lines; the bodies' own frames are anywhere."""
    bodies = [world_body(), Body("base", 0, Joint(open=True))]
    before = np.eye(4)
    for k, (kind, point, axis) in enumerate(lines):
        frame = tip if k == len(lines) - 1 else random_pose(rng)
        inside = np.linalg.inv(frame)
        dof = Dof(kind, inside[:3, :3] @ axis, inside[:3, :3] @ point + inside[:3, 3], name=f"j{k}")
        bodies.append(Body(f"b{k}", k + 1, Joint(f"j{k}", np.linalg.inv(before) @ frame, (dof,))))
        before = frame
    return KinematicModel("chain", "test", "test", tuple(bodies))


def worst_error(seed: int, conventions: tuple[Convention, ...]) -> float:
    """The largest entry in which the tables of one random chain differ from Pinocchio's pose of the tip."""
    rng = np.random.default_rng(seed)
    model = model_of(random_lines(rng, int(rng.integers(1, 9))), random_pose(rng), rng)
    q = rng.uniform(-math.pi, math.pi, (2, model.width))
    native = build(model, 1)
    poses = native.poses(q)[:, -1]
    tables = [dh.table(model, None, c, as_data_sheet=as_sheet) for c in conventions for as_sheet in (False, True)]
    return max(float(np.abs(table.poses(q) - poses).max()) for table in tables)


def test_tables_of_500_random_chains_are_exact() -> None:
    errors = [worst_error(seed, (list(Convention)[seed % 3],)) for seed in range(500)]
    assert max(errors) < 1e-9


@pytest.mark.full
def test_tables_of_ten_thousand_random_chains_are_exact() -> None:
    errors = [worst_error(seed, (list(Convention)[seed % 3],)) for seed in range(1000, 11000)]
    assert max(errors) < 1e-9


def as_lines(lines: list[tuple[Kind, Array, Array]]) -> list[AxisLine]:
    return [AxisLine(tuple(point.tolist()), tuple(axis.tolist()), sliding=kind is Kind.SLIDE) for kind, point, axis in lines]


def moved(lines: list[tuple[Kind, Array, Array]], by: Array, rng: np.random.Generator) -> list[tuple[Kind, Array, Array]]:
    """The same axes after a rigid motion, with points elsewhere on them; a slide's line may be anywhere."""
    out = []
    for kind, point, axis in lines:
        on_line = point + rng.uniform(-2, 2) * axis if kind is Kind.HINGE else rng.uniform(-2, 2, 3)
        out.append((kind, by[:3, :3] @ on_line + by[:3, 3], by[:3, :3] @ axis))
    return out


def distance(a: tuple[DhLink, ...], b: tuple[DhLink, ...]) -> float:
    """The largest difference of two signatures; angles on the circle."""
    lengths = [abs(x.d - y.d) + abs(x.a - y.a) for x, y in zip(a, b, strict=True)]
    angles = [
        max(abs(math.remainder(x.theta - y.theta, 2 * math.pi)), abs(math.remainder(x.alpha - y.alpha, 2 * math.pi)), abs(x.beta - y.beta))
        for x, y in zip(a, b, strict=True)
    ]
    return max(*lengths, *angles)


def test_the_canonical_form_does_not_depend_on_frames() -> None:
    for seed in range(400):
        rng = np.random.default_rng(seed)
        lines = random_lines(rng, int(rng.integers(1, 9)))
        tip, by = random_pose(rng), random_pose(rng)
        here = signature(as_lines(lines), DhFrame.of(tip))
        there = signature(as_lines(moved(lines, by, rng)), DhFrame.of(by @ tip))
        assert distance(here, there) < 1e-6, seed


def test_the_canonical_form_tells_robots_apart() -> None:
    told_apart = 0
    for seed in range(200):
        rng = np.random.default_rng(seed)
        lines = random_lines(rng, 6)
        tip = random_pose(rng)
        hinge = next(k for k in (2, 3, 4, 5) if lines[k][0] is Kind.HINGE or k == 5)
        kind, point, axis = lines[hinge]
        off = np.cross(axis, [0.3, 0.5, 0.7])
        changed = [*lines[:hinge], (kind, point + 1e-3 * off, axis), *lines[hinge + 1 :]]
        told_apart += distance(signature(as_lines(lines), DhFrame.of(tip)), signature(as_lines(changed), DhFrame.of(tip))) > 1e-5
    assert told_apart > 180  # in a few of them only the tip moves, which a signature leaves out


def test_a_scara_has_the_table_of_the_textbook() -> None:
    """Two vertical axes 0.5 m apart, the first 0.63 m up: d = 0.63, a = 0.5 and no twist."""
    turned = rigid(rotation_about(np.array([0.0, 0.0, 1.0]), np.asarray(math.pi / 2)), np.array([0.0, 0.0, 0.63]))
    shifted = rigid(np.eye(3), np.array([0.5, 0.0, 0.0]))
    axis = np.array([0.0, 0.0, 1.0])
    model = KinematicModel(
        "scara_robot",
        "test",
        "test",
        (
            world_body(),
            Body("base_link", 0, Joint(open=True)),
            Body("shoulder_link", 1, Joint("joint_1", turned, (Dof(Kind.HINGE, axis, name="joint_1"),))),
            Body("wrist_link", 2, Joint("joint_2", shifted, (Dof(Kind.HINGE, axis, name="joint_2"),))),
        ),
    )
    rows = [(row.joint, row.theta, row.d, row.a, row.alpha) for row in dh.table(model).rows]
    assert rows == [("joint_1", math.pi / 2, 0.63, 0.5, 0.0), ("joint_2", 0.0, 0.0, 0.0, 0.0)]


def test_nearly_parallel_axes_do_not_blow_up() -> None:
    rng = np.random.default_rng(5)
    axis = np.array([0.0, 0.0, 1.0])
    tilted = rotation_about(np.array([1.0, 0.0, 0.0]), np.asarray(1e-4)) @ axis
    lines = [
        (Kind.HINGE, np.zeros(3), axis),
        (Kind.HINGE, np.array([0.4, 0.3, 0.1]), tilted),
        (Kind.HINGE, np.array([0.8, 0.3, 0.0]), axis),
    ]
    rows = dh.table(model_of(lines, random_pose(rng), rng)).rows
    assert all(abs(row.a) < 2 and abs(row.d) < 2 for row in rows)
    assert rows[0].beta != 0.0
