"""Digests of whole elements that do not depend on anybody's name: by them a renamed element is found again."""

from __future__ import annotations

import re
from dataclasses import is_dataclass, replace
from typing import TYPE_CHECKING

from hymeko_x.ir.parts import Body, Joint, Shape
from hymeko_x.ir.residue.paths import attributes_of, digest

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism, RobotEdge

_IN_ELEMENTS = re.compile(
    r"\s(?:type|size|material|rgba|density|friction|axis|range|ref|springref|stiffness|damping|frictionloss|armature|actuatorfrcrange|"
    r'ctrlrange|forcerange|gear|kp|kv|dampratio)="[^"]*"'
)
"""What a default class of MJCF says for its elements, each of which has it in a field of its own when it is read."""


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
        return replace(part, dofs=tuple(replace(dof, name=None) for dof in part.dofs))
    if is_dataclass(part) and any(item.name == "name" for item in attributes_of(part)):
        return replace(part, name=None)  # type: ignore[type-var]
    return part


def print_of_extra(extra: Extra) -> str:
    """The digest of an extra; of default classes only of what no element has in a field, where an edit would be seen."""
    is_classes = extra.format == "mjcf" and not extra.path and extra.text.startswith("<default")
    return digest(extra.format, extra.path, _IN_ELEMENTS.sub("", extra.text) if is_classes else extra.text)


def shape_group(edge: RobotEdge) -> str:
    """What a shape belongs to: all shapes of one name on one body stand or fall together. Empty for other edges."""
    if not isinstance(edge.data, Shape):
        return ""
    body = next((arc.target.name for arc in edge.arcs if arc.sign > 0), "")
    return digest(body, edge.data.name)
