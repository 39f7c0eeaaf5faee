"""The lumped network of a mechanism: its masses, grounds and constitutive edges, checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.ir import lumped, parts
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.networks.domains import domains_of
from hymeko_x.networks.laws import parse_law
from hymeko_x.networks.network import EFFORTS, MOTIONS, Branch, Network, NetworkElement

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Refusal
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism, RobotArc


def has_network(mechanism: Mechanism) -> bool:
    """Whether there is a lumped network in it."""
    return next(mechanism.vertices(lumped.Mass), None) is not None or next(mechanism.edges(lumped.Constitutive), None) is not None


def network_of(mechanism: Mechanism) -> Network:
    """The lumped network of a mechanism.

    Raises: Refusal (HX400) for one in which nothing moves, HX401 units that do not fit, HX402 a moving end without mass, HX403 couplings in
    a circle, HX406 an edge that describes no network.
    """
    branches = tuple(_branch(mechanism, key, arcs) for key, _, arcs in mechanism.edges(lumped.Constitutive))
    followers = _followers(mechanism)
    ends = [key for key, _ in mechanism.vertices(lumped.Mass)]
    ends += [key for branch in branches for key, _ in branch.ends] + [key for branch in branches for key, _, _ in branch.senses]
    ends = list(dict.fromkeys(ends))
    masses = {key: _mass(mechanism, key) for key in ends if key.kind in ("mass", "body")}
    moved = {key: _port(mechanism, key) for key in ends if key.kind in ("port", "world")}
    if not masses:
        raise refuse(codes.NO_DYNAMICS, f"{mechanism.name}: nothing in the network has a mass, so that nothing moves")
    for follower, (_, leaders) in followers.items():
        for key in (follower, *[leader for leader, _ in leaders]):
            if key not in masses:
                raise _wrong(mechanism, key, "is coupled, and it is no mass of the network")
    sensors = _sensors(mechanism, {*masses, *[branch.id for branch in branches]})
    domains = domains_of(mechanism, branches, followers)
    return Network(mechanism.name, masses, moved, branches, followers, sensors, domains)


def _wrong(mechanism: Mechanism, key: Id, words: str, hint: str = "") -> Refusal:
    return refuse(codes.BAD_NETWORK, f"{key} {words}", mechanism.origin(key), element=str(key), hint=hint)


def _branch(mechanism: Mechanism, key: Id, arcs: tuple[RobotArc, ...]) -> Branch:
    ends: list[tuple[Id, float]] = []
    elements: list[NetworkElement] = []
    senses: list[tuple[Id, float, float]] = []
    for arc in arcs:
        part = mechanism.graph.vertices.get(arc.target)
        weight = (*numbers_weight(arc), *(1.0, 0.0)[len(numbers_weight(arc)) :])
        if arc.role == "sense":
            senses.append((arc.target, weight[0], weight[1]))
        elif arc.role:
            raise _wrong(mechanism, key, f"has an arc of the role '{arc.role}' to {arc.target}; the only role is 'sense'")
        elif isinstance(part, lumped.Spring | lumped.Damper) or (isinstance(part, lumped.Port) and part.kind not in MOTIONS):
            elements.append(_element(mechanism, arc.target, part, weight[0]))
        elif arc.sign == 0:
            raise _wrong(mechanism, key, f"has an arc without direction to {arc.target}", "+ and - are the two sides of the deflection")
        else:
            ends.append((arc.target, -arc.sign * weight[0]))
    if not ends:
        raise _wrong(mechanism, key, "joins no masses", "@edge { + ground - mass ~ spring }")
    return Branch(key, tuple(ends), tuple(elements), tuple(senses))


def _element(mechanism: Mechanism, key: Id, part: lumped.Spring | lumped.Damper | lumped.Port, count: float) -> NetworkElement:
    if isinstance(part, lumped.Port):
        _port(mechanism, key)
        return NetworkElement(key, part, count)
    names = ("x", "k") if isinstance(part, lumped.Spring) else ("v", "c")
    return NetworkElement(key, part, count, parse_law(part.law, names, str(key), mechanism.origin(key)) if part.law else None)


def _port(mechanism: Mechanism, key: Id) -> lumped.Port:
    part = mechanism.graph.vertices[key]
    if isinstance(part, parts.World):
        return lumped.Port()
    assert isinstance(part, lumped.Port)
    if part.kind not in MOTIONS + EFFORTS:
        raise _wrong(mechanism, key, f"is a port of the type '{part.kind}'; there are {', '.join(MOTIONS + EFFORTS)}")
    return part


def _mass(mechanism: Mechanism, key: Id) -> float:
    part = mechanism.graph.vertices[key]
    if isinstance(part, lumped.Mass):
        mass: float | None = part.mass
    else:
        mass = part.inertial.mass if isinstance(part, parts.Body) and part.inertial else None
    if mass is None or not 0.0 < mass < float("inf"):
        found = "no mass" if mass is None else f"the mass {mass:g}"
        message = f"{key} moves and has {found}; its acceleration is not determined"
        hint = "give it a positive mass, or make it a ground; a spring and a damper in a row have a small mass between them"
        raise refuse(codes.MASSLESS, message, mechanism.origin(key), element=str(key), hint=hint)
    return mass


def _followers(mechanism: Mechanism) -> dict[Id, tuple[float, tuple[tuple[Id, float], ...]]]:
    """The masses that levers and gears move, leaders before followers."""
    found: dict[Id, tuple[float, tuple[tuple[Id, float], ...]]] = {}
    for key, coupling, arcs in mechanism.edges(parts.Coupling):
        if not coupling.active or not any(arc.target.kind in ("mass", "body") for arc in arcs):
            continue
        followers = [arc.target for arc in arcs if arc.sign > 0]
        leaders = [(arc.target, numbers_weight(arc) or (0.0, 1.0)) for arc in arcs if arc.sign < 0]
        if len(followers) != 1 or not leaders or any(len(weight) > 2 for _, weight in leaders):
            raise _wrong(mechanism, key, "does not couple one mass to others by [offset ratio]")
        if followers[0] in found:
            raise _wrong(mechanism, key, f"is the second coupling that {followers[0]} follows")
        ratios = tuple((leader, weight[1] if len(weight) > 1 else 0.0) for leader, weight in leaders)
        found[followers[0]] = (sum(weight[0] for _, weight in leaders), ratios)
    return _ordered(mechanism, found)


def _ordered(
    mechanism: Mechanism, found: dict[Id, tuple[float, tuple[tuple[Id, float], ...]]]
) -> dict[Id, tuple[float, tuple[tuple[Id, float], ...]]]:
    left, ordered = dict(found), {}
    while left:
        ready = [key for key, (_, leaders) in left.items() if not any(leader in left for leader, _ in leaders)]
        if not ready:
            names = ", ".join(map(str, left))
            message = f"{names} follow each other in a circle; their positions form an algebraic loop"
            first = next(iter(left))
            raise refuse(codes.ALGEBRAIC_LOOP, message, mechanism.origin(first), element=str(first))
        ordered.update({key: left.pop(key) for key in ready})
    return ordered


def _sensors(mechanism: Mechanism, known: set[Id]) -> dict[Id, tuple[parts.Sensor, Id]]:
    found = {}
    for _, _, arcs in mechanism.edges(parts.Sense):
        sensors = [arc.target for arc in arcs if arc.sign < 0]
        measured = [arc.target for arc in arcs if arc.sign > 0 and arc.target in known]
        if len(sensors) == 1 and len(measured) == 1:
            found[sensors[0]] = (mechanism.vertex(sensors[0], parts.Sensor), measured[0])
    return found
