"""Real robots: nothing is lost on the way through a mechanism, and Pinocchio sees the same robot."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

from hymeko_x.compare.diff import diff
from hymeko_x.xml.tree import read_numbers
from tests.urdf.samples import dump, load, tags


@pytest.mark.robots("urdf", every=2)
@pytest.mark.unread("HX005", "HX028", "HX040", "HX046")
def test_a_real_robot_comes_back_without_a_difference(robot: Path) -> None:
    source = robot.read_bytes()
    mechanism = load(source)
    text = dump(mechanism)
    assert diff(mechanism, load(text)) == ()
    assert load(text) == mechanism
    assert dump(load(text)) == text


@pytest.mark.robots("urdf", every=2)
@pytest.mark.unread("HX005", "HX028", "HX040", "HX046")
def test_every_tag_and_attribute_of_a_real_robot_is_there(robot: Path) -> None:
    source = robot.read_bytes()
    assert tags(source) - tags(dump(load(source))) == Counter()


@pytest.mark.robots("urdf", every=2)
@pytest.mark.unread("HX005", "HX028", "HX040", "HX046")
def test_every_value_of_a_real_robot_is_there_to_the_last_digit(robot: Path) -> None:
    source = robot.read_bytes()
    assert values(source) - values(dump(load(source)).encode()) == Counter()


def values(data: bytes) -> Counter[tuple[str, str | tuple[float, ...]]]:
    """Every attribute and every text by the path of its element; numbers as numbers, so that 0.10 is 0.1."""
    root = etree.fromstring(data, etree.XMLParser(recover=True, huge_tree=True))
    found: Counter[tuple[str, str | tuple[float, ...]]] = Counter()
    for element in root.iter("*"):
        path = "/".join([*(above.tag for above in reversed(list(element.iterancestors()))), element.tag])
        pairs = [*((f"{path}@{name}", value) for name, value in element.items()), (path, (element.text or "").strip())]
        found.update((where, read_numbers(value) or " ".join(value.split())) for where, value in pairs)
    return found


@pytest.mark.robots("urdf", every=2)
@pytest.mark.unread("HX005", "HX028", "HX040", "HX046")
def test_pinocchio_sees_the_same_robot(robot: Path) -> None:
    source, result = (pin.buildModelFromXML(text) for text in (robot.read_text(), dump(load(robot.read_bytes()))))
    assert [source.nq, list(source.names)] == [result.nq, list(result.names)]
    for a, b in zip(source.inertias, result.inertias, strict=True):
        assert np.abs(a.toDynamicParameters() - b.toDynamicParameters()).max() <= 1e-12 * max(1.0, np.abs(a.toDynamicParameters()).max())
    assert np.array_equal(source.effortLimit, result.effortLimit)
    assert np.array_equal(source.velocityLimit, result.velocityLimit)
    assert np.array_equal(source.lowerPositionLimit, result.lowerPositionLimit)
    assert np.array_equal(source.upperPositionLimit, result.upperPositionLimit)
    one, other = source.createData(), result.createData()
    rng = np.random.default_rng(0)
    for _ in range(10):
        q = pin.integrate(source, pin.neutral(source), rng.uniform(-3.0, 3.0, source.nv))
        pin.framesForwardKinematics(source, one, q)
        pin.framesForwardKinematics(result, other, q)
        for a, b in zip(one.oMf, other.oMf, strict=True):
            assert np.abs(a.homogeneous - b.homogeneous).max() <= 1e-12
