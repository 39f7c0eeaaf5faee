"""Variants of a robot for domain randomisation: the same seed gives the same robot on every machine."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.parts import Body, Joint, Shape
from hymeko_x.robot.errors import EditError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.ir.parts import Dof, VertexPart

OF_DOFS = ("damping", "friction", "stiffness", "armature")
SPREADS = ("mass", *OF_DOFS, "contact_friction")


def vary(mechanism: Mechanism, seed: int, spreads: Mapping[str, float]) -> Mechanism:
    """Each number times a factor drawn evenly from 1 - spread to 1 + spread, by the seed and the name of its element alone.

    Masses take their tensors with them. Raises: EditError for a spread outside of 0 to 1.
    """
    for name, spread in spreads.items():
        if name not in SPREADS:
            raise EditError(f"robot '{mechanism.name}': there is no spread of {name}; known: {', '.join(SPREADS)}")
        if not 0 <= spread <= 1:
            raise EditError(f"robot '{mechanism.name}': the spread of {name} is a number from 0 to 1, found {spread!r}")

    def factor(key: Id, name: str) -> float:
        return 1.0 + spreads[name] * (2.0 * Random(f"{seed} {key.kind} {key.name} {name}").random() - 1.0)

    def dof_of(key: Id, dof: Dof) -> Dof:
        return replace(dof, **{name: getattr(dof, name) * factor(key, name) for name in OF_DOFS if spreads.get(name)})

    vertices: dict[Id, VertexPart] = {}
    edges: dict[Id, RobotEdge] = {}
    for key, body in mechanism.vertices(Body):
        if spreads.get("mass") and body.inertial is not None and body.inertial.mass is not None:
            by = factor(key, "mass")
            tensor = None if body.inertial.tensor is None else tuple(number * by for number in body.inertial.tensor)
            vertices[key] = replace(body, inertial=replace(body.inertial, mass=body.inertial.mass * by, tensor=tensor, written=None))
    for key, edge in mechanism.graph.edges.items():
        if isinstance(edge.data, Joint) and edge.data.dofs:
            edges[key] = replace(edge, data=replace(edge.data, dofs=tuple([dof_of(key, dof) for dof in edge.data.dofs])))
        elif isinstance(edge.data, Shape) and spreads.get("contact_friction") and edge.data.friction:
            sliding, *rest = edge.data.friction
            edges[key] = replace(edge, data=replace(edge.data, friction=(sliding * factor(key, "contact_friction"), *rest)))
    return mechanism.replace(vertices=vertices, edges=edges)
