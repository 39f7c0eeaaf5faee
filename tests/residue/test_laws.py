"""The laws of the residue on arbitrary mechanisms: any one is restored from any other, in memory and through text."""

from __future__ import annotations

from dataclasses import fields, is_dataclass

from hypothesis import given, settings

from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts, values
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.residue.delta import residue_of
from hymeko_x.ir.residue.merge import restore
from hymeko_x.ir.residue.types import hints_of, settled
from hymeko_x.language.residue import parse_residue, print_residue
from hymeko_x.testing import mechanisms
from tests.residue.exactness import unequal


@settings(max_examples=80, deadline=None)
@given(mechanisms(), mechanisms())
def test_any_mechanism_is_restored_from_any_image(source: Mechanism, image: Mechanism) -> None:
    report = Report()
    residue = parse_residue(print_residue(residue_of(source, image)))
    assert unequal(source, restore(image, residue, report)) == []
    assert list(report) == []


@settings(max_examples=30, deadline=None)
@given(mechanisms())
def test_what_is_the_same_leaves_no_residue(source: Mechanism) -> None:
    assert residue_of(source, source).is_empty


@settings(max_examples=30, deadline=None)
@given(mechanisms(), mechanisms())
def test_the_text_is_a_fixed_point(source: Mechanism, image: Mechanism) -> None:
    text = print_residue(residue_of(source, image))
    assert print_residue(parse_residue(text)) == text


def test_the_types_of_every_part_are_known() -> None:
    kinds = [kind for module in (parts, values) for kind in vars(module).values() if isinstance(kind, type) and is_dataclass(kind)]
    assert [kind for kind in (*kinds, Edge, Arc) if set(hints_of(kind)) != {item.name for item in fields(kind)}] == []
    assert settled(parts.Camera, "resolution", (640.0, 480.0)) == (640, 480)
