"""The arcs of an edge that has more or fewer in the image: they are put in as a whole, with the weights that were edited since."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.graph import Edge
from hymeko_x.residue.alike import is_alike

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.residue import Change

ARCS = ("arcs",)
"""The path of all arcs of an edge."""


def with_edited_weights(part: object, change: Change) -> Change:
    """A change of all arcs with the edited weights of those that source and image share; any other change as it is.

    The colour of a shape that was moved is then still that of its material, which the image does not have.
    """
    if change.path != ARCS or not isinstance(part, Edge) or not isinstance(change.there, tuple) or len(part.arcs) != len(change.there):
        return change
    edited: dict[tuple[int, Id], tuple[RobotArc, RobotArc]] = {}
    for now, then in zip(part.arcs, change.there, strict=True):
        if not is_alike(replace(now, weight=None), replace(then, weight=None)):
            return change
        if not is_alike(now.weight, then.weight):
            edited[now.sign, now.target] = now, then
    arcs = []
    for arc in change.value:  # type: ignore[attr-defined]
        now, then = edited.pop((arc.sign, arc.target), (arc, arc))
        if not is_alike(arc.weight, then.weight):
            return change
        arcs.append(replace(arc, weight=now.weight))
    return change if edited else change._replace(there=part.arcs, value=tuple(arcs))
