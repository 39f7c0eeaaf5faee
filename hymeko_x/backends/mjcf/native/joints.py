"""<joint> and <freejoint>."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.backends.mjcf.native.spot import Op, Spot
from hymeko_x.formats.mjcf.joints import ANCHOR, AXIS, JOINT
from hymeko_x.ir.parts import DofKind
from hymeko_x.ir.values import IDENTITY, Written, apply, inverse, rotate

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.formats.mjcf.codec import Group, Settings
    from hymeko_x.ir.mechanism import JointView
    from hymeko_x.ir.parts import Dof
    from hymeko_x.ir.values import Pose, Vec3


def joint_ops(sheet: Sheet, spot: Spot, view: JointView) -> list[Op]:
    """The dofs of the joint above a body."""
    several = len(view.joint.dofs) > 1
    return [_dof_op(sheet, spot, view, dof, str(number) if several else "") for number, dof in enumerate(view.joint.dofs, 1)]


def _dof_op(sheet: Sheet, spot: Spot, view: JointView, dof: Dof, prefix: str) -> Op:
    key = view.id
    notes = sheet.notes(key)
    path = f"joint[{prefix}]" if prefix else ""
    said = sheet.said(key, path)
    around = spot.around(notes.get(f"{prefix}frame"))
    name = dof.name if prefix else dof.name or sheet.name(key)
    inside = tuple(sheet.inside(key, path))
    if dof.kind is DofKind.FREE and notes.get(f"{prefix}tag") != "joint" and _is_bare(dof):
        return Op("leaf", "freejoint", {"name": name, **said}, inside, around)
    own_class = _class_of(sheet, view, prefix)
    base = sheet.base("joint", own_class, spot.childclass_in(around))
    frame = around.pose if around is not None else IDENTITY
    groups, values = _values(view, dof, frame)
    found = sheet.attributes(values, groups, base, notes, said, prefix)
    attributes: Attributes = {"name": name, "class": own_class, **found, **said}
    return Op("leaf", "joint", attributes, inside, around)


def _class_of(sheet: Sheet, view: JointView, prefix: str) -> str | None:
    found = sheet.mechanism.stereotypes.get(view.id, ())
    number = int(prefix) - 1 if prefix else 0
    name = found[number] if number < len(found) else ""
    return name if name and sheet.classes.has(name) else None


def _is_bare(dof: Dof) -> bool:
    return not (dof.damping or dof.friction or dof.stiffness or dof.armature)


def _values(view: JointView, dof: Dof, frame: Pose) -> tuple[tuple[Group, ...], dict[str, object]]:
    """The dof as it is seen from the body at the reference configuration."""
    axis, anchor, written = dof.axis, dof.anchor, dof.written
    if view.child_pose != IDENTITY:
        axis, anchor, written = rotate(view.child_pose.quat, axis), apply(view.child_pose, anchor), None
    limits = dof.limits
    span = None if limits.upper is None else (limits.lower or 0.0, limits.upper)
    effort = None if limits.effort is None else (-limits.effort, limits.effort)
    values: dict[str, object] = {
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
    if frame == IDENTITY:
        return JOINT, values
    return tuple(_seen_from(group, frame) for group in JOINT), values


def _seen_from(group: Group, frame: Pose) -> Group:
    """The axis and the anchor of a dof that stands in a <frame>, seen from the body."""
    back = inverse(frame)
    if group is AXIS:

        def read_axis(said: Mapping[str, str], settings: Settings) -> tuple[Vec3, Written | None]:
            return rotate(frame.quat, AXIS.read(said, settings)[0]), None

        def write_axis(value: tuple[Vec3, Written | None], settings: Settings) -> dict[str, str]:
            return AXIS.write((rotate(back.quat, value[0]), None), settings)

        return replace(group, read=read_axis, write=write_axis)
    if group is ANCHOR:

        def read_anchor(said: Mapping[str, str], settings: Settings) -> Vec3:
            return apply(frame, ANCHOR.read(said, settings))

        def write_anchor(value: Vec3, settings: Settings) -> dict[str, str]:
            return ANCHOR.write(apply(back, value), settings)

        return replace(group, read=read_anchor, write=write_anchor)
    return group
