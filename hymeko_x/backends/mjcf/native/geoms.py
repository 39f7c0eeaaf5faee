"""<geom>."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.native.spot import Op, Spot
from hymeko_x.formats.mjcf.places import FITTED_GEOM, GEOM, GRID, PLACE, Place, seen_from
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.parts import Plane

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.formats.mjcf.codec import Group
    from hymeko_x.ir.mechanism import ShapeView


def geom_op(sheet: Sheet, spot: Spot, view: ShapeView) -> Op:
    """A shape on its body."""
    key, shape = view.id, view.shape
    notes, said = sheet.notes(key), sheet.said(key)
    around = spot.around(notes.get("frame"))
    own_class = sheet.own_class(key)
    base = sheet.base("geom", own_class, spot.childclass_in(around))
    fitted = "mesh" in said or ("mesh" in base and view.mesh is None)
    groups: tuple[Group, ...] = FITTED_GEOM if fitted else GEOM
    if around is not None:
        groups = (seen_from(PLACE, around.pose), *groups[1:])
    grid = float(notes.get("grid", GRID)) if isinstance(shape.geometry, Plane) else None
    mesh = None if view.mesh is None else sheet.reference(Arc(view.mesh))
    values: dict[str, object] = {
        "place": Place(shape.geometry, view.pose, grid),
        "mesh": mesh,
        "material": None if view.material is None else sheet.reference(Arc(view.material)),
        "rgba": shape.rgba or (),
        "mass": shape.mass,
        "density": shape.density,
        "friction": shape.friction,
    }
    context = said if fitted or mesh is None else {**said, "mesh": mesh}
    attributes: Attributes = {
        "name": shape.name,
        "class": own_class,
        **sheet.attributes(values, groups, base, notes, context),
        **said,
    }
    return Op("leaf", "geom", attributes, tuple(sheet.inside(key)), around)
