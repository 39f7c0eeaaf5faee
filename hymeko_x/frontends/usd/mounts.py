"""Sites, cameras and lights: the elements that a prim mounts on a body or on the world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.bodies import body_at
from hymeko_x.ir.mechanism import WORLD, mount_edge
from hymeko_x.ir.parts import Camera, Frame, Light, World

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id


# ---- sites, cameras and lights ---------------------------------------------------------------------------------------------------


def read_site(prim: Prim, builder: UsdBuilder) -> None:
    """A frame at the prim, which is all that it is if it has the type that the writer sets; a gprim of it stays an extra."""
    key = builder.new_id(prim, "frame")
    builder.vertices[key] = Frame()
    if prim.kind == "Xform":
        schemas = [schema for schema in words.SITES if prim.has_api(schema)]
        builder.mark_read(prim, "@type", *(f"@{schema}" for schema in schemas))
        if len(schemas) < len(words.SITES):
            builder.note(key, words.SITE, schemas[0])
    mount(prim, key, builder)


def read_camera(prim: Prim, builder: UsdBuilder) -> None:
    """A camera with its vertical field of view, 2 atan(aperture / 2 f); the rest of its lens stays extras."""
    key = builder.new_id(prim, "camera")
    focal = words.single(prim.value("focalLength") or 50.0)
    aperture = words.single(prim.value("verticalAperture") or words.APERTURE)
    fovy = 2.0 * math.atan(aperture / (2.0 * focal))
    builder.vertices[key] = Camera(fovy)
    builder.mark_read(prim, "@type")
    if aperture == words.APERTURE and 0.0 < fovy < math.pi:  # as the writer sets it
        builder.mark_read(prim, *(name for name in ("focalLength", "verticalAperture") if not prim.is_animated(name)))
    mount(prim, key, builder)


def mount(prim: Prim, key: Id, builder: UsdBuilder) -> None:
    """The edge that mounts an element at the pose of its prim, on the nearest body or on the world."""
    found = body_at(prim, builder)
    body, owner = found if found is not None else (None, WORLD)
    if owner == WORLD:
        builder.vertices.setdefault(WORLD, World())
    pose = builder.transforms.seen_from(prim, body).pose
    builder.edges[builder.new_id(prim, "mount", key.name)] = mount_edge(owner, key, pose)
    ops = [name for name in prim.properties if name.startswith("xformOp")]
    builder.mark_read(prim, *(name for name in ops if "scale" not in name or name == words.WITHIN))


def read_light(prim: Prim, builder: UsdBuilder) -> None:
    """A light where it shines; a sphere light with a cone is a spot."""
    kind = words.LIGHTS[prim.kind]
    if kind == "point" and prim.has_api(words.CONE):
        kind = "spot"
        builder.mark_read(prim, f"@{words.CONE}")
    key = builder.new_id(prim, "light")
    colour = builder.get(prim, "inputs:color")
    builder.vertices[key] = Light(kind, colour)
    builder.mark_read(prim, "@type")
    mount(prim, key, builder)
