"""The counterparts of one robot's bodies and coordinates in the other, and what has none.

Bodies are matched by name; unnamed and renamed ones by their place in the tree; with ``structure`` all of them by the shape
of the tree and by their poses. Bodies in between that only carry dofs (no mass, no shape) may exist on one side only:
a ball is three hinges elsewhere, and three hinges on one body are a chain elsewhere.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.verify.matching.bodies import joint_speller, only_carries, pair_by_name, pair_by_structure, speller
from hymeko_x.verify.model import WORLD, Kind, KinematicModel

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

BODIES, JOINTS, BASE = "bodies", "joints", "base"

_TURNING = (Kind.HINGE, Kind.BALL, Kind.SCREW, Kind.FREE)
_SAME_MOTION = {Kind.SCREW: Kind.HINGE}  # a screw's angle is the coordinate of the hinge that stands for it
_MOST_LISTED = 3  # bodies named in a note


class Unmatched(Struct, frozen=True):
    """Something that has no counterpart: the quantity that it belongs to, and words that name it."""

    quantity: str
    words: str


class BallMatch(Struct, frozen=True):
    """A body whose rotation is one quaternion on one side and three hinges on the other.

    ``top_a`` and ``top_b`` are the nearest matched ancestors; the dofs are the last ones in between that turn.
    """

    body_a: int
    body_b: int
    top_a: int
    top_b: int
    dofs_a: tuple[int, ...]
    dofs_b: tuple[int, ...]


class Match(Struct):
    """Pairs of bodies (the world first) and of dofs, and what has no partner.

    ``pinned_a`` and ``pinned_b`` are bases whose poses are not compared; ``unmatched_a`` and ``unmatched_b`` bodies without a partner.
    """

    bodies: list[tuple[int, int]] = field(default_factory=lambda: [(WORLD, WORLD)])
    dofs: list[tuple[int, int]] = field(default_factory=list)
    balls: list[BallMatch] = field(default_factory=list)
    findings: list[Unmatched] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    pinned_a: set[int] = field(default_factory=set)
    pinned_b: set[int] = field(default_factory=set)
    unmatched_a: list[int] = field(default_factory=list)
    unmatched_b: list[int] = field(default_factory=list)

    def find(self, quantity: str, words: str) -> None:
        """Record something without a counterpart."""
        self.findings.append(Unmatched(quantity, words))


class JointPath(Struct, frozen=True):
    """From the nearest matched ancestor ``top`` to a matched body: the bodies in between and at the end, and their dofs, in order."""

    top: int
    bodies: tuple[int, ...]
    dofs: tuple[int, ...]


def match(a: KinematicModel, b: KinematicModel, *, structure: bool = False) -> Match:
    """The counterparts of two robots' bodies and coordinates."""
    pairs = pair_by_structure(a, b) if structure else pair_by_name(a, b)
    found = Match()
    found.bodies = [(i, pairs[i]) for i in range(len(a.bodies)) if i in pairs]
    back = {j: i for i, j in found.bodies}
    if not structure:
        _compare_names(found, a, b)
    _find_unmatched(found, a, b, pairs, back)
    paths_a, paths_b = _paths(a, pairs.keys()), _paths(b, back.keys())
    for i, j in found.bodies[1:]:
        path_a, path_b = paths_a[i], paths_b[j]
        if pairs[path_a.top] != path_b.top:
            parents = a.body_label(path_a.top), b.body_label(path_b.top)
            found.find(JOINTS, f"{a.body_label(i)} is below {parents[0]}, and below {parents[1]} in the other")
        _match_joint(found, a, b, (i, path_a), (j, path_b), names=not structure)
    _find_unmatched_dofs(found, a, b)
    return found


# ---- bodies ----------------------------------------------------------------------------------------------------------


def _compare_names(found: Match, a: KinematicModel, b: KinematicModel) -> None:
    """Pairs that were made by place although both have names, or although the first lost its name."""
    spell = speller(a, b)
    for i, j in found.bodies[1:]:
        ours, theirs = a.bodies[i].name, b.bodies[j].name
        if ours is not None and "world" not in (ours, theirs) and (theirs is None or spell(ours) != spell(theirs)):
            found.find(BODIES, f"{a.body_label(i)} {_renamed(theirs)}")


