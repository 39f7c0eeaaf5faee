"""<joint> and <freejoint>: all joints of a body are one edge from its parent, with their dofs in order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.joints import JOINT
from hymeko_x.formats.mjcf.notations import frame_of, is_joint
from hymeko_x.ir.mechanism import WORLD, Id, joint_edge
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import UNLIMITED, Dof, DofKind, Joint, Limits
from hymeko_x.ir.values import Z, apply, rotate

if TYPE_CHECKING:
    from hymeko_x.frontends.mjcf.builder import BodyScope, MjcfBuilder, Values
    from hymeko_x.ir.values import Pose
    from hymeko_x.xml.tree import XmlNode

_VELOCITIES = {DofKind.HINGE: 1, DofKind.SLIDE: 1, DofKind.BALL: 3, DofKind.FREE: 6}


def read_joints(found: list[tuple[XmlNode, BodyScope]], body: Id, parent: Id, pose: Pose, builder: MjcfBuilder) -> None:
    """The edge from the parent to the body; without joints it is a fixed one."""
    key = _joint_id(found, body, builder)
    dofs = []
    stereotypes = []
    for number, (element, scope) in enumerate(found, 1):
        prefix = "" if len(found) == 1 else str(number)
        dofs.append(_read_dof(element, scope, key, prefix, builder))
        stereotypes.append(builder.stereotypes.pop(key, ("",))[0])
        builder.origins.setdefault(key, element.origin)
    if any(stereotypes):
        builder.stereotypes[key] = tuple(stereotypes)
    _check_dofs(dofs, found, parent)
    builder.edges[key] = joint_edge(Joint(tuple(dofs)), parent, body, pose)
    builder.origins.setdefault(key, builder.origins[body])
    builder.show(key)


def _joint_id(found: list[tuple[XmlNode, BodyScope]], body: Id, builder: MjcfBuilder) -> Id:
    if len(found) == 1 and (name := found[0][0].attributes.get("name")):
        return Id("joint", name)
    key = builder.names.take("joint", body.name)
    if len(found) == 1:
        builder.note(key, UNNAMED, True)
    return key


def _read_dof(element: XmlNode, scope: BodyScope, key: Id, prefix: str, builder: MjcfBuilder) -> Dof:
    name = element.take("name") or None
    if name:
        builder.register(element, "joint", name, key)
        builder.roles.setdefault(key, {})[name] = name if prefix else ""
    if scope.frame:
        builder.note(key, frame_of(prefix), scope.frame)
    dof = _free(element, key, prefix, builder) if element.tag == "freejoint" else _typed(element, scope, key, prefix, builder)
    builder.keep(element, key, f"joint[{prefix}]" if prefix else "")
    return dof if not prefix or name is None else _named(dof, name)


def _named(dof: Dof, name: str) -> Dof:
    from msgspec.structs import replace

    return replace(dof, name=name)


def _free(element: XmlNode, key: Id, prefix: str, builder: MjcfBuilder) -> Dof:
    return Dof(DofKind.FREE, Z)


def _typed(element: XmlNode, scope: BodyScope, key: Id, prefix: str, builder: MjcfBuilder) -> Dof:
    base = builder.base(element, key, scope.childclass)
    found = builder.values(element, JOINT, base, key, prefix, always=bool(scope.frame))
    if found["type"] is DofKind.FREE:
        builder.note(key, is_joint(prefix), "joint")
    axis, written = found["axis"]
    if scope.frame:
        axis, written = rotate(scope.pose.quat, axis), None
    return Dof(
        found["type"],
        axis,
        _limits(found),
        damping=found["damping"],
        friction=found["frictionloss"],
        stiffness=found["stiffness"],
        spring_ref=found["springref"][0],
        armature=found["armature"],
        ref=found["ref"][0],
        anchor=apply(scope.pose, found["pos"]) if scope.frame else found["pos"],
        written=written,
    )


def _limits(found: Values) -> Limits:
    span = found["range"][0]
    force = found["actuatorfrcrange"][0]
    effort = force[1] if force is not None and force[0] == -force[1] else None
    if span is None and effort is None:
        return UNLIMITED
    low, high = span or (None, None)
    return Limits(low, high, effort=effort)


def _check_dofs(dofs: list[Dof], found: list[tuple[XmlNode, BodyScope]], parent: Id) -> None:
    """What MuJoCo refuses, which takes several dofs or a free one."""
    if not dofs or (len(dofs) == 1 and dofs[0].kind is not DofKind.FREE):
        return
    after_ball = False
    velocities = 0
    for dof, (element, _) in zip(dofs, found, strict=True):
        velocities += _VELOCITIES[dof.kind]
        if dof.kind is DofKind.FREE and (len(dofs) > 1 or parent != WORLD):
            why = "it is not the only joint of its body" if len(dofs) > 1 else "its body is not a child of the world"
            raise refuse(codes.UNKNOWN_WORD, f"a free joint cannot stand here: {why}", element.origin)
        if after_ball and dof.kind in (DofKind.HINGE, DofKind.BALL):
            raise refuse(codes.UNKNOWN_WORD, "a ball joint is followed by another rotation in the same body", element.origin)
        if velocities > 6:
            raise refuse(codes.UNKNOWN_WORD, "the joints of one body have more than 6 degrees of freedom", element.origin)
        after_ball = after_ball or dof.kind is DofKind.BALL
