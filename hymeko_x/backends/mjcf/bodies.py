"""<worldbody>: bodies with all that is in them, and the frames around it, without recursion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.backends.mjcf.frames import open_body
from hymeko_x.backends.mjcf.geoms import write_geom
from hymeko_x.backends.mjcf.joints import write_dof
from hymeko_x.backends.mjcf.mounts import write_mount
from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf.codec import POSE
from hymeko_x.formats.mjcf.notations import CHILDCLASS
from hymeko_x.formats.mjcf.places import INERTIAL, seen_from
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body, Role
from hymeko_x.ir.values import IDENTITY, compose, inverse
from hymeko_x.ir.written import clean_pose
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.frames import BodyTag
    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.ir.mechanism import Id, JointView, ShapeView
    from hymeko_x.ir.parts import Inertial

_POSE = (POSE,)
_INERTIAL = (INERTIAL,)
_NO_TENSOR = (0.0,) * 6


def write_worldbody(sheet: MjcfSheet) -> None:
    """The world's own geometry and every tree below it."""
    kept = sheet.kept_attributes(WORLD)
    world = sheet.section("worldbody", kept)
    world.has_end = True
    stack = [open_body(sheet, WORLD, world, kept.get("childclass"))]
    while stack:
        stack += _filled(sheet, stack.pop())


def _filled(sheet: MjcfSheet, body: BodyTag) -> list[BodyTag]:
    """Write the content of a body. Returns the bodies in it, which are open."""
    mechanism, key = sheet.mechanism, body.key
    view = mechanism.parent_joint.get(key)
    inertial = mechanism.vertex(key, Body).inertial if key != WORLD else None
    if inertial is not None:
        _add_inertial(sheet, body, inertial)
    for number in range(len(view.joint.dofs) if view is not None else 0):
        write_dof(sheet, body, view, number)  # type: ignore[arg-type]
    shapes = mechanism.shapes.get(key, ())
    for shape in shapes if sheet.from_mjcf or len(shapes) < 2 else sorted(shapes, key=_is_collision):
        write_geom(sheet, body, shape)
    for mount in mechanism.mounts.get(key, ()):
        write_mount(sheet, body, mount)
    if key == WORLD:
        return [_add_body(sheet, body, root, mechanism.parent_joint.get(root)) for root in mechanism.roots]
    return [_add_body(sheet, body, joint.child, joint) for joint in mechanism.children.get(key, ())]


def _is_collision(view: ShapeView) -> bool:
    """Whether a shape is only touched; what is seen stands before it, as in the files of MuJoCo Menagerie."""
    return view.shape.role is Role.COLLISION


def _add_inertial(sheet: MjcfSheet, body: BodyTag, inertial: Inertial) -> None:
    """Mass, centre of mass, and the tensor about it in body axes: three numbers where the products are zero, else six."""
    if not sheet.from_mjcf and (inertial.tensor is None or inertial.written is not None):
        inertial = replace(inertial, tensor=inertial.tensor or _NO_TENSOR, written=None)
    notations = sheet.notations(body.key)
    frame = body.frame_of(sheet, body.key, "inertial/")
    groups = _INERTIAL if frame is None else (seen_from(INERTIAL, frame.pose),)
    attributes = sheet.attributes({"inertial": inertial}, groups, {}, notations, {}, "inertial/")
    body.add(Tag("inertial", {**attributes, **sheet.kept_attributes(body.key, "inertial")}), frame)


def _add_body(sheet: MjcfSheet, outer: BodyTag, key: Id, view: JointView | None) -> BodyTag:
    """A body without its content: its pose at the reference configuration is P C^-1 in its parent."""
    pose = IDENTITY if view is None else view.parent_pose
    if view is not None and view.child_pose != IDENTITY:
        pose = clean_pose(compose(pose, inverse(view.child_pose)))
    notations, kept = sheet.notations(key), sheet.kept_attributes(key)
    frame = outer.frame_of(sheet, key)
    groups = _POSE if frame is None else (seen_from(POSE, frame.pose),)
    childclass = sheet.note(key, CHILDCLASS)
    attributes = {
        "name": sheet.name(key),
        "childclass": childclass,
        **sheet.attributes({"pose": pose}, groups, {}, notations, kept),
        **kept,
    }
    has_inertial = sheet.mechanism.vertex(key, Body).inertial is not None
    inside = [text for text in sheet.inside(key) if not (has_inertial and text.startswith("<inertial"))]  # which the engine ignored
    tag = tag_of("body", attributes, inside)
    outer.add(tag, frame)
    return open_body(sheet, key, tag, childclass or (outer.childclass if frame is None else frame.childclass))
