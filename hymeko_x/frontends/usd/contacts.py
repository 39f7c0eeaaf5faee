"""Pairs of bodies that do not collide, by filtered pairs and by collision groups, and the friction of colliders."""

from __future__ import annotations

from itertools import combinations, product
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes
from hymeko_x.formats.usd import single
from hymeko_x.formats.usd.contacts import BY_BOTH, BY_GROUPS, GROUP, GROUPED, GROUPS, pairs_digest
from hymeko_x.frontends.usd.materials import bound_to
from hymeko_x.frontends.usd.prims import BINDING
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Contact, Role, Shape

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id

PAIRS = "PhysicsFilteredPairsAPI"
_TARGETS = "physics:filteredPairs"
_BINDING = f"{BINDING}:physics"
_FRICTIONS = (
    ("physics:dynamicFriction",),
    ("mjc:torsionalfriction", "newton:torsionalFriction"),
    ("mjc:rollingfriction", "newton:rollingFriction"),
)


def read_filtered_pairs(prim: Prim, builder: UsdBuilder) -> None:
    """Each body that another one is filtered against; a list that names anything else than bodies stays an extra."""
    body = builder.bodies.get(prim.path)
    others = [builder.bodies.get(path) for path in prim.targets(_TARGETS)] if prim.has_api(PAIRS) else []
    if body is None or not others or None in others:
        return
    builder.mark_read(prim, f"@{PAIRS}", _TARGETS)
    for other in others:
        if other is not None:
            key = builder.new_id(prim, "contact", f"{body.name}_{other.name}")
            builder.edges[key] = Edge(Contact("exclude"), (Arc(body), Arc(other)))


def friction_of(prim: Prim, builder: UsdBuilder) -> tuple[float, ...]:
    """Sliding, torsional and rolling friction of a collider by its physics material; nothing where that has none."""
    bound = bound_to(prim, builder.scene, "physics")
    found: list[float] = []
    if bound is None:
        return ()
    for names in _FRICTIONS:
        authored = next((value for name in names for value in [bound.value(name)] if value is not None), None)
        if authored is None:
            break
        found.append(single(float(authored)))
    if bound.is_generated and prim.targets(_BINDING):
        builder.mark_read(prim, _BINDING)
        if BINDING not in prim.properties:
            builder.mark_read(prim, "@MaterialBindingAPI")
    return tuple(found)


# ---- collision groups --------------------------------------------------------------------------------------------------------------

MOST_PAIRS = 10_000
"""How many pairs of bodies are typed at most: a hundred groups of a hundred bodies are as long as a large robot."""
_MOST_GROUPS = 500
_MOST_KINDS = 400
_MOST_MEMBERS = 1_000_000
"""How many prims all groups together may include."""

Memberships = frozenset[str]
"""The groups that a collider is in."""


class _TooMany(Exception):
    """More than can be written as pairs; the text names the excess."""


def read_collision_groups(prims: list[Prim], builder: UsdBuilder) -> None:
    """Each pair of bodies of which no collider of the one touches a collider of the other, as an exclusion noted as such."""
    groups = [prim for prim in prims if prim.kind == GROUP]
    if not groups:
        return
    try:
        pairs = _pairs(groups, builder)
    except _TooMany as error:
        builder.warn(
            groups[0], codes.NOT_REPRESENTED, f"collision groups with {error} are kept as written; no other format represents them"
        )
        return
    if not pairs:
        return
    known = {frozenset(arc.target for arc in edge.arcs): key for key, edge in builder.edges.items() if isinstance(edge.data, Contact)}
    for first, second in pairs:
        key = known.get(frozenset((first, second)))
        if key is None:
            key = builder.names.take("contact", f"{first.name or 'world'}_{second.name}")
            builder.origins[key] = builder.origin_of(groups[0])
            builder.edges[key] = Edge(Contact("exclude"), (Arc(first), Arc(second)))
            builder.note(key, GROUPED, BY_GROUPS)
        else:
            builder.note(key, GROUPED, BY_BOTH)
    builder.note(ROOT, GROUPS, pairs_digest(pairs))


