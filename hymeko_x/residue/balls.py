"""Balls that the image has as three hinges with bodies between them: the hinges stand or fall together, and move together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.graph import Edge
from hymeko_x.ir.parts import DofKind, Joint
from hymeko_x.residue.alike import is_alike

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.residue import Residue, WholeElement

DOFS = ("data", "dofs")
"""Where the dofs of a joint stand in its edge."""
_ABOVE = 2
"""How many hinges a ball has above the last one."""
_PARENT = ("arcs", 0, "target")
_KIND = ("data", "dofs", 0, "kind")


def hinges_of_balls(residue: Residue) -> dict[Id, list[WholeElement]]:
    """The joints above the last hinge of each ball, from above; the last one has the name of the ball."""
    above: dict[Id, WholeElement] = {}
    for removal in residue.removals:
        if isinstance(removal.part, Edge) and isinstance(removal.part.data, Joint) and len(removal.part.arcs) > 1:
            above[removal.part.arcs[1].target] = removal
    parents = {change.element: change for change in residue.changes if change.path == _PARENT}
    found: dict[Id, list[WholeElement]] = {}
    for change in residue.changes if above else ():
        ends = parents.get(change.element)
        if change.path != _KIND or change.value is not DofKind.BALL or ends is None:
            continue
        chain: list[WholeElement] = []
        body = ends.there
        while body in above and len(chain) < _ABOVE:
            chain.insert(0, above[body])
            body = chain[0].part.arcs[0].target  # type: ignore[union-attr]
        if chain and body == ends.value:
            found[change.element] = chain
    return found


def moved_and_apart(image: Mechanism, balls: Mapping[Id, Sequence[WholeElement]]) -> tuple[dict[Id, RobotArc], set[Id]]:
    """The balls of which the first hinge alone is at another place or on another body, with its arc to that; those edited otherwise.

    Something new may be on a body between two hinges as well.
    """
    moved: dict[Id, RobotArc] = {}
    apart: set[Id] = set()
    for key, chain in balls.items():
        now = [image.graph.edges.get(hinge.id) for hinge in chain]
        first, then = now[0], chain[0].part
        if not _is_bare(image, key, chain):
            apart.add(key)
            continue
        if all(_is_same(edge, hinge.part) for edge, hinge in zip(now, chain, strict=True)):
            continue
        is_rest = all(_is_same(edge, hinge.part) for edge, hinge in zip(now[1:], chain[1:], strict=True))
        if (
            is_rest
            and first is not None
            and isinstance(then, Edge)
            and _is_same(replace(first, arcs=(then.arcs[0], *first.arcs[1:])), then)
        ):
            moved[key] = first.arcs[0]
        elif any(now):
            apart.add(key)
    return moved, apart


def _is_same(now: RobotEdge | None, then: object) -> bool:
    """Whether a hinge is what it was, between the same bodies."""
    if now is None or not isinstance(then, Edge):
        return False
    return is_alike(now, then) and [arc.target for arc in now.arcs] == [arc.target for arc in then.arcs]


def _is_bare(image: Mechanism, ball: Id, chain: Sequence[WholeElement]) -> bool:
    """Whether the bodies between the hinges carry nothing else."""
    hinges = {ball, *(hinge.id for hinge in chain)}
    bodies = [hinge.part.arcs[1].target for hinge in chain if isinstance(hinge.part, Edge)]
    return all(found.edge in hinges for body in bodies for found in image.graph.incidence.get(body, ()))
