"""<joint>: its two ends, dofs, limits and dynamics, <mimic> as a coupling, and what exporters write into fixed joints."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import notations
from hymeko_x.frontends.urdf.builder import read_origin, shortened, take_each_number, take_name, take_numbers
from hymeko_x.ir.mechanism import ROOT, WORLD, coupling_edge, joint_edge
from hymeko_x.ir.parts import UNLIMITED, Body, Calibration, Dof, DofKind, Joint, Limits, Safety
from hymeko_x.ir.values import Written, X, plane_axes, unit
from hymeko_x.xml.text import attributes_text
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.formats.urdf import UrdfJointType
    from hymeko_x.frontends.urdf.builder import UrdfBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.values import Vec3
    from hymeko_x.xml.tree import XmlNode

_SINGLE = ((DofKind.HINGE,), (DofKind.SLIDE,))
_BOUNDS = ("lower", "upper")
_RATES = ("velocity", "effort", "acceleration", "jerk")


def read_joints(root: XmlNode, builder: UrdfBuilder) -> None:
    """Add all joints; a joint without two ends stays outside of the tree, as it was written."""
    waiting = []
    for node in root.take_children("joint"):
        ends = _ends_of(node, builder)
        if ends is None:
            root.leave(node)
            continue
        joint = _read_joint(node, ends, builder)
        if node.has("mimic") or not joint.dofs:
            waiting.append(node)
        else:
            builder.close(node)
    for node in waiting:
        _read_mimic(node, builder)
    _note_meaningless(waiting, builder)
    for node in waiting:
        builder.close(node)


def _read_joint(node: XmlNode, ends: tuple[XmlNode, XmlNode], builder: UrdfBuilder) -> Joint:
    key = take_name(node, "joint", builder.joints, builder)
    parent, child = [_take_link(node, end, builder) for end in ends]
    word = _read_type(node, builder)
    pose = read_origin(node, key, builder)
    joint = Joint(_read_dofs(node, key, word, builder))
    if word != words.default_type(joint):
        builder.note(key, notations.TYPE, word)
    builder.edges[key] = joint_edge(joint, parent, child, pose)
    return joint


# ---- ends and type -----------------------------------------------------------------------------------------------------------


def _ends_of(joint: XmlNode, builder: UrdfBuilder) -> tuple[XmlNode, XmlNode] | None:
    """The elements that name the parent and the child of a joint; None, which is reported, where one is missing."""
    parent, child = joint.child("parent"), joint.child("child")
    if parent is not None and child is not None and "link" in parent.attributes and "link" in child.attributes:
        return parent, child
    ends = (("parent", parent), ("child", child))
    missing = " and no ".join([f"<{tag} link>" for tag, end in ends if end is None or "link" not in end.attributes])
    name = joint.attributes.get("name", "")
    message = f"joint '{name}' has no {missing}; it is kept as written and is not part of the tree"
    builder.report.error(codes.MISSING_PART, message, joint.origin, element=f"joint '{name}'")
    return None


def _take_link(joint: XmlNode, end: XmlNode, builder: UrdfBuilder) -> Id:
    """The link that an end of a joint names; one that is not defined is added, empty, so that the joint keeps its place."""
    end.taken = True
    name = end.take("link") or ""
    known = builder.links.get(name)
    if known is not None:
        return known
    message = f"{joint.subject}: <{end.tag} link> is '{name}', which is not defined; an empty link of this name was added"
    is_world = end.tag == "parent" and name == WORLD.name  # the usual way to fix a base, and what some readers define by themselves
    (builder.warn if is_world else builder.error)(codes.UNDEFINED_REFERENCE, joint, message)
    key = builder.links[name] = builder.names.take("body", name)
    builder.vertices[key] = Body()
    builder.origins[key] = joint.origin
    return key


def _read_type(node: XmlNode, builder: UrdfBuilder) -> str:
    word = node.attributes.get("type")
    if word is not None and word in words.JOINT_TYPES:
        node.take("type")
        return word
    known = ", ".join(words.JOINT_TYPES)
    message = "has no type" if word is None else f"has type '{word}', which is kept as written"
    code = codes.MISSING_ATTRIBUTE if word is None else codes.UNKNOWN_WORD
    builder.error(code, node, f"{node.subject} {message}; read as fixed; known: {known}")
    return "fixed"


# ---- dofs --------------------------------------------------------------------------------------------------------------------


def _read_dofs(node: XmlNode, key: Id, word: str, builder: UrdfBuilder) -> tuple[Dof, ...]:
    """The dofs of a joint. Elements without a meaning for its type (the axis of a fixed joint) become extras."""
    kinds = words.JOINT_TYPES[word].dofs
    if kinds in _SINGLE:
        return (_read_dof(node, key, kinds[0], words.JOINT_TYPES[word], builder),)
    if word == "planar":
        normal, written = _read_axis(node, key, builder)
        x, y = plane_axes(normal)
        return (Dof(DofKind.SLIDE, x), Dof(DofKind.SLIDE, y), Dof(DofKind.HINGE, normal, written=written))
    return tuple(Dof(kind) for kind in kinds)


def _read_dof(node: XmlNode, key: Id, kind: DofKind, known: UrdfJointType, builder: UrdfBuilder) -> Dof:
    axis, written = _read_axis(node, key, builder)
    limits = _read_limits(node, key, builder) if known.bounded else _read_open_limits(node, builder)
    damping, friction = _read_dynamics(node, key, builder)
    return Dof(
        kind,
        axis,
        limits,
        damping,
        friction,
        safety=_read_safety(node, key, builder),
        calibration=_read_calibration(node, builder),
        written=written,
    )


def _read_axis(joint: XmlNode, key: Id, builder: UrdfBuilder) -> tuple[Vec3, Written | None]:
    """The unit axis in the joint frame, and the numbers as written where they are others."""
    node = joint.take_child("axis")
    if node is None:
        builder.follow(key, notations.NO_AXIS, follows=True)
        return X, None
    text = node.attributes.get("xyz", "1 0 0")
    if _has_no_direction(text):
        message = (
            f"{joint.subject}: <axis xyz> is '{shortened(text)}', which has no direction; 1 0 0 is used, and the text is kept as written"
        )
        builder.error(codes.ZERO_AXIS, node, message)
        return X, None
    x, y, z = numbers = take_numbers(node, "xyz", 3, builder, instead="1 0 0 is used") or X
    axis = unit((x, y, z))
    if axis == (x, y, z):
        if axis == X:
            builder.follow(key, notations.NO_AXIS, follows=False)
        return axis, None
    message = f"{joint.subject}: the axis was normalised; its numbers are kept for writing URDF again"
    builder.report.note(codes.NOT_UNIT, message, node.origin, element=joint.element)
    return axis, Written("axis", numbers)


def _has_no_direction(text: str) -> bool:
    """Whether the numbers are zero, or so small or large that nothing can be divided by their length."""
    numbers = read_numbers(text)
    return bool(numbers) and not 1e-300 <= math.hypot(*(numbers or ())) < math.inf


def _read_dynamics(joint: XmlNode, key: Id, builder: UrdfBuilder) -> tuple[float, float]:
    node = joint.take_child("dynamics")
    if node is None:
        builder.follow(key, notations.DYNAMICS, follows=False)
        return 0.0, 0.0
    damping, friction = _usually(0.0, node, ("damping", "friction"), key, builder)
    if damping == friction == 0.0:
        builder.follow(key, notations.DYNAMICS, follows=True)
    return damping, friction


def _usually(default: float, node: XmlNode, names: Sequence[str], key: Id, builder: UrdfBuilder) -> list[float]:
    """The number of each of these attributes, its default value where it is missing or bad."""
    values = []
    for name, found in zip(names, take_each_number(node, names, builder, instead=f"{default:g} is used"), strict=True):
        value = default if found is None else found
        if value == default:
            builder.follow(key, notations.without(name), follows=found is None and name not in node.attributes)
        values.append(value)
    return values


# ---- limits ------------------------------------------------------------------------------------------------------------------


def _read_limits(joint: XmlNode, key: Id, builder: UrdfBuilder) -> Limits:
    """The limits of a joint for which URDF requires them. Without lower or upper they are 0, by the standard."""
    node = joint.take_child("limit")
    if node is None:
        message = (
            f"{joint.subject} has no <limit>; read as unlimited, and written with {words.NO_LIMIT_TEXT} (urdfdom refuses the file as it is)"
        )
        builder.warn(codes.MISSING_LIMIT, joint, message)
        return UNLIMITED
    missing = [name for name in ("effort", "velocity") if name not in node.attributes]
    without = [name for name in _BOUNDS if name not in node.attributes]
    lower, upper, *rates = _take_limits(node, _BOUNDS + _RATES, builder)
    bounds = {"lower": lower, "upper": upper} | dict.fromkeys(without, 0.0)
    for name, bound in bounds.items():
        if bound == 0.0:
            builder.follow(key, notations.without(name), follows=name in without)
    limits = Limits(*bounds.values(), *rates)
    _check_limits(joint, node, limits, missing, builder)
    return limits


def _read_open_limits(joint: XmlNode, builder: UrdfBuilder) -> Limits:
    """The effort and velocity of a continuous joint; its lower and upper mean nothing and become extras."""
    node = joint.take_child("limit")
    if node is None:
        return UNLIMITED
    limits = Limits(None, None, *_take_limits(node, _RATES, builder))
    if limits == UNLIMITED:
        joint.leave(node)
    return limits


def _take_limits(node: XmlNode, names: Sequence[str], builder: UrdfBuilder) -> list[float | None]:
    """The limits of these names; None for unlimited."""
    numbers = take_each_number(node, names, builder, instead="unlimited is used")
    return [None if number is None or words.is_no_limit(number) else number for number in numbers]


def _check_limits(joint: XmlNode, node: XmlNode, limits: Limits, missing: list[str], builder: UrdfBuilder) -> None:
    if missing:
        message = f"{joint.subject}: <limit> has no {' and no '.join(missing)}; read as unlimited (urdfdom refuses the file as it is)"
        builder.warn(codes.MISSING_LIMIT, node, message)
    if limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
        message = f"{joint.subject}: the lower limit is above the upper one; both are kept"
        builder.warn(codes.BAD_LIMIT, node, message)
    if (limits.effort or 0.0) < 0.0 or (limits.velocity or 0.0) < 0.0:
        message = f"{joint.subject}: the limit of effort or velocity is negative; it is kept"
        builder.warn(codes.BAD_LIMIT, node, message)


# ---- safety and calibration ------------------------------------------------------------------------------------------------------


def _read_safety(joint: XmlNode, key: Id, builder: UrdfBuilder) -> Safety | None:
    node = joint.take_child("safety_controller")
    if node is None:
        return None
    names = ("k_velocity", "k_position", "soft_lower_limit", "soft_upper_limit")
    if "k_velocity" not in node.attributes:
        message = f"{joint.subject}: <safety_controller> has no k_velocity; 0 is used"
        builder.warn(codes.MISSING_ATTRIBUTE, node, message)
    return Safety(*_usually(0.0, node, names, key, builder))


def _read_calibration(joint: XmlNode, builder: UrdfBuilder) -> Calibration | None:
    node = joint.take_child("calibration")
    if node is None:
        return None
    names = ("rising", "falling", "reference_position")
    found = Calibration(*take_each_number(node, names, builder, instead="nothing is used"))
    if found == Calibration():
        joint.leave(node)
        return None
    return found


# ---- mimic ---------------------------------------------------------------------------------------------------------------------


def _read_mimic(joint: XmlNode, builder: UrdfBuilder) -> None:
    """<mimic> as a coupling: q = offset + multiplier * q_leader. One that cannot work stays as it was written."""
    if not joint.has("mimic") or joint.owner is None:
        return
    node = joint.take_child("mimic")
    assert node is not None
    leader = builder.joints.get(node.attributes.get("joint", ""))
    problem = _mimic_problem(joint.owner, leader, node, builder)
    if problem or leader is None:
        builder.warn(codes.UNDEFINED_REFERENCE, node, f"{joint.subject} {problem}; the <mimic> is kept as written")
        joint.leave(node)
        return
    node.take("joint")
    (offset,) = _usually(0.0, node, ("offset",), joint.owner, builder)
    (multiplier,) = _usually(1.0, node, ("multiplier",), joint.owner, builder)
    key = builder.names.take("coupling", joint.owner.name)
    builder.edges[key] = coupling_edge(joint.owner, ((leader, (offset, multiplier)),))
    builder.origins[key] = node.origin


def _mimic_problem(follower: Id, leader: Id | None, node: XmlNode, builder: UrdfBuilder) -> str:
    """Why a joint cannot mimic another one, or nothing."""
    name = node.attributes.get("joint")
    if name is None:
        return "has a <mimic> without a joint"
    if leader is None:
        return f"mimics '{name}', which is not a joint of this robot"
    if leader == follower:
        return "mimics itself"
    if _is_fixed(follower, builder):
        return "is fixed and cannot mimic"
    return f"mimics '{name}', which is fixed" if _is_fixed(leader, builder) else ""


def _is_fixed(key: Id | None, builder: UrdfBuilder) -> bool:
    joint = builder.edges[key].data if key is not None else None
    return isinstance(joint, Joint) and not joint.dofs


# ---- fixed joints ------------------------------------------------------------------------------------------------------------


def _note_meaningless(joints: list[XmlNode], builder: UrdfBuilder) -> None:
    """Note the meaningless elements that all fixed joints have, and at least half of them and two alike; others stay extras."""
    fixed = [node for node in joints if _is_fixed(node.owner, builder)]
    unread = {child.tag for node in fixed for child in node.children if not child.taken}
    usual = tuple([(tag, text) for tag in words.MEANINGLESS_IF_FIXED if tag in unread and (text := _take_usual(fixed, tag))])
    if usual:
        builder.note(ROOT, notations.FIXED, usual)


def _take_usual(fixed: list[XmlNode], tag: str) -> str:
    """The most frequent text of this child, taken out of the joints that have it; empty where it is not frequent, or a joint has none."""
    found = [(child, f"<{tag}{attributes_text(child.attributes)}/>") for node in fixed if (child := _plain_child(node, tag))]
    votes = Counter(text for _, text in found)
    text, count = votes.most_common(1)[0] if votes else ("", 0)
    if count < 2 or 2 * count < len(fixed) or len(found) < len(fixed):
        return ""
    for child, own in found:
        if own == text:
            child.taken, child.attributes = True, {}
    return text


def _plain_child(node: XmlNode, tag: str) -> XmlNode | None:
    """The first such child, if it has nothing but attributes."""
    child = next((child for child in node.children if child.tag == tag and not child.taken), None)
    return None if child is None or child.children or child.text is not None else child
