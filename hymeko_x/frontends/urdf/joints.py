"""Joints: their two ends, dofs, limits and dynamics, and <mimic> as a coupling."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import urdf as words
from hymeko_x.frontends.urdf.draft import read_origin, shortened, take_name, take_number, take_numbers
from hymeko_x.frontends.urdf.fixed import gather_meaningless
from hymeko_x.ir.mechanism import coupling_edge, joint_edge
from hymeko_x.ir.parts import UNLIMITED, Body, Calibration, Dof, DofKind, Joint, Limits, Safety
from hymeko_x.ir.values import Written, X, plane_axes, unit
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from hymeko_x.formats.urdf import JointType
    from hymeko_x.frontends.urdf.draft import Draft
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.values import Vec3
    from hymeko_x.xml.tree import Node

_SINGLE = ((DofKind.HINGE,), (DofKind.SLIDE,))


def read_joints(root: Node, draft: Draft) -> None:
    """Add all joints; a joint without two ends stays outside of the tree, as it was written."""
    waiting = []
    for node in root.take_children("joint"):
        if not _has_ends(node, draft):
            root.leave(node)
            continue
        joint = _read_joint(node, draft)
        if node.has("mimic") or not joint.dofs:
            waiting.append(node)
        else:
            draft.close(node)
    for node in waiting:
        _read_mimic(node, draft)
    gather_meaningless(waiting, draft)
    for node in waiting:
        draft.close(node)


def _read_joint(node: Node, draft: Draft) -> Joint:
    key = take_name(node, "joint", draft.joints, draft)
    parent, child = _read_end(node, "parent", draft), _read_end(node, "child", draft)
    word = _read_type(node, draft)
    pose = read_origin(node, words.STYLE_JOINT_ORIGIN, draft)
    joint = Joint(_read_dofs(node, word, draft))
    if word != words.default_type(joint):
        draft.note(key, words.TYPE, word)
    draft.edges[key] = joint_edge(joint, parent, child, pose)
    return joint


# ---- ends and type -----------------------------------------------------------------------------------------------------------


def _has_ends(node: Node, draft: Draft) -> bool:
    missing = [f"<{tag} link>" for tag in ("parent", "child") if not _names_link(node, tag)]
    if missing:
        name = node.attributes.get("name", "")
        said = f"joint '{name}' has no {' and no '.join(missing)}; it is kept as written and is not part of the tree"
        draft.report.error(codes.MISSING_PART, said, node.origin, element=f"joint '{name}'")
    return not missing


def _names_link(joint: Node, tag: str) -> bool:
    for kid in joint.children:
        if kid.tag == tag:
            return "link" in kid.attributes
    return False


def _read_end(joint: Node, tag: str, draft: Draft) -> Id:
    """The link that a joint names; one that is not defined is added, empty, so that the joint keeps its place."""
    node = joint.take_child(tag)
    name = (node.take("link") if node is not None else None) or ""
    known = draft.links.get(name)
    if known is not None:
        return known
    said = f"{joint.subject}: <{tag} link> is '{name}', which is not defined; an empty link of this name was added"
    draft.report.error(codes.UNDEFINED_REFERENCE, said, joint.origin, element=joint.element)
    key = draft.links[name] = draft.names.take("body", name)
    draft.vertices[key] = Body()
    draft.origins[key] = joint.origin
    return key


def _read_type(node: Node, draft: Draft) -> str:
    word = node.attributes.get("type")
    if word is not None and word in words.JOINT_TYPES:
        node.take("type")
        return word
    known = ", ".join(words.JOINT_TYPES)
    said = "has no type" if word is None else f"has type '{word}', which is kept as written"
    draft.report.error(
        codes.MISSING_ATTRIBUTE if word is None else codes.UNKNOWN_WORD,
        f"{node.subject} {said}; read as fixed; known: {known}",
        node.origin,
        element=node.element,
    )
    return "fixed"


# ---- dofs --------------------------------------------------------------------------------------------------------------------


def _read_dofs(node: Node, word: str, draft: Draft) -> tuple[Dof, ...]:
    """The dofs of a joint. What means nothing for its type (the axis of a fixed joint) is left to become an extra."""
    kinds = words.JOINT_TYPES[word].dofs
    if kinds in _SINGLE:
        return (_read_dof(node, kinds[0], words.JOINT_TYPES[word], draft),)
    if word == "planar":
        normal, written = _read_axis(node, draft)
        x, y = plane_axes(normal)
        return (Dof(DofKind.SLIDE, x), Dof(DofKind.SLIDE, y), Dof(DofKind.HINGE, normal, written=written))
    return tuple(Dof(kind) for kind in kinds)


def _read_dof(node: Node, kind: DofKind, known: JointType, draft: Draft) -> Dof:
    axis, written = _read_axis(node, draft)
    limits = _read_limits(node, draft) if known.bounded else _read_open_limits(node, draft)
    damping, friction = _read_dynamics(node, draft)
    return Dof(
        kind,
        axis,
        limits,
        damping,
        friction,
        safety=_read_safety(node, draft),
        calibration=_read_calibration(node, draft),
        written=written,
    )


def _read_axis(joint: Node, draft: Draft) -> tuple[Vec3, Written | None]:
    """The unit axis in the joint frame, and the numbers as written where they are others."""
    node = joint.take_child("axis")
    if node is None:
        return X, None
    text = node.attributes.get("xyz", "1 0 0")
    if _has_no_direction(text):
        said = f"{joint.subject}: <axis xyz> is '{shortened(text)}', which has no direction; 1 0 0 is used, and the text is kept as written"
        draft.report.error(codes.ZERO_AXIS, said, node.origin, element=joint.element)
        return X, None
    x, y, z = numbers = take_numbers(node, "xyz", 3, draft.report, instead="1 0 0 is used") or X
    axis = unit((x, y, z))
    if axis == (x, y, z):
        return axis, None
    said = f"{joint.subject}: the axis was normalised; its numbers are kept for writing URDF again"
    draft.report.note(codes.NOT_UNIT, said, node.origin, element=joint.element)
    return axis, Written("axis", numbers)


def _has_no_direction(text: str) -> bool:
    """Whether the numbers are zero, or so small or large that nothing can be divided by their length."""
    numbers = read_numbers(text)
    return bool(numbers) and not 1e-300 <= math.hypot(*(numbers or ())) < math.inf


def _read_dynamics(joint: Node, draft: Draft) -> tuple[float, float]:
    node = joint.take_child("dynamics")
    if node is None:
        return 0.0, 0.0
    damping, friction = (_or_zero(node, name, draft) for name in ("damping", "friction"))
    if damping == friction == 0.0:
        draft.style.add(words.STYLE_DYNAMICS)
    return damping, friction


def _or_zero(node: Node, name: str, draft: Draft) -> float:
    value = take_number(node, name, draft.report, instead="0 is used")
    return 0.0 if value is None else value


# ---- limits ------------------------------------------------------------------------------------------------------------------


def _read_limits(joint: Node, draft: Draft) -> Limits:
    """The limits of a joint that URDF wants to have some. Without lower or upper they are 0, as the standard says."""
    node = joint.take_child("limit")
    if node is None:
        said = (
            f"{joint.subject} has no <limit>; read as unlimited, and written with the largest numbers (urdfdom refuses the file as it is)"
        )
        draft.report.warn(codes.MISSING_LIMIT, said, joint.origin, element=joint.element)
        return UNLIMITED
    missing = [name for name in ("effort", "velocity") if name not in node.attributes]
    limits = _rates(node, _bound(node, "lower", draft), _bound(node, "upper", draft), draft)
    _check_limits(joint, node, limits, missing, draft)
    return limits


def _read_open_limits(joint: Node, draft: Draft) -> Limits:
    """The effort and velocity of a continuous joint; its lower and upper mean nothing and become extras."""
    node = joint.take_child("limit")
    if node is None:
        return UNLIMITED
    limits = _rates(node, None, None, draft)
    if limits == UNLIMITED:
        joint.leave(node)
    return limits


def _bound(node: Node, name: str, draft: Draft) -> float | None:
    if name not in node.attributes:
        return 0.0
    return _limited(take_number(node, name, draft.report, instead="unlimited is used"))


def _rates(node: Node, lower: float | None, upper: float | None, draft: Draft) -> Limits:
    return Limits(
        lower,
        upper,
        _rate(node, "velocity", draft),
        _rate(node, "effort", draft),
        _rate(node, "acceleration", draft),
        _rate(node, "jerk", draft),
    )


def _rate(node: Node, name: str, draft: Draft) -> float | None:
    return _limited(take_number(node, name, draft.report, instead="unlimited is used"))


def _limited(value: float | None) -> float | None:
    return None if value is None or abs(value) >= words.NO_LIMIT else value


def _check_limits(joint: Node, node: Node, limits: Limits, missing: list[str], draft: Draft) -> None:
    if missing:
        said = f"{joint.subject}: <limit> has no {' and no '.join(missing)}; read as unlimited (urdfdom refuses the file as it is)"
        draft.report.warn(codes.MISSING_LIMIT, said, node.origin, element=joint.element)
    if limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
        said = f"{joint.subject}: the lower limit is above the upper one; both are kept"
        draft.report.warn(codes.BAD_LIMIT, said, node.origin, element=joint.element)
    if (limits.effort or 0.0) < 0.0 or (limits.velocity or 0.0) < 0.0:
        said = f"{joint.subject}: the limit of effort or velocity is negative; it is kept"
        draft.report.warn(codes.BAD_LIMIT, said, node.origin, element=joint.element)


# ---- safety and calibration ------------------------------------------------------------------------------------------------------


def _read_safety(joint: Node, draft: Draft) -> Safety | None:
    node = joint.take_child("safety_controller")
    if node is None:
        return None
    names = ("k_velocity", "k_position", "soft_lower_limit", "soft_upper_limit")
    if "k_velocity" not in node.attributes:
        said = f"{joint.subject}: <safety_controller> has no k_velocity; 0 is used"
        draft.report.warn(codes.MISSING_ATTRIBUTE, said, node.origin, element=joint.element)
    return Safety(*(_or_zero(node, name, draft) for name in names))


def _read_calibration(joint: Node, draft: Draft) -> Calibration | None:
    node = joint.take_child("calibration")
    if node is None:
        return None
    names = ("rising", "falling", "reference_position")
    found = Calibration(*(take_number(node, name, draft.report, instead="nothing is used") for name in names))
    if found == Calibration():
        joint.leave(node)
        return None
    return found


# ---- mimic ---------------------------------------------------------------------------------------------------------------------


def _read_mimic(joint: Node, draft: Draft) -> None:
    """<mimic> as a coupling: q = offset + multiplier * q_leader. One that cannot work stays as it was written."""
    if not joint.has("mimic") or joint.owner is None:
        return
    node = joint.take_child("mimic")
    assert node is not None
    leader = draft.joints.get(node.attributes.get("joint", ""))
    problem = _mimic_problem(joint.owner, leader, node, draft)
    if problem or leader is None:
        draft.report.warn(
            codes.UNDEFINED_REFERENCE, f"{joint.subject} {problem}; the <mimic> is kept as written", node.origin, element=joint.element
        )
        joint.leave(node)
        return
    node.take("joint")
    multiplier = take_number(node, "multiplier", draft.report, instead="1 is used")
    coefficients = (_or_zero(node, "offset", draft), 1.0 if multiplier is None else multiplier)
    key = draft.names.take("coupling", joint.owner.name)
    draft.edges[key] = coupling_edge(joint.owner, ((leader, coefficients),))
    draft.origins[key] = node.origin


def _mimic_problem(follower: Id, leader: Id | None, node: Node, draft: Draft) -> str:
    """Why a joint cannot mimic another one, or nothing."""
    name = node.attributes.get("joint")
    if name is None:
        return "has a <mimic> without a joint"
    if leader is None:
        return f"mimics '{name}', which is not a joint of this robot"
    if leader == follower:
        return "mimics itself"
    for key, said in ((follower, "is fixed and cannot mimic"), (leader, f"mimics '{name}', which is fixed")):
        joint = draft.edges[key].data
        if isinstance(joint, Joint) and not joint.dofs:
            return said
    return ""
