"""Mass, centre and tensor of each body, or of what is rigidly joined where one robot merged bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.checks.pair import Pair, worst
from hymeko_x.verify.model import WORLD, Array, Body, KinematicModel

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.verify.verdict import Check

Inertia = tuple[float, Array, Array]
"""Mass in kg, centre in m, tensor about the centre in kg m^2, all in one frame."""

_MARGIN = 2e-11
_LEAST = 2e-10  # what an engine that refuses massless moving bodies gets instead, in kg and kg m^2


def check_inertia(pair: Pair) -> Iterator[Check]:
    """Worst mass, centre and tensor. Tensors are compared, not eigenframes: axes of equal moments are arbitrary."""
    labels, ours, theirs = _units(pair)
    mass = np.array([abs(x[0] - y[0]) for x, y in zip(ours, theirs, strict=True)])
    weighty = [k for k, (x, y) in enumerate(zip(ours, theirs, strict=True)) if min(abs(x[0]), abs(y[0])) > _LEAST]
    centre = np.array([float(np.linalg.norm(ours[k][1] - theirs[k][1])) for k in weighty])
    tensor = np.array([float(np.abs(x[2] - y[2]).max()) for x, y in zip(ours, theirs, strict=True)])
    relative = max(1e-9, 8.0 * pair.precision)
    masses = np.array([abs(x[0]) for x in ours])
    sizes = np.array([float(np.abs(ours[k][1]).max()) for k in weighty])
    moments = np.array([float(np.abs(x[2]).max()) for x in ours])
    spread = masses * np.array([float(x[1] @ x[1]) for x in ours])
    floors = np.array([_floor(pair, x) for x in ours])
    yield worst("mass", "kg", mass, np.maximum(relative * masses, np.maximum(floors, 1e-13)), lambda k: labels[k])
    yield worst("centre of mass", "m", centre, np.maximum(1e-9, relative * sizes), lambda k: labels[weighty[k]])
    yield worst(
        "inertia tensor", "kg m^2", tensor, np.maximum(relative * moments, np.maximum(floors, 1e-13 + 1e-12 * spread)), lambda k: labels[k]
    )


def _floor(pair: Pair, inertia: Inertia) -> float:
    """What may appear out of nothing where MuJoCo needs mass on everything that moves and the first robot has none.

    Where a tensor is at the edge of what a body can have, MuJoCo's solver needs a margin of some 1e-12 kg m^2.
    """
    if not made_for_mujoco(pair):
        return 0.0
    return _LEAST if inertia[0] <= _LEAST or np.linalg.eigvalsh(inertia[2])[0] <= _LEAST else _MARGIN


def made_for_mujoco(pair: Pair) -> bool:
    """Whether the second robot is one for MuJoCo, which refuses inertias that the first robot's format allows."""
    return pair.b.format == "mjcf" and pair.a.format != "mjcf"


def repaired_bodies(pair: Pair) -> list[tuple[int, int]]:
    """Pairs of bodies whose inertia was accepted although it differs: what differs there says nothing about dynamics."""
    bodies = [(i, j, pair.a.bodies[i], pair.b.bodies[j]) for i, j in pair.match.bodies[1:]]
    found = [(i, j) for i, j, ours, theirs in bodies if not (_comparable(ours, theirs) and ours.shaped)]
    if not made_for_mujoco(pair):
        return found
    for i, j, ours, theirs in bodies:
        if not ours.shaped:
            continue
        x, y = of_body(ours), of_body(theirs)
        apart = max(abs(x[0] - y[0]), float(np.abs(x[2] - y[2]).max()))
        unphysical = not is_physical(x[2]) and is_physical(y[2])
        if unphysical or 1e-9 * float(np.abs(x[2]).max()) < apart <= _floor(pair, x):
            found.append((i, j))
    return found


# ---- what is compared with what --------------------------------------------------------------------------------------


def _units(pair: Pair) -> tuple[list[str], list[Inertia], list[Inertia]]:
    """Body by body; group by group where a body of a fixed group has no partner."""
    labels: list[str] = []
    ours: list[Inertia] = []
    theirs: list[Inertia] = []
    group_a, group_b = fixed_groups(pair.a), fixed_groups(pair.b)
    merged_a = {group_a[i] for i in pair.match.lone_a if pair.a.bodies[i].mass}
    merged_b = {group_b[j] for j in pair.match.lone_b if pair.b.bodies[j].mass}
    members_a, members_b = _members(group_a), _members(group_b)
    seen: set[tuple[int, int]] = set()
    unweighed: list[str] = []
    for i, j in pair.match.bodies[1:]:
        groups = group_a[i], group_b[j]
        if not _comparable(pair.a.bodies[i], pair.b.bodies[j]):
            unweighed.append(pair.a.body_label(i))
            continue
        whole = groups[0] in merged_a or groups[1] in merged_b
        if whole and (groups in seen or WORLD in groups):
            continue
        seen.add(groups)
        labels.append(f"what is fixed to {pair.a.body_label(i)}" if whole else pair.a.body_label(i))
        ours.append(_sum_in(pair.a, members_a[groups[0]], i) if whole else of_body(pair.a.bodies[i]))
        theirs.append(_sum_in(pair.b, members_b[groups[1]], j) if whole else of_body(pair.b.bodies[j]))
    if unweighed:
        pair.notes.append(
            f"inertia of {len(unweighed)} bodies: not said in one of the files, so every engine computes another ({unweighed[0]})"
        )
    return _without_unsaid(pair, labels, ours, theirs)


def _comparable(ours: Body, theirs: Body) -> bool:
    """Whether both files say something. A mass that the first says and the second does not is a difference."""
    return ours.weighed and (theirs.weighed or ours.mass > 0.0)


def _without_unsaid(
    pair: Pair, labels: list[str], ours: list[Inertia], theirs: list[Inertia]
) -> tuple[list[str], list[Inertia], list[Inertia]]:
    """Tensors that the first file does not say, and those that no body can have, which MuJoCo refuses: only masses are compared.

    A tensor that only the second file does not say is a difference.
    """
    theirs = [(mass, centre, np.nan_to_num(tensor)) for mass, centre, tensor in theirs]
    kept = []
    for label, x, y in zip(labels, ours, theirs, strict=True):
        unsaid = bool(np.isnan(x[2]).any())
        repaired = not unsaid and made_for_mujoco(pair) and not is_physical(x[2]) and is_physical(y[2])
        if unsaid:
            pair.notes.append(f"inertia tensor: {pair.a.format} does not say that of {label}")
        if repaired:
            pair.notes.append(f"inertia tensor: that of {label} is not physical in {pair.a.format}, and MuJoCo takes no such tensor")
        kept.append((x[0], x[1], y[2]) if unsaid or repaired else x)
    return labels, kept, theirs


def is_physical(tensor: Array) -> bool:
    """Whether a mass distribution can have this tensor: principal moments not negative, none above the sum of the others."""
    low, middle, high = np.linalg.eigvalsh(tensor)
    slack = 1e-11 + 1e-9 * abs(high)
    return bool(low >= -1e-15 and low + middle >= high - slack) and bool(low > 1e-15 or high < 1e-15 or low + middle > high + 1e-15)


def of_body(body: Body) -> Inertia:
    """The inertia of one body in its own frame; a tensor that its file does not say is not a number."""
    return body.mass, body.com, body.tensor if body.shaped else np.full((3, 3), np.nan)


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
        arm = part[1] - centre
        tensor += part[2] + part[0] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return mass, centre, tensor
