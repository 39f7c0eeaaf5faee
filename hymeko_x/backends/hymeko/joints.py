"""Joints as HyMeKo text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.hymeko.extras import comments_of
from hymeko_x.backends.hymeko.parts import limit_items, word_fields
from hymeko_x.backends.hymeko.sharing import ratio_of
from hymeko_x.backends.hymeko.values import pose_value
from hymeko_x.formats import hymeko as words
from hymeko_x.formats.hymeko.references import child_names
from hymeko_x.formats.hymeko.sharing import RATIO
from hymeko_x.ir import parts
from hymeko_x.ir.fields import identical
from hymeko_x.ir.mechanism import Id, numbers_weight
from hymeko_x.ir.values import IDENTITY, Pose
from hymeko_x.language.syntax import ArcItem, Field, Item, Node, QuotedName, Ref, Stereotype

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.hymeko.sheet import HymekoSheet
    from hymeko_x.backends.hymeko.values import Angles
    from hymeko_x.ir.mechanism import Mechanism, RobotArc
    from hymeko_x.ir.views import JointView

_BODIES = words.TARGETS["joint"]
_SHORT_AXES = {str(direction): (name, "") for name, direction in words.AXES.items() if len(name) == 1}
_SHORT_AXES |= {str((-x + 0.0, -y + 0.0, -z + 0.0)): (name, "-") for name, (x, y, z) in words.AXES.items() if len(name) == 1}


def joint_items(sheet: HymekoSheet, key: Id) -> tuple[str, list[Item]]:
    """The type's name (empty for a hinge) and the block of a joint: ends, dofs, what it follows."""
    view = sheet.mechanism.joints[key]
    items: list[Item] = [_end(sheet, view.parent, "+", view.parent_pose, "")]
    followers = sheet.shared.get(key, ())
    framed = not identical(view.child_pose, IDENTITY)
    if framed or followers or view.child != _implied_child(sheet, key):
        items.append(_end(sheet, view.child, "-", view.child_pose, "at" if framed else ""))
    for follower in followers:
        items += comments_of(sheet.mechanism.extras.get(follower, ()))
        items.append(_follower(sheet, view.parent_pose, sheet.mechanism.joints[follower]))
    dofs = view.joint.dofs
    kind = words.JOINT_TYPES.get(tuple(dof.kind for dof in dofs), "compound")
    if kind == "compound":
        items.extend(dof_node(dof, sheet.angles) for dof in dofs)
    else:
        items.extend(item for dof in dofs for item in _dof_items(dof, sheet.angles))
    items.extend(_mimic(sheet, arc) for arc in sheet.mimics.get(Id("coupling", key.name), ()))
    return kind, items


def _implied_child(sheet: HymekoSheet, key: Id) -> Id | None:
    """The body that a joint without a child leads to."""
    name = next((name for name in child_names(key.name) if "body" in sheet.names.get(name, ())), None)
    return None if name is None else Id("body", name)


def _end(sheet: HymekoSheet, body: Id, direction: str, pose: Pose, role: str) -> ArcItem:
    weight = None if identical(pose, IDENTITY) else pose_value(pose, sheet.angles)
    return ArcItem(sheet.ref(body, _BODIES, direction), role, weight)


def _follower(sheet: HymekoSheet, shared: Pose, view: JointView) -> ArcItem:
    """The arc to the child of a joint that stands in the edge of the one that it follows; ``shared`` is that one's pose."""
    ratio = ratio_of(sheet.mimics, view.id)
    block = () if ratio == 1.0 else (Field(RATIO, ratio),)
    framed = not identical(view.child_pose, IDENTITY)
    arc = _end(sheet, view.child, "-", view.child_pose, "at" if framed else "")
    if not framed and not identical(view.parent_pose, shared):
        arc = arc._replace(weight=pose_value(view.parent_pose, sheet.angles))
    return arc._replace(items=block)


def _mimic(sheet: HymekoSheet, arc: RobotArc) -> ArcItem:
    coefficients = numbers_weight(arc)
    weight = None if identical(coefficients, (0.0, 1.0)) else coefficients
    return ArcItem(sheet.ref(arc.target, words.TARGETS["coupling"], "-"), "mimic", weight)


def mimic_arcs(mechanism: Mechanism) -> Mapping[Id, tuple[RobotArc, ...]]:
    """The couplings that stand in the block of the following joint: named like it, active, with nothing beside them."""
    found: dict[Id, tuple[RobotArc, ...]] = {}
    marked = {*mechanism.extras, *mechanism.notations, *mechanism.layout}
    for key, coupling, arcs in mechanism.edges(parts.Coupling):
        if key in marked or key in mechanism.graph.incidence or not coupling.active or len(arcs) < 2:
            continue
        follower, *leaders = arcs
        sound = follower.sign > 0 and numbers_weight(follower) == (1.0,) and not follower.role
        named = follower.target.name == key.name and follower.target in mechanism.joints
        if sound and named and all(arc.sign < 0 and not arc.role and numbers_weight(arc) for arc in leaders):
            found[key] = tuple(leaders)
    return found


def dof_node(dof: parts.Dof, angles: Angles) -> Node:
    """The block of one of several dofs: ``roll : hinge { .. }``, and ``dof : hinge { .. }`` for one without a name."""
    name = "dof" if dof.name is None else QuotedName(dof.name) if dof.name in words.DOF_BLOCKS else dof.name
    items = [item for item in _dof_items(dof, angles) if not (isinstance(item, Field) and item.name == "dof_name")]
    return Node(name, tuple(items), (Stereotype(Ref((words.DOF_TYPES[dof.kind],))),))


def _dof_items(dof: parts.Dof, angles: Angles) -> list[Item]:
    items = _axis(dof)
    motion = "angle" if dof.kind in words.TURNING else "length"
    items.extend(limit_items(dof.limits, angles, motion))
    items.extend(word_fields(dof, words.DOF_WORDS, angles, motion))
    if dof.safety is not None:
        items.append(Node("safety", tuple(word_fields(dof.safety, words.SAFETY_WORDS, angles, motion))))
    if dof.calibration is not None:
        items.append(Node("calibration", tuple(word_fields(dof.calibration, words.CALIBRATION_WORDS, angles, motion))))
    return items


def _axis(dof: parts.Dof) -> list[Item]:
    if dof.written is not None and dof.written.kind == "axis":
        return [Field("axis", dof.written.numbers)]
    if str(dof.axis) == str(words.default_axis(dof.kind)):  # as texts, because -0 is equal to 0 and still another number
        return []
    short = _SHORT_AXES.get(str(dof.axis))
    return [Field("axis", Ref((short[0],), short[1]) if short else dof.axis)]
