"""Denavit-Hartenberg parameters: the canonical numbers of every chain from the base to a tip."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import Pair, worst
from hymeko_x.verify.dh import chain, chains, lines_of
from hymeko_x.verify.dh_signature import signature

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.verify.dh_lines import Link
    from hymeko_x.verify.verdict import Check

_MOST_ROWS = 3000  # of all chains together; forward kinematics covers what is left out
_ALLOWED = 1e-7  # m and rad: common normals of axes 3 degrees apart amplify errors by some hundreds


def check_chains(pair: Pair) -> Iterator[Check]:
    """Lengths (a and d) and angles (theta, alpha, beta) of the chains that both robots have."""
    lengths: list[float] = []
    angles: list[float] = []
    labels: list[str] = []
    for i, j, dofs_a, dofs_b in _chains(pair):
        ours, theirs = _signature(pair, i, dofs_a, first=True), _signature(pair, j, dofs_b, first=False)
        for dof, x, y in zip(dofs_a, ours, theirs, strict=True):
            lengths.append(max(abs(x.d - y.d), abs(x.a - y.a)))
            angles.append(max(_apart(x.theta, y.theta), _apart(x.alpha, y.alpha), _apart(x.beta, y.beta)))
            labels.append(f"{pair.a.dof_label(dof)} in the chain to {pair.a.body_label(i)}")
    if labels:
        yield worst("DH parameters, lengths", "m", np.array(lengths), pair.allowed(_ALLOWED, 50.0), lambda k: labels[k])
        yield worst("DH parameters, angles", "rad", np.array(angles), pair.allowed(_ALLOWED, 50.0), lambda k: labels[k])


def _chains(pair: Pair) -> Iterator[tuple[int, int, list[int], list[int]]]:
    """The tips of the first robot that have a counterpart below the same dofs, as long as there are not too many."""
    partner, bodies = dict(pair.match.dofs), dict(pair.match.bodies)
    rows = 0
    for i in chains(pair.a):
        dofs = chain(pair.a, i)[1]
        if i not in bodies or not dofs:
            continue
        theirs = chain(pair.b, bodies[i])[1]
        if [partner.get(d) for d in dofs] != theirs or any(pair.a.dofs[d].kind is not pair.b.dofs[partner[d]].kind for d in dofs):
            continue
        rows += len(dofs)
        if rows > _MOST_ROWS:
            pair.notes.append(f"DH parameters: more than {_MOST_ROWS} rows; kinematics cover the other chains")
            return
        yield i, bodies[i], dofs, theirs


def _signature(pair: Pair, body: int, dofs: list[int], *, first: bool) -> tuple[Link, ...]:
    model, poses, rest = (pair.a, pair.zero_a, None) if first else (pair.b, pair.zero_b, pair.rest_b)
    lines, frames = lines_of(model, chain(model, body)[0], body, dofs, poses, rest)
    return signature(lines, frames[1])


def _apart(a: float, b: float) -> float:
    """The distance of two angles on the circle."""
    return abs(math.remainder(a - b, 2.0 * math.pi))
