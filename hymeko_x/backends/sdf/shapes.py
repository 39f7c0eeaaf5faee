"""<visual> and <collision>: geometry, appearance and friction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import materials
from hymeko_x.formats.sdf.values import COLOUR, NUMBER, PAIR, SOLIDS, VECTOR, BadText, ValueField
from hymeko_x.ir.parts import Material, Mesh, MeshShape, NoShape, Plane, Role
from hymeko_x.ir.values import Pose, compose, inverse, quat_from_z, unit
from hymeko_x.xml.printing import Tag
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.sdf.sheet import SdfSheet
    from hymeko_x.ir.mechanism import ShapeView
    from hymeko_x.ir.parts import Geometry

_MISSING = object()
"""No value equals it: what has no default is always written."""
_SOLIDS = {kind: (name, fields, tuple([field._replace(default=_MISSING) for field in fields])) for name, (kind, fields) in SOLIDS.items()}
"""The element of each geometry, its fields, and those of geometries from other formats, which are always written."""
_MU = ValueField("surface/friction/ode/mu", "friction", NUMBER)
_DENSITY = ValueField("density", "density", NUMBER)
_SCALE = ValueField("scale", "scale", VECTOR, (1.0, 1.0, 1.0))
_DIFFUSE = ValueField("diffuse", "rgba", COLOUR)
_AMBIENT = ValueField("ambient", "rgba", COLOUR)


def shape_tag(view: ShapeView, name: str, number: int, scope: str, sheet: SdfSheet) -> Tag:
    """The n-th <visual> or <collision> of a link."""
    tag = Tag(name, {"name": words.shape_name(name, number) if view.shape.name is None else view.shape.name})
    texts = sheet.written(view.id)
    pose, normal = _pose_of(view, texts)
    sheet.add_pose(tag, view.id, scope, view.body, pose=pose)
    if not isinstance(view.shape.geometry, NoShape) or "geometry" in texts:
        _add_geometry(tag.add("geometry"), view, normal, texts, sheet)
    if view.shape.role is Role.VISUAL:
        _add_material(tag, view, texts, sheet)
    elif view.shape.friction:
        sheet.put(tag, _MU, view.shape.friction[0], texts)
    if view.shape.density is not None and "density" in texts:
        sheet.put(tag, _DENSITY, view.shape.density, texts)
    sheet.put_back(tag, view.id)
    return tag


def _pose_of(view: ShapeView, texts: Mapping[str, str]) -> tuple[Pose, str | None]:
    """The shape's pose; that of a plane is followed by the turn to the normal that its author gave."""
    text = texts.get("geometry/plane/normal")
    if not isinstance(view.shape.geometry, Plane) or text is None:
        return view.pose, None
    try:
        turn = Pose(quat=quat_from_z(unit(VECTOR.read(text))))
    except (BadText, ZeroDivisionError):
        return view.pose, None
    return compose(view.pose, inverse(turn)), text


def _add_geometry(tag: Tag, view: ShapeView, normal: str | None, texts: Mapping[str, str], sheet: SdfSheet) -> None:
    match view.shape.geometry:
        case Plane((x, y)):
            _add_plane(tag.add("plane"), (2.0 * x, 2.0 * y), normal, texts, sheet)
        case MeshShape():
            _add_mesh(tag.add("mesh"), view, texts, sheet)
        case geometry if type(geometry) in _SOLIDS:  # of what SDF alone has, nothing is written: it is an extra
            _add_solid(tag, geometry, texts, sheet)


def _add_solid(geometry_tag: Tag, geometry: Geometry, texts: Mapping[str, str], sheet: SdfSheet) -> None:
    name, own, new = _SOLIDS[type(geometry)]
    tag = geometry_tag.add(name)
    for field in own if sheet.from_sdf else new:
        sheet.put(tag, field, getattr(geometry, field.name), texts, f"geometry/{name}/")


def _add_plane(tag: Tag, size: tuple[float, float], normal: str | None, texts: Mapping[str, str], sheet: SdfSheet) -> None:
    """The size is only that of what is drawn; one of zero stands for none."""
    if normal is not None:
        tag.add("normal").children.append(normal)
    shown = (size[0] or 1.0, size[1] or 1.0)
    sheet.put(tag, ValueField("size", "size", PAIR, (1.0, 1.0) if sheet.from_sdf else _MISSING), shown, texts, "geometry/plane/")


def _add_mesh(tag: Tag, view: ShapeView, texts: Mapping[str, str], sheet: SdfSheet) -> None:
    if view.mesh is None:
        return
    mesh = sheet.mechanism.vertex(view.mesh, Mesh)
    uri = sheet.mesh_files.get(view.mesh, mesh.uri)
    if uri is not None:
        sheet.add_text(tag, "uri", escaped(uri))
    sheet.put(tag, _SCALE, mesh.scale, texts, "geometry/mesh/")


# ---- appearance --------------------------------------------------------------------------------------------------------------


def _add_material(visual: Tag, view: ShapeView, texts: Mapping[str, str], sheet: SdfSheet) -> None:
    part = sheet.mechanism.graph.vertices.get(view.material) if view.material is not None else None
    material = part if isinstance(part, Material) else None
    rgba = view.shape.rgba or (material.rgba if material is not None else None)
    if rgba is not None:
        tag = visual.child("material")
        if not sheet.from_sdf or materials.AMBIENT in texts:
            sheet.put(tag, _AMBIENT, rgba, texts, "material/")  # whose default is black
        sheet.put(tag, _DIFFUSE, rgba, texts, "material/")
    images = sheet.textures.get(view.material, {}) if view.material is not None else {}
    numbers = [] if material is None else [(tag, getattr(material, name)) for tag, name in materials.NUMBERS.items()]
    if not images and not any(value is not None for _, value in numbers):
        return
    metal = visual.child("material").child("pbr").child("metal")
    for name, use in materials.MAPS.items():
        if use in images:
            metal.add(name).children.append(escaped(images[use]))
    for name, value in numbers:
        sheet.put(metal, ValueField(name, name, NUMBER), value, texts, "material/pbr/metal/")