def _renamed(name: str | None) -> str:
    return "lost its name" if name is None else f"is called '{name}'"


def _find_unmatched(found: Match, a: KinematicModel, b: KinematicModel, pairs: dict[int, int], back: dict[int, int]) -> None:
    found.unmatched_a = [i for i in range(1, len(a.bodies)) if i not in pairs]
    found.unmatched_b = [j for j in range(1, len(b.bodies)) if j not in back]
    for model, unmatched, words in ((a, found.unmatched_a, "is missing"), (b, found.unmatched_b, "is new")):
        carriers = [i for i in unmatched if only_carries(model, i)]
        if carriers:
            rest = f" and {len(carriers) - _MOST_LISTED} more" if len(carriers) > _MOST_LISTED else ""
            labels = ", ".join(model.body_label(i) for i in carriers[:_MOST_LISTED])
            found.notes.append(f"bodies that only carry dofs: {labels}{rest} ({words})")
        for i in set(unmatched) - set(carriers):
            body = model.bodies[i]
            details = f" (mass {body.mass:.6g} kg, {len(body.shapes)} shapes)" if body.mass or body.shapes else ""
            found.find(BODIES, f"{model.body_label(i)} {words}{details}")


# ---- joints ----------------------------------------------------------------------------------------------------------


def _paths(model: KinematicModel, matched: Iterable[int]) -> dict[int, JointPath]:
    """For each matched body its path up; linear in the bodies, because unmatched ones hand theirs down."""
    known = set(matched)
    through: dict[int, JointPath] = {WORLD: JointPath(WORLD, (), ())}
    found: dict[int, JointPath] = {}
    for i, body in enumerate(model.bodies[1:], start=1):
        first = model.first_dof[i]
        own = tuple(range(first, first + len(body.joint.dofs)))
        above = JointPath(body.parent, (), ()) if body.parent in known else through[body.parent]
        path = JointPath(above.top, (*above.bodies, i), (*above.dofs, *own))
        if i in known:
            found[i] = path
        else:
            through[i] = path
    return found


def _match_joint(
    found: Match, a: KinematicModel, b: KinematicModel, ours: tuple[int, JointPath], theirs: tuple[int, JointPath], *, names: bool
) -> None:
    """Pairs the dofs between a pair of bodies and their ancestors, and finds where the joints differ."""
    (i, path_a), (j, path_b) = ours, theirs
    base = _base_kind(a, path_a), _base_kind(b, path_b)
    if base[0] and base[1] and (base[0] != base[1] or base == ("open", "open")):
        _match_base(found, a, b, path_a, path_b, (base[0], base[1]))
        return
    aligned = _aligned(*([model.dofs[d].kind for d in path.dofs] for model, path in ((a, path_a), (b, path_b))))
    splits_balls = a.row.has_single_dof_joints or b.row.has_single_dof_joints
    if aligned is None or (any(len(left) != len(right) for left, right in aligned) and not splits_balls):
        pairs = _pairs_by_dof_name(a, b, path_a.dofs, path_b.dofs)
    else:
        runs = [([path_a.dofs[k] for k in left], [path_b.dofs[k] for k in right]) for left, right in aligned]
        pairs = [(left[0], right[0]) for left, right in runs if len(left) == len(right)]
        balls = [(left, right) for left, right in runs if len(left) != len(right)]
        found.balls += (BallMatch(i, j, path_a.top, path_b.top, tuple(left), tuple(right)) for left, right in balls)
    found.dofs += pairs
    if names and aligned is not None:
        _compare_joint_names(found, a, b, path_a, path_b, pairs)


def _aligned(ours: Sequence[Kind], theirs: Sequence[Kind]) -> list[tuple[range, range]] | None:
    """Runs of dofs that correspond: one and one of the same kind, or a ball and three hinges, which then are the last to turn.

    None where the dofs do not move in the same way.
    """
    runs: list[tuple[range, range]] = []
    i = j = 0
    while i < len(ours) and j < len(theirs):
        wide_i, wide_j = 1, 1
        if ours[i] is not theirs[j]:
            wide_i, wide_j = (1, 3) if ours[i] is Kind.BALL else (3, 1)
            pieces = ours[i : i + wide_i], theirs[j : j + wide_j]
            turning = any(kind in _TURNING for kind in (*ours[i + wide_i :], *theirs[j + wide_j :]))
            if turning or sorted(map(list, pieces), key=len) != [[Kind.BALL], [Kind.HINGE] * 3]:
                return None
        runs.append((range(i, i + wide_i), range(j, j + wide_j)))
        i, j = i + wide_i, j + wide_j
    return runs if i == len(ours) and j == len(theirs) else None


