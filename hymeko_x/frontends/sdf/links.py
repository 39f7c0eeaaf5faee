"""<link>: a body with its inertial, shapes, sensors and lights."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.notations import WrittenPose
from hymeko_x.formats.sdf.values import NUMBER, TENSOR, BadText, read_pose
from hymeko_x.frontends.sdf.sensors import read_light, read_link_sensor
from hymeko_x.frontends.sdf.shapes import read_shape
from hymeko_x.ir.mechanism import ShapeView, pose_weight
from hymeko_x.ir.parts import Body, Inertial, InertialWritten, Shape
from hymeko_x.ir.solids import solid_of_colliders
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, rotate_tensor
from hymeko_x.rewrite.inertia import is_physical
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from hymeko_x.frontends.sdf.builder import SdfBuilder, SdfModel
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.values import Pose, Tensor
    from hymeko_x.xml.tree import XmlNode


def read_link(node: XmlNode, model: SdfModel, builder: SdfBuilder) -> None:
    """Add what a link has: its inertial, visuals first, then collisions, then sensors and lights."""
    key = node.owner
    assert key is not None
    inertial = _read_inertial(node, key, model, builder)
    builder.vertices[key] = Body(inertial)
    density = _density(node, key, builder) if inertial is None and not model.is_static else None
    for tag, role in words.ROLES.items():
        for number, shape in enumerate(node.take_children(tag), start=1):
            read_shape(shape, number, role, key, model, builder, density)
    if density is not None:
        builder.vertices[key] = Body(_inertial_of_collisions(node, key, density, builder))
        builder.note(key, notations.AUTO, True)
    for sensor in node.take_children("sensor"):
        read_link_sensor(sensor, key, model, builder)
    for light in node.take_children("light"):
        read_light(light, key, model, builder)


def _read_inertial(link: XmlNode, key: Id, model: SdfModel, builder: SdfBuilder) -> Inertial | None:
    """Mass, centre of mass and tensor; None where they come from the collisions.

    What is missing is 1 kg and 1 kg m^2, as libsdformat has it.
    """
    node = link.take_child("inertial")
    if node is None:
        builder.note(key, notations.NO_INERTIAL, True)
        return Inertial(1.0, tensor=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
    if is_auto(node, builder):
        link.leave(node)
        return None
    pose = _read_pose(node, key, builder)
    mass = builder.child_value(node, "mass", NUMBER, 1.0, key, "inertial/mass")
    xx, yy, zz, xy, xz, yz = builder.values(node, "inertia", TENSOR, key, "inertial/").values()
    tensor: Tensor = (xx, yy, zz, xy, xz, yz)
    if mass < 0.0:
        builder.warn(codes.BAD_MASS, node, f"{link.subject}: the mass is negative, which libsdformat refuses; it is kept")
    if not is_physical(tensor):
        builder.warn(
            codes.BAD_TENSOR, node, f"{link.subject}: no body can have this inertia tensor, and libsdformat refuses it; it is kept"
        )
    if pose.quat == NO_ROTATION:
        return Inertial(mass, pose.xyz, tensor)
    return Inertial(mass, pose.xyz, rotate_tensor(pose.quat, tensor), InertialWritten(pose, tensor))


def is_auto(node: XmlNode, builder: SdfBuilder) -> bool:
    """Whether the inertial of a link comes from its collisions, which the element that stays as written then says."""
    return node.attributes.get("auto", "").lower() in ("true", "1") and builder.version_of(node) >= words.minor(words.VERSION_OF_AUTO)


def _density(link: XmlNode, key: Id, builder: SdfBuilder) -> float | None:
    """The density in kg/m^3 of collisions that give none, where the inertial comes from them; else None."""
    node = link.child("inertial")
    if node is None:
        return None
    text = next((child.text for child in node.children if child.tag == "density"), None)
    numbers = read_numbers(text or "")
    return numbers[0] if numbers else words.DENSITY


def _inertial_of_collisions(link: XmlNode, key: Id, density: float, builder: SdfBuilder) -> Inertial | None:
    """The inertial of the link's collisions, scaled to the mass where the file gives one; None where there is a mesh among them."""
    views = [
        ShapeView(shape, edge.data, key, pose_weight(edge.arcs[0]), None, None)
        for shape in (child.owner for child in link.children if child.tag == "collision")
        if shape is not None and isinstance((edge := builder.edges[shape]).data, Shape)
    ]
    found = solid_of_colliders(views, density)
    if found is None:
        return None
    if not all(map(math.isfinite, (found.mass, *found.com, *found.tensor))):
        builder.error(codes.BAD_NUMBER, link, f"{link.subject}: the inertial of its collisions is not finite; it is left unspecified")
        return None
    node = next(child for child in link.children if child.tag == "inertial")
    mass = read_numbers(next((child.text or "" for child in node.children if child.tag == "mass"), ""))
    return (found.times(mass[0] / found.mass) if mass else found).inertial()


def _read_pose(inertial: XmlNode, key: Id, builder: SdfBuilder) -> Pose:
    """The pose of the centre of mass and its axes; nothing names the frame that it is relative to, which is the link."""
    child = inertial.take_child("pose")
    if child is None:
        return IDENTITY
    text = " ".join((child.text or "").split())
    written = WrittenPose(None, child.attributes.get("rotation_format"), child.attributes.get("degrees"), text)
    try:
        pose = read_pose(written)
    except BadText as error:
        inertial.leave(child)
        builder.error(codes.BAD_NUMBER, child, f"{child.subject}: <pose> is '{text[:60]}', expected {error}; the identity is used")
        return IDENTITY
    child.text = None
    texts = builder.written.setdefault(key, {})
    texts |= {f"inertial/pose/@{name}": value for name in ("rotation_format", "degrees") if (value := child.take(name)) is not None}
    if pose == IDENTITY or len(texts) or (pose.quat == NO_ROTATION and len(text.split()) != 6):
        texts["inertial/pose"] = text
    return pose
