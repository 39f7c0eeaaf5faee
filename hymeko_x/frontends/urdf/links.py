"""<link>: a body with its inertial, and visuals and collisions with their geometry."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import notations
from hymeko_x.frontends.urdf.builder import read_origin, take_each_number, take_name, take_number, take_numbers
from hymeko_x.frontends.urdf.materials import read_shape_material
from hymeko_x.ir.mechanism import ROOT, shape_edge
from hymeko_x.ir.notations import WITHOUT_TENSOR
from hymeko_x.ir.parts import Body, Box, Capsule, Cylinder, Inertial, InertialWritten, Mesh, MeshShape, NoShape, Shape, Sphere
from hymeko_x.ir.values import rotate_tensor
from hymeko_x.source import file_stem
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.frontends.urdf.builder import UrdfBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Geometry, Role
    from hymeko_x.ir.values import Tensor, Vec3
    from hymeko_x.xml.tree import XmlNode

_NO_GEOMETRY = "the shape has no geometry"
_TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def read_link(node: XmlNode, builder: UrdfBuilder) -> None:
    """Add a link with its shapes: visuals first, then collisions, each in their order."""
    key = take_name(node, "body", builder.links, builder)
    inertial = _read_inertial(node, key, builder)
    builder.vertices[key] = Body(inertial)
    if inertial is not None and inertial.tensor is None:
        builder.note(key, WITHOUT_TENSOR, True)
    for tag, role in words.ROLES.items():
        for shape in node.take_children(tag):
            _read_shape(shape, role, key, builder)
    builder.close(node)


def _read_shape(node: XmlNode, role: Role, body: Id, builder: UrdfBuilder) -> None:
    key = builder.own(node, "shape", f"{body.name}/{node.tag}")
    name = node.take("name")
    pose = read_origin(node, key, builder)
    geometry, mesh = _read_geometry(node, key, builder)
    rgba, material = read_shape_material(node, builder)
    builder.edges[key] = shape_edge(Shape(geometry, role, name, rgba), body, pose, mesh, material)


# ---- inertia -------------------------------------------------------------------------------------------------------------------


def _read_inertial(link: XmlNode, key: Id, builder: UrdfBuilder) -> Inertial | None:
    """Mass, centre of mass and tensor, turned from the axes of its <origin> into those of the body; None without one."""
    node = link.take_child("inertial")
    if node is None:
        return None
    mass = _read_mass(node, builder)
    tensor = _read_tensor(node, builder)
    frame = read_origin(node, key, builder, turned=tensor is not None)
    if frame.written is None or tensor is None:
        return Inertial(mass, frame.xyz, tensor)
    return Inertial(mass, frame.xyz, rotate_tensor(frame.quat, tensor), InertialWritten(frame, tensor))


def _read_mass(inertial: XmlNode, builder: UrdfBuilder) -> float | None:
    node = inertial.take_child("mass")
    if node is None:
        _warn_missing(inertial, "mass", "its mass is unspecified", builder)
        return None
    mass = take_number(node, "value", builder, instead="the mass is unspecified")
    if mass is None and "value" not in node.attributes:
        _warn_missing(node, "value", "the mass is unspecified", builder)
        inertial.leave(node)
    return mass


def _read_tensor(inertial: XmlNode, builder: UrdfBuilder) -> Tensor | None:
    node = inertial.take_child("inertia")
    if node is None:
        _warn_missing(inertial, "inertia", "its tensor is unspecified (urdfdom then drops the mass as well)", builder)
        return None
    numbers = take_each_number(node, _TENSOR, builder, instead="0 is used")
    if None in numbers:
        for name, number in zip(_TENSOR, numbers, strict=True):
            if number is None and name not in node.attributes:
                _warn_missing(node, name, "0 is used", builder)
    xx, yy, zz, xy, xz, yz = [0.0 if number is None else number for number in numbers]
    return (xx, yy, zz, xy, xz, yz)


def _warn_missing(node: XmlNode, missing: str, instead: str, builder: UrdfBuilder) -> None:
    attribute = node.tag in ("mass", "inertia")
    code = codes.MISSING_ATTRIBUTE if attribute else codes.MISSING_PART
    builder.warn(code, node, f"{node.subject}: <{node.tag}> has no {missing if attribute else f'<{missing}>'}; {instead}")


# ---- geometry ----------------------------------------------------------------------------------------------------------------


def _read_geometry(shape: XmlNode, key: Id, builder: UrdfBuilder) -> tuple[Geometry, Id | None]:
    """The geometry of a visual or collision, and its mesh. An unknown one is no shape, and an extra."""
    node = shape.take_child("geometry")
    if node is None:
        _warn_empty(shape, f"<{shape.tag}> has no <geometry>", builder)
        return NoShape(), None
    found = node.take_child_of(_GEOMETRIES)
    if found is None:
        tags = ", ".join(f"<{child.tag}>" for child in node.unread_children())
        known = ", ".join(f"<{tag}>" for tag in _GEOMETRIES)
        _warn_empty(node, f"<geometry> contains {tags or 'nothing'}, expected one of {known}", builder)
        return NoShape(), None
    if node.has(*_GEOMETRIES):
        message = f"{node.subject}: <geometry> contains more than one shape; the first one counts, the others are kept as written"
        builder.warn(codes.REPEATED, node, message)
    if found.tag == "mesh":
        return MeshShape(), _read_mesh(found, key, builder)
    geometry = _READERS[found.tag](found, builder)
    if geometry is None:
        node.leave(found)
        return NoShape(), None
    return geometry, None


def _warn_empty(node: XmlNode, problem: str, builder: UrdfBuilder) -> None:
    message = f"{node.subject}: {problem}; {_NO_GEOMETRY}"
    builder.warn(codes.MISSING_PART, node, message)


# ---- one reader per geometry; None when its numbers cannot be read -----------------------------------------------------------


def _read_box(node: XmlNode, builder: UrdfBuilder) -> Geometry | None:
    size = _sized(node, "size", 3, builder)
    if size is None:
        return None
    x, y, z = size
    return Box((x, y, z))


def _read_sphere(node: XmlNode, builder: UrdfBuilder) -> Geometry | None:
    radius = _sized(node, "radius", 1, builder)
    return None if radius is None else Sphere(radius[0])


def _read_cylinder(node: XmlNode, builder: UrdfBuilder) -> Geometry | None:
    radius, length = _sized(node, "radius", 1, builder), _sized(node, "length", 1, builder)
    return None if radius is None or length is None else Cylinder(radius[0], length[0])


def _read_capsule(node: XmlNode, builder: UrdfBuilder) -> Geometry | None:
    radius, length = _sized(node, "radius", 1, builder), _sized(node, "length", 1, builder)
    builder.follow(ROOT, notations.CAPSULE, follows=True)
    return None if radius is None or length is None else Capsule(radius[0], length[0])


def _sized(node: XmlNode, attribute: str, count: int, builder: UrdfBuilder) -> tuple[float, ...] | None:
    """Numbers without which there is no geometry."""
    if attribute in node.attributes:
        return take_numbers(node, attribute, count, builder, instead=_NO_GEOMETRY)
    message = f"{node.subject}: <{node.tag}> has no {attribute}; {_NO_GEOMETRY}, and the text is kept as written"
    builder.error(codes.MISSING_ATTRIBUTE, node, message)
    return None


_READERS: Mapping[str, Callable[[XmlNode, UrdfBuilder], Geometry | None]] = MappingProxyType(
    {"box": _read_box, "cylinder": _read_cylinder, "sphere": _read_sphere, "capsule": _read_capsule}
)
_GEOMETRIES = ("mesh", *_READERS)


# ---- meshes ----------------------------------------------------------------------------------------------------------------------


def _read_mesh(node: XmlNode, shape: Id, builder: UrdfBuilder) -> Id:
    """The mesh vertex of a file and scale; shapes that use the same ones share it."""
    uri = node.take("filename")
    if uri is None:
        message = f"{node.subject}: <mesh> has no filename; it stays empty"
        builder.warn(codes.MISSING_ATTRIBUTE, node, message)
        uri = ""
    scale = _read_scale(node, shape, builder)
    known = builder.meshes.get((uri, scale))
    if known is not None:
        return known
    key = builder.names.take("mesh", file_stem(uri) or "mesh")
    builder.vertices[key] = Mesh(uri or None, scale)
    builder.origins[key] = node.origin
    builder.meshes[uri, scale] = key
    return key


def _read_scale(node: XmlNode, shape: Id, builder: UrdfBuilder) -> Vec3:
    one = read_numbers(node.attributes.get("scale", ""))
    if one is not None and len(one) == 1:
        node.take("scale")
        message = f"{node.subject}: <mesh scale> is one number; read as the same in all directions (urdfdom drops such a shape)"
        builder.warn(codes.BAD_NUMBER, node, message)
        return (one[0], one[0], one[0])
    found = take_numbers(node, "scale", 3, builder, instead="1 1 1 is used")
    x, y, z = found or (1.0, 1.0, 1.0)
    if (x, y, z) == (1.0, 1.0, 1.0):
        builder.follow(shape, notations.SCALE, follows=found is not None)
    return (x, y, z)
