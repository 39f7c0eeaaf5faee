"""<joint>: its type, two ends, axes with limits and dynamics, and <mimic> as a coupling."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.gearboxes import GEARBOX
from hymeko_x.formats.sdf.values import DYNAMICS, LIMITS, NUMBER, OLD_PITCH, PITCH, STRENGTH_LIMITS, VECTOR, BadText
from hymeko_x.frontends.sdf.models import body_of
from hymeko_x.frontends.sdf.sensors import read_joint_sensor
from hymeko_x.ir.decimals import clean_vector
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD, joint_edge
from hymeko_x.ir.parts import Coupling, Dof, DofKind, Joint, Limits, World
from hymeko_x.ir.values import NO_ROTATION, Written, Z, rotate, unit

if TYPE_CHECKING:
    from hymeko_x.frontends.sdf.builder import SdfBuilder, SdfModel
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.ir.values import Vec3
    from hymeko_x.xml.tree import XmlNode

_OLD_DEFAULT = 7
"""The version from which on an axis is given in the joint's frame and names another one in ``expressed_in``."""


def read_joint(node: XmlNode, model: SdfModel, builder: SdfBuilder) -> None:
    """Add a joint; one without two ends or of an unknown type stays as it was written, and a gearbox waits for the other joints."""
    key = node.owner
    assert key is not None
    kind = node.attributes.get("type", "")
    if kind == GEARBOX:
        builder.gearboxes.append((node, model))
        return
    ends = _read_ends(node, model, builder)
    if kind not in words.JOINT_TYPES or ends is None:
        if kind not in words.JOINT_TYPES:
            known = ", ".join(words.JOINT_TYPES)
            builder.warn(codes.UNKNOWN_WORD, node, f"{node.subject} has type '{kind}', known are {known}; it is kept as written")
        keep_as_written(node, key, model, builder)
        return
    parent, child = ends
    node.take("type")
    dofs = _read_dofs(node, kind, key, model, builder)
    frames = builder.frames
    if parent == WORLD:
        builder.vertices.setdefault(WORLD, World())
    builder.edges[key] = joint_edge(Joint(dofs), parent, child, frames.relative(key, parent), frames.relative(key, child))
    if kind != words.default_type(Joint(dofs)):
        builder.note(key, notations.TYPE, kind)
    _read_couplings(node, key, model, builder)
    for sensor in node.take_children("sensor"):
        read_joint_sensor(sensor, key, model, builder)


def keep_as_written(node: XmlNode, key: Id, model: SdfModel, builder: SdfBuilder) -> None:
    """Give up the id, so that the whole element is unread."""
    node.owner = None
    node.attributes = {"name": words.split_scope(key.name)[1], **node.attributes}
    model.node.leave(node)
    for member in node.walk():
        member.taken = False
    builder.left.add(key)
    builder.notations.pop(key, None)
    builder.written.pop(key, None)
    if builder.joints.get(key.name) == key:
        del builder.joints[key.name]


# ---- ends ------------------------------------------------------------------------------------------------------------------------


def _read_ends(node: XmlNode, model: SdfModel, builder: SdfBuilder) -> tuple[Id, Id] | None:
    """The bodies that the joint joins; frames stand for the bodies that they are on."""
    names, bodies = [], []
    for tag in ("parent", "child"):
        child = node.child(tag)
        name = "" if child is None else (child.text or "").strip()
        found = builder.find(model.scope, name) if name else None
        body = None if found is None else body_of(found, builder)
        if body is None or (tag == "child" and body == WORLD):
            problem = f"names '{name}' as its {tag}, which is no link" if name else f"has no <{tag}>"
            builder.error(codes.UNDEFINED_REFERENCE, node, f"{node.subject} {problem}; it is kept as written, outside of the tree")
            return None
        names.append(name)
        bodies.append(body)
        if body != found:
            names[-1] += "*"
    parent, child_body = bodies
    if parent == child_body:
        builder.error(codes.CYCLE, node, f"{node.subject} joins link '{parent.name}' to itself; it is kept as written, outside of the tree")
        return None
    for tag in ("parent", "child"):
        end = node.take_child(tag)
        assert end is not None
        end.text = None
    if any(name.endswith("*") for name in names):
        assert node.owner is not None
        builder.note(node.owner, notations.ENDS, " ".join(name if name.endswith("*") else "-" for name in names))
    return parent, child_body


