"""Mechanisms with closed loops at a configuration: closing them, and the velocities that keep them closed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.couplings import independent
from hymeko_x.dynamics.positions import nearest
from hymeko_x.ir import parts

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.trees import Trees

    Floats = NDArray[np.floating[Any]]

_CLOSED = 1e-9
"""In m, or twice the sine of an angle: gaps up to which a loop is closed."""
_RANK = 1e-8
_WELL = 0.05
"""A coordinate follows others only where at least this part of what it does to the closures is its own, if there are such."""


def assembled(found: Trees, z: Sequence[float], kept: Collection[str] = ()) -> list[float]:
    """The positions next to z with closed loops; the joints ``kept`` stay where they are.

    Raises: Refusal (HX408) that names the loop with the widest gap when they cannot be closed.
    """
    if not found.closures:
        return list(z)
    at = nearest(independent(found.tree, found.followers), found.closed_at, z, kept)
    phi, _ = found.closed_at(at)
    if abs(phi).max() > _CLOSED:
        raise _open(found, phi)
    return at


def _open(found: Trees, phi: Floats) -> Exception:
    worst, at = 0.0, 0
    name = found.closures[0].id
    for closure in found.closures:
        count = closure.rows
        gap = float(abs(phi[at : at + count]).max())
        at += count
        if gap > worst:
            worst, name = gap, closure.id
    message = f"{name} cannot be closed near that configuration; a gap of {worst:.3g} remains"
    hint = "--at joint=value,... holds these joints and closes the loops with the others"
    return refuse(codes.NO_FORM, message, found.mechanism.origin(name), element=str(name), hint=hint)


class IndependentVelocities(NamedTuple):
    """Independent velocities of a mechanism with loops: their columns, and the matrix T with z' = T times these velocities."""

    columns: list[int]
    basis: Floats


def reduction(found: Trees, z: Sequence[float]) -> IndependentVelocities:
    """The velocities that the loops leave at z: those of driven joints first, then in the order of the tree."""
    import numpy as np

    links = independent(found.tree, found.followers)
    width = sum(link.velocities for link in links)
    if not found.closures:
        return IndependentVelocities(list(range(width)), np.eye(width))
    _, slope = found.closed_at(z)
    driven = {arc.target for _, _, arcs in found.mechanism.edges(parts.Drive) for arc in arcs if arc.sign < 0}
    order = [(link.joint in driven, column) for column, link in enumerate([k for k in links for _ in range(k.velocities)])]
    candidates = [column for _, column in sorted(order, key=lambda pair: (pair[0], -pair[1]))]
    following = _following(slope, candidates)
    columns = [column for column in range(width) if column not in following]
    basis = np.zeros((width, len(columns)))
    basis[columns, range(len(columns))] = 1.0
    if following:
        basis[following] = np.linalg.lstsq(slope[:, following], -slope[:, columns], rcond=_RANK)[0]
    basis[np.abs(basis) < 1e-14] = 0.0
    return IndependentVelocities(columns, basis)


def _following(slope: Floats, candidates: Sequence[int]) -> list[int]:
    """As many columns, in the order of the candidates, as J has independent ones."""
    import numpy as np

    scale = max(1e-300, float(np.linalg.norm(slope, 2)))
    rank = int(np.linalg.matrix_rank(slope, tol=_RANK * scale))
    basis = np.zeros((len(slope), 0))
    found: list[int] = []
    for least in (_WELL, _RANK):
        for column in candidates:
            if column in found or len(found) == rank:
                continue
            rest = slope[:, column] - basis @ (basis.T @ slope[:, column])
            size = float(np.linalg.norm(rest))
            if size > _RANK * scale and size > least * float(np.linalg.norm(slope[:, column])):
                rest = rest - basis @ (basis.T @ rest)
                basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
                found.append(column)
    return sorted(found)
