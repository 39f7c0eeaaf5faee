"""<contact>, <equality> and <tendon>."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.native.parameters import parameter_attributes
from hymeko_x.backends.mjcf.native.sheet import write_section
from hymeko_x.formats.mjcf.codec import numbers_of
from hymeko_x.formats.mjcf.joints import TENDON
from hymeko_x.formats.mjcf.words import shifted
from hymeko_x.ir.mechanism import WORLD, numbers_weight, pose_weight
from hymeko_x.ir.parts import Contact, Coupling, DofKind, Joint, Loop, Tendon
from hymeko_x.ir.tendons import PULLEY, SIDE
from hymeko_x.ir.values import number_text, numbers_text

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.ir.mechanism import Id, RobotArc

Items = list[tuple["Id", str, "Attributes", list[str]]]

_CONTACT_ENDS = {"pair": ("geom1", "geom2"), "exclude": ("body1", "body2")}


def write_contacts(sheet: Sheet) -> None:
    """Pairs and exclusions."""
    items: Items = []
    for key, contact, arcs in sheet.mechanism.edges(Contact):
        own_class = sheet.own_class(key)
        ends = {name: sheet.reference(arc) for name, arc in zip(_CONTACT_ENDS[contact.kind], arcs, strict=True)}
        attributes: Attributes = {
            "name": sheet.name(key),
            "class": own_class,
            **ends,
            **parameter_attributes(contact.parameters, sheet.base(contact.kind, own_class)),
            **sheet.said(key),
        }
        items.append((key, contact.kind, attributes, sheet.inside(key)))
    write_section(sheet, "contact", items)


# ---- equality ------------------------------------------------------------------------------------------------------------------


def write_equalities(sheet: Sheet) -> None:
    """Closures and couplings, in the order in which they were written."""
    items: Items = []
    for key, edge in sheet.mechanism.graph.edges.items():
        if isinstance(edge.data, Coupling):
            items.append((key, "joint", _coupling(sheet, key, edge.data, edge.arcs), sheet.inside(key)))
        elif isinstance(edge.data, Loop):
            items.append((key, edge.data.kind, _loop(sheet, key, edge.data, edge.arcs), sheet.inside(key)))
    write_section(sheet, "equality", items)


def _coupling(sheet: Sheet, key: Id, coupling: Coupling, arcs: tuple[RobotArc, ...]) -> Attributes:
    follower = next(arc for arc in arcs if arc.sign > 0)
    leader = next(arc for arc in arcs if arc.sign < 0)
    first, second = _ref(sheet, follower), _ref(sheet, leader)
    coefficients = _trimmed(shifted(numbers_weight(leader), second))
    coefficients[0] -= first
    text = numbers_text(tuple(coefficients)) if coefficients != [0.0, 1.0] else None
    noted = sheet.notes(key).get("@polycoef")
    if noted is not None and _absolute(numbers_of({"c": noted}, "c", 1, 5) or (), first, second) == list(numbers_weight(leader)):
        text = noted
    return {
        "name": sheet.name(key),
        "class": sheet.own_class(key),
        "joint1": sheet.reference(follower),
        "joint2": sheet.reference(leader),
        "polycoef": text,
        "active": None if coupling.active else "false",
        **sheet.said(key),
    }


def _absolute(said: tuple[float, ...], follower_ref: float, leader_ref: float) -> list[float]:
    """The coefficients in coordinates that do not count from the reference, in the reader's own arithmetic."""
    found = shifted(said if len(said) > 1 else (*said, 1.0), -leader_ref)
    found[0] += follower_ref
    return _trimmed(found)


def _trimmed(coefficients: list[float]) -> list[float]:
    while len(coefficients) > 2 and coefficients[-1] == 0.0:
        coefficients = coefficients[:-1]
    return coefficients


def _ref(sheet: Sheet, arc: RobotArc) -> float:
    edge = sheet.mechanism.graph.edges.get(arc.target)
    if edge is None or not isinstance(edge.data, Joint) or not edge.data.dofs:
        return 0.0
    return next((dof.ref for dof in edge.data.dofs if arc.role and dof.name == arc.role), edge.data.dofs[0].ref)


