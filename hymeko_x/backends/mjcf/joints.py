"""<joint> and <freejoint>."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf.joints import ANCHOR, AXIS, JOINT
from hymeko_x.formats.mjcf.notations import is_joint
from hymeko_x.ir.decimals import clean_vector
from hymeko_x.ir.parts import DofKind
from hymeko_x.ir.values import IDENTITY, ZERO, Written, Z, apply, inverse, rotate, unit

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.frames import BodyTag
    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.formats.mjcf.codec import AttributeGroup, Settings
    from hymeko_x.ir.mechanism import JointView
    from hymeko_x.ir.parts import Dof
    from hymeko_x.ir.values import Pose, Vec3

_NO_AXIS = (DofKind.BALL, DofKind.FREE)


def write_dof(sheet: MjcfSheet, body: BodyTag, view: JointView, number: int) -> None:
    """One dof of the joint that leads to a body, as an element of the body's tag."""
    key, dof = view.id, view.joint.dofs[number]
    prefix = str(number + 1) if len(view.joint.dofs) > 1 else ""
    path = f"joint[{prefix}]" if prefix else ""
    notations, kept = sheet.notations(key), sheet.kept_attributes(key, path)
    frame = body.frame_of(sheet, key, prefix)
    name = dof.name if prefix else dof.name or sheet.name(key)
    inside = sheet.inside(key, path)
    if dof.kind is DofKind.FREE and sheet.note(key, is_joint(prefix)) != "joint" and _is_bare(dof):
        body.add(tag_of("freejoint", {"name": name, **kept}, inside), frame)
        return
    own_class = sheet.own_class(key, number)
    base = sheet.base("joint", own_class, body.childclass if frame is None else frame.childclass)
    groups = JOINT if frame is None or frame.pose == IDENTITY else tuple([_seen_from(group, frame.pose) for group in JOINT])
    found = sheet.attributes(_values(sheet, view, dof), groups, base, notations, kept, prefix)
    owner = key if not dof.name else key._replace(name=dof.name)
    body.add(tag_of("joint", {"name": name, "class": own_class, **found, **kept}, inside, owner), frame)


def _is_bare(dof: Dof) -> bool:
    return not (dof.damping or dof.friction or dof.stiffness or dof.armature)


def _values(sheet: MjcfSheet, view: JointView, dof: Dof) -> dict[str, object]:
    """The dof as it is seen from the body at the reference configuration."""
    axis, anchor, written = dof.axis, dof.anchor, dof.written
    if view.child_pose != IDENTITY:
        axis = clean_vector(rotate(view.child_pose.quat, axis))
        anchor, written = clean_vector(apply(view.child_pose, anchor)), None
    if not sheet.from_mjcf:
        axis, anchor, written = _explicit(dof.kind, axis, anchor)
    limits = dof.limits
    span = None if limits.upper is None else (limits.lower or 0.0, limits.upper)
    effort = None if limits.effort is None else (-limits.effort, limits.effort)
    return {
        "type": dof.kind,
        "axis": (axis, written),
        "pos": anchor,
        "range": (span, dof.kind),
        "ref": (dof.ref, dof.kind),
        "springref": (dof.spring_ref, dof.kind),
        "stiffness": dof.stiffness,
        "damping": dof.damping,
        "frictionloss": dof.friction,
        "armature": dof.armature,
        "actuatorfrcrange": (effort, DofKind.SLIDE),
    }


def _explicit(kind: DofKind, axis: Vec3, anchor: Vec3) -> tuple[Vec3, Vec3, Written | None]:
    """An axis that is written also where it is the default, so that joints can share it; a slide needs no anchor."""
    if kind in _NO_AXIS:
        return Z, anchor if kind is DofKind.BALL else ZERO, None
    axis = unit(axis)
    return axis, ZERO if kind is DofKind.SLIDE else anchor, Written("axis", axis)


def _seen_from(group: AttributeGroup, frame: Pose) -> AttributeGroup:
    """The axis and the anchor of a dof that stands in a <frame>, seen from the body."""
    back = inverse(frame)
    if group is AXIS:

        def read_axis(attributes: Mapping[str, str], settings: Settings) -> tuple[Vec3, Written | None]:
            return rotate(frame.quat, AXIS.read(attributes, settings)[0]), None

        def write_axis(value: tuple[Vec3, Written | None], settings: Settings) -> dict[str, str]:
            return AXIS.write((rotate(back.quat, value[0]), None), settings)

        return replace(group, read=read_axis, write=write_axis)
    if group is ANCHOR:

        def read_anchor(attributes: Mapping[str, str], settings: Settings) -> Vec3:
            return apply(frame, ANCHOR.read(attributes, settings))

        def write_anchor(value: Vec3, settings: Settings) -> dict[str, str]:
            return ANCHOR.write(apply(back, value), settings)

        return replace(group, read=read_anchor, write=write_anchor)
    return group
