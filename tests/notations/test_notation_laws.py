"""Laws of notations: in another order, other digits, other units and other words, the same robot is the same robot."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree
from msgspec.structs import replace

from hymeko_x import formats, pipeline
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.ir.names import rename
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from hymeko_x.testing import arms
from hymeko_x.verify import model_of
from hymeko_x.verify.checks import compare
from tests.notations import mjcf, urdf, usd
from tests.verify.usd_writer import usd_of

SOME = settings(max_examples=max(4, settings.default.max_examples // 12), deadline=None, suppress_health_check=list(HealthCheck))
CHANCES = st.randoms(use_true_random=False)
CLOSE = Tolerance(1e-9, 1e-9)
SINGLE = Tolerance(1e-5, 1e-5)
"""What single precision keeps of metres given in centimetres."""

SUFFIXES = {"urdf": "urdf", "xacro": "xacro", "mjcf": "xml", "usd": "usda", "hymeko": "hymeko"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("notations")


def written(robot: Mechanism, format: str) -> bytes:
    return pipeline.write(robot, formats.by_name(format), Options(), NoFiles(), Report()).main


def assert_same(one: bytes, other: bytes, format: str, folder: Path, tolerance: Tolerance | None = CLOSE, into: str = "") -> None:
    """The reader reads the same mechanism of both, and the verifier sees the same robot in both."""
    names = folder / f"one.{SUFFIXES[format]}", folder / f"other.{SUFFIXES[into or format]}"
    for path, data in zip(names, (one, other), strict=True):
        path.write_bytes(data)
    if tolerance is not None:
        before, after = (read(data, kind) for data, kind in ((one, format), (other, into or format)))
        assert [str(line) for line in diff(before, after, tolerance)] == []
    verdict = compare(*map(model_of, names), samples=4)
    assert [f"{check.quantity} at {check.at}: {check.worst}" for check in verdict.failed] == []
    assert verdict.is_same


def read(data: bytes, format: str) -> Mechanism:
    """What the text says; not the words in which it says so, nor in which order, after which USD calls shapes."""
    found = pipeline.read(Source(f"r.{SUFFIXES[format]}", data), formats.by_name(format), Report())
    shapes = {view.id: Id("shape", f"{body} {view.shape.role}") for body, views in found.shapes.items() for view in views}
    return rename(replace(found, extras={}), shapes)


@SOME
@given(robot=arms(), chance=CHANCES)
def test_urdf_in_other_words_is_the_same_robot(robot: Mechanism, chance: Random, folder: Path) -> None:
    text = written(robot, "urdf")
    assert_same(text, urdf.otherwise(text, chance), "urdf", folder)


@SOME
@given(robot=arms(), chance=CHANCES)
def test_urdf_with_quaternions_reads_as_the_same_robot(robot: Mechanism, chance: Random) -> None:
    text = written(robot, "urdf")
    other = urdf.otherwise(text, chance, quaternions=True)
    assert [str(line) for line in diff(read(text, "urdf"), read(other, "urdf"), CLOSE)] == []


@SOME
@given(robot=arms(), chance=CHANCES)
def test_xacro_that_computes_its_numbers_is_the_same_robot(robot: Mechanism, chance: Random, folder: Path) -> None:
    text = written(robot, "urdf")
    assert_same(text, urdf.as_xacro(text, chance), "urdf", folder, into="xacro")


@SOME
@given(robot=arms(), chance=CHANCES)
def test_mjcf_in_other_words_is_the_same_robot(robot: Mechanism, chance: Random, folder: Path) -> None:
    model = mjcf.plain(written(robot, "mjcf"))
    assert_same(etree.tostring(model), mjcf.otherwise(model, chance), "mjcf", folder)


@SOME
@given(robot=arms(), chance=CHANCES)
def test_mjcf_that_gives_two_ends_is_the_same_robot(robot: Mechanism, chance: Random, folder: Path) -> None:
    model = mjcf.plain(written(robot, "mjcf"))
    assert_same(etree.tostring(model), mjcf.otherwise(model, chance, round_about=True), "mjcf", folder, tolerance=None)


@SOME
@given(robot=arms(), chance=CHANCES)
def test_a_stage_in_other_words_is_the_same_robot(robot: Mechanism, chance: Random, folder: Path) -> None:
    text = written(robot, "usd")
    assert_same(text, usd.otherwise(text.decode(), chance).encode(), "usd", folder, SINGLE)


@SOME
@given(robot=arms(), chance=CHANCES, metres=st.sampled_from([0.01, 0.001, 0.0254]), kilograms=st.sampled_from([1.0, 0.001, 0.45359237]))
def test_a_stage_in_other_units_is_the_same_robot(robot: Mechanism, chance: Random, metres: float, kilograms: float, folder: Path) -> None:
    plain = model_of(_plainly_named(robot))
    other = usd.otherwise(usd_of(plain, metres=metres, kilograms=kilograms), chance)
    assert_same(usd_of(plain).encode(), other.encode(), "usd", folder, SINGLE)


def _plainly_named(robot: Mechanism) -> Mechanism:
    """The robot with names that are paths of prims, and without a follower that turns, of which the writer knows no unit."""
    turning = {key for key, view in robot.joints.items() for dof in view.joint.dofs if dof.kind is parts.DofKind.HINGE}
    mixed = [key for key, _, arcs in robot.edges(parts.Coupling) if turning & {arc.target for arc in arcs}]
    robot = robot.replace(without=mixed)
    named = [*(key for key, _ in robot.vertices(parts.Body)), *robot.joints]
    return rename(robot, {key: Id(key.kind, f"{key.kind}_{number}") for number, key in enumerate(named)})
