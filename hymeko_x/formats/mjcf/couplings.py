"""Couplings that a mechanism from MJCF holds as text: tendons that follow tendons, and tendons and joints that are held."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.formats.mjcf import NAME
from hymeko_x.formats.mjcf.classes import Classes, merge
from hymeko_x.formats.mjcf.codec import numbers_of
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.formats.mjcf.words import shifted, trimmed
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import ROOT, Id, numbers_weight
from hymeko_x.ir.parts import Coupling, Joint, Tendon

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge


class _End(NamedTuple):
    """What an equality names: the element, the role of its dof, and its coordinate or length at the reference configuration."""

    id: Id
    role: str
    reference: float


def couplings(mechanism: Mechanism) -> Iterator[tuple[Id, RobotEdge]]:
    """The equalities of tendons, and of joints without a leader, in plain coordinates and lengths.

    What is held follows itself by the polynomial c0 + 0 q. The length of a spatial tendon counts from 0.
    """
    texts = [extra for extra in mechanism.extras.get(ROOT, ()) if extra.format == NAME]
    classes = Classes(parse_text(extra.text) for extra in texts if extra.text.startswith("<default"))
    ends: dict[str, Mapping[str, _End]] = {"tendon": _tendons(mechanism), "joint": _joints(mechanism)}
    for element in [parse_text(extra.text) for extra in texts if extra.path == "equality"]:
        given = merge(classes.of(f"{element.tag}@equality", element.attributes.get("class")), element.attributes)
        named = [
            ends[element.tag].get(given[word]) for word in (f"{element.tag}1", f"{element.tag}2") if word in given and element.tag in ends
        ]
        found = [end for end in named if end is not None]
        if found and len(found) == len(named):
            yield Id("coupling", given.get("name") or found[0].role or found[0].id.name), _coupling(given, found)


def _coupling(given: Mapping[str, str], ends: list[_End]) -> RobotEdge:
    """Source: MuJoCo, equality/tendon: l1 - l1(0) = c0 + c1 (l2 - l2(0)) + ...; without a second one l1 - l1(0) = c0."""
    written = numbers_of(given, "polycoef", 1, 5) or (0.0, 1.0)
    follower, leader = ends[0], ends[-1]
    coefficients = [written[0], 0.0]
    if len(ends) == 2:
        coefficients = trimmed(shifted(written if len(written) > 1 else (*written, 1.0), -leader.reference))
    coefficients[0] += follower.reference
    arcs: tuple[RobotArc, ...] = Arc(follower.id, 1, (1.0,), follower.role), Arc(leader.id, -1, tuple(coefficients), leader.role)
    return Edge(Coupling(given.get("active") != "false"), arcs)


def _joints(mechanism: Mechanism) -> Mapping[str, _End]:
    found = {}
    for key, joint, _ in mechanism.edges(Joint):
        for dof in joint.dofs:
            role = dof.name or "" if len(joint.dofs) > 1 else ""
            found[role or key.name] = _End(key, role, dof.ref)
    return found


def _tendons(mechanism: Mechanism) -> Mapping[str, _End]:
    return {key.name: _End(key, "", sum(_length(mechanism, arc) for arc in arcs)) for key, _, arcs in mechanism.edges(Tendon)}


def _length(mechanism: Mechanism, arc: RobotArc) -> float:
    """What a joint adds to the length of a fixed tendon at the reference configuration."""
    found = dof_at(mechanism.graph.edges, arc)
    return 0.0 if found is None else found[1].ref * numbers_weight(arc)[0]
