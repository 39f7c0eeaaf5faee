"""Which body and which coordinate of one robot is which of the other, and where they have no counterpart.

Bodies are matched by name; unnamed and renamed ones by their place in the tree; with ``structure`` all of them by the shape
of the tree and by where they are. Bodies in between that only carry dofs (no mass, no shape) may exist on one side only:
a ball is three hinges elsewhere, and three hinges on one body are a chain elsewhere.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.verify.model import WORLD, Body, Kind, KinematicModel

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

BODIES, JOINTS, BASE = "bodies", "joints", "base"

_SAME_PLACE = 1e-5  # of a body that must have been renamed, because it is where the other was and weighs as much
_SAME_MOTION = {Kind.SCREW: Kind.HINGE}  # a screw's angle is the coordinate of the hinge that stands for it


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that has no counterpart: the quantity that it belongs to, and words that name it."""

    quantity: str
    words: str


@dataclass(frozen=True, slots=True)
class Turned:
    """A body whose rotation is one quaternion on one side and several coordinates on the other."""

    body_a: int
    body_b: int
    dofs_a: tuple[int, ...]
    dofs_b: tuple[int, ...]


@dataclass(slots=True)
class Match:
    """Pairs of bodies (the world first) and of dofs, and what has no partner.

    ``floor_a`` and ``floor_b`` are bases that must not count; ``lone_a`` and ``lone_b`` bodies without a partner;
    ``carriers`` of them are those that only carry dofs.
    """

    bodies: list[tuple[int, int]] = field(default_factory=lambda: [(WORLD, WORLD)])
    dofs: list[tuple[int, int]] = field(default_factory=list)
    turned: list[Turned] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    floor_a: set[int] = field(default_factory=set)
    floor_b: set[int] = field(default_factory=set)
    lone_a: list[int] = field(default_factory=list)
    lone_b: list[int] = field(default_factory=list)

    def find(self, quantity: str, words: str) -> None:
        """Record something without a counterpart."""
        self.findings.append(Finding(quantity, words))


@dataclass(frozen=True, slots=True)
class Path:
    """From a matched body up to the nearest matched ancestor: the bodies in between and at the end, and their dofs, from the top."""

    top: int
    bodies: tuple[int, ...]
    dofs: tuple[int, ...]


def match(a: KinematicModel, b: KinematicModel, *, structure: bool = False) -> Match:
    """The counterparts of two robots' bodies and coordinates."""
    pairs = _by_structure(a, b) if structure else _by_name(a, b)
    found = Match()
    found.bodies = [(i, pairs[i]) for i in range(len(a.bodies)) if i in pairs]
    back = {j: i for i, j in found.bodies}
    _compare_names(found, a, b, structure=structure)
    _find_lone(found, a, b, pairs, back)
    paths_a, paths_b = _paths(a, pairs.keys()), _paths(b, back.keys())
    for i, j in found.bodies[1:]:
        _match_joint(
            found, a, b, (i, paths_a[i]), (j, paths_b[j]), parent_matches=pairs[paths_a[i].top] == paths_b[j].top, names=not structure
        )
    _find_lone_dofs(found, a, b)
    return found


# ---- bodies by name --------------------------------------------------------------------------------------------------


def plain(name: str) -> str:
    """A name as USD would have to spell it."""
    spelled = re.sub(r"\W", "_", name)
    return f"_{spelled}" if spelled[:1].isdigit() else spelled


def _by_name(a: KinematicModel, b: KinematicModel) -> dict[int, int]:
    pairs = {WORLD: WORLD}
    taken = {WORLD}
    for i, body in enumerate(a.bodies[1:], start=1):
        j = b.index.get(body.name) if body.name is not None else None
        if j is not None and j not in taken:  # the world is taken: a link may only be called so
            pairs[i] = j
            taken.add(j)
    if "usd" in (a.format, b.format):
        _pair_spelled(a, b, pairs, taken)
    _pair_by_place(a, b, pairs, taken)
    return pairs