# ---- dofs ------------------------------------------------------------------------------------------------------------------------


def _read_dofs(node: XmlNode, kind: str, key: Id, model: SdfModel, builder: SdfBuilder) -> tuple[Dof, ...]:
    found = words.JOINT_TYPES[kind]
    return tuple([_read_dof(node, dof, tag, kind, key, model, builder) for dof, tag in zip(found.dofs, words.AXES, strict=False)])


def _read_dof(node: XmlNode, kind: DofKind, tag: str, word: str, key: Id, model: SdfModel, builder: SdfBuilder) -> Dof:
    axis = node.take_child(tag)
    if kind is DofKind.BALL:
        dynamics = {} if axis is None else builder.values(axis, "dynamics", DYNAMICS[:1], key, f"{tag}/")
        return Dof(kind, **dynamics)
    pitch = _read_pitch(node, key, builder) if kind is DofKind.SCREW else 0.0
    if axis is None:
        builder.error(codes.MISSING_PART, node, f"{node.subject} has no <{tag}>; 0 0 1 is used")
        return Dof(kind, Z, pitch=pitch)
    fields = LIMITS if words.JOINT_TYPES[word].bounded else STRENGTH_LIMITS
    limits = Limits(**builder.values(axis, "limit", fields, key, f"{tag}/"))
    direction, written = read_axis(axis, tag, key, model, builder)
    dynamics = builder.values(axis, "dynamics", DYNAMICS, key, f"{tag}/")
    return Dof(kind, direction, limits=limits, **dynamics, pitch=pitch, written=written)


def _read_pitch(node: XmlNode, key: Id, builder: SdfBuilder) -> float:
    """The pitch of a screw in m per rad: ``screw_thread_pitch``, or ``thread_pitch`` of old files, which is the inverse, left-handed."""
    new = builder.child_value(node, "screw_thread_pitch", PITCH, None, key, "screw_thread_pitch")
    if new is not None:
        return float(new)
    old = builder.child_value(node, "thread_pitch", OLD_PITCH, None, key, "thread_pitch")
    if old is not None:
        builder.written.setdefault(key, {}).setdefault("thread_pitch", OLD_PITCH.write(old))
        return float(old)
    return float(OLD_PITCH.read("1"))  # libsdformat's default


def read_axis(axis: XmlNode, tag: str, key: Id, model: SdfModel, builder: SdfBuilder) -> tuple[Vec3, Written | None]:
    """The unit axis in the joint's frame, and the numbers as written where they have another length."""
    xyz = axis.take_child("xyz")
    if xyz is None:
        builder.error(codes.MISSING_PART, axis, f"{axis.subject}: <{tag}> has no <xyz>; 0 0 1 is used")
        return Z, None
    text = " ".join((xyz.text or "").split())
    try:
        numbers = VECTOR.read(text)
        direction = unit(numbers)
    except (BadText, ZeroDivisionError):
        axis.leave(xyz)
        message = f"{axis.subject}: <xyz> is '{text[:60]}', expected a direction of 3 numbers; 0 0 1 is used, and the text is kept"
        builder.error(codes.ZERO_AXIS, axis, message)
        return Z, None
    xyz.text = None
    frame = _frame_of_axis(xyz, axis, tag, key, model, builder)
    if frame is not None:
        builder.written.setdefault(key, {})[f"{tag}/xyz"] = text
        turn = builder.frames.relative(frame, key).quat
        return direction if turn == NO_ROTATION else clean_vector(unit(rotate(turn, direction))), None
    return direction, None if direction == numbers else Written("axis", numbers)


