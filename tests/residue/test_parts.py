"""Which shapes of the image are the parts of one capsule of the source."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Capsule, Cylinder, Role, Shape, Sphere
from hymeko_x.residue import Residue, WholeElement
from hymeko_x.residue.parts import capsules_of

if TYPE_CHECKING:
    from hymeko_x.ir.parts import Geometry


def element(name: str, geometry: Geometry) -> WholeElement:
    return WholeElement(Id("shape", name), Edge(Shape(geometry, Role.VISUAL), (Arc(Id("body", "leg"), 1),)))


@pytest.mark.parametrize("balls", range(4))
def test_a_capsule_without_length_takes_each_part_once(balls: int) -> None:
    """Both ends are in one place; a damaged record may have fewer than both."""
    rod, *ends = [element("bar", Cylinder(0.1, 0.0)), *(element(f"ball#{number}", Sphere(0.1)) for number in range(balls))]
    capsule = element("capsule", Capsule(0.1, 0.0))
    expected = {} if balls < 2 else {part.id: capsule.id for part in (rod, *ends[:2])}
    assert capsules_of(Residue(additions=(capsule,), removals=(rod, *ends))) == expected
