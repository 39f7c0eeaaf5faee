"""<geom>: shapes on bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.mjcf import notations
from hymeko_x.formats.mjcf.notations import frame_of
from hymeko_x.formats.mjcf.places import FITTED_GEOM, GEOM, GRID, GeomPlace
from hymeko_x.formats.mjcf.roles import role_of
from hymeko_x.formats.mjcf.words import PLACES
from hymeko_x.frontends.mjcf.builder import BodyScope, placed
from hymeko_x.ir.mechanism import shape_edge
from hymeko_x.ir.parts import Shape

if TYPE_CHECKING:
    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.xml.tree import XmlNode


def read_geom(element: XmlNode, scope: BodyScope, builder: MjcfBuilder) -> None:
    """A shape on a body; what only MuJoCo knows of it stays with it as it is."""
    own_class = element.attributes.get("class")
    given = {**builder.classes.of("geom", own_class or scope.childclass), **element.attributes}
    role = role_of(given)
    key = builder.names.take("shape", f"{scope.body.name}/{PLACES[role]}")
    builder.origins[key] = element.origin
    base = builder.base(element, key, scope.childclass)
    name = element.take("name") or None
    if name is not None:
        builder.register(element, "geom", name, key)
    if scope.frame:
        builder.note(key, frame_of(), scope.frame)
    fitted = "mesh" in given and given.get("type") != "mesh"
    found = builder.values(element, FITTED_GEOM if fitted else GEOM, base, key, always=bool(scope.frame))
    place: GeomPlace = found["place"]
    shape = Shape(place.geometry, role, name, found["rgba"] or None, found["mass"], found["density"], found["friction"])
    mesh = builder.find(element, "mesh", found["mesh"]) if found.get("mesh") else None
    material = builder.find(element, "material", found["material"]) if found["material"] else None
    builder.edges[key] = shape_edge(shape, scope.body, placed(place.pose, scope), mesh, material)
    if place.grid is not None and place.grid != GRID:
        builder.note(key, notations.GRID, place.grid)
    builder.keep(element, key)
