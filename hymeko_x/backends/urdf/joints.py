"""<joint>: its type, ends, axis, limits and dynamics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import notations
from hymeko_x.ir.digits import number_text, number_texts, numbers_text
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import DofKind, Joint
from hymeko_x.ir.values import IDENTITY, X, plane_axes, unit
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from hymeko_x.backends.urdf.sheet import UrdfSheet
    from hymeko_x.ir.mechanism import Id, JointView
    from hymeko_x.ir.parts import Calibration, Dof, Limits, Safety


def joint_tag(key: Id, sheet: UrdfSheet) -> Tag:
    """The <joint> of a joint.

    Raises: Refusal with HX104 when URDF cannot represent the joint.
    """
    view = sheet.mechanism.joints[key]
    word = _type(view, sheet)
    tag = Tag("joint", {"name": key.name, "type": word})
    sheet.add_origin(tag, key, view.parent_pose)
    tag.add("parent", link=view.parent.name)
    tag.add("child", link=view.child.name)
    if view.joint.dofs:
        _add_dofs(tag, key, view.joint.dofs, word, sheet)
    else:
        tag.children += [text for name, text in sheet.usual_if_fixed if not sheet.has_own(key, name)]
    _add_mimic(tag, key, sheet)
    return tag


def _type(view: JointView, sheet: UrdfSheet) -> str:
    """The word for the joint: its author's if it still fits, else the usual one."""
    usual = words.default_type(view.joint)
    own = sheet.mechanism.notation(view.id, notations.TYPE)
    word = own if own is not None and _fits(own, view.joint, usual) else usual
    if word is None or view.child_pose != IDENTITY or not _is_standard(view.joint):
        message = f"{view.id} has dofs or a frame that URDF cannot represent"
        raise refuse(codes.NOT_REPRESENTED, message, sheet.mechanism.origin(view.id), element=str(view.id))
    return word


def _fits(word: str, joint: Joint, usual: str | None) -> bool:
    known = words.JOINT_TYPES.get(word)
    if known is None or known.dofs != tuple(dof.kind for dof in joint.dofs):
        return False
    return known.bounded or usual is None or not words.JOINT_TYPES[usual].bounded


def _is_standard(joint: Joint) -> bool:
    """Whether a joint with several dofs moves as URDF's planar joint does, and no axis passes beside the origin."""
    if any(any(dof.anchor) or dof.ref for dof in joint.dofs):
        return False
    return len(joint.dofs) < 3 or tuple(dof.axis for dof in joint.dofs[:2]) == plane_axes(joint.dofs[2].axis)


def _add_dofs(tag: Tag, key: Id, dofs: tuple[Dof, ...], word: str, sheet: UrdfSheet) -> None:
    dof = dofs[-1]
    if dof.kind in (DofKind.HINGE, DofKind.SLIDE) and not (_written_axis(dof) == X and sheet.has_habit(key, notations.NO_AXIS)):
        tag.add("axis", xyz=numbers_text(_written_axis(dof)))
    if len(dofs) > 1:
        return
    if dof.calibration is not None:
        _add_calibration(tag, dof.calibration)
    if dof.kind in (DofKind.HINGE, DofKind.SLIDE) and (dof.damping or dof.friction or sheet.has_habit(key, notations.DYNAMICS)):
        tag.add("dynamics", **_unusual(key, {"damping": (dof.damping, 0.0), "friction": (dof.friction, 0.0)}, sheet))
    _add_limits(tag, key, dof.limits, sheet, bounded=words.JOINT_TYPES[word].bounded)
    if dof.safety is not None:
        _add_safety(tag, key, dof.safety, sheet)


def _unusual(key: Id, numbers: dict[str, tuple[float, float]], sheet: UrdfSheet) -> dict[str, str]:
    """Attributes with these numbers, without those that have their default value and were left out."""
    return {
        name: number_text(value)
        for name, (value, default) in numbers.items()
        if value != default or not sheet.has_habit(key, notations.without(name))
    }


def _written_axis(dof: Dof) -> tuple[float, ...]:
    """The axis as its author wrote it, if that still is the same direction."""
    if dof.written is None or dof.written.kind != "axis":
        return dof.axis
    x, y, z = dof.written.numbers
    return dof.written.numbers if unit((x, y, z)) == dof.axis else dof.axis


def _add_limits(tag: Tag, key: Id, limits: Limits, sheet: UrdfSheet, *, bounded: bool) -> None:
    """<limit>, with a number that is none where URDF requires one (:data:`hymeko_x.formats.urdf.NO_LIMIT`)."""
    none: dict[str, str] = {"lower": f"-{words.NO_LIMIT_TEXT}", "upper": words.NO_LIMIT_TEXT} if bounded else {}
    if bounded or limits.effort is not None or limits.velocity is not None:
        none |= {"effort": words.NO_LIMIT_TEXT, "velocity": words.NO_LIMIT_TEXT}
    values = {name: getattr(limits, name) for name in words.LIMITS if bounded or name not in ("lower", "upper")}
    given = number_texts({name: value for name, value in values.items() if value is not None})
    attributes = {name: given.get(name, none.get(name)) for name in words.LIMITS}
    left_out = {name for name in ("lower", "upper") if values.get(name) == 0.0 and sheet.has_habit(key, notations.without(name))}
    if given or none:
        tag.add("limit", **{name: text for name, text in attributes.items() if text is not None and name not in left_out})


def _add_safety(tag: Tag, key: Id, safety: Safety, sheet: UrdfSheet) -> None:
    numbers = {
        "soft_lower_limit": (safety.soft_lower, 0.0),
        "soft_upper_limit": (safety.soft_upper, 0.0),
        "k_position": (safety.k_position, 0.0),
        "k_velocity": (safety.k_velocity, 0.0),
    }
    tag.add("safety_controller", **_unusual(key, numbers, sheet))


def _add_calibration(tag: Tag, calibration: Calibration) -> None:
    values = {"rising": calibration.rising, "falling": calibration.falling, "reference_position": calibration.reference}
    tag.add("calibration", **number_texts({name: value for name, value in values.items() if value is not None}))


def _add_mimic(tag: Tag, key: Id, sheet: UrdfSheet) -> None:
    leader = sheet.leaders.get(key)
    if leader is None:
        return
    offset, multiplier = (*numbers_weight(leader), 0.0, 0.0)[:2]
    tag.add("mimic", joint=leader.target.name, **_unusual(key, {"multiplier": (multiplier, 1.0), "offset": (offset, 0.0)}, sheet))
