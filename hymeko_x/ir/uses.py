"""Where meshes and materials are used first, in the order in which shapes stand in a text."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism


def first_uses(mechanism: Mechanism) -> dict[Id, Id]:
    """For every mesh and material the first shape that uses it, in the order in which shapes are printed."""
    graph = mechanism.graph
    order = [key for key in dict.fromkeys(mechanism.layout) if key.kind in ("body", "world")]
    placed = set(order)
    order += [key for key in graph.vertices if key.kind == "world" and key not in placed]
    order += [key for key in graph.vertices if key.kind == "body" and key not in placed]
    found: dict[Id, Id] = {}
    for body in order:
        for view in mechanism.shapes.get(body, ()):
            for used in (view.mesh, view.material):
                if used is not None:
                    found.setdefault(used, view.id)
    return found
