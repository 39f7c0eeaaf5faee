"""Which material a prim is bound to: as USD computes it, and without asking it where the answer stands on the prim itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.frontends.usd.prims import BINDING

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.frontends.usd.stage import Scene

_API = "MaterialBindingAPI"


def bound_to(prim: Prim, scene: Scene, purpose: str = "") -> Prim | None:
    """The prim of the material that a prim has for a purpose (empty: for all), None without one."""
    if not prim.is_bound:
        return None
    plain = _plain_target(prim, purpose)
    found = scene.prims.get(plain) if plain is not None else None
    return found if found is not None and found.is_real and found.kind == "Material" else _computed(prim, scene, purpose)


def _plain_target(prim: Prim, purpose: str) -> str | None:
    """The path of the material where one binding of the prim alone decides."""
    own = [name for name in prim.properties if name.startswith(BINDING)]
    is_alone = len(own) == 1 and prim.has_api(_API) and not (prim.parent is not None and prim.parent.is_bound)
    if not is_alone or own[0] not in (BINDING, f"{BINDING}:{purpose}"):
        return None
    targets = prim.targets(own[0])
    return targets[0] if len(targets) == 1 else None


def _computed(prim: Prim, scene: Scene, purpose: str) -> Prim | None:
    """By all rules of inheritance, strength and collections."""
    from pxr import UsdShade

    bound = UsdShade.MaterialBindingAPI(prim.composed).ComputeBoundMaterial(purpose or UsdShade.Tokens.allPurpose)[0]
    return scene.prims.get(str(bound.GetPath())) if bound else None
