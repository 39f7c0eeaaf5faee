"""Mass, centre and inertia tensor of each body, or of a rigid group where one robot merged bodies.

Compared: mass in kg, centre in m, tensor in kg m^2 (not eigenframes: axes of equal moments are arbitrary). Allowed: 1e-9 of the value,
1e-9 m, and the least inertia that MuJoCo needs where the second robot was made for it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import RELATIVE, Differences, Pair
from hymeko_x.verify.model import WORLD, Array, Body, KinematicModel
from hymeko_x.verify.spatial import shifted_tensor

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.verify.verdict import Check

Inertia = tuple[float, Array, Array]
"""Mass in kg, centre in m, tensor about the centre in kg m^2, all in one frame."""

CENTRE = 1e-9
"""In m."""

_LEAST = 2e-10
"""In kg and kg m^2: the inertia that a massless moving body gets for an engine that refuses it."""

_MARGIN = 2e-11
"""In kg and kg m^2: MuJoCo's solver needs some 1e-12 where a tensor is at the edge of those that a body can have."""

_DUST = 1e-13
"""In kg and kg m^2: the rounding of what is left when an engine's sum over rigidly joined bodies is taken apart."""

_ZERO_MOMENT = 1e-15
"""In kg m^2: what engines take for zero."""

_EDGE = 1e-11
"""In kg m^2: by so much a moment may exceed the sum of the others, because it was rounded."""

_SPREAD = 1e-12
"""Of mass times squared distance of the centre: the same rounding, of tensors about the frame's origin."""


def check_inertia(pair: Pair) -> Iterator[Check]:
    """Worst mass, centre and tensor."""
    masses, centres, tensors = Differences("mass", "kg"), Differences("centre of mass", "m"), Differences("inertia tensor", "kg m^2")
    relative = pair.allowed(RELATIVE)
    for label, (mass, centre, tensor), (other_mass, other_centre, other_tensor) in _units(pair):
        floor = _floor(pair, (mass, centre, tensor))
        if not (mass or other_mass or tensor.any() or other_tensor.any()):
            continue
        masses.add(abs(mass - other_mass), max(relative * abs(mass), floor, _DUST), label, mass, other_mass)
        if min(abs(mass), abs(other_mass)) > _LEAST:
            distance = float(np.linalg.norm(centre - other_centre))
            centres.add(distance, max(CENTRE, relative * float(np.abs(centre).max())), label, centre, other_centre)
        rounding = _DUST + _SPREAD * abs(mass) * float(centre @ centre)
        lever = abs(mass) * max(float(centre @ centre), float(other_centre @ other_centre))  # what a shift of the parts by rounding changes
        allowed = max(relative * max(float(np.abs(tensor).max()), lever), floor, rounding)
        tensors.add(float(np.abs(tensor - other_tensor).max()), allowed, label, tensor, other_tensor)
    yield from (*masses.checks(), *centres.checks(), *tensors.checks())


def _floor(pair: Pair, inertia: Inertia) -> float:
    """The inertia that may appear where the second robot's engine needs some on everything that moves and the first robot has none."""
    if not _gets_least_mass(pair):
        return 0.0
    return _LEAST if inertia[0] <= _LEAST or np.linalg.eigvalsh(inertia[2])[0] <= _LEAST else _MARGIN


def _gets_least_mass(pair: Pair) -> bool:
    """Whether one of two formats has an engine that refuses inertias: a converter then gives the least, or had got it before."""
    return pair.a.row is not pair.b.row and (pair.a.row.requires_mass or pair.b.row.requires_mass)


def repaired_bodies(pair: Pair) -> list[tuple[int, int]]:
    """Pairs of bodies whose inertia was accepted although it differs: they are left out of the dynamics."""
    found: list[tuple[int, int]] = []
    for i, j in pair.match.bodies[1:]:
        ours, theirs = pair.a.bodies[i], pair.b.bodies[j]
        if not (_comparable(ours, theirs) and ours.tensor_is_known):
            found.append((i, j))
        elif _gets_least_mass(pair):
            x, y = of_body(ours), of_body(theirs)
            difference = max(abs(x[0] - y[0]), float(np.abs(x[2] - y[2]).max()))
            unphysical = not is_physical(x[2]) and is_physical(y[2])
            if unphysical or RELATIVE * float(np.abs(x[2]).max()) < difference <= _floor(pair, x):
                found.append((i, j))
    return found


# ---- bodies and rigid groups -----------------------------------------------------------------------------------------


