"""The laws of the residue on arbitrary mechanisms: any one is restored from any other, in memory and through text."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, assume, given, reject, settings
from msgspec import Struct

import hymeko_x as hx
from hymeko_x import codes
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir import geometry, parts, values
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.types import hints_of, settled
from hymeko_x.residue.delta import residue_of
from hymeko_x.residue.merge import restore
from hymeko_x.residue.reading import parse_residues
from hymeko_x.residue.text import print_residue
from hymeko_x.testing import mechanisms
from tests.residue.exactness import unequal


@settings(max_examples=80, deadline=None)
@given(mechanisms(), mechanisms())
def test_any_mechanism_is_restored_from_any_image(source: Mechanism, image: Mechanism) -> None:
    report = Report()
    (residue,) = parse_residues(print_residue(residue_of(source, image)))
    assert unequal(source, restore(image, residue, report).mechanism) == []
    assert list(report) == []


@pytest.mark.parametrize("format", ["urdf", pytest.param("xacro", marks=pytest.mark.full), "mjcf", "usd"])
@settings(max_examples=20, deadline=None, suppress_health_check=list(HealthCheck))
@given(robot=mechanisms())
@pytest.mark.unread  # generated or damaged input: any
def test_what_a_format_cannot_say_comes_back_from_it(format: str, robot: Mechanism) -> None:
    assume(format != "mjcf" or not _goes_out_of_range(robot))
    assume(robot.graph.vertices)  # what was written without anything at all is read as an error
    assert unequal(robot, hx.loads(_written(robot, format), format, lenient=True).mechanism) == []


def _written(robot: Mechanism, format: str) -> str:
    """The text of a robot, but for one with extras that are no XML."""
    try:
        return hx.dumps(robot, format, keep="inside", lenient=True)
    except Refusal as refusal:
        if refusal.diagnostic.code != codes.BAD_VALUE:
            raise
        reject()


def _goes_out_of_range(robot: Mechanism) -> bool:
    """Whether relations of joints, which MJCF counts from their references, may leave the range of doubles."""
    dofs = [dof for view in robot.joints.values() for dof in view.joint.dofs]
    return any(robot.edges(parts.Coupling)) and any(abs(dof.ref) > 1e9 for dof in dofs)


@settings(max_examples=30, deadline=None)
@given(mechanisms())
def test_what_is_the_same_leaves_no_residue(source: Mechanism) -> None:
    assert residue_of(source, source).is_empty


@settings(max_examples=30, deadline=None)
@given(mechanisms(), mechanisms())
def test_the_text_is_a_fixed_point(source: Mechanism, image: Mechanism) -> None:
    text = print_residue(residue_of(source, image))
    assert [print_residue(found) for found in parse_residues(text)] == [text]


def test_the_types_of_every_part_are_known() -> None:
    kinds = [
        kind
        for module in (geometry, parts, values)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Struct) and kind.__module__ == module.__name__
    ]
    assert [kind for kind in (*kinds, Edge, Arc) if set(hints_of(kind)) != {*kind.__struct_fields__}] == []
    assert settled(parts.Camera, "resolution", (640.0, 480.0)) == (640, 480)
