"""Closures of more than two bodies, which formats write as several of two."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

MOBILE = """mobile : robot {{
  hub {{ mass 1 inertia [0.1 0.1 0.1] }} ring {{ mass 1 inertia [0.1 0.1 0.1] }}
  a {{ mass 1 inertia [0.1 0.1 0.1] }} b {{ mass 1 inertia [0.1 0.1 0.1] }} c {{ mass 1 inertia [0.1 0.1 0.1] }}
  @base : fixed {{ + world - hub }} @turn {{ + hub - ring axis=Z }}
  @hip {{ + hub - a axis=Y }} @knee {{ + hub - b axis=X }} @toe {{ [0 0 0.2] + hub - c axis=Y }}
  @knot : {kind} {{ [0 0 0.2] ~ a [0 0 0.2] ~ b ~ c }}
}}
"""


def test_a_closure_with_dofs_is_a_joint_that_closes_a_loop() -> None:
    text = "t : robot { base {} a {} @knot : loop { ~ base ~ a dof { moves=slide axis=Y } } @j { + base - a } }"
    assert "@knot : loop.joint { ~ base ~ a dof : slide { axis=Y } }" in hx.dumps(hx.loads(text, "hymeko"), "hymeko")


@pytest.mark.parametrize("suffix", [".xml", ".usda", ".sdf"])
@pytest.mark.parametrize("kind", ["connect", "weld"])
def test_a_closure_of_three_bodies_is_two_closures(kind: str, suffix: str, tmp_path: Path) -> None:
    source, target = tmp_path / "mobile.hymeko", tmp_path / f"mobile{suffix}"
    source.write_text(MOBILE.format(kind=kind))
    result = hx.convert(source, target, keep=True)
    notes = [str(one.message) for one in result.report if "knot" in one.message]
    assert notes == ["loop 'knot' joins 3 elements; it is written as 2 closures of the first with each other one"]
    verdict = hx.verify(source, target)
    (row,) = (row for row in verdict.checks if row.quantity == "loops")
    assert (row.passed, verdict.verdict) == (True, "same")
    assert "@knot : " + kind + " { [0 0 0.2] ~ a [0 0 0.2] ~ b ~ c }" in hx.dumps(hx.load(target), "hymeko")
