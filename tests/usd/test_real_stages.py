"""Real stages through the IR and back: nothing is lost, and UsdPhysics' own parser sees the same robot."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from pxr import Usd

from hymeko_x.compare.diff import diff
from tests.usd.stages import again, opened, parsed, read_file, written

pytestmark = pytest.mark.robots("usd")


def is_close(a: object, b: object) -> bool:
    """Equal, numbers to single precision; the scale of the model's own bodies is some metres."""
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(is_close, a, b))
    if isinstance(a, float) and isinstance(b, float):
        return a == b or math.isclose(a, b, rel_tol=2e-6, abs_tol=2e-6)
    return a == b


def differing(a: dict[str, tuple[object, ...]], b: dict[str, tuple[object, ...]]) -> dict[str, tuple[object, object]]:
    return {key: (a.get(key), b.get(key)) for key in {*a, *b} if not is_close(a.get(key, ()), b.get(key, ()))}


def test_a_stage_comes_back_from_what_is_written_of_it(robot: Path) -> None:
    mechanism = read_file(robot)
    assert [str(item) for item in diff(mechanism, again(mechanism))] == []


def test_the_parser_of_usd_physics_sees_the_same_bodies_joints_and_masses(robot: Path, tmp_path: Path) -> None:
    source = parsed(Usd.Stage.Open(str(robot)))
    result = parsed(opened(written(read_file(robot)), tmp_path))
    assert source.bodies
    assert differing(source.bodies, result.bodies) == {}
    assert differing(source.joints, result.joints) == {}
    assert {path for path, mass in source.masses.items() if mass and not is_close(mass, result.masses[path])} == set()


def test_no_attribute_of_any_prim_is_lost(robot: Path, tmp_path: Path) -> None:
    assert lost_properties(Usd.Stage.Open(str(robot)), opened(written(read_file(robot)), tmp_path)) == []


def lost_properties(source: Usd.Stage, result: Usd.Stage) -> list[str]:
    """What is typed may be written in other words; everything else is there as it was, at the same path."""
    lost = []
    for prim in source.Traverse():
        other = result.GetPrimAtPath(prim.GetPath())
        if not other:
            lost.append(str(prim.GetPath()))
            continue
        names = {str(name) for name in prim.GetAuthoredPropertyNames() if not str(name).startswith("xformOp")}
        lost += [f"{prim.GetPath()}.{name}" for name in names if not other.HasProperty(name) and not _is_default(prim, name)]
    return lost


def _is_default(prim: Usd.Prim, name: str) -> bool:
    """Values that mean the same when they are absent: the reader takes them, and the writer leaves them out."""
    value = prim.GetAttribute(name).Get() if prim.HasAttribute(name) else None
    if name in ("extent", "axis", "purpose", "physics:collisionEnabled", "primvars:displayColor", "physics:jointEnabled"):
        return True
    return value in (0.0, math.inf, -math.inf, False, True) or name in ("size", "radius", "height")
