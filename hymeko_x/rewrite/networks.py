"""Lumped networks as robots: each mass is a body, and springs and dampers belong to the joint between two of them.

The masses of a tree of branches move along one axis: x in translation, where gravity does no work, and about z in rotation. The coordinate
of a joint is the deflection of its branch, so that stiffness, damping and rest length are those of the joint.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal
from hymeko_x.ir import lumped
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.ids import LUMPED_KINDS
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, joint_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Actuator, Body, Dof, DofKind, Drive, Inertial, Joint, World
from hymeko_x.ir.values import ZERO, Tensor, X, Z

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.networks.network import Branch, Network

_BALL = 0.004
"""In m^2: the moment of inertia per mass, 0.4 r^2, of the ball with r = 0.1 m that a mass in translation is taken for. No motion along
an axis depends on it."""
_MASS_OF_INERTIA = 1.0
"""In kg, of a body that a moment of inertia becomes; its centre is on the axis, so that no motion depends on it."""


class _Step(NamedTuple):
    """A mass with the end that carries it, and the branches between them with the direction of their deflection."""

    mass: Id
    parent: Id
    branches: tuple[Branch, ...]


def robot_of_network(mechanism: Mechanism, format: Format, report: Report) -> Mechanism:
    """The robot of a lumped network that is a tree of masses; another mechanism as it is.

    A graph or a network of which a format for robots would represent nothing is an error (HX065) that gives the reason.
    """
    if format.is_exact or next(mechanism.vertices(Body), None) is not None:
        return mechanism
    kinds = Counter(key.kind for key in mechanism.graph.vertices if key.kind in LUMPED_KINDS)
    if not kinds:
        return mechanism
    network, reason = _network(mechanism)
    steps = () if network is None else _tree(network)
    reason = reason or ("" if network is None else _obstacle(network, steps))
    if network is None or reason:
        found = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
        message = f"'{mechanism.name}' has no bodies, and {format.name} can represent nothing of it: {found}; {reason}"
        report.error(codes.NOT_A_ROBOT, message, hint="hymeko represents graphs and lumped systems")
        return mechanism
    axes = " and ".join(_AXES[domain] for domain in dict.fromkeys(network.domains[step.mass] for step in steps))
    moving = f"its {len(steps)} masses move" if len(steps) > 1 else "its mass moves"
    report.note(codes.REWRITTEN, f"the network '{mechanism.name}' becomes a robot: {moving} {axes}")
    return _robot(mechanism, network, steps)


def _network(mechanism: Mechanism) -> tuple[Network | None, str]:
    """The network of a mechanism, or why it has none."""
    from hymeko_x.networks.assembly import has_network, network_of  # robots need nothing of it

    if not has_network(mechanism):
        return None, "it has no masses"
    try:
        return network_of(mechanism), ""
    except Refusal as error:
        return None, error.diagnostic.message


_AXES: Mapping[str, str] = {"translation": "along x", "rotation": "about z"}


def _tree(network: Network) -> tuple[_Step, ...]:
    """The masses from the grounds outwards, each with what carries it; masses that nothing joins to a ground begin a tree in the world."""
    joined: dict[Id, dict[Id, list[Branch]]] = {}
    for branch in network.branches:
        first, *others = dict.fromkeys(WORLD if end in network.moved else end for end, _ in branch.ends)
        for other in others[:1]:
            joined.setdefault(first, {}).setdefault(other, []).append(branch)
            joined.setdefault(other, {}).setdefault(first, []).append(branch)
    steps: list[_Step] = []
    reached = {WORLD}
    for start in (WORLD, *network.masses):
        if start not in reached:
            steps.append(_Step(start, WORLD, ()))
        reached.add(start)
        waiting = [start]
        for end in waiting:
            for other, branches in joined.get(end, {}).items():
                if other not in reached:
                    reached.add(other)
                    steps.append(_Step(other, end, tuple(branches)))
                    waiting.append(other)
    return tuple(steps)


def _obstacle(network: Network, steps: tuple[_Step, ...]) -> str:
    """Why a network is no tree of masses on joints; empty where it is one."""
    for key in network.followers:
        return f"{key} follows other masses"
    for key, port in network.moved.items():
        if port.kind in ("position", "flow"):
            return f"{key} moves as an input gives it, and joints have no such motion"
    for branch in network.branches:
        ratios = sorted(ratio for _, ratio in branch.ends)
        if ratios != [-1.0, 1.0]:
            return f"{branch.id} does not join two ends of ratio 1"
        for element in branch.elements:
            if element.law is not None or (isinstance(element.part, lumped.Port) and element.part.kind != "effort"):
                return f"{element.id} {'has a law of its own' if element.law is not None else 'is a controller'}"
    standing = {branch.id for step in steps for branch in step.branches}
    for branch in network.branches:
        if branch.id not in standing and any(end not in network.moved for end, _ in branch.ends):
            return f"{branch.id} closes a circle of branches"
    return ""


def _robot(mechanism: Mechanism, network: Network, steps: tuple[_Step, ...]) -> Mechanism:
    names = names_in_use(mechanism)
    bodies = {WORLD: WORLD} | {step.mass: names.take("body", step.mass.name) for step in steps}
    vertices: dict[Id, VertexPart] = {WORLD: World()}
    edges: dict[Id, RobotEdge] = {}
    for step in steps:
        turns = network.domains[step.mass] == "rotation"
        vertices[bodies[step.mass]] = Body(_inertial(network.masses[step.mass], turns=turns))
        joint = names.take("joint", step.branches[0].id.name if step.branches else f"{step.mass.name}_joint")
        edges[joint] = joint_edge(Joint((_dof(step, turns=turns),)), bodies[step.parent], bodies[step.mass])
        for branch in step.branches:
            for element in branch.elements:
                if isinstance(element.part, lumped.Port):
                    actuator = names.take("actuator", element.id.name)
                    gear = element.count * _direction(branch, step)
                    vertices[actuator] = Actuator("motor")
                    driven: RobotArc = Arc(joint, -1, None if gear == 1.0 else (gear,))
                    edges[names.take("drive", element.id.name)] = Edge(Drive(), (Arc(actuator, 1), driven))
    return Mechanism(mechanism.name, Hypergraph(vertices, edges), source=mechanism.source)


def _inertial(mass: float, *, turns: bool) -> Inertial:
    """The inertial of a mass in kg, or of a moment of inertia in kg m^2 about the axis, whose tensor is that of a ball."""
    moment = mass if turns else mass * _BALL
    tensor: Tensor = (moment, moment, moment, 0.0, 0.0, 0.0)
    return Inertial(_MASS_OF_INERTIA if turns else mass, ZERO, tensor)


def _dof(step: _Step, *, turns: bool) -> Dof:
    """The dof of a mass: springs and dampers in parallel are one of each, and the rest is where their forces add up to zero."""
    stiffness = damping = pull = 0.0
    for branch in step.branches:
        for element in branch.elements:
            if isinstance(element.part, lumped.Spring):
                stiffness += element.count * element.part.stiffness
                pull += element.count * element.part.stiffness * element.part.rest * _direction(branch, step)
            elif isinstance(element.part, lumped.Damper):
                damping += element.count * element.part.damping
    rest = pull / stiffness if stiffness else 0.0
    kind, axis = (DofKind.HINGE, Z) if turns else (DofKind.SLIDE, X)
    return Dof(kind, axis, stiffness=stiffness, damping=damping, spring_ref=rest)


def _direction(branch: Branch, step: _Step) -> float:
    """1 where the deflection of a branch is the position of the mass less that of what carries it, else -1."""
    return next(ratio for end, ratio in branch.ends if end == step.mass)
