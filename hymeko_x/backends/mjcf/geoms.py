"""<geom>."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf import CLASSES
from hymeko_x.formats.mjcf.notations import GRID as NOTED_GRID
from hymeko_x.formats.mjcf.notations import attribute, frame_of
from hymeko_x.formats.mjcf.places import FITTED_GEOM, GEOM, GRID, PLACE, Place, between_its_ends, seen_from
from hymeko_x.formats.mjcf.roles import role_attributes
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.parts import Body, NoShape, Plane
from hymeko_x.rewrite.densities import WATER

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.mjcf.sheet import BodyTag, MjcfSheet
    from hymeko_x.formats.mjcf.codec import Group
    from hymeko_x.ir.mechanism import ShapeView


def write_geom(sheet: MjcfSheet, body: BodyTag, view: ShapeView) -> None:
    """A shape on its body. One that did not come from MJCF has the class of its role."""
    key, shape = view.id, view.shape
    if isinstance(shape.geometry, NoShape) and not sheet.from_mjcf:
        raise ValueError("a shape without geometry is not legal MJCF")
    notations, kept = sheet.notations(key), sheet.kept_attributes(key)
    frame = body.frame(sheet.note(key, frame_of()))
    own_class = sheet.own_class(key) if sheet.from_mjcf else CLASSES.get(shape.role)
    base = sheet.base("geom", own_class, body.childclass if frame is None else frame.childclass)
    fitted = "mesh" in kept or ("mesh" in base and view.mesh is None)
    groups: tuple[Group, ...] = FITTED_GEOM if fitted else GEOM
    if frame is not None:
        groups = (seen_from(PLACE, frame.pose), *groups[1:])
    grid = (sheet.mechanism.notation(key, NOTED_GRID) or GRID) if isinstance(shape.geometry, Plane) else None
    mesh = None if view.mesh is None else sheet.reference(Arc(view.mesh))
    place = Place(shape.geometry, view.pose, grid)
    values: dict[str, object] = {
        "place": between_its_ends(place) if "fromto" in base else place,
        "mesh": mesh,
        "material": None if view.material is None else sheet.reference(Arc(view.material)),
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


def _is_of_water(sheet: MjcfSheet, view: ShapeView, base: Mapping[str, str]) -> bool:
    """Whether the mass of a body follows from a shape without a density, which the class of that would give another one."""
    part = sheet.mechanism.graph.vertices.get(view.body)
    weighs = isinstance(part, Body) and part.inertial is None and view.shape.mass is None and view.shape.density is None
    return sheet.from_mjcf and weighs and "density" in base
