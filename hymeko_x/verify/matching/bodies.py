"""The counterpart of each body: by name, by its place in the tree, or by the shape of the tree."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from hymeko_x.verify.model import WORLD, Array, Body, Kind, KinematicModel

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Iterator, Sequence

_MOST_CARRIERS = 8
"""Between two bodies: no joint has more than six dofs, and a ball below three slides is all that needs more."""

_SAME_PLACE = 1e-5
"""In m, kg and as matrix entries, summed up: a body of another name that is where the other was, with its mass, has been renamed."""

_WORLD, _WORLD_LINK = "world", "world_link"
"""What a body may not be called beside the world in most formats, and what it is called there."""


# ---- bodies by name --------------------------------------------------------------------------------------------------


def identifier(name: str) -> str:
    """A name as an identifier: letters, digits and underscores, no digit first."""
    spelled = re.sub(r"\W", "_", name)
    return f"_{spelled}" if spelled[:1].isdigit() else spelled


def speller(a: KinematicModel, b: KinematicModel) -> Callable[[str], str]:
    """The spelling in which names of two robots are compared: as identifiers where one of the formats has no other names."""
    return identifier if a.row.names_are_identifiers or b.row.names_are_identifiers else str


def joint_speller(a: KinematicModel, b: KinematicModel) -> Callable[[str], str]:
    """The spelling in which names of joints are compared: without what sets them apart from bodies where a format needs that."""
    spell = speller(a, b)
    if a.row.joints_share_names or b.row.joints_share_names:
        return lambda name: spell(name).removesuffix("_joint")
    return spell


def pair_by_name(a: KinematicModel, b: KinematicModel) -> dict[int, int]:
    """For each matched body of the first robot the second's; bodies with no name or another one are matched by their place."""
    pairs = {WORLD: WORLD}
    taken = {WORLD}
    for i, body in enumerate(a.bodies[1:], start=1):
        j = b.index.get(body.name) if body.name is not None else None
        if j is not None and j not in taken:  # the world is taken: a link may have its name
            pairs[i] = j
            taken.add(j)
    if speller(a, b) is identifier:
        ours, theirs = _spelled(a, pairs), _spelled(b, taken)
        for spelling in ours.keys() & theirs.keys():
            pairs[ours[spelling]] = theirs[spelling]
            taken.add(theirs[spelling])
    for name, other in ((_WORLD, _WORLD_LINK), (_WORLD_LINK, _WORLD)):
        mine = next((k for k, body in enumerate(a.bodies) if body.name == name and k not in pairs), None)
        partner = next((k for k, body in enumerate(b.bodies) if body.name == other and k not in taken), None)
        if mine is not None and partner is not None:
            pairs[mine] = partner
            taken.add(partner)
    _pair_by_place(a, b, pairs, taken)
    return pairs


def _spelled(model: KinematicModel, taken: Container[int]) -> dict[str, int]:
    """The free bodies by their names as identifiers, where only one has it."""
    names = [(identifier(body.name), i) for i, body in enumerate(model.bodies) if body.name is not None and i not in taken]
    counts = Counter(name for name, _ in names)
    return {name: i for name, i in names if counts[name] == 1}


class _Limb(Struct, frozen=True, eq=False):
    """An unmatched descendant of a matched body, with nothing but carriers of dofs in between.

    ``names`` and ``kinds`` are those of all dofs up to the matched body, a ball being three hinges; ``pose`` is its pose there.
    """

    body: int
    names: tuple[str, ...]
    kinds: tuple[Kind, ...]
    pose: Array
    mass: float
    is_child: bool
    has_name: bool


def _pair_by_place(a: KinematicModel, b: KinematicModel, pairs: dict[int, int], taken: set[int]) -> None:
    """Unmatched children of matched bodies, by the names of their joints, else as the only ones of their kind there."""
    for parent in range(len(a.bodies)):
        if parent not in pairs:
            continue
        rivals = [k for k in a.children[parent] if k not in pairs]
        if not rivals:
            continue
        free = _Free([limb for j in b.children[pairs[parent]] for limb in _limbs(b, j, taken)])
        crowded = len(rivals) != free.count
        for limbs in [list(_limbs(a, k, pairs)) for k in rivals]:
            for limb in limbs:  # the first of a chain that has a counterpart
                other = _counterpart(limb, free, crowded=crowded)
                if other is not None:
                    pairs[limb.body] = other.body
                    taken.add(other.body)
                    free.remove(other)
                    break


def _limbs(model: KinematicModel, body: int, matched: Container[int]) -> Iterator[_Limb]:
    """A body, and as long as it only carries dofs its child."""
    names: tuple[str, ...] = ()
    kinds: tuple[Kind, ...] = ()
    pose = np.eye(4)
    for depth in range(_MOST_CARRIERS + 1):
        if body in matched:
            return
        part = model.bodies[body]
        names, kinds, pose = names + _joint_names(part), kinds + _hinged(part), pose @ part.joint.placement
        yield _Limb(body, names, kinds, pose, part.mass, depth == 0, part.name is not None)
        if not only_carries(model, body):
            return
        (body,) = model.children[body]