def _pair_spelled(a: KinematicModel, b: KinematicModel, pairs: dict[int, int], taken: set[int]) -> None:
    """Names that USD cannot spell, compared as it spells them, where that leaves no doubt."""
    ours = _spelled(a, pairs.keys())
    theirs = _spelled(b, taken)
    for spelling in ours.keys() & theirs.keys():
        pairs[ours[spelling]] = theirs[spelling]
        taken.add(theirs[spelling])


def _spelled(model: KinematicModel, taken: Iterable[int]) -> dict[str, int]:
    used = set(taken)
    names = [(plain(body.name), i) for i, body in enumerate(model.bodies) if body.name is not None and i not in used]
    counts = Counter(name for name, _ in names)
    return {name: i for name, i in names if counts[name] == 1}


def _pair_by_place(a: KinematicModel, b: KinematicModel, pairs: dict[int, int], taken: set[int]) -> None:
    """Unmatched bodies below matched ones, by the names of their joints, else as the only ones of their kind there."""
    for i in range(1, len(a.bodies)):
        parent = a.bodies[i].parent
        if i in pairs or parent not in pairs:
            continue
        free = [j for j in b.children[pairs[parent]] if j not in taken]
        rivals = [k for k in a.children[parent] if k not in pairs]
        j = _counterpart(a, b, i, free, rivals)
        if j is not None:
            pairs[i] = j
            taken.add(j)


def _counterpart(a: KinematicModel, b: KinematicModel, i: int, free: Sequence[int], rivals: Sequence[int]) -> int | None:
    """The one of ``free`` that body i must be: of the same joint, else alike among as many rivals as candidates."""
    names = _joint_names(a.bodies[i])
    if names:
        named = [j for j in free if _joint_names(b.bodies[j]) == names]
        if len(named) == 1:
            return named[0]
    unnamed = a.bodies[i].name is None
    alike = [
        j
        for j in free
        if _kinds(a.bodies[i]) == _kinds(b.bodies[j])
        and (unnamed or b.bodies[j].name is None or (len(rivals) == len(free) and _distance(a.bodies[i], b.bodies[j]) < _SAME_PLACE))
    ]
    return min(alike, key=lambda j: _distance(a.bodies[i], b.bodies[j]), default=None)


def _joint_names(body: Body) -> tuple[str, ...]:
    return tuple(dof.name for dof in body.joint.dofs if dof.name is not None)


def _kinds(body: Body) -> tuple[Kind, ...]:
    return tuple(dof.kind for dof in body.joint.dofs)


def _distance(a: Body, b: Body) -> float:
    """How far apart two bodies' places and masses are; only its order matters."""
    return float(np.abs(a.joint.placement - b.joint.placement).sum()) + abs(a.mass - b.mass)


# ---- bodies by structure ---------------------------------------------------------------------------------------------


def _by_structure(a: KinematicModel, b: KinematicModel) -> dict[int, int]:
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
        below = tuple(sorted(colours[k] for k in model.children[i]))
        key = (tuple(kind.value for kind in _kinds(model.bodies[i])), below)
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
        cost = np.array([[_distance(a.bodies[i], b.bodies[j]) for j in right] for i in left]).reshape(len(left), len(right))
        rows, columns = linear_sum_assignment(cost)
        yield from ((left[r], right[c]) for r, c in zip(rows, columns, strict=True))


# ---- what has no partner ---------------------------------------------------------------------------------------------


def _compare_names(found: Match, a: KinematicModel, b: KinematicModel, *, structure: bool) -> None:
    """Pairs that were made by place although both have names, or although the first lost its name."""
    if structure:
        return
    spelled = "usd" in (a.format, b.format)
    for i, j in found.bodies[1:]:
        ours, theirs = a.bodies[i].name, b.bodies[j].name
        if ours is None or ours == theirs or ours == "world" or (spelled and theirs is not None and plain(ours) == plain(theirs)):
            continue
        found.find(BODIES, f"{a.body_label(i)} is called '{theirs}'" if theirs is not None else f"{a.body_label(i)} lost its name")


