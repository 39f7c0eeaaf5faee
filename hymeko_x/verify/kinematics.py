"""Forward kinematics of many configurations at once, level by level over the tree, and the configurations to compare at."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from hymeko_x.verify.model import Array, Coupling, Dof, Index, Kind, KinematicModel
from hymeko_x.verify.spatial import angle_between, random_quats, rigid, rotation_about, rotation_from_quat

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

_POSES_AT_ONCE = 20_000  # keeps the memory of one batch at a few MB, whatever the number of samples


class _Slot(Struct, frozen=True, eq=False):
    """The k-th dof of every body that has one, of one kind: which bodies, which columns, and the dofs' constants."""

    kind: Kind
    bodies: Index
    columns: Index
    axes: Array
    anchors: Array
    refs: Array
    pitches: Array


class Kinematics(Struct, frozen=True, eq=False):
    """A model prepared for batched forward kinematics. Make it with :func:`prepare`."""

    placements: Array
    slots: tuple[_Slot, ...]
    levels: tuple[tuple[Index, Index], ...]

    def poses(self, q: Array) -> Array:
        """World poses (n, bodies, 4, 4) at configurations q (n, width)."""
        local = np.broadcast_to(self.placements, (len(q), *self.placements.shape)).copy()
        for slot in self.slots:
            local[:, slot.bodies] = local[:, slot.bodies] @ _motion(slot, q)
        for bodies, parents in self.levels:
            local[:, bodies] = local[:, parents] @ local[:, bodies]
        return local

    def batches(self, q: Array) -> Iterator[tuple[slice, Array]]:
        """The poses of all configurations in slices small enough for flat memory."""
        step = max(1, _POSES_AT_ONCE // max(1, len(self.placements)))
        for start in range(0, len(q), step):
            rows = slice(start, min(start + step, len(q)))
            yield rows, self.poses(q[rows])


def prepare(model: KinematicModel, *, pinned: frozenset[int] = frozenset()) -> Kinematics:
    """The constants of a model's forward kinematics.

    The bodies in ``pinned`` are on the world's frame whatever their joint: bases whose pose is not compared.
    """
    placements = np.stack([np.eye(4) if i in pinned else body.joint.placement for i, body in enumerate(model.bodies)])
    return Kinematics(placements, _slots(model, pinned), _levels(model))


def _slots(model: KinematicModel, pinned: frozenset[int]) -> tuple[_Slot, ...]:
    members: dict[tuple[int, str], list[tuple[int, int]]] = {}
    for body, first in enumerate(model.first_dof):
        if body in pinned:
            continue
        for place, dof in enumerate(model.bodies[body].joint.dofs):
            members.setdefault((place, dof.kind.value), []).append((body, first + place))
    return tuple(_slot(model, Kind(kind), pairs) for (_, kind), pairs in sorted(members.items()))


def _slot(model: KinematicModel, kind: Kind, pairs: list[tuple[int, int]]) -> _Slot:
    dofs = [model.dofs[dof] for _, dof in pairs]
    return _Slot(
        kind,
        np.array([body for body, _ in pairs], dtype=np.intp),
        np.array([model.columns[dof] for _, dof in pairs], dtype=np.intp),
        np.stack([dof.axis for dof in dofs]),
        np.stack([dof.anchor for dof in dofs]),
        np.array([dof.ref for dof in dofs]),
        np.array([dof.pitch for dof in dofs]),
    )


def _levels(model: KinematicModel) -> tuple[tuple[Index, Index], ...]:
    depth = [0] * len(model.bodies)
    levels: dict[int, list[int]] = {}
    for index, body in enumerate(model.bodies[1:], start=1):
        depth[index] = depth[body.parent] + 1
        levels.setdefault(depth[index], []).append(index)
    return tuple(
        (np.array(bodies, dtype=np.intp), np.array([model.bodies[i].parent for i in bodies], dtype=np.intp))
        for _, bodies in sorted(levels.items())
    )


def _motion(slot: _Slot, q: Array) -> Array:
    """Tr(a) M(q - ref) Tr(-a) of every dof of the slot, (n, dofs, 4, 4)."""
    match slot.kind:
        case Kind.FREE:
            pose = q[:, slot.columns[:, None] + np.arange(7)]
            return rigid(rotation_from_quat(pose[..., 3:]), pose[..., :3])
        case Kind.BALL:
            turn = rotation_from_quat(q[:, slot.columns[:, None] + np.arange(4)])
            return _about(turn, slot.anchors, np.zeros(3))
        case Kind.HINGE | Kind.SCREW:
            angle = q[:, slot.columns] - slot.refs
            shift = slot.axes * (slot.pitches * angle)[..., None]
            return _about(rotation_about(slot.axes, angle), slot.anchors, shift)
        case Kind.SLIDE:
            shift = slot.axes * (q[:, slot.columns] - slot.refs)[..., None]
            return rigid(np.eye(3), shift)


def _about(turn: Array, anchors: Array, shift: Array) -> Array:
    """A turn that keeps the anchors in place, followed by a shift."""
    return rigid(turn, anchors - (turn @ anchors[..., None])[..., 0] + shift)


_AGREEMENT = 1e-9
"""In m, of larger robots the part of their reach, and in rad: two readers of one file compute in doubles."""


def disagreement(model: KinematicModel, engine: Callable[[Array], Array], count: int = 3) -> str:
    """Where the world poses that an engine computes differ from the model's; "" when nowhere.

    ``engine`` takes configurations (n, width) of the model and returns the poses (n, bodies, 4, 4) of its bodies.
    """
    q = draw(model, count, np.random.default_rng(0))
    ours, theirs = prepare(model).poses(q), engine(q)
    distance = np.linalg.norm(ours[..., :3, 3] - theirs[..., :3, 3], axis=-1).max(axis=0)
    angle = angle_between(ours[..., :3, :3], theirs[..., :3, :3]).max(axis=0)
    worst = int(np.argmax(np.maximum(distance, angle)))
    if max(distance[worst], angle[worst]) <= _AGREEMENT * (1 + float(np.abs(ours[..., :3, 3]).max())):
        return ""
    return f"{model.body_label(worst)} is {distance[worst]:.3g} m and {angle[worst]:.3g} rad apart"


# ---- configurations to compare at ------------------------------------------------------------------------------------

_REACH = {Kind.HINGE: 2 * np.pi, Kind.SCREW: 2 * np.pi, Kind.SLIDE: 10.0}
"""In rad or m from the reference: where wider limits are cut, because rounding errors grow with the coordinate."""

_UNLIMITED = {Kind.HINGE: np.pi, Kind.SCREW: np.pi, Kind.SLIDE: 1.0}
"""In rad or m from the reference, in both directions: the range of a coordinate without limits."""


def draw(model: KinematicModel, count: int, rng: np.random.Generator) -> Array:
    """Configurations (count + 3, width): the authored pose, all lower limits, all upper limits, then random ones inside.

    Limits beyond two turns or 10 m are cut there; without limits a hinge takes one turn and a slide 2 m. Balls and free
    joints are at rest in the first three rows. Followers are computed from their leaders in every row.
    """
    q = np.zeros((count + 3, model.width))
    for dof, column in zip(model.dofs, model.columns, strict=True):
        _fill(q, dof, column, rng)
    follow(model, q)
    return q


def _fill(q: Array, dof: Dof, column: int, rng: np.random.Generator) -> None:
    count = len(q) - 3
    if dof.kind is Kind.BALL:
        q[:3, column] = 1.0
        q[3:, column : column + 4] = random_quats(rng, count)
    elif dof.kind is Kind.FREE:
        q[:3, column + 3] = 1.0
        q[3:, column : column + 3] = rng.uniform(-1, 1, (count, 3))
        q[3:, column + 3 : column + 7] = random_quats(rng, count)
    else:
        lower, upper = bounds(dof)
        q[:3, column] = dof.ref, lower, upper
        q[3:, column] = rng.uniform(lower, upper, count)


def bounds(dof: Dof) -> tuple[float, float]:
    """The finite range that a scalar dof is sampled in. [0, 0] is how exporters write "no limits", so it moves freely."""
    reach, free = _REACH[dof.kind], _UNLIMITED[dof.kind]
    if dof.lower == dof.upper == 0.0:
        return -free, free
    lower = max(dof.lower, dof.ref - reach) if np.isfinite(dof.lower) else dof.ref - free
    upper = min(dof.upper, dof.ref + reach) if np.isfinite(dof.upper) else dof.ref + free
    return (lower, upper) if lower <= upper else (dof.ref, dof.ref)


def follow(model: KinematicModel, q: Array) -> None:
    """Sets the followers' columns in place, leaders before their followers; a circle of followers is cut at its first."""
    for coupling in ordered(model):
        value = np.full(len(q), coupling.constant)
        for leader, coefficients in coupling.leaders:
            x = q[:, model.columns[leader]]
            value += x * np.polynomial.polynomial.polyval(x, np.asarray(coefficients)) if coefficients else 0.0
        q[:, model.columns[coupling.follower]] = value


def ordered(model: KinematicModel) -> Sequence[Coupling]:
    """The couplings, every leader's own coupling before the couplings that it leads."""
    by_follower = {coupling.follower: coupling for coupling in model.couplings}
    order: dict[int, Coupling] = {}
    visited: set[int] = set()
    stack = list(by_follower)[::-1]
    while stack:
        dof = stack[-1]
        leaders = [] if dof in visited else [leader for leader, _ in by_follower[dof].leaders if leader in by_follower]
        visited.add(dof)
        waiting = [leader for leader in leaders if leader not in visited]
        if waiting:
            stack += waiting
        else:
            order.setdefault(stack.pop(), by_follower[dof])
    return list(order.values())
