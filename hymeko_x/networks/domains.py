"""Which ends of a network are in translation and which in rotation, and whether the units of its elements agree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.ir import lumped, parts

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.networks.network import Branch

DOMAINS = ("translation", "rotation")


class Units(Struct, frozen=True):
    """The units of one domain."""

    position: str
    velocity: str
    acceleration: str
    effort: str
    mass: str
    stiffness: str
    damping: str


UNITS: Mapping[str, Units] = {
    "translation": Units("m", "m/s", "m/s^2", "N", "kg", "N/m", "N*s/m"),
    "rotation": Units("rad", "rad/s", "rad/s^2", "N*m", "kg*m^2", "N*m/rad", "N*m*s/rad"),
}


def domains_of(
    mechanism: Mechanism, branches: tuple[Branch, ...], followers: Mapping[Id, tuple[float, tuple[tuple[Id, float], ...]]]
) -> dict[Id, str]:
    """The domain of every mass, end, edge and element: given, or that of its neighbours, else translation.

    Neighbours are an edge with its elements and its ends of ratio 1, and a coupled mass with leaders of ratio 1; another
    ratio may lead from translation to rotation (a rack and its pinion).

    Raises: Refusal (HX401) where two neighbours are in different domains, or an element names a domain that does not exist.
    """
    neighbours: dict[Id, list[Id]] = {}
    for branch in branches:
        near = [key for key, ratio in branch.ends if abs(ratio) == 1.0] + [element.id for element in branch.elements]
        _join(neighbours, branch.id, [key for key in near if not _is_neutral(mechanism, key)])
    for key, (_, leaders) in followers.items():
        _join(neighbours, key, [leader for leader, ratio in leaders if abs(ratio) == 1.0])
    found: dict[Id, str] = {}
    for start in [*mechanism.graph.vertices, *neighbours]:
        if start not in found:
            together = _connected(neighbours, start)
            given = [(domain, key) for key in together if (domain := _given(mechanism, key))]
            others = [other for other in given if other[0] != given[0][0]]
            if others:
                raise _contradiction(mechanism, given[0], others[0])
            found |= dict.fromkeys(together, given[0][0] if given else DOMAINS[0])
    return found


def _is_neutral(mechanism: Mechanism, key: Id) -> bool:
    """Whether an end or a port has no domain of its own and hands none on: one ground may serve translations and rotations."""
    part = mechanism.graph.vertices.get(key)
    return isinstance(part, parts.World) or (isinstance(part, lumped.Port) and not part.domain and part.kind not in ("position", "flow"))


def _connected(neighbours: dict[Id, list[Id]], start: Id) -> list[Id]:
    seen, stack = {start: None}, [start]
    while stack:
        for near in neighbours.get(stack.pop(), ()):
            if near not in seen:
                seen[near] = None
                stack.append(near)
    return list(seen)


def _join(neighbours: dict[Id, list[Id]], key: Id, others: list[Id]) -> None:
    neighbours.setdefault(key, []).extend(others)
    for other in others:
        neighbours.setdefault(other, []).append(key)


def _given(mechanism: Mechanism, key: Id) -> str:
    domain: str = getattr(mechanism.graph.vertices.get(key), "domain", "")
    if domain and domain not in DOMAINS:
        message = f"{key} is in the domain '{domain}'; there are {' and '.join(DOMAINS)}"
        raise refuse(codes.BAD_UNITS, message, mechanism.origin(key), element=str(key))
    return domain


def _contradiction(mechanism: Mechanism, a: tuple[str, Id], b: tuple[str, Id]) -> Exception:
    (one, first), (other, second) = a, b
    message = f"{first} is in {one} and {second} in {other} and edges of ratio 1 join them; their units do not agree"
    hint = "a ratio as the weight of an arc leads from one domain to the other: [radius] - rack"
    return refuse(codes.BAD_UNITS, message, mechanism.origin(second), element=str(second), hint=hint)