def _pairs(groups: list[Prim], builder: UsdBuilder) -> list[tuple[Id, Id]]:
    """The pairs in the order of the bodies. Raises: _TooMany."""
    kinds: dict[frozenset[Memberships], list[tuple[int, Id]]] = {}
    for number, (body, memberships) in enumerate(_memberships(groups, builder).items()):
        kinds.setdefault(frozenset(memberships), []).append((number, body))
    if len(kinds) > _MOST_KINDS or sum(len(groups_of) for kind in kinds for groups_of in kind) > 5 * _MOST_KINDS:
        raise _TooMany(f"{len(kinds)} kinds of members")
    rules = _rules(groups, {name for kind in kinds for memberships in kind for name in memberships})
    found: list[tuple[tuple[int, Id], tuple[int, Id]]] = []
    partly = None
    for (one, here), (other, there) in [*combinations(kinds.items(), 2), *((item, item) for item in kinds.items())]:
        filtered = [rules.are_filtered(a, b) for a, b in product(one, other)]
        if any(filtered) and not all(filtered):
            partly = partly or (here[0][1], there[-1][1])
        if not all(filtered):
            continue
        count = len(here) * (len(here) - 1) // 2 if here is there else len(here) * len(there)
        if len(found) + count > MOST_PAIRS:
            raise _TooMany(f"more than {MOST_PAIRS} pairs of bodies")
        found += combinations(here, 2) if here is there else ((a, b) if a < b else (b, a) for a, b in product(here, there))
    if partly is not None:
        message = f"collision groups separate only some colliders of {partly[0]} and {partly[1]}; that is kept as written"
        builder.report.note(codes.NOT_REPRESENTED, message, builder.origin_of(groups[0]), element=groups[0].path)
    return [(a, b) for (_, a), (_, b) in sorted(found)]


def _memberships(groups: list[Prim], builder: UsdBuilder) -> dict[Id, set[Memberships]]:
    """For each body (and the world) with colliders, in which groups these are."""
    inside: dict[str, list[str]] = {}
    count = 0
    if len(groups) > _MOST_GROUPS:
        raise _TooMany(f"{len(groups)} groups")
    for group in groups:
        for path in _members(group):
            inside.setdefault(path, []).append(group.path)
            count += 1
        if count > _MOST_MEMBERS:
            raise _TooMany(f"more than {_MOST_MEMBERS} members")
    found: dict[Id, set[Memberships]] = {}
    for path, body in _colliders(builder):
        found.setdefault(body, set()).add(frozenset(inside.get(path, ())))
    return found


def _members(group: Prim) -> Iterator[str]:
    """The paths of all prims that are in a group."""
    from pxr import Usd, UsdPhysics

    collection = UsdPhysics.CollisionGroup(group.composed).GetCollidersCollectionAPI()
    return map(str, Usd.CollectionAPI.ComputeIncludedPaths(collection.ComputeMembershipQuery(), group.scene.stage))


def _colliders(builder: UsdBuilder) -> Iterator[tuple[str, Id]]:
    """The path of each collider with its body."""
    for path, keys in builder.elements.items():
        for key in keys:
            edge = builder.edges.get(key) if key.kind == "shape" else None
            if edge is not None and isinstance(edge.data, Shape) and edge.data.role is not Role.VISUAL:
                yield path, edge.arcs[0].target


class _Rules(NamedTuple):
    """The filters of groups: ``apart`` with which each does not collide, ``inverted`` those that collide only with the ones they name."""

    apart: Mapping[str, Memberships]
    inverted: Memberships

    def are_filtered(self, one: Memberships, other: Memberships) -> bool:
        """Whether a collider in these groups does not touch one in those. Without a group one touches all but the picky."""
        if one and other:
            return any(not self.apart[group].isdisjoint(other) for group in one)
        return not self.inverted.isdisjoint(one or other)


def _rules(groups: list[Prim], used: set[str]) -> _Rules:
    """The rules of the groups that have colliders; groups of one merge name are one group with all of their filters.

    Source: the schema of UsdPhysics and OpenUSD's own table, which takes a filtered group that is not there for the first one.
    """
    merged = {group.path: f"merge {name}" if (name := group.value("physics:mergeGroup")) else group.path for group in groups}
    filtered = [(merged[group.path], _others(group, merged), group.value("physics:invertFilteredGroups") is True) for group in groups]
    names = set(merged.values())
    apart: dict[str, set[str]] = {name: set() for name in names}
    for name, others, inverted in filtered:
        for other in names - others if inverted else others:
            apart[name].add(other)
            apart[other].add(name)
    picky = {name for name, _, inverted in filtered if inverted}
    return _Rules(
        {name: frozenset(other for other in used if merged[other] in apart[merged[name]]) for name in used},
        frozenset(name for name in used if merged[name] in picky),
    )


def _others(group: Prim, merged: Mapping[str, str]) -> set[str]:
    """The groups that a group names."""
    return {merged[path] for path in group.targets("physics:filteredGroups") if path in merged}