def _loop(sheet: Sheet, key: Id, loop: Loop, arcs: tuple[RobotArc, ...]) -> Attributes:
    first, second = arcs[0], arcs[1]
    own_class = sheet.own_class(key)
    if first.target.kind == "frame":
        ends: Attributes = {"site1": sheet.reference(first), "site2": sheet.reference(second)}
    else:
        ends = {
            "body1": sheet.reference(first),
            "body2": None if second.target == WORLD else sheet.reference(second),
            **_closure(sheet, key, loop, first, second),
        }
    return {
        "name": sheet.name(key),
        "class": own_class,
        **ends,
        "active": None if loop.active else "false",
        **parameter_attributes(loop.parameters, sheet.base(loop.kind, own_class)),
        **sheet.said(key),
    }


def _closure(sheet: Sheet, key: Id, loop: Loop, first: RobotArc, second: RobotArc) -> Attributes:
    notes = sheet.notes(key)
    anchor = pose_weight(first).xyz if loop.kind == "connect" else pose_weight(second).xyz
    noted = numbers_of(notes, "@anchor", 3, 3)
    said: Attributes = {"anchor": notes["@anchor"] if noted == anchor else numbers_text(anchor) if any(anchor) else None}
    if loop.kind == "connect":
        return {"anchor": said["anchor"] or "0 0 0"}
    said["relpose"] = notes.get("@relpose")
    return said


# ---- tendons -------------------------------------------------------------------------------------------------------------------


def write_tendons(sheet: Sheet) -> None:
    """Tendons with their paths."""
    items: Items = []
    for key, tendon, arcs in sheet.mechanism.edges(Tendon):
        own_class = sheet.own_class(key)
        base = sheet.base("tendon", own_class)
        upper = tendon.limits.upper
        values = {
            "range": (None if upper is None else (tendon.limits.lower or 0.0, upper), DofKind.SLIDE),
            "stiffness": tendon.stiffness,
            "damping": tendon.damping,
            "frictionloss": tendon.friction,
            "armature": tendon.armature,
            "width": tendon.width,
            "rgba": tendon.rgba or (),
        }
        attributes: Attributes = {
            "name": sheet.name(key),
            "class": own_class,
            **sheet.attributes(values, TENDON, base, sheet.notes(key), {}),
            **parameter_attributes(tendon.parameters, base),
            **sheet.said(key),
        }
        items.append((key, tendon.kind, attributes, [*_path(sheet, arcs), *sheet.inside(key)]))
    write_section(sheet, "tendon", items)


def _path(sheet: Sheet, arcs: tuple[RobotArc, ...]) -> list[str]:
    """The steps of a path; the side of a wrapping shape stands behind it."""
    steps: list[list[tuple[str, str]]] = []
    tags: list[str] = []
    for arc in arcs:
        if arc.role == SIDE:
            steps[-1].append(("sidesite", sheet.reference(arc)))
            continue
        tag, attributes = _step(sheet, arc)
        tags.append(tag)
        steps.append(attributes)
    return [f"<{tag}{_attributes(found)}/>" for tag, found in zip(tags, steps, strict=True)]


def _step(sheet: Sheet, arc: RobotArc) -> tuple[str, list[tuple[str, str]]]:
    if arc.role == PULLEY:
        return PULLEY, [("divisor", number_text(numbers_weight(arc)[0]))]
    if arc.target.kind == "joint":
        return "joint", [("joint", sheet.reference(arc)), ("coef", number_text(numbers_weight(arc)[0]))]
    if arc.target.kind == "shape":
        return "geom", [("geom", sheet.reference(arc))]
    return "site", [("site", sheet.reference(arc))]


def _attributes(found: list[tuple[str, str]]) -> str:
    from hymeko_x.xml.text import attributes_text

    return attributes_text(dict(found))
