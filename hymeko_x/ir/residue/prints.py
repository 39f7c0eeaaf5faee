"""Digests of whole elements that do not depend on anybody's name: by them a renamed element is found again."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x.ir.parts import Body, Joint, Shape
from hymeko_x.ir.residue.paths import digest

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge


def print_of(mechanism: Mechanism, key: Id) -> str:
    """The digest of an element with what it is on, or of a body with what is on it."""
    edge = mechanism.graph.edges.get(key)
    if edge is not None:
        return digest(*_edge_values(edge))
    part = mechanism.graph.vertices[key]
    if not isinstance(part, Body):
        return digest(_nameless(part))
    above = mechanism.parent_joint.get(key)
    joint = () if above is None else (above.joint, above.parent_pose, above.child_pose)
    return digest(part, *map(_nameless, joint), *_shape_values(mechanism, key))


def weight_print(mechanism: Mechanism, body: Id) -> str:
    """The digest of everything that a body's mass may follow from."""
    part = mechanism.graph.vertices[body]
    return digest(part, *_shape_values(mechanism, body))


def _shape_values(mechanism: Mechanism, body: Id) -> list[object]:
    return [value for view in mechanism.shapes.get(body, ()) for value in (_nameless(view.shape), view.pose)]


def _edge_values(edge: RobotEdge) -> list[object]:
    values: list[object] = [_nameless(edge.data)]
    for arc in edge.arcs:
        values += [arc.sign, arc.role, arc.target.kind, arc.weight]
    return values


def _nameless(part: object) -> object:
    """A part without the names that it may carry."""
    if isinstance(part, Joint):
        if all(dof.name is None for dof in part.dofs):
            return part
        return replace(part, dofs=tuple(replace(dof, name=None) for dof in part.dofs))
    if getattr(part, "name", None) is not None:
        return replace(part, name=None)  # type: ignore[type-var]
    return part


def shape_group(edge: RobotEdge) -> str:
    """What a shape belongs to: all shapes of one name on one body stand or fall together. Empty for other edges."""
    if not isinstance(edge.data, Shape):
        return ""
    body = next((arc.target.name for arc in edge.arcs if arc.sign > 0), "")
    return digest(body, edge.data.name)
