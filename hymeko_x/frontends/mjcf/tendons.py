"""<tendon>: cables along their whole path, and linear combinations of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.classes import merge
from hymeko_x.formats.mjcf.codec import BadAttribute, numbers_of, parameter_value
from hymeko_x.formats.mjcf.joints import TENDON
from hymeko_x.formats.mjcf.tree import COMMENT
from hymeko_x.formats.mjcf.words import TENDON_PARAMETERS
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import UNLIMITED, Limits, Tendon
from hymeko_x.ir.tendons import FIXED, PULLEY, SIDE, SPATIAL, WRAP, wrong_path

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.xml.tree import XmlNode


def read_tendons(sections: list[XmlNode], builder: MjcfBuilder) -> None:
    """Spatial and fixed tendons in order."""
    for section in sections:
        for element in section.children:
            if element.tag in (SPATIAL, FIXED):
                _read_tendon(element, builder)
            else:
                builder.keep_at_root(element, "tendon")


def _read_tendon(element: XmlNode, builder: MjcfBuilder) -> None:
    key = builder.own(element, "tendon", "tendon")
    base = builder.base(element, key)
    found = builder.values(element, TENDON, base, key)
    span = found["range"][0]
    red, green, blue, alpha = found["rgba"] or (0.0,) * 4
    tendon = Tendon(
        element.tag,
        UNLIMITED if span is None else Limits(*span),
        found["damping"],
        found["stiffness"],
        found["frictionloss"],
        found["armature"],
        found["width"],
        (red, green, blue, alpha) if found["rgba"] else None,
        _take_parameters(element, base),
    )
    arcs: list[RobotArc] = []
    for step in element.detach("joint", "site", "geom", PULLEY):
        arcs += _path(step, key, builder)
    _check_path(element, tendon, arcs, builder)
    builder.edges[key] = Edge(tendon, tuple(arcs))
    element.children = [child for child in element.children if child.tag != COMMENT]
    builder.keep(element, key)
    builder.show(key)


def _take_parameters(element: XmlNode, base: Mapping[str, str]) -> Parameters:
    """Other parameters of a tendon's length and forces, also where its class gives them."""
    merged = merge(base, element.attributes)
    found = tuple((name, parameter_value(name, merged[name])) for name in TENDON_PARAMETERS if name in merged)
    for name, _ in found:
        element.take(name)
    return found


def _check_path(element: XmlNode, tendon: Tendon, arcs: list[RobotArc], builder: MjcfBuilder) -> None:
    """Raises: Refusal for a path that MuJoCo refuses."""
    wrong = wrong_path(tendon, arcs, builder.edges)
    if wrong is not None:
        raise refuse(codes.BAD_NUMBER, f"the path of <{element.tag}> {wrong}", element.origin)


def _path(step: XmlNode, tendon: Id, builder: MjcfBuilder) -> list[RobotArc]:
    """One step of the path: one arc, and one more for the side of a wrapping shape."""
    if step.tag == PULLEY:
        divisor = _number(step, "divisor", builder)
        if divisor <= 0.0:
            raise refuse(codes.BAD_NUMBER, f"<pulley divisor> is {divisor}, expected a positive number", step.origin)
        return [Arc(tendon, 0, (divisor,), PULLEY)]
    if step.tag == "joint":
        joint = builder.find(step, "joint", step.attributes.get("joint", ""))
        role = builder.roles.get(joint, {}).get(step.attributes["joint"], "")
        return [Arc(joint, 1, (_number(step, "coef", builder),), role)]
    if step.tag == "site":
        return [Arc(builder.find(step, "site", step.attributes.get("site", "")))]
    arcs: list[RobotArc] = [Arc(builder.find(step, "geom", step.attributes.get("geom", "")), 0, None, WRAP)]
    side = step.attributes.get("sidesite")
    return arcs if side is None else [*arcs, Arc(builder.find(step, "site", side), 0, None, SIDE)]


def _number(step: XmlNode, name: str, builder: MjcfBuilder) -> float:
    try:
        found = numbers_of(step.attributes, name, 1, 1)
    except BadAttribute as error:
        raise builder.bad(step, error) from error
    if found is None:
        raise refuse(codes.MISSING_ATTRIBUTE, f"<{step.tag}> needs {name}", step.origin)
    return found[0]
