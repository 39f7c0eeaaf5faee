"""<visual> and <collision>: geometry, appearance and friction of a shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf.values import NUMBER, PAIR, SOLIDS, VECTOR, ValueField
from hymeko_x.frontends.sdf.materials import read_material
from hymeko_x.ir.mechanism import shape_edge
from hymeko_x.ir.parts import Mesh, MeshShape, NoShape, Plane, Role, Shape
from hymeko_x.ir.values import Pose, Z, compose, quat_from_z, unit
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from hymeko_x.frontends.sdf.builder import SdfBuilder, SdfModel
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Geometry
    from hymeko_x.xml.tree import XmlNode

_FRICTION = ValueField("surface/friction/ode/mu", "friction", NUMBER)


def read_shape(node: XmlNode, number: int, role: Role, body: Id, model: SdfModel, builder: SdfBuilder, density: float | None) -> None:
    """Add a shape, the n-th of its role. ``density`` in kg/m^3 is that of collisions from which the body's inertial comes, else None."""
    name = node.take("name")
    node.owner = key = builder.fresh("shape", f"{body.name}/{node.tag}", node.origin)
    pose, base = builder.pose(node, key)
    frame = builder.base_of(node, model.scope, base, body)
    if frame != body:
        pose = compose(builder.frames.relative(frame, body), pose)
    geometry, mesh, turn = _read_geometry(node, key, builder)
    rgba, material = read_material(node, key, builder) if role is Role.VISUAL else (None, None)
    mu = builder.value(node, _FRICTION, key) if role is Role.COLLISION else None
    weight = None
    if density is not None and role is Role.COLLISION:
        is_given = node.has("density")
        weight = builder.value(node, ValueField("density", "density", NUMBER, density), key)
        if is_given and weight is not None:
            builder.written.setdefault(key, {}).setdefault("density", NUMBER.write(weight))
    shape = Shape(geometry, role, None if name == words.shape_name(node.tag, number) else name, rgba, density=weight)
    if mu is not None:
        shape = Shape(geometry, role, shape.name, rgba, density=weight, friction=(mu,))
    builder.edges[key] = shape_edge(shape, body, pose if turn is None else compose(pose, turn), mesh, material)


# ---- geometry ----------------------------------------------------------------------------------------------------------------


def _read_geometry(shape: XmlNode, key: Id, builder: SdfBuilder) -> tuple[Geometry, Id | None, Pose | None]:
    """The geometry of a shape, its mesh, and how it is turned in the shape's frame."""
    node = shape.child("geometry")
    if node is None:
        builder.warn(codes.MISSING_PART, shape, f"{shape.subject}: <{shape.tag}> has no <geometry>; the shape has no geometry")
        return NoShape(), None, None
    node.taken = True
    if not node.children:
        builder.written.setdefault(key, {})["geometry"] = ""
    found = _geometry_of(node, shape, builder)
    if found is None or found.tag in words.OTHER_GEOMETRIES:
        tags = ", ".join(f"<{child.tag}>" for child in node.unread_children())
        if found is None:
            message = f"{shape.subject}: <geometry> contains {tags or 'nothing'}, expected one of {', '.join((*SOLIDS, 'plane', 'mesh'))}"
            builder.warn(codes.MISSING_PART, shape, f"{message}; the shape has no geometry")
        elif not node.has("empty"):
            message = f"{shape.subject}: {tags} is kept as written, and has no shape in other formats"
            builder.report.note(codes.UNKNOWN_WORD, message, shape.origin, element=shape.element)
        return NoShape(), None, None
    found.taken = True
    if found.tag == "mesh":
        return MeshShape(), _read_mesh(found, key, builder), None
    if found.tag == "plane":
        return _read_plane(found, key, builder)
    kind, fields = SOLIDS[found.tag]
    return kind(*[builder.value(found, field, key, f"geometry/{found.tag}/") for field in fields]), None, None


def _geometry_of(node: XmlNode, shape: XmlNode, builder: SdfBuilder) -> XmlNode | None:
    """The child of a <geometry> that counts; None without one."""
    found = [child for child in node.children if child.tag in words.GEOMETRIES]
    if len(found) < 2:
        return found[0] if found else None
    first = min(found, key=lambda child: words.GEOMETRIES.index(child.tag))
    message = f"{shape.subject}: <geometry> contains more than one shape; <{first.tag}> counts, and the others are kept as written"
    builder.warn(codes.REPEATED, shape, message)
    return first


def _read_plane(node: XmlNode, key: Id, builder: SdfBuilder) -> tuple[Geometry, Id | None, Pose | None]:
    """A plane with its normal along z; the shape is turned so that it points where the file says."""
    size = builder.child_value(node, "size", PAIR, (1.0, 1.0), key, "geometry/plane/size")
    normal = builder.child_value(node, "normal", VECTOR, Z, key, "geometry/plane/normal")
    try:
        turn = quat_from_z(unit(normal))
    except ZeroDivisionError:
        builder.error(codes.ZERO_AXIS, node, f"{node.subject}: the normal of the plane is zero; 0 0 1 is used")
        return Plane((size[0] / 2.0, size[1] / 2.0)), None, None
    if normal != Z:
        builder.written.setdefault(key, {}).setdefault("geometry/plane/normal", VECTOR.write(normal))
    return Plane((size[0] / 2.0, size[1] / 2.0)), None, None if normal == Z else Pose(quat=turn)


def _read_mesh(node: XmlNode, key: Id, builder: SdfBuilder) -> Id:
    """The mesh vertex of a file and scale; shapes that use the same ones share it. A submesh is kept as written."""
    child = node.take_child("uri")
    uri = "" if child is None else child.take_text()
    if not uri:
        builder.error(codes.MISSING_ATTRIBUTE, node, f"{node.subject}: <mesh> has no <uri>; it stays empty")
    scale = builder.child_value(node, "scale", VECTOR, (1.0, 1.0, 1.0), key, "geometry/mesh/scale")
    known = builder.meshes.get((uri, scale))
    if known is not None:
        return known
    mesh = builder.fresh("mesh", file_stem(uri) or "mesh", node.origin)
    builder.vertices[mesh] = Mesh(uri or None, scale)
    builder.meshes[uri, scale] = mesh
    return mesh
