"""<transmission> (ROS 1): its type, joints and actuators with their parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.urdf import notations
from hymeko_x.formats.urdf.notations import Reduction, TypeAs
from hymeko_x.ir.digits import number_text, numbers_text
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Actuator, Drive
from hymeko_x.xml.printing import Tag
from hymeko_x.xml.text import escaped, is_name

if TYPE_CHECKING:
    from hymeko_x.backends.urdf.sheet import UrdfSheet
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Parameters


def transmission_tag(key: Id, sheet: UrdfSheet) -> Tag:
    """The <transmission> of a drive."""
    edge = sheet.mechanism.graph.edges[key]
    assert isinstance(edge.data, Drive)
    tag = Tag("transmission", {"name": key.name})
    _add_kind(tag, edge.data.kind, sheet.choice(key, notations.TYPE_AS))
    joints = [arc for arc in edge.arcs if arc.sign < 0 and arc.target.kind == "joint"]
    actuators = [arc for arc in edge.arcs if arc.sign > 0]
    for arc in joints:
        _add_end(tag, "joint", arc, edge.data.parameters if len(joints) == 1 else ())
    for arc in actuators:
        part = sheet.mechanism.vertex(arc.target, Actuator)
        _add_end(tag, "actuator", arc, part.parameters)
    _add_reductions(tag, joints, actuators, sheet.choice(key, notations.REDUCTION))
    return tag


def _add_kind(tag: Tag, kind: str, type_as: TypeAs) -> None:
    if type_as is TypeAs.ATTRIBUTE:
        tag.attributes["type"] = kind
    elif kind:
        tag.children.append(_element("type", kind))


def _add_end(tag: Tag, name: str, arc: RobotArc, parameters: Parameters) -> None:
    end = tag.add(name, name=arc.target.name)
    if arc.role:
        end.children.append(_element("role", arc.role))
    for key, value in parameters:
        if not is_name(key):  # from another format, where a name may be any text; the ledger lists it
            continue
        text = value if isinstance(value, str) else numbers_text(value) if isinstance(value, tuple) else number_text(value)
        end.children.append(_element(key, text))


def _add_reductions(tag: Tag, joints: list[RobotArc], actuators: list[RobotArc], place: Reduction) -> None:
    """The reductions: each with its arc, but the only one of a simple transmission where its author put it."""
    ends = [child for child in tag.children if isinstance(child, Tag) and child.name in ("joint", "actuator")]
    weights = [numbers_weight(arc) for arc in (*joints, *actuators)]
    if len(joints) == len(actuators) == 1 and weights[0] and not weights[1]:
        target = {Reduction.ACTUATOR: ends[1], Reduction.JOINT: ends[0], Reduction.TRANSMISSION: tag}[place]
        target.children.append(_element("mechanicalReduction", number_text(weights[0][0])))
        return
    for end, weight in zip(ends, weights, strict=True):
        if weight:
            end.children.append(_element("mechanicalReduction", number_text(weight[0])))


def _element(name: str, text: str) -> Tag:
    return Tag(name, {}, [escaped(text)] if text else [])
