"""Geometries: boxes, cylinders, spheres, capsules and meshes."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import urdf as words
from hymeko_x.frontends.urdf.draft import take_numbers
from hymeko_x.ir.mechanism import file_stem
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Mesh, MeshShape, NoShape, Sphere
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.frontends.urdf.draft import Draft
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Geometry
    from hymeko_x.ir.values import Vec3
    from hymeko_x.xml.tree import Node

_NO_GEOMETRY = "the shape has no geometry"


def read_geometry(shape: Node, draft: Draft) -> tuple[Geometry, Id | None]:
    """What a visual or collision looks like, and its mesh. What nobody understands is no shape, and an extra."""
    node = shape.take_child("geometry")
    if node is None:
        _say(shape, f"<{shape.tag}> has no <geometry>", draft)
        return NoShape(), None
    found = node.take_child_among(_READERS)
    if found is None:
        tags = ", ".join(f"<{kid.tag}>" for kid in node.unread_children())
        known = ", ".join(f"<{tag}>" for tag in _READERS)
        _say(node, f"<geometry> holds {tags or 'nothing'}, expected one of {known}", draft)
        return NoShape(), None
    if node.has_among(_READERS):
        said = f"{node.subject}: <geometry> holds more than one shape; the first one counts, the others are kept as written"
        draft.report.warn(codes.REPEATED, said, node.origin, element=node.element)
    if found.tag == "mesh":
        return MeshShape(), _read_mesh(found, draft)
    geometry = _READERS[found.tag](found, draft)
    if geometry is None:
        node.leave(found)
        return NoShape(), None
    return geometry, None


def _say(node: Node, what: str, draft: Draft) -> None:
    said = f"{node.subject}: {what}; {_NO_GEOMETRY}"
    draft.report.warn(codes.MISSING_PART, said, node.origin, element=node.element)


# ---- one reader per geometry; None when its numbers cannot be read -----------------------------------------------------------


def _read_box(node: Node, draft: Draft) -> Geometry | None:
    size = _sized(node, "size", 3, draft)
    if size is None:
        return None
    x, y, z = size
    return Box((x, y, z))


def _read_sphere(node: Node, draft: Draft) -> Geometry | None:
    radius = _sized(node, "radius", 1, draft)
    return None if radius is None else Sphere(radius[0])


def _read_cylinder(node: Node, draft: Draft) -> Geometry | None:
    radius, length = _sized(node, "radius", 1, draft), _sized(node, "length", 1, draft)
    return None if radius is None or length is None else Cylinder(radius[0], length[0])


def _read_capsule(node: Node, draft: Draft) -> Geometry | None:
    radius, length = _sized(node, "radius", 1, draft), _sized(node, "length", 1, draft)
    draft.style.add(words.STYLE_CAPSULE)
    return None if radius is None or length is None else Capsule(radius[0], length[0])


def _sized(node: Node, attribute: str, count: int, draft: Draft) -> tuple[float, ...] | None:
    """Numbers without which there is no geometry."""
    if attribute in node.attributes:
        return take_numbers(node, attribute, count, draft.report, instead=_NO_GEOMETRY)
    said = f"{node.subject}: <{node.tag}> has no {attribute}; {_NO_GEOMETRY}, and the text is kept as written"
    draft.report.error(codes.MISSING_ATTRIBUTE, said, node.origin, element=node.element)
    return None


def _no_reader(node: Node, draft: Draft) -> Geometry | None:
    raise AssertionError(f"<{node.tag}> of {draft.version} is read elsewhere")


_READERS: Mapping[str, Callable[[Node, Draft], Geometry | None]] = MappingProxyType(
    {
        "mesh": _no_reader,
        "box": _read_box,
        "cylinder": _read_cylinder,
        "sphere": _read_sphere,
        "capsule": _read_capsule,
    }
)


# ---- meshes ----------------------------------------------------------------------------------------------------------------------


def _read_mesh(node: Node, draft: Draft) -> Id:
    """The mesh vertex of a file and scale; shapes that use the same ones share it."""
    uri = node.take("filename")
    if uri is None:
        said = f"{node.subject}: <mesh> has no filename; it stays empty"
        draft.report.error(codes.MISSING_ATTRIBUTE, said, node.origin, element=node.element)
        uri = ""
    scale = _read_scale(node, draft)
    known = draft.meshes.get((uri, scale))
    if known is not None:
        return known
    key = draft.names.take("mesh", file_stem(uri) or "mesh")
    draft.vertices[key] = Mesh(uri or None, scale)
    draft.origins[key] = node.origin
    draft.meshes[uri, scale] = key
    return key


def _read_scale(node: Node, draft: Draft) -> Vec3:
    one = read_numbers(node.attributes.get("scale", ""))
    if one is not None and len(one) == 1:
        node.take("scale")
        said = f"{node.subject}: <mesh scale> is one number; read as the same in all directions (urdfdom drops such a shape)"
        draft.report.warn(codes.BAD_NUMBER, said, node.origin, element=node.element)
        return (one[0], one[0], one[0])
    found = take_numbers(node, "scale", 3, draft.report, instead="1 1 1 is used")
    if found == (1.0, 1.0, 1.0):
        draft.style.add(words.STYLE_SCALE)
    x, y, z = found or (1.0, 1.0, 1.0)
    return (x, y, z)