def _frame_of_axis(xyz: XmlNode, axis: XmlNode, tag: str, key: Id, model: SdfModel, builder: SdfBuilder) -> Id | None:
    """The frame in which an axis is given, if not that of the joint: named, or the model's in old files."""
    name = xyz.take("expressed_in")
    if name:
        found = builder.find(model.scope, name)
        if found is None:
            message = f"{axis.subject}: the axis is expressed in '{name}', which is not defined; the joint's frame is used"
            builder.error(codes.UNDEFINED_REFERENCE, axis, message)
            return None
        builder.written.setdefault(key, {})[f"{tag}/xyz/@expressed_in"] = name
        return found
    if name is not None:
        builder.written.setdefault(key, {})[f"{tag}/xyz/@expressed_in"] = name
    if builder.version_of(axis) >= _OLD_DEFAULT:
        return None
    flag = axis.take_child("use_parent_model_frame")
    text = None if flag is None else flag.take_text()
    if text is not None:
        builder.written.setdefault(key, {})[f"{tag}/use_parent_model_frame"] = text
    uses_model = builder.version_of(axis) < 5 if text is None else text.lower() in ("true", "1")
    return model.frame if uses_model else None


# ---- mimic -----------------------------------------------------------------------------------------------------------------------


def _read_couplings(node: XmlNode, key: Id, model: SdfModel, builder: SdfBuilder) -> None:
    for number, tag in enumerate(words.AXES):
        axis = node.child(tag)
        mimic = None if axis is None else axis.take_child("mimic")
        if axis is None or mimic is None:
            continue
        leader = builder.joints.get(words.scoped(model.scope, mimic.attributes.get("joint", "")))
        if leader is None:
            message = f"{node.subject} mimics joint '{mimic.attributes.get('joint', '')}', which is not defined; this is kept as written"
            builder.error(codes.UNDEFINED_REFERENCE, mimic, message)
            axis.leave(mimic)
            continue
        if mimic.attributes.get("axis") == words.AXES[1] and not _has_two_axes(leader, model):
            builder.error(
                codes.UNDEFINED_REFERENCE,
                mimic,
                f"{node.subject} mimics the second axis of {leader}, which has one; this is kept as written",
            )
            axis.leave(mimic)
            continue
        _read_mimic(mimic, key, leader, number, builder)


def _has_two_axes(joint: Id, model: SdfModel) -> bool:
    kinds = [child.attributes.get("type", "") for child in model.node.children if child.owner == joint]
    return not kinds or len(words.JOINT_TYPES.get(kinds[0], words.JOINT_TYPES["fixed"]).dofs) > 1


def _read_mimic(mimic: XmlNode, follower: Id, leader: Id, number: int, builder: SdfBuilder) -> None:
    """follower = multiplier * (leader - reference) + offset."""
    mimic.take("joint")
    axis = mimic.take("axis")
    role = "1" if axis == "axis2" else ""
    key = builder.names.take("coupling", follower.name)
    if axis is not None and not role:
        builder.written.setdefault(key, {})["@axis"] = axis
    present = {child.tag for child in mimic.children}
    values = {
        tag: builder.child_value(mimic, tag, NUMBER, default, key, tag)
        for tag, default in (("multiplier", 1.0), ("offset", 0.0), ("reference", 0.0))
    }
    constant = values["offset"] - values["multiplier"] * values["reference"]
    texts = builder.written.setdefault(key, {})
    for tag in (tag for tag in values if values["reference"] and tag in present):
        texts.setdefault(tag, NUMBER.write(values[tag]))
    if "multiplier" not in present:
        texts["multiplier"] = ""
    leads: RobotArc = Arc(leader, -1, (constant + 0.0, values["multiplier"]), role)
    builder.edges[key] = Edge(Coupling(), (Arc(follower, 1, (1.0,), "1" if number else ""), leads))
    builder.origins[key] = mimic.origin
