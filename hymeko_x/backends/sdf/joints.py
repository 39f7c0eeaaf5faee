"""<joint>: type, ends, axes with limits and dynamics, <mimic>; closures of loops are joints as well."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.backends.sdf.sensors import joint_sensor_tag
from hymeko_x.diagnostics import refuse
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.gearboxes import ENDS, GEARBOX, RATIO
from hymeko_x.formats.sdf.values import (
    DYNAMICS,
    LIMITS,
    NUMBER,
    OLD_PITCH,
    PITCH,
    STRENGTH_LIMITS,
    VECTOR,
    BadText,
    ValueField,
)
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import WORLD, numbers_weight
from hymeko_x.ir.parts import Dof, DofKind, Joint, Loop
from hymeko_x.ir.values import rotate, unit
from hymeko_x.xml.printing import Tag
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.sdf.sheet import SdfSheet
    from hymeko_x.ir.mechanism import Id

_RATIO = ValueField(RATIO, "ratio", NUMBER, 1.0)


def joint_tag(key: Id, scope: str, sheet: SdfSheet) -> Tag:
    """The <joint> of a joint, or of the closure of a loop. Raises: Refusal with HX104."""
    joint, parent, child = _ends(key, sheet)
    usual = words.default_type(joint)
    own = sheet.mechanism.notation(key, notations.TYPE)
    word = own if own is not None and words.JOINT_TYPES.get(own, words.JOINT_TYPES["fixed"]).dofs == _kinds(joint) else usual
    if word is None:
        message = f"{key} has dofs that SDF cannot represent"
        raise refuse(codes.NOT_REPRESENTED, message, sheet.mechanism.origin(key), element=str(key))
    tag = Tag("joint", {"name": sheet.name(key, scope), "type": word})
    base = parent if parent != WORLD and not sheet.from_sdf and parent.name.startswith(scope) else None
    names = _end_names(key, parent, child, scope, sheet)
    sheet.add_pose(tag, key, scope, sheet.places.find(scope, names[1]) or child, base)
    for name, text in zip(("parent", "child"), names, strict=True):
        sheet.add_text(tag, name, escaped(text))
    for number, dof in enumerate(joint.dofs):
        _add_dof(tag, dof, words.AXES[number], word, key, scope, sheet)
    sheet.put_back(tag, key)
    tag.children += [joint_sensor_tag(sensor, scope, sheet) for sensor in sheet.joint_sensors.get(key, ())]
    return tag


def gearbox_tag(key: Id, scope: str, sheet: SdfSheet) -> Tag:
    """The <joint> of a coupling that is a gearbox, with the names and axes that its author gave it."""
    gear, texts = sheet.gears[key], sheet.written(key)
    tag = Tag("joint", {"name": sheet.name(key, scope), "type": GEARBOX})
    sheet.add_pose(tag, key, scope, gear.child, pose=gear.pose)
    names: tuple[str, ...] = sheet.mechanism.notation(key, notations.GEARBOX) or ()
    for name, text in zip(ENDS, names, strict=False):
        tag.add(name).children.append(escaped(text))
    sheet.put(tag, _RATIO, gear.ratio, texts)
    for name in words.AXES:
        expressed, flag = texts.get(f"{name}/xyz/@expressed_in"), texts.get(f"{name}/use_parent_model_frame")
        axis = tag.add(name)
        axis.add("xyz", **({} if expressed is None else {"expressed_in": expressed})).children.append(texts[f"{name}/xyz"])
        if flag is not None:
            axis.add("use_parent_model_frame").children.append(escaped(flag))
    sheet.put_back(tag, key)
    tag.children += [joint_sensor_tag(sensor, scope, sheet) for sensor in sheet.joint_sensors.get(key, ())]
    return tag


def _kinds(joint: Joint) -> tuple[DofKind, ...]:
    return tuple(dof.kind for dof in joint.dofs)


def _ends(key: Id, sheet: SdfSheet) -> tuple[Joint, Id, Id]:
    view = sheet.mechanism.joints.get(key)
    if view is not None:
        return view.joint, view.parent, view.child
    edge = sheet.mechanism.graph.edges[key]
    assert isinstance(edge.data, Loop)
    dofs = edge.data.dofs or (Dof(DofKind.BALL),) if edge.data.kind == "connect" else edge.data.dofs
    first, second = (sheet.places.body_of(arc.target) for arc in edge.arcs[:2])
    return Joint(dofs), first, second


def _end_names(key: Id, parent: Id, child: Id, scope: str, sheet: SdfSheet) -> list[str]:
    """The names of both ends: those of frames that the author named, where these still are on the links."""
    own = (sheet.mechanism.notation(key, notations.ENDS) or "- -").split()
    found = []
    for body, name in zip((parent, child), own, strict=False):
        frame = sheet.places.find(scope, name.removesuffix("*")) if name.endswith("*") else None
        kept = frame is not None and sheet.places.body_of(frame) == body
        found.append(name.removesuffix("*") if kept else sheet.places.name(body, scope))
    return found


# ---- dofs ------------------------------------------------------------------------------------------------------------------------


def _add_dof(tag: Tag, dof: Dof, name: str, word: str, key: Id, scope: str, sheet: SdfSheet) -> None:
    texts = sheet.written(key)
    if dof.kind is DofKind.BALL:
        if dof.damping:
            axis = tag.child(name)
            if not sheet.from_sdf:
                axis.add("xyz").children.append("0 0 1")
            sheet.put_all(axis, "dynamics", [(DYNAMICS[0], dof.damping)], texts, f"{name}/")
        return
    if dof.kind is DofKind.SCREW:
        _add_pitch(tag, dof, texts, sheet)
    axis = tag.add(name)
    _add_axis(axis, dof, name, key, scope, texts, sheet)
    limits = LIMITS if words.JOINT_TYPES[word].bounded else STRENGTH_LIMITS
    sheet.put_all(axis, "limit", [(field, getattr(dof.limits, field.name)) for field in limits], texts, f"{name}/")
    sheet.put_all(axis, "dynamics", [(field, getattr(dof, field.name)) for field in DYNAMICS], texts, f"{name}/")
    _add_mimic(axis, key, name, sheet)


def _add_pitch(tag: Tag, dof: Dof, texts: Mapping[str, str], sheet: SdfSheet) -> None:
    """The pitch by the word that the author used; old readers know ``thread_pitch`` alone."""
    old = "thread_pitch" in texts or words.minor(sheet.version) < words.minor(words.VERSION_OF_PITCH)
    name, codec = ("thread_pitch", OLD_PITCH) if old and "screw_thread_pitch" not in texts and dof.pitch else ("screw_thread_pitch", PITCH)
    sheet.put(tag, ValueField(name, "pitch", codec, OLD_PITCH.read("1") if sheet.from_sdf else None), dof.pitch, texts)


def _add_axis(axis: Tag, dof: Dof, name: str, key: Id, scope: str, texts: Mapping[str, str], sheet: SdfSheet) -> None:
    """The axis in the frame, and with the length, that its author gave it, where it still is the same one."""
    expressed, text = texts.get(f"{name}/xyz/@expressed_in"), texts.get(f"{name}/xyz")
    flag = texts.get(f"{name}/use_parent_model_frame")
    frame = sheet.places.find(scope, expressed) if expressed is not None else sheet.places.model_frame(scope)
    if text is not None and frame is not None and _turned(text, frame, key, sheet) == _rounded(dof.axis):
        child = axis.add("xyz", **({} if expressed is None else {"expressed_in": expressed}))
        child.children.append(text)
        if flag is not None:
            axis.add("use_parent_model_frame").children.append(escaped(flag))
        return
    own = dof.written.numbers if dof.written is not None and dof.written.kind == "axis" else None
    same = own is not None and len(own) == 3 and _rounded(unit((own[0], own[1], own[2]))) == _rounded(dof.axis)
    attributes = {"expressed_in": ""} if expressed == "" else {}
    axis.add("xyz", **attributes).children.append(numbers_text(own if same and own is not None else dof.axis))
    if text is None and flag is not None:
        axis.add("use_parent_model_frame").children.append(escaped(flag))
    elif words.minor(sheet.version) < words.VERSION_OF_JOINT_AXES:
        axis.add("use_parent_model_frame").children.append("0")


def _turned(text: str, frame: Id, joint: Id, sheet: SdfSheet) -> tuple[float, ...] | None:
    """The unit axis in the frame of the joint, rounded; None for a text that is no direction."""
    try:
        return _rounded(unit(rotate(sheet.places.relative(frame, joint).quat, unit(VECTOR.read(text)))))
    except (BadText, ZeroDivisionError):
        return None


def _rounded(axis: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(round(value, 9) + 0.0 for value in axis)


def _add_mimic(axis: Tag, key: Id, name: str, sheet: SdfSheet) -> None:
    """follower = multiplier * (leader - reference) + offset."""
    found = sheet.leaders.get((key, name))
    if found is None:
        return
    coupling, leader = found
    constant, multiplier = (*numbers_weight(leader), 0.0, 0.0)[:2]
    scope = words.split_scope(key.name)[0]
    tag = axis.add("mimic", joint=leader.target.name.removeprefix(scope))
    texts = sheet.written(coupling)
    if leader.role or "@axis" in texts:
        tag.attributes["axis"] = sheet.axis_name(leader)
    try:
        reference = NUMBER.read(texts.get("reference", "0"))
        offset = NUMBER.read(texts.get("offset", "0"))
    except BadText:
        reference = offset = 0.0
    if not reference or abs(offset - multiplier * reference - constant) > 1e-12 * max(1.0, abs(constant)):
        reference, offset = 0.0, constant
    if multiplier != 1.0 or texts.get("multiplier") != "":
        tag.add("multiplier").children.append(sheet.text(NUMBER, multiplier, None, texts.get("multiplier")) or "1")
    for word, value in (("offset", offset), ("reference", reference)):
        text = sheet.text(NUMBER, value, 0.0, texts.get(word))
        if text is not None:
            tag.add(word).children.append(text)
