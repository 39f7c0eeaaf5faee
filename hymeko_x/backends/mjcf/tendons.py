"""<tendon>: cables and combinations of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.text import Attributes, Text, number, numbers
from hymeko_x.formats.mjcf.codec import parameter_text
from hymeko_x.formats.mjcf.words import TENDON_PARAMETERS
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Shape, Tendon
from hymeko_x.ir.tendons import PULLEY, SIDE, SPATIAL

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.names import Printed
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc


def write_tendons(text: Text, mechanism: Mechanism, names: Printed) -> None:
    """Every tendon with its path."""
    tendons = list(mechanism.edges(Tendon))
    if not tendons:
        return
    text.section("tendon")
    for key, tendon, arcs in tendons:
        text.open(tendon.kind, {"name": names.of(key), **_behaviour(tendon)})
        for tag, attributes in _steps(mechanism, arcs, names):
            text.leaf(tag, attributes)
        text.close()
    text.close()


def _behaviour(tendon: Tendon) -> Attributes:
    lower, upper = tendon.limits.lower, tendon.limits.upper
    return {
        "range": None if upper is None else numbers(lower or 0.0, upper),
        "stiffness": number(tendon.stiffness, 0.0),
        "damping": number(tendon.damping, 0.0),
        "frictionloss": number(tendon.friction, 0.0),
        "armature": number(tendon.armature, 0.0),
        "width": number(tendon.width) if tendon.kind == SPATIAL else None,
        "rgba": None if tendon.rgba is None or tendon.kind != SPATIAL else numbers(*tendon.rgba),
        **{name: parameter_text(value) for name, value in tendon.parameters if name in TENDON_PARAMETERS},
    }


def _steps(mechanism: Mechanism, arcs: tuple[RobotArc, ...], names: Printed) -> list[tuple[str, Attributes]]:
    """The steps of a path; a shape has the site beside it, whose arc comes after its own."""
    steps: list[tuple[str, Attributes]] = []
    for arc in arcs:
        if arc.role == SIDE:
            steps[-1][1]["sidesite"] = names.of(arc.target)
        elif arc.role == PULLEY:
            steps.append((PULLEY, {"divisor": numbers(*numbers_weight(arc))}))
        elif arc.target.kind == "joint":
            steps.append(("joint", {"joint": names.joint(arc), "coef": numbers(*numbers_weight(arc))}))
        elif arc.target.kind == "shape":
            steps.append(("geom", {"geom": _geom_name(mechanism, arc.target)}))
        else:
            steps.append(("site", {"site": names.of(arc.target)}))
    return steps


def _geom_name(mechanism: Mechanism, key: Id) -> str | None:
    shape = mechanism.graph.edges[key].data
    return shape.name if isinstance(shape, Shape) else None