def _find_lone(found: Match, a: KinematicModel, b: KinematicModel, pairs: dict[int, int], back: dict[int, int]) -> None:
    found.lone_a = [i for i in range(1, len(a.bodies)) if i not in pairs]
    found.lone_b = [j for j in range(1, len(b.bodies)) if j not in back]
    for model, lone, words in ((a, found.lone_a, "is missing"), (b, found.lone_b, "is new")):
        carriers = [i for i in lone if _only_carries(model, i)]
        if carriers:
            found.notes.append(f"bodies that only carry dofs: {_listed([model.body_label(i) for i in carriers])} ({words})")
        for i in set(lone) - set(carriers):
            found.find(BODIES, f"{model.body_label(i)} {words}{_whereabouts(model, i)}")


def _only_carries(model: KinematicModel, i: int) -> bool:
    """A body between two joints that has neither mass nor shape, and moves."""
    body = model.bodies[i]
    return body.mass == 0.0 and not body.shapes and bool(body.joint.dofs) and len(model.children[i]) == 1


def _whereabouts(model: KinematicModel, i: int) -> str:
    body = model.bodies[i]
    return f" (mass {body.mass:.6g} kg, {len(body.shapes)} shapes)" if body.mass or body.shapes else ""


def _listed(words: Sequence[str], most: int = 3) -> str:
    rest = f" and {len(words) - most} more" if len(words) > most else ""
    return ", ".join(words[:most]) + rest


# ---- joints ----------------------------------------------------------------------------------------------------------


def _paths(model: KinematicModel, matched: Iterable[int]) -> dict[int, Path]:
    """For each matched body its path up; linear in the bodies, because unmatched ones hand theirs down."""
    known = set(matched)
    through: dict[int, Path] = {WORLD: Path(WORLD, (), ())}
    found: dict[int, Path] = {}
    for i, body in enumerate(model.bodies[1:], start=1):
        first = model.first_dof[i]
        own = tuple(range(first, first + len(body.joint.dofs)))
        above = Path(body.parent, (), ()) if body.parent in known else through[body.parent]
        path = Path(above.top, (*above.bodies, i), (*above.dofs, *own))
        if i in known:
            found[i] = path
        else:
            through[i] = path
    return found


def _match_joint(
    found: Match,
    a: KinematicModel,
    b: KinematicModel,
    ours: tuple[int, Path],
    theirs: tuple[int, Path],
    *,
    parent_matches: bool,
    names: bool,
) -> None:
    """Pairs the dofs above a pair of bodies, and says what differs between the joints."""
    (i, path_a), (j, path_b) = ours, theirs
    if not parent_matches:
        found.find(JOINTS, f"{a.body_label(i)} hangs on {a.body_label(path_a.top)}, and on {b.body_label(path_b.top)} in the other")
    base = _base_kind(a, path_a), _base_kind(b, path_b)
    if base[0] and base[1] and (base[0] != base[1] or base == ("open", "open")):
        _match_base(found, a, b, path_a, path_b, (base[0], base[1]))
        return
    kinds_a, kinds_b = ([model.dofs[d].kind for d in path.dofs] for model, path in ((a, path_a), (b, path_b)))
    if kinds_a == kinds_b:
        found.dofs += zip(path_a.dofs, path_b.dofs, strict=True)
    elif "urdf" in (a.format, b.format) and _turns(kinds_a) and _turns(kinds_b) and Kind.BALL in (*kinds_a, *kinds_b):
        found.turned.append(Turned(i, j, path_a.dofs, path_b.dofs))
        return
    else:
        found.dofs += _pairs_by_dof_name(a, b, path_a.dofs, path_b.dofs)
    if names:
        _compare_joint_names(found, a, b, path_a, path_b)


def _base_kind(model: KinematicModel, path: Path) -> str | None:
    """How a root is attached: open, fixed or free; None for a body that is no root or moves in another way."""
    if path.top != WORLD:
        return None
    kinds = [model.dofs[d].kind for d in path.dofs]
    if kinds == [Kind.FREE]:
        return "free"
    if kinds:
        return None
    return "open" if any(model.bodies[i].joint.open for i in path.bodies) else "fixed"