def _units(pair: Pair) -> Iterator[tuple[str, Inertia, Inertia]]:
    """Body by body, with its label; group by group where a body of a rigid group has no partner."""
    group_a, group_b = fixed_groups(pair.a), fixed_groups(pair.b)
    merged_a = {group_a[i] for i in pair.match.unmatched_a if pair.a.bodies[i].mass}
    merged_b = {group_b[j] for j in pair.match.unmatched_b if pair.b.bodies[j].mass}
    members_a, members_b = _members(group_a), _members(group_b)
    seen: set[tuple[int, int]] = set()
    unknown: list[str] = []
    for i, j in pair.match.bodies[1:]:
        groups = group_a[i], group_b[j]
        if not _comparable(pair.a.bodies[i], pair.b.bodies[j]):
            unknown.append(pair.a.body_label(i))
            continue
        whole = groups[0] in merged_a or groups[1] in merged_b
        if whole and (groups in seen or WORLD in groups):
            continue
        seen.add(groups)
        label = f"what is fixed to {pair.a.body_label(i)}" if whole else pair.a.body_label(i)
        ours = _sum_in(pair.a, members_a[groups[0]], i) if whole else of_body(pair.a.bodies[i])
        theirs = _sum_in(pair.b, members_b[groups[1]], j) if whole else of_body(pair.b.bodies[j])
        yield label, *_without_unknown(pair, label, ours, theirs)
    if unknown:
        pair.notes.append(
            f"inertia of {len(unknown)} bodies: not given in one of the files, so that each engine computes another ({unknown[0]})"
        )


def _comparable(ours: Body, theirs: Body) -> bool:
    """Whether both files give an inertia. A mass in the first and none in the second is a difference."""
    return ours.inertia_is_known and (theirs.inertia_is_known or ours.mass > 0.0)


def _without_unknown(pair: Pair, label: str, ours: Inertia, theirs: Inertia) -> tuple[Inertia, Inertia]:
    """Without tensors that the first file does not give, and those that no body can have and MuJoCo refuses: only masses are compared.

    A tensor that only the second file does not give is a difference.
    """
    theirs = theirs[0], theirs[1], np.nan_to_num(theirs[2])
    unknown = bool(np.isnan(ours[2]).any())
    repaired = not unknown and _gets_least_mass(pair) and not is_physical(ours[2]) and is_physical(theirs[2])
    if unknown:
        pair.notes.append(f"inertia tensor: {pair.a.format} does not give that of {label}")
    if repaired:
        pair.notes.append(f"inertia tensor: that of {label} is not physical in {pair.a.format}, and {pair.b.engine} refuses it")
    return ((ours[0], ours[1], theirs[2]) if unknown or repaired else ours), theirs


def of_body(body: Body) -> Inertia:
    """The inertia of one body in its own frame; a tensor that its file does not give is not a number."""
    return body.mass, body.com, body.tensor if body.tensor_is_known else np.full((3, 3), np.nan)


def is_physical(tensor: Array) -> bool:
    """Whether a body with an extent in all directions can have this tensor, or it is zero.

    Its principal moments are positive, and none is larger than the sum of the others.
    """
    low, middle, high = np.linalg.eigvalsh(tensor)
    if low < -_ZERO_MOMENT or low + middle < high - (_EDGE + RELATIVE * abs(high)):
        return False
    return bool(low > _ZERO_MOMENT or high < _ZERO_MOMENT or low + middle > high + _ZERO_MOMENT)


def fixed_groups(model: KinematicModel) -> list[int]:
    """For each body the topmost body that it is rigidly joined to."""
    group = list(range(len(model.bodies)))
    for i, body in enumerate(model.bodies[1:], start=1):
        if not body.joint.dofs and not body.joint.open:
            group[i] = group[body.parent]
    return group


def _members(group: list[int]) -> dict[int, list[int]]:
    members: dict[int, list[int]] = {}
    for i, top in enumerate(group):
        members.setdefault(top, []).append(i)
    return members


def _sum_in(model: KinematicModel, members: list[int], frame: int) -> Inertia:
    """The inertia of rigidly joined bodies together, in the frame of one of them."""
    place: dict[int, Array] = {members[0]: np.eye(4)}
    for i in members[1:]:
        place[i] = place[model.bodies[i].parent] @ model.bodies[i].joint.placement
    back = np.linalg.inv(place[frame])
    parts = [moved(of_body(model.bodies[i]), back @ place[i]) for i in members if i != WORLD]
    return combined(parts)


def moved(inertia: Inertia, transform: Array) -> Inertia:
    """The same inertia seen from another frame."""
    turn, shift = transform[:3, :3], transform[:3, 3]
    return inertia[0], turn @ inertia[1] + shift, turn @ inertia[2] @ turn.T


def combined(parts: list[Inertia]) -> Inertia:
    """Mass, centre and tensor of several bodies in one frame (parallel axes)."""
    mass = sum(part[0] for part in parts)
    if mass == 0.0:
        return 0.0, np.zeros(3), sum((part[2] for part in parts), np.zeros((3, 3)))
    centre = sum((part[0] * part[1] for part in parts), np.zeros(3)) / mass
    tensor = np.zeros((3, 3))
    for part in parts:
        tensor += shifted_tensor(part[0], part[1] - centre, part[2])
    return mass, centre, tensor
