"""<joint type="gearbox">: a relation of the two hinges between its links and its reference body, as a coupling."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.gearboxes import ENDS, RATIO, REFERENCE, Hinge, turn_of
from hymeko_x.formats.sdf.values import NUMBER, VECTOR
from hymeko_x.frontends.sdf.joints import keep_as_written, read_axis
from hymeko_x.frontends.sdf.models import body_of
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Coupling, DofKind, Joint
from hymeko_x.ir.values import rotate

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.formats.sdf.gearboxes import Turn
    from hymeko_x.frontends.sdf.builder import SdfBuilder, SdfModel
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.values import Vec3
    from hymeko_x.xml.tree import XmlNode


def read_gearboxes(builder: SdfBuilder) -> None:
    """Each gearbox as a coupling, when all joints of the tree are known; one that is no relation of two hinges stays as written."""
    hinges = _hinges(builder) if builder.gearboxes else {}
    for node, model in builder.gearboxes:
        problem = _read_gearbox(node, model, builder, hinges)
        if problem is not None:
            builder.warn(codes.MISSING_PART, node, f"{node.subject}: {problem}; the gearbox is kept as written")
            assert node.owner is not None
            keep_as_written(node, node.owner, model, builder)


def _hinges(builder: SdfBuilder) -> dict[frozenset[Id], Hinge]:
    found = {}
    for key, edge in builder.edges.items():
        if isinstance(edge.data, Joint) and [dof.kind for dof in edge.data.dofs] == [DofKind.HINGE]:
            parent, child = edge.arcs[0].target, edge.arcs[1].target
            axis = rotate(builder.frames.in_world(key).quat, edge.data.dofs[0].axis)
            found[frozenset((parent, child))] = Hinge(key, parent, axis)
    return found


def _read_gearbox(node: XmlNode, model: SdfModel, builder: SdfBuilder, hinges: Mapping[frozenset[Id], Hinge]) -> str | None:
    """Add the coupling of a gearbox, or return why it is none."""
    key = node.owner
    assert key is not None
    names = [_text(node, tag) for tag in ENDS]
    bodies = [WORLD if tag == REFERENCE and not name else _body(name, model, builder) for tag, name in zip(ENDS, names, strict=True)]
    turns = []
    for tag, body, end in zip(words.AXES, bodies, ENDS, strict=False):
        if body is None or bodies[2] is None:
            return f"<{end}> or <{REFERENCE}> names no link"
        axis = _read_axis(node, tag, model, builder)
        turn = None if axis is None else turn_of(body, bodies[2], axis, hinges)
        if turn is None:
            return f"no hinge between {body} and {bodies[2]}, from which its angles are measured, turns about its <{tag}>"
        turns.append(turn)
    leader, follower = turns
    if leader.joint == follower.joint:
        return "both of its angles are those of one joint"
    _add_coupling(node, key, leader, follower, builder)
    builder.note(key, notations.GEARBOX, tuple(names if names[2] else names[:2]))
    return None


def _text(node: XmlNode, tag: str) -> str:
    child = node.child(tag)
    return "" if child is None else (child.text or "").strip()


def _body(name: str, model: SdfModel, builder: SdfBuilder) -> Id | None:
    found = builder.find(model.scope, name) if name else None
    return None if found is None else body_of(found, builder)


def _read_axis(node: XmlNode, tag: str, model: SdfModel, builder: SdfBuilder) -> Vec3 | None:
    """A unit axis in the world at the zero configuration."""
    axis, key = node.take_child(tag), node.owner
    if axis is None or key is None or not axis.has("xyz"):
        return None
    direction, written = read_axis(axis, tag, key, model, builder)
    builder.written.setdefault(key, {}).setdefault(f"{tag}/xyz", VECTOR.write(direction if written is None else written.numbers))
    return rotate(builder.frames.in_world(key).quat, direction)


def _add_coupling(node: XmlNode, key: Id, leader: Turn, follower: Turn, builder: SdfBuilder) -> None:
    """theta_2 = -ratio * theta_1, in the coordinates of the two joints."""
    for tag in ENDS:
        end = node.take_child(tag)
        if end is not None:
            end.text = None
    node.take("type")
    ratio = builder.child_value(node, RATIO, NUMBER, 1.0, key, RATIO)
    factor = -ratio * leader.sign * follower.sign
    builder.edges[key] = Edge(Coupling(), (Arc(follower.joint, 1, (1.0,)), Arc(leader.joint, -1, (0.0, factor + 0.0))))
