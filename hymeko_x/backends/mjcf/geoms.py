"""<geom>."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf import CLASSES, MAIN
from hymeko_x.formats.mjcf.notations import GRID as NOTED_GRID
from hymeko_x.formats.mjcf.notations import attribute
from hymeko_x.formats.mjcf.places import FITTED_GEOM, GEOM, GRID, PLACE, GeomPlace, between_its_ends, seen_from
from hymeko_x.formats.mjcf.roles import role_attributes
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.parts import Body, Box, Capsule, Cylinder, Ellipsoid, NoShape, Plane
from hymeko_x.rewrite.densities import WATER

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.frames import BodyTag
    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.formats.mjcf.codec import AttributeGroup
    from hymeko_x.ir.mechanism import ShapeView
    from hymeko_x.ir.parts import Geometry


def write_geom(sheet: MjcfSheet, body: BodyTag, view: ShapeView) -> None:
    """A shape on its body. One that did not come from MJCF has the class of its role."""
    key, shape = view.id, view.shape
    if isinstance(shape.geometry, NoShape) and not sheet.from_mjcf:
        raise ValueError("a shape without geometry is not legal MJCF")
    notations, kept = sheet.notations(key), sheet.kept_attributes(key)
    frame = body.frame_of(sheet, key)
    own_class = sheet.own_class(key) if sheet.from_mjcf else CLASSES.get(shape.role)
    base = sheet.base("geom", own_class, body.childclass if frame is None else frame.childclass)
    fitted = "mesh" in kept or ("mesh" in base and view.mesh is None)
    groups: tuple[AttributeGroup, ...] = FITTED_GEOM if fitted else GEOM
    if frame is not None:
        groups = (seen_from(PLACE, frame.pose), *groups[1:])
    if "fromto" in base and not fitted and not _has_ends(shape.geometry) and "fromto" not in (main := sheet.base("geom", MAIN)):
        own_class, kept, base = MAIN, {**_beyond(main, base, groups), **kept}, main  # as no position undoes the two points of a class
    grid = (sheet.mechanism.notation(key, NOTED_GRID) or GRID) if isinstance(shape.geometry, Plane) else None
    mesh = None if view.mesh is None else sheet.reference(Arc(view.mesh))
    place = GeomPlace(shape.geometry, view.pose, grid)
    values: dict[str, object] = {
        "place": between_its_ends(place) if "fromto" in base else place,
        "mesh": mesh,
        "material": sheet.reference(Arc(view.material)) if view.material is not None else "" if base.get("material") else None,
        "rgba": shape.rgba or (),
        "mass": shape.mass,
        "density": WATER if _is_of_water(sheet, view, base) else shape.density,
        "friction": shape.friction,
    }
    context = kept if fitted or mesh is None else {**kept, "mesh": mesh}
    found = sheet.attributes(values, groups, base, notations, context)
    if isinstance(shape.geometry, NoShape) and (kind := sheet.note(key, attribute("type"))) is not None:
        found["type"] = kind  # of a geom that the IR does not have
    own = {**found, **kept}
    own |= role_attributes(shape.role, {**base, **own}) if sheet.from_mjcf else {}
    body.add(tag_of("geom", {"name": shape.name or None, "class": own_class, **own}, sheet.inside(key), view.body), frame)


def _has_ends(geometry: Geometry) -> bool:
    """Whether two points and one size can give it: it is as wide as it is deep."""
    match geometry:
        case Box((x, y, _)) | Ellipsoid((x, y, _)):
            return x == y
    return isinstance(geometry, Capsule | Cylinder)


def _beyond(main: Mapping[str, str], base: Mapping[str, str], groups: tuple[AttributeGroup, ...]) -> dict[str, str]:
    """What a class gives beyond the main one, but for the attributes of these groups."""
    named = {name for group in groups for name in group.names}
    return {name: text for name, text in base.items() if name not in named and main.get(name) != text}


def _is_of_water(sheet: MjcfSheet, view: ShapeView, base: Mapping[str, str]) -> bool:
    """Whether the mass of a body follows from a shape without a density, which the class of that would give another one."""
    part = sheet.mechanism.graph.vertices.get(view.body)
    weighs = isinstance(part, Body) and part.inertial is None and view.shape.mass is None and view.shape.density is None
    return sheet.from_mjcf and weighs and "density" in base
