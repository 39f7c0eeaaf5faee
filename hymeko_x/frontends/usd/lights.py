"""Lights of UsdLux that the IR has a word for: their kind and colour; what else they say stays extras."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.relations import mount
from hymeko_x.ir.parts import Light

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim


def read_light(prim: Prim, draft: Draft) -> None:
    """A light where it shines; a sphere light with a cone is a spot."""
    kind = words.LIGHTS[prim.kind]
    if kind == "point" and prim.has_api(words.CONE):
        kind = "spot"
        draft.take(prim, f"@{words.CONE}")
    key = draft.own(prim, "light")
    colour = draft.get(prim, "inputs:color")
    draft.vertices[key] = Light(kind, colour)
    draft.take(prim, "@type")
    mount(prim, key, draft)
