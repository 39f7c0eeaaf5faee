"""Links: a body with its inertial, its visuals and its collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import urdf as words
from hymeko_x.frontends.urdf.draft import read_origin, take_name, take_number
from hymeko_x.frontends.urdf.geometry import read_geometry
from hymeko_x.frontends.urdf.materials import read_shape_material
from hymeko_x.ir.mechanism import shape_edge
from hymeko_x.ir.parts import Body, Inertial, InertialWritten, Shape
from hymeko_x.ir.values import rotate_tensor
from hymeko_x.rewrite.solids import UNSAID, UNSAID_NOTATION

if TYPE_CHECKING:
    from hymeko_x.frontends.urdf.draft import Draft
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Role
    from hymeko_x.ir.values import Tensor
    from hymeko_x.xml.tree import Node

_ORIGIN_STYLES = {"visual": words.STYLE_VISUAL_ORIGIN, "collision": words.STYLE_COLLISION_ORIGIN}
_TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def read_link(node: Node, draft: Draft) -> None:
    """Add a link with its shapes: visuals first, then collisions, each in their order."""
    key = take_name(node, "body", draft.links, draft)
    inertial = _read_inertial(node, draft)
    draft.vertices[key] = Body(inertial)
    if inertial is not None and inertial.tensor is None:
        draft.note(key, UNSAID_NOTATION, UNSAID)
    for tag, role in words.ROLES.items():
        for shape in node.take_children(tag):
            _read_shape(shape, role, key, draft)
    draft.close(node)


def _read_shape(node: Node, role: Role, body: Id, draft: Draft) -> None:
    key = draft.own(node, "shape", f"{body.name}/{node.tag}")
    name = node.take("name")
    pose = read_origin(node, _ORIGIN_STYLES[node.tag], draft)
    geometry, mesh = read_geometry(node, draft)
    rgba, material = read_shape_material(node, draft)
    draft.edges[key] = shape_edge(Shape(geometry, role, name, rgba), body, pose, mesh, material)


# ---- inertia -------------------------------------------------------------------------------------------------------------------


def _read_inertial(link: Node, draft: Draft) -> Inertial | None:
    """Mass, centre of mass and tensor, turned from the axes of its <origin> into those of the body; None without one."""
    node = link.take_child("inertial")
    if node is None:
        return None
    mass = _read_mass(node, draft)
    tensor = _read_tensor(node, draft)
    frame = read_origin(node, words.STYLE_INERTIAL_ORIGIN, draft, turned=tensor is not None)
    if frame.written is None or tensor is None:
        return Inertial(mass, frame.xyz, tensor)
    return Inertial(mass, frame.xyz, rotate_tensor(frame.quat, tensor), InertialWritten(frame, tensor))


def _read_mass(inertial: Node, draft: Draft) -> float | None:
    node = inertial.take_child("mass")
    if node is None:
        _say_missing(inertial, "mass", "its mass is unspecified", draft)
        return None
    mass = take_number(node, "value", draft.report, instead="the mass is unspecified")
    if mass is None and "value" not in node.attributes:
        _say_missing(node, "value", "the mass is unspecified", draft)
        inertial.leave(node)
    return mass


def _read_tensor(inertial: Node, draft: Draft) -> Tensor | None:
    node = inertial.take_child("inertia")
    if node is None:
        _say_missing(inertial, "inertia", "its tensor is unspecified (urdfdom then drops the mass as well)", draft)
        return None
    values = []
    for name in _TENSOR:
        value = take_number(node, name, draft.report, instead="0 is used")
        if value is None and name not in node.attributes:
            _say_missing(node, name, "0 is used", draft)
        values.append(0.0 if value is None else value)
    xx, yy, zz, xy, xz, yz = values
    return (xx, yy, zz, xy, xz, yz)


def _say_missing(node: Node, what: str, instead: str, draft: Draft) -> None:
    attribute = node.tag in ("mass", "inertia")
    draft.report.warn(
        codes.MISSING_ATTRIBUTE if attribute else codes.MISSING_PART,
        f"{node.subject}: <{node.tag}> has no {what if attribute else f'<{what}>'}; {instead}",
        node.origin,
        element=node.element,
    )
