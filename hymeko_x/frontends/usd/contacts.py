"""What touches what: pairs of bodies that do not collide, and the friction that physics materials give to colliders."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.usd import single
from hymeko_x.frontends.usd.bindings import bound_to
from hymeko_x.frontends.usd.prims import BINDING
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Contact

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim

PAIRS = "PhysicsFilteredPairsAPI"
_TARGETS = "physics:filteredPairs"
_BINDING = f"{BINDING}:physics"
_FRICTIONS = (
    ("physics:dynamicFriction",),
    ("mjc:torsionalfriction", "newton:torsionalFriction"),
    ("mjc:rollingfriction", "newton:rollingFriction"),
)


def read_filtered_pairs(prim: Prim, draft: Draft) -> None:
    """Each body that another one is filtered against; a list that names anything else than bodies stays an extra."""
    body = draft.bodies.get(prim.path)
    others = [draft.bodies.get(path) for path in prim.targets(_TARGETS)] if prim.has_api(PAIRS) else []
    if body is None or not others or None in others:
        return
    draft.take(prim, f"@{PAIRS}", _TARGETS)
    for other in others:
        if other is not None:
            key = draft.own(prim, "contact", f"{body.name}_{other.name}")
            draft.edges[key] = Edge(Contact("exclude"), (Arc(body), Arc(other)))


def friction_of(prim: Prim, draft: Draft) -> tuple[float, ...]:
    """Sliding, torsional and rolling friction of a collider by its physics material; nothing where that does not say."""
    bound = bound_to(prim, draft.scene, "physics")
    found: list[float] = []
    if bound is None:
        return ()
    for names in _FRICTIONS:
        said = next((value for name in names for value in [bound.value(name)] if value is not None), None)
        if said is None:
            break
        found.append(single(float(said)))
    if bound.is_ours and prim.targets(_BINDING):
        draft.take(prim, _BINDING)
        if BINDING not in prim.properties:
            draft.take(prim, "@MaterialBindingAPI")
    return tuple(found)
