"""<tendon>: cables along their whole path, and linear combinations of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf.joints import TENDON
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import DofKind, Tendon
from hymeko_x.ir.tendons import PULLEY, SIDE, SPATIAL
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.ir.mechanism import Id, RobotArc


def write_tendons(sheet: MjcfSheet) -> None:
    """Every tendon with its path."""
    items: list[tuple[Id, Tag]] = []
    for key, tendon, arcs in sheet.mechanism.edges(Tendon):
        own_class = sheet.own_class(key)
        base = sheet.base("tendon", own_class)
        attributes = {
            "name": sheet.name(key),
            "class": own_class,
            **sheet.attributes(_values(tendon), TENDON, base, sheet.notations(key), {}),
            **sheet.parameters(tendon.parameters, f"tendon/{tendon.kind}", base),
            **sheet.kept_attributes(key),
        }
        items.append((key, tag_of(tendon.kind, attributes, [*_path(sheet, arcs), *sheet.inside(key)])))
    sheet.write_section("tendon", items)


def _values(tendon: Tendon) -> dict[str, object]:
    upper, shown = tendon.limits.upper, tendon.kind == SPATIAL
    return {
        "range": (None if upper is None else (tendon.limits.lower or 0.0, upper), DofKind.SLIDE),
        "stiffness": tendon.stiffness,
        "damping": tendon.damping,
        "frictionloss": tendon.friction,
        "armature": tendon.armature,
        "width": tendon.width if shown else None,
        "rgba": tendon.rgba or () if shown else (),
    }


def _path(sheet: MjcfSheet, arcs: tuple[RobotArc, ...]) -> list[Tag]:
    """The steps of a path; the site beside a wrapping shape, whose arc comes after the shape's, is an attribute of it."""
    steps: list[Tag] = []
    for arc in arcs:
        if arc.role == SIDE:
            steps[-1].attributes["sidesite"] = sheet.reference(arc)
        elif arc.role == PULLEY:
            steps.append(Tag(PULLEY, {"divisor": sheet.numbers(numbers_weight(arc))}))
        elif arc.target.kind == "joint":
            steps.append(Tag("joint", {"joint": sheet.reference(arc), "coef": sheet.numbers(numbers_weight(arc))}))
        else:
            tag = "geom" if arc.target.kind == "shape" else "site"
            steps.append(Tag(tag, {tag: sheet.reference(arc)}))
    return steps