def _match_base(found: Match, a: KinematicModel, b: KinematicModel, path_a: Path, path_b: Path, kinds: tuple[str, str]) -> None:
    """Bases of different kinds, or open ones, do not count: the robots are compared relative to them."""
    found.floor_a.update(path_a.bodies)
    found.floor_b.update(path_b.bodies)
    if "open" not in kinds:
        found.find(BASE, f"{a.body_label(path_a.bodies[-1])} is {kinds[0]}, and {kinds[1]} in the other")
    elif kinds != ("open", "open"):
        found.notes.append(
            f"base: {a.body_label(path_a.bodies[-1])} is {kinds[0]} in {a.format}, {kinds[1]} in {b.format}; compared relative to it"
        )


def _turns(kinds: Sequence[Kind]) -> bool:
    """Whether these dofs can take every orientation and do nothing else."""
    return list(kinds) in ([Kind.BALL], [Kind.HINGE] * 3)


def _pairs_by_dof_name(a: KinematicModel, b: KinematicModel, ours: Sequence[int], theirs: Sequence[int]) -> list[tuple[int, int]]:
    named = {b.dofs[d].name: d for d in theirs if b.dofs[d].name is not None}
    pairs = [(d, named[a.dofs[d].name]) for d in ours if a.dofs[d].name in named]
    return [(d, e) for d, e in pairs if _motion(a.dofs[d].kind) is _motion(b.dofs[e].kind)]


def _motion(kind: Kind) -> Kind:
    return _SAME_MOTION.get(kind, kind)


def _compare_joint_names(found: Match, a: KinematicModel, b: KinematicModel, path_a: Path, path_b: Path) -> None:
    spelled = "usd" in (a.format, b.format)
    if not path_a.dofs and not path_b.dofs and len(path_a.bodies) == len(path_b.bodies) == 1:
        ours, theirs = a.bodies[path_a.bodies[0]].joint.name, b.bodies[path_b.bodies[0]].joint.name
        if ours is not None and theirs is not None and not _same_name(ours, theirs, spelled=spelled):
            found.find(JOINTS, f"joint '{ours}' is called '{theirs}'")
        return
    if len(path_a.dofs) != len(path_b.dofs):
        return
    for d, e in zip(path_a.dofs, path_b.dofs, strict=True):
        ours, theirs = a.dofs[d].name, b.dofs[e].name
        if ours is None or a.dofs[d].kind is Kind.FREE or (theirs is None and _named_as_one(b, e)):
            continue
        if theirs is None or not _same_name(ours, theirs, spelled=spelled):
            found.find(JOINTS, f"joint '{ours}' is called '{theirs}'" if theirs is not None else f"joint '{ours}' lost its name")


def _same_name(a: str, b: str, *, spelled: bool) -> bool:
    return a == b or (spelled and plain(a) == plain(b))


def _named_as_one(model: KinematicModel, dof: int) -> bool:
    """Whether the dof belongs to a joint of several that has one name for all of them."""
    joint = model.bodies[model.body_of_dof[dof]].joint
    return len(joint.dofs) > 1 and joint.name is not None


def _find_lone_dofs(found: Match, a: KinematicModel, b: KinematicModel) -> None:
    """Dofs without a partner, except followers (a coupling says where they are) and bases that do not count."""
    ours = {d for d, _ in found.dofs} | {d for turned in found.turned for d in turned.dofs_a}
    theirs = {e for _, e in found.dofs} | {e for turned in found.turned for e in turned.dofs_b}
    for model, known, floor, words in ((a, ours, found.floor_a, "has no counterpart"), (b, theirs, found.floor_b, "is new")):
        followers = {coupling.follower for coupling in model.couplings}
        for dof, body in enumerate(model.body_of_dof):
            if dof not in known and dof not in followers and body not in floor:
                found.find(JOINTS, f"{model.dof_label(dof)} ({model.dofs[dof].kind.value}) {words}")