class _Free:
    """Limbs without a counterpart yet, by the names of their joints and by the kinds of their dofs."""

    def __init__(self, limbs: Sequence[_Limb]) -> None:
        self.count = sum(limb.is_child for limb in limbs)
        self._by_name: dict[str, list[_Limb]] = {}
        self._by_kinds: dict[tuple[Kind, ...], list[_Limb]] = {}
        for limb in limbs:
            self._by_kinds.setdefault(limb.kinds, []).append(limb)
            for name in set(limb.names):
                self._by_name.setdefault(name, []).append(limb)

    def remove(self, limb: _Limb) -> None:
        """Take out a limb that has its counterpart."""
        self._by_kinds[limb.kinds].remove(limb)
        for name in set(limb.names):
            self._by_name[name].remove(limb)

    def named(self, limb: _Limb) -> list[_Limb]:
        """Those with the same joints; dofs may be nameless on one side."""
        names = set(limb.names)
        near = {other.body: other for name in names for other in self._by_name.get(name, ())}
        return [other for other in near.values() if names <= set(other.names) or names >= set(other.names)]

    def of_kinds(self, limb: _Limb) -> Sequence[_Limb]:
        """Those whose dofs are of the same kinds."""
        return self._by_kinds.get(limb.kinds, ())


def _counterpart(limb: _Limb, free: _Free, *, crowded: bool) -> _Limb | None:
    """The limb with the same joints, else with the same kinds of dofs; where both have names, at the same place as well."""
    named = free.named(limb)
    if named:
        return min(named, key=lambda other: (limb.kinds != other.kinds, limb.names != other.names, _distance(limb, other)))
    nearest: tuple[float, _Limb] | None = None
    for other in free.of_kinds(limb):
        distance = _distance(limb, other)
        renamed = not crowded and limb.is_child and other.is_child and distance < _SAME_PLACE
        if not renamed and limb.has_name and other.has_name:
            continue
        if nearest is None or distance < nearest[0]:
            nearest = distance, other
        if distance == 0.0:
            break
    return nearest[1] if nearest else None


def _joint_names(body: Body) -> tuple[str, ...]:
    return tuple(dof.name for dof in body.joint.dofs if dof.name is not None)


def _kinds(body: Body) -> tuple[Kind, ...]:
    return tuple(dof.kind for dof in body.joint.dofs)


def _hinged(body: Body) -> tuple[Kind, ...]:
    """The kinds of the dofs of a body's joint, each ball as three hinges."""
    return tuple(kind for whole in _kinds(body) for kind in ((Kind.HINGE,) * 3 if whole is Kind.BALL else (whole,)))


def _distance(a: _Limb, b: _Limb) -> float:
    """The difference of two bodies' places and masses; only its order matters."""
    return float(np.abs(a.pose - b.pose).sum()) + abs(a.mass - b.mass)


def only_carries(model: KinematicModel, i: int) -> bool:
    """Whether a body between two joints has neither mass nor shape, and moves: it stands for a joint of several dofs."""
    body = model.bodies[i]
    return body.mass == 0.0 and not body.shapes and bool(body.joint.dofs) and len(model.children[i]) == 1


# ---- bodies by structure ---------------------------------------------------------------------------------------------


def pair_by_structure(a: KinematicModel, b: KinematicModel) -> dict[int, int]:
    """Rooted tree isomorphism: subtrees of one colour are paired below paired parents, the nearest ones first."""
    colours: dict[tuple[object, ...], int] = {}
    colour_a, colour_b = _colours(a, colours), _colours(b, colours)
    pairs = {WORLD: WORLD}
    stack = [(WORLD, WORLD)]
    while stack:
        i, j = stack.pop()
        for k, m in _pair_children(a, b, a.children[i], b.children[j], colour_a, colour_b):
            pairs[k] = m
            stack.append((k, m))
    return pairs


def _colours(model: KinematicModel, known: dict[tuple[object, ...], int]) -> list[int]:
    """A number per body that is equal exactly for subtrees of the same joints and branches, from the leaves up."""
    colours = [0] * len(model.bodies)
    for i in range(len(model.bodies) - 1, -1, -1):
        branches = tuple(sorted(colours[k] for k in model.children[i]))
        key = (tuple(kind.value for kind in _kinds(model.bodies[i])), branches)
        colours[i] = known.setdefault(key, len(known))
    return colours


def _pair_children(
    a: KinematicModel, b: KinematicModel, ours: Sequence[int], theirs: Sequence[int], colour_a: list[int], colour_b: list[int]
) -> Iterable[tuple[int, int]]:
    from scipy.optimize import linear_sum_assignment

    groups: dict[int, tuple[list[int], list[int]]] = {}
    for i in ours:
        groups.setdefault(colour_a[i], ([], []))[0].append(i)
    for j in theirs:
        groups.setdefault(colour_b[j], ([], []))[1].append(j)
    for left, right in groups.values():
        cost = np.array([[_difference(a.bodies[i], b.bodies[j]) for j in right] for i in left]).reshape(len(left), len(right))
        rows, columns = linear_sum_assignment(cost)
        yield from ((left[r], right[c]) for r, c in zip(rows, columns, strict=True))


def _difference(a: Body, b: Body) -> float:
    return float(np.abs(a.joint.placement - b.joint.placement).sum()) + abs(a.mass - b.mass)
