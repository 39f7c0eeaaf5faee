"""<worldbody>: bodies with all that is in them, and the frames around it, without recursion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.native.geoms import geom_op
from hymeko_x.backends.mjcf.native.joints import joint_ops
from hymeko_x.backends.mjcf.native.mounts import mount_ops
from hymeko_x.backends.mjcf.native.spot import Around, Op, Spot, spot_of
from hymeko_x.formats.mjcf.codec import POSE
from hymeko_x.formats.mjcf.places import INERTIAL, seen_from
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body
from hymeko_x.ir.values import IDENTITY, compose, inverse

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.ir.mechanism import Id, JointView
    from hymeko_x.ir.parts import Inertial


_PLACE = (POSE,)
_WEIGHT = (INERTIAL,)


def write_worldbody(sheet: Sheet) -> None:
    """The world's own geometry and every tree below it."""
    said = sheet.said(WORLD)
    sheet.text.section("worldbody", dict(said))
    stack: list[Op | None] = []
    _push(stack, _content(sheet, spot_of(sheet, WORLD, said.get("childclass"))))
    while stack:
        op = stack.pop()
        if op is None:
            sheet.text.close()
        elif op.kind == "leaf":
            sheet.element(op.tag, op.attributes, list(op.inside))
        else:
            sheet.text.open(op.tag, op.attributes)
            for line in op.inside:
                sheet.text.raw(line)
            if op.spot is not None and op.kind == "body":
                stack.append(None)
                _push(stack, _content(sheet, op.spot))
    sheet.text.close()


def _push(stack: list[Op | None], ops: list[Op]) -> None:
    """Put the content of a body on the stack; frames are opened and closed where they change."""
    wrapped: list[Op | None] = []
    opened: Around | None = None
    named: set[str] = set()
    for op in ops:
        closed, entered = _way(opened, op.around)
        wrapped += [None] * closed
        wrapped += [_frame_op(around, named) for around in entered]
        opened = op.around
        wrapped.append(op)
    wrapped += [None] * (opened.depth if opened else 0)
    stack.extend(reversed(wrapped))


def _way(start: Around | None, end: Around | None) -> tuple[int, list[Around]]:
    """How many frames are left on the way from one frame to another, and which ones are entered, from the outermost."""
    closed = 0
    entered: list[Around] = []
    while start is not end:
        if start is not None and (end is None or start.depth >= end.depth):
            start, closed = start.outer, closed + 1
        elif end is not None:
            entered.append(end)
            end = end.outer
    return closed, entered[::-1]


def _frame_op(around: Around, named: set[str]) -> Op:
    """The start of a frame; where it has to be opened again, it stays nameless."""
    attributes: Attributes = dict(around.attributes)
    if around.number in named:
        attributes.pop("name", None)
    named.add(around.number)
    return Op("frame", "frame", attributes)


def _content(sheet: Sheet, spot: Spot) -> list[Op]:
    mechanism = sheet.mechanism
    ops: list[Op] = []
    view = mechanism.parent_joint.get(spot.body)
    if spot.body != WORLD:
        ops += _inertial_ops(sheet, spot)
    if view is not None:
        ops += joint_ops(sheet, spot, view)
    ops += [geom_op(sheet, spot, shape) for shape in mechanism.shapes.get(spot.body, ())]
    ops += mount_ops(sheet, spot)
    ops += [_body_op(sheet, spot, joint) for joint in mechanism.children.get(spot.body, ())]
    if spot.body == WORLD:
        ops += [_body_op(sheet, spot, None, body) for body in mechanism.roots if body not in mechanism.parent_joint]
    return ops


def _inertial_ops(sheet: Sheet, spot: Spot) -> list[Op]:
    inertial: Inertial | None = sheet.mechanism.vertex(spot.body, Body).inertial
    if inertial is None:
        return []
    notes = sheet.notes(spot.body)
    around = spot.around(notes.get("inertial/frame"))
    groups = _WEIGHT if around is None else (seen_from(INERTIAL, around.pose),)
    attributes = sheet.attributes({"inertial": inertial}, groups, {}, notes, {}, "inertial/")
    return [Op("leaf", "inertial", {**attributes, **sheet.said(spot.body, "inertial")}, around=around)]


def _body_op(sheet: Sheet, spot: Spot, view: JointView | None, body: Id | None = None) -> Op:
    """The start of a body: its pose at the reference configuration is P C^-1 in its parent."""
    key = body if view is None else view.child
    assert key is not None
    pose = IDENTITY if view is None else view.parent_pose
    if view is not None and view.child_pose != IDENTITY:
        pose = compose(pose, inverse(view.child_pose))
    notes = sheet.notes(key)
    around = spot.around(notes.get("frame"))
    groups = _PLACE if around is None else (seen_from(POSE, around.pose),)
    said = sheet.said(key)
    childclass = notes.get("childclass")
    attributes: Attributes = {
        "name": sheet.name(key),
        "childclass": childclass,
        **sheet.attributes({"pose": pose}, groups, {}, notes, said),
        **said,
    }
    inner = spot_of(sheet, key, childclass or spot.childclass_in(around))
    return Op("body", "body", attributes, tuple(sheet.inside(key)), around, inner)
