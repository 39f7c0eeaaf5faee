"""Couplings as NewtonMimicAPI, with the higher powers of MjcEqualityJointAPI."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x.backends.usd.sheet import T, apply, dof_of, point, put
from hymeko_x.formats import usd as words
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Coupling, DofKind

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet, WrittenPrim
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Dof


class _Follower(NamedTuple):
    """A coupling with one leader: the prims and dofs of both ends, and the coefficients."""

    key: Id
    coupling: Coupling
    spec: WrittenPrim
    dof: Dof
    leader: WrittenPrim
    weight: tuple[float, ...]


def write_mimics(sheet: UsdSheet) -> None:
    """Each coupling with one leader as Newton's mimic; the constant of a hinge in degrees. MuJoCo's schema has powers up to four.

    Newton refuses a leader that follows another joint itself, so that it is led by the first of its leaders.
    """
    followers: dict[Any, _Follower] = {}
    for key, coupling, arcs in sheet.mechanism.edges(Coupling):
        found = _follower(sheet, key, coupling, arcs)
        if found is not None:
            followers.setdefault(found.spec.path, found)
    for found in followers.values():
        spec, weight = found.spec, found.weight
        if sheet.mechanism.notation(found.key, words.EQUALITY) is None:
            leader, native = _first_leader(found, followers)
            for names in (words.NEWTON_MIMIC, words.NEUTRAL_MIMIC) if sheet.is_neutral else (words.NEWTON_MIMIC,):
                _write_mimic(names, spec, leader.path, found.dof, native, found.coupling.active)
            _write_powers(spec, weight, 2)
        else:
            apply(spec, "MjcEqualityJointAPI")
            point(spec, "mjc:target", found.leader.path)
            _write_powers(spec, weight, 0)
        sheet.paths[found.key] = spec.path


def _follower(sheet: UsdSheet, key: Id, coupling: Coupling, arcs: tuple[RobotArc, ...]) -> _Follower | None:
    follower = next((arc for arc in arcs if arc.sign > 0), None)
    leaders = [arc for arc in arcs if arc.sign < 0]
    if follower is None or len(leaders) != 1:
        return None
    here, there = dof_of(sheet, follower), dof_of(sheet, leaders[0])
    weight = numbers_weight(leaders[0]) or (0.0, 1.0)
    if here is None or there is None or len(weight) > 5:
        return None
    return _Follower(key, coupling, here[0], here[2], there[0], weight)


def _first_leader(found: _Follower, followers: dict[Any, _Follower]) -> tuple[WrittenPrim, tuple[float, ...]]:
    """The leader that is no follower, and the coefficients with respect to it: a + b (c + d x) = (a + b c) + b d x."""
    leader, weight = found.leader, found.weight
    passed = {found.spec.path}
    while leader.path in followers and leader.path not in passed and len(weight) == 2:
        above = followers[leader.path]
        if len(above.weight) != 2:
            break
        passed.add(leader.path)
        leader, weight = above.leader, (weight[0] + weight[1] * above.weight[0], weight[1] * above.weight[1])
    return (leader, weight) if leader.path not in passed else (found.leader, found.weight)


def _write_mimic(names: words.MimicSchema, spec: Any, leader: Any, dof: Dof, weight: tuple[float, ...], is_active: bool) -> None:
    apply(spec, names.schema)
    point(spec, names.leader, leader)
    constant = weight[0] if weight else 0.0
    put(spec, names.offset, T.Float, math.degrees(constant) if dof.kind is DofKind.HINGE else constant)
    put(spec, names.factor, T.Float, weight[1] if len(weight) > 1 else 0.0)
    if not is_active:
        put(spec, names.enabled, T.Bool, False)


def _write_powers(spec: Any, weight: tuple[float, ...], first: int) -> None:
    """The coefficients of MuJoCo's schema from this power on; the default is 1 for the first power, else 0."""
    authored = [(power, value) for power, value in enumerate(weight) if power >= first and value != (1.0 if power == 1 else 0.0)]
    for power, value in authored:
        apply(spec, "MjcEqualityJointAPI")
        put(spec, f"mjc:coef{power}", T.Double, value)
