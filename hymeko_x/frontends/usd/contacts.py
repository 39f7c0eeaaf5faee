"""What touches what: pairs of bodies that do not collide, and the friction that physics materials give to colliders."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import UsdShade

from hymeko_x.formats.usd import single
from hymeko_x.frontends.usd.draft import has_api
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Contact

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft

PAIRS = "PhysicsFilteredPairsAPI"
_TARGETS = "physics:filteredPairs"
_FRICTIONS = (
    ("physics:dynamicFriction",),
    ("mjc:torsionalfriction", "newton:torsionalFriction"),
    ("mjc:rollingfriction", "newton:rollingFriction"),
)


def read_filtered_pairs(prim: Any, draft: Draft) -> None:
    """Each body that another one is filtered against; a list that names anything else than bodies stays an extra."""
    body = draft.bodies.get(str(prim.GetPath()))
    others = [draft.bodies.get(str(path)) for path in prim.GetRelationship(_TARGETS).GetTargets()] if has_api(prim, PAIRS) else []
    if body is None or not others or None in others:
        return
    draft.take(prim, f"@{PAIRS}", _TARGETS)
    for other in others:
        if other is not None:
            key = draft.own(prim, "contact", f"{body.name}_{other.name}")
            draft.edges[key] = Edge(Contact("exclude"), (Arc(body), Arc(other)))


def friction_of(prim: Any) -> tuple[float, ...]:
    """Sliding, torsional and rolling friction of a collider by its physics material; nothing where that does not say."""
    bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
    found: list[float] = []
    for names in _FRICTIONS if bound else ():
        said = [bound.GetPrim().GetAttribute(name).Get() for name in names if bound.GetPrim().GetAttribute(name).HasAuthoredValue()]
        if not said:
            break
        found.append(single(float(said[0])))
    return tuple(found)