def _base_kind(model: KinematicModel, path: JointPath) -> str | None:
    """How a root is joined to the world: open, fixed or free; None for a body that is no root or moves in another way."""
    if path.top != WORLD:
        return None
    kinds = [model.dofs[d].kind for d in path.dofs]
    if kinds == [Kind.FREE]:
        return "free"
    if kinds:
        return None
    return "open" if any(model.bodies[i].joint.open for i in path.bodies) else "fixed"


def _match_base(found: Match, a: KinematicModel, b: KinematicModel, path_a: JointPath, path_b: JointPath, kinds: tuple[str, str]) -> None:
    """The poses of bases of different kinds, or open ones, are not compared: the robots are compared relative to them."""
    found.pinned_a.update(path_a.bodies)
    found.pinned_b.update(path_b.bodies)
    if "open" not in kinds:
        found.find(BASE, f"{a.body_label(path_a.bodies[-1])} is {kinds[0]}, and {kinds[1]} in the other")
    elif kinds != ("open", "open"):
        found.notes.append(
            f"base: {a.body_label(path_a.bodies[-1])} is {kinds[0]} in {a.format}, {kinds[1]} in {b.format}; compared relative to it"
        )


def _pairs_by_dof_name(a: KinematicModel, b: KinematicModel, ours: Sequence[int], theirs: Sequence[int]) -> list[tuple[int, int]]:
    named = {b.dofs[d].name: d for d in theirs if b.dofs[d].name is not None}
    pairs = [(d, named[a.dofs[d].name]) for d in ours if a.dofs[d].name in named]
    return [(d, e) for d, e in pairs if _motion(a.dofs[d].kind) is _motion(b.dofs[e].kind)]


def _motion(kind: Kind) -> Kind:
    return _SAME_MOTION.get(kind, kind)


def _compare_joint_names(
    found: Match, a: KinematicModel, b: KinematicModel, path_a: JointPath, path_b: JointPath, pairs: Sequence[tuple[int, int]]
) -> None:
    spell = joint_speller(a, b)
    if not path_a.dofs and not path_b.dofs and len(path_a.bodies) == len(path_b.bodies) == 1:
        ours, theirs = a.bodies[path_a.bodies[0]].joint.name, b.bodies[path_b.bodies[0]].joint.name
        if ours is not None and theirs is not None and spell(ours) != spell(theirs):
            found.find(JOINTS, f"joint '{ours}' is called '{theirs}'")
        return
    for d, e in pairs:
        ours, theirs = a.dofs[d].name, b.dofs[e].name
        if ours is None or a.dofs[d].kind is Kind.FREE or (theirs is None and _named_as_one(b, e)):
            continue
        if theirs is None or spell(ours) != spell(theirs):
            found.find(JOINTS, f"joint '{ours}' {_renamed(theirs)}")


def _named_as_one(model: KinematicModel, dof: int) -> bool:
    """Whether the dof belongs to a joint of several that has one name for all of them."""
    joint = model.bodies[model.body_of_dof[dof]].joint
    return len(joint.dofs) > 1 and joint.name is not None


def _find_unmatched_dofs(found: Match, a: KinematicModel, b: KinematicModel) -> None:
    """Dofs without a partner, except followers (a coupling determines them) and those of bases that are not compared."""
    ours = {d for d, _ in found.dofs} | {d for ball in found.balls for d in ball.dofs_a}
    theirs = {e for _, e in found.dofs} | {e for ball in found.balls for e in ball.dofs_b}
    for model, known, pinned, words in ((a, ours, found.pinned_a, "has no counterpart"), (b, theirs, found.pinned_b, "is new")):
        followers = {coupling.follower for coupling in model.couplings}
        for dof, body in enumerate(model.body_of_dof):
            if dof not in known and dof not in followers and body not in pinned:
                found.find(JOINTS, f"{model.dof_label(dof)} ({model.dofs[dof].kind.value}) {words}")
