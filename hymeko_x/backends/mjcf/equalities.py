"""<equality>: closures of loops, and joints that follow joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf.codec import numbers_of
from hymeko_x.formats.mjcf.notations import attribute
from hymeko_x.formats.mjcf.words import shifted, trimmed
from hymeko_x.ir.mechanism import WORLD, numbers_weight, pose_weight
from hymeko_x.ir.parts import Coupling, Loop
from hymeko_x.ir.values import quat_inverse, quat_product, unit_quat

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.sheet import Attributes, MjcfSheet
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.xml.printing import Tag


def write_equalities(sheet: MjcfSheet) -> None:
    """Closures between two elements and couplings of joints, in their common order, by which MuJoCo numbers them."""
    items: list[tuple[Id, Tag]] = []
    for key in sheet.mechanism.constraints:
        edge = sheet.mechanism.graph.edges[key]
        data, arcs = edge.data, edge.arcs
        if isinstance(data, Coupling) and all(arc.target.kind == "joint" for arc in arcs):
            items.append((key, tag_of("joint", _coupling(sheet, key, data, arcs), sheet.inside(key))))
        elif isinstance(data, Loop) and data.kind in ("connect", "weld") and len(arcs) == 2:
            items.append((key, tag_of(data.kind, _loop(sheet, key, data, arcs), sheet.inside(key))))
    sheet.write_section("equality", items)


def _coupling(sheet: MjcfSheet, key: Id, coupling: Coupling, arcs: tuple[RobotArc, ...]) -> Attributes:
    """The follower's coordinate as a polynomial of the leader's, both counted from their reference values.

    Source: MuJoCo, equality/joint: q1 - ref1 = c0 + c1 (q2 - ref2) + ...; without a leader q1 - ref1 = c0.
    """
    follower = next(arc for arc in arcs if arc.sign > 0)
    leader = next(arc for arc in arcs if arc.sign < 0)
    return {
        "name": sheet.name(key),
        "class": sheet.own_class(key),
        "joint1": sheet.reference(follower),
        "joint2": None if sheet.dof(leader) is None else sheet.reference(leader),
        "polycoef": _polynomial(sheet, key, follower, leader),
        "active": None if coupling.active else "false",
        **sheet.kept_attributes(key),
    }


def _polynomial(sheet: MjcfSheet, key: Id, follower: RobotArc, leader: RobotArc) -> str | None:
    """The coefficients as their author wrote them while they mean the same; None where an author of MJCF left the default, 0 1."""
    led, leading = sheet.dof(follower), sheet.dof(leader)
    first, second = led.ref if led else 0.0, leading.ref if leading else 0.0
    factor = (numbers_weight(follower) or (1.0,))[0]
    noted = numbers_of(sheet.notations(key), "@polycoef", 1, 5)
    if noted is not None and factor == 1.0 and _absolute(noted, first, second) == list(numbers_weight(leader)):
        return sheet.notations(key)["@polycoef"]
    coefficients = [value / factor for value in shifted(numbers_weight(leader), second)]
    coefficients[0] -= first
    found = tuple(trimmed(coefficients)) if leading else (coefficients[0], 0.0)
    return None if found == (0.0, 1.0) and sheet.from_mjcf else sheet.numbers(found)


def _absolute(written: tuple[float, ...], follower_ref: float, leader_ref: float) -> list[float]:
    """The coefficients in coordinates that do not count from the reference, in the reader's own arithmetic."""
    found = shifted(written if len(written) > 1 else (*written, 1.0), -leader_ref)
    found[0] += follower_ref
    return trimmed(found)


def _loop(sheet: MjcfSheet, key: Id, loop: Loop, arcs: tuple[RobotArc, ...]) -> Attributes:
    first, second = arcs
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
        **sheet.parameters(loop.parameters, f"equality/{loop.kind}", sheet.base(loop.kind, own_class)),
        **sheet.kept_attributes(key),
    }


def _closure(sheet: MjcfSheet, key: Id, loop: Loop, first: RobotArc, second: RobotArc) -> Attributes:
    """Of a weld: ``anchor`` is the point in body 2 that meets the position of ``relpose`` in body 1, whose rotation is body 2's.

    Source: MuJoCo's constraint, seen from its residual; the manual speaks of the relative pose of the bodies.
    """
    notations = sheet.notations(key)
    one, two = pose_weight(first), pose_weight(second)
    anchor = one.xyz if loop.kind == "connect" else two.xyz
    text = notations["@anchor"] if numbers_of(notations, "@anchor", 3, 3) == anchor else sheet.numbers(anchor)
    if loop.kind == "connect":
        return {"anchor": text}
    turn = unit_quat(quat_product(one.quat, quat_inverse(two.quat)))
    relative = sheet.note(key, attribute("relpose")) if sheet.from_mjcf else sheet.numbers((*one.xyz, *turn))
    return {"anchor": text if any(anchor) or "@anchor" in notations else None, "relpose": relative}
