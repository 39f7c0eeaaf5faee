"""<link>: inertial, visuals and collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf.notations import SCALE
from hymeko_x.ir.digits import number_text, number_texts, numbers_text
from hymeko_x.ir.parts import Body, Box, Capsule, Cylinder, Mesh, MeshShape, NoShape, Sphere
from hymeko_x.ir.values import Pose, rotate_tensor
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from hymeko_x.backends.urdf.sheet import UrdfSheet
    from hymeko_x.ir.mechanism import Id, ShapeView
    from hymeko_x.ir.parts import Inertial
    from hymeko_x.ir.values import Tensor


def link_tag(key: Id, sheet: UrdfSheet) -> Tag:
    """The <link> of a body."""
    tag = Tag("link", {"name": key.name})
    inertial = sheet.mechanism.vertex(key, Body).inertial
    if inertial is not None:
        _add_inertial(tag, key, inertial, sheet)
    shapes = sheet.mechanism.shapes.get(key, ())
    for name, role in words.ROLES.items():
        for view in shapes:
            if view.shape.role is role:
                _add_shape(tag, name, view, sheet)
    return tag


def _add_inertial(link: Tag, key: Id, inertial: Inertial, sheet: UrdfSheet) -> None:
    tag = link.add("inertial")
    frame, tensor = _as_written(inertial)
    sheet.add_origin(tag, key, frame)
    if inertial.mass is not None:
        tag.add("mass", value=number_text(inertial.mass))
    if tensor is not None:
        xx, yy, zz, xy, xz, yz = tensor
        tag.add("inertia", **number_texts({"ixx": xx, "ixy": xy, "ixz": xz, "iyy": yy, "iyz": yz, "izz": zz}))


def _as_written(inertial: Inertial) -> tuple[Pose, Tensor | None]:
    """The tensor in its author's axes if it still is the same one, else in those of the body."""
    written = inertial.written
    if written is None or rotate_tensor(written.frame.quat, written.tensor) != inertial.tensor:
        return Pose(inertial.com), inertial.tensor
    return Pose(inertial.com, written.frame.quat, written.frame.written), written.tensor


def _add_shape(link: Tag, name: str, view: ShapeView, sheet: UrdfSheet) -> None:
    tag = link.add(name)
    if view.shape.name is not None:
        tag.attributes["name"] = view.shape.name
    sheet.add_origin(tag, view.id, view.pose)
    _add_geometry(tag.add("geometry"), view, sheet)
    sheet.materials.add_to_shape(tag, view)
    sheet.put_back(tag, view.id)


def _add_geometry(tag: Tag, view: ShapeView, sheet: UrdfSheet) -> None:
    match view.shape.geometry:
        case Box(size):
            tag.add("box", size=numbers_text(size))
        case Sphere(radius):
            tag.add("sphere", radius=number_text(radius))
        case Cylinder(radius, length):
            tag.add("cylinder", radius=number_text(radius), length=number_text(length))
        case Capsule(radius, length):
            tag.add("capsule", radius=number_text(radius), length=number_text(length))
        case MeshShape():
            _add_mesh(tag, view, sheet)
        case NoShape():
            pass
        case other:
            raise refuse(
                codes.NOT_REPRESENTED, f"{view.id} is a {type(other).__name__.lower()}, which URDF cannot represent", element=str(view.id)
            )


def _add_mesh(tag: Tag, view: ShapeView, sheet: UrdfSheet) -> None:
    if view.mesh is None:
        return
    mesh = sheet.mechanism.vertex(view.mesh, Mesh)
    child = tag.add("mesh")
    uri = sheet.uri(view.mesh)
    if uri is not None:
        child.attributes["filename"] = uri
    if mesh.scale != (1.0, 1.0, 1.0) or sheet.has_habit(view.id, SCALE):
        child.attributes["scale"] = numbers_text(mesh.scale)
