"""Sites, cameras and lights on their bodies."""

from __future__ import annotations

import math
from itertools import chain
from typing import TYPE_CHECKING, Any

from pxr import Gf, Vt

from hymeko_x.backends.usd.sheet import T, apply, put
from hymeko_x.formats import usd as words
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Camera, Frame, Light, Tendon

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet, WrittenPrim

_SITE_SIZE = 0.005
"""The radius in m of a site without a size in MJCF."""


def write_mounts(sheet: UsdSheet) -> None:
    """Frames as Xforms with the site schemas of MuJoCo and Newton, cameras and lights; each prim also represents the mount.

    A site of a cable is a small ball with purpose ``guide``, as MuJoCo's converter writes sites: Newton leads cables through shapes alone.
    """
    knots = {arc.target for _, _, arcs in sheet.mechanism.edges(Tendon) for arc in arcs if arc.target.kind == "frame"}
    for view in chain.from_iterable(sheet.mechanism.mounts.values()):
        part = sheet.mechanism.graph.vertices.get(view.mounted)
        if not isinstance(part, Frame | Camera | Light) or view.mounted in sheet.paths:
            continue
        home = sheet.root if view.body == WORLD else sheet.paths.get(view.body)
        if home is None:
            continue
        spec = sheet.add_prim(view.mounted, home, _type_of(part), below=view.body != WORLD)
        sheet.paths[view.id] = spec.path
        sheet.set_pose(spec, view.pose, on=view.body)
        _write_mounted(spec, part, sheet.mechanism.notation(view.mounted, words.SITE))
        if isinstance(part, Frame) and view.mounted in knots and sheet.mechanism.notation(view.mounted, words.PATH) is None:
            _write_ball(spec, part.size[0] if part.size and part.size[0] > 0.0 else _SITE_SIZE)


def _write_ball(spec: WrittenPrim, radius: float) -> None:
    """The shape of a site, of this radius in m."""
    spec.kind = "Sphere"
    put(spec, "radius", T.Double, radius)
    put(spec, "purpose", T.Token, "guide")
    put(spec, "extent", T.Float3Array, Vt.Vec3fArray([Gf.Vec3f(-radius), Gf.Vec3f(radius)]))


def _type_of(part: Frame | Camera | Light) -> str:
    match part:
        case Frame():
            return "Xform"
        case Camera():
            return "Camera"
        case Light(kind):
            return next((name for name, meant in words.LIGHTS.items() if meant == kind), "SphereLight")


def _write_mounted(spec: Any, part: Frame | Camera | Light, site: str | None) -> None:
    """The schemas and attributes of a frame, a camera or a light beside its pose. ``site``: the one schema of a frame's author."""
    if isinstance(part, Frame):
        apply(spec, *(words.SITES if site is None else (site,)))
    elif isinstance(part, Light):
        if part.kind == "spot":
            apply(spec, words.CONE)
        if part.diffuse is not None:
            put(spec, "inputs:color", T.Color3f, Gf.Vec3f(*part.diffuse))
    elif part.fovy is not None and 0.0 < part.fovy < math.pi:
        put(spec, "verticalAperture", T.Float, words.APERTURE)
        put(spec, "focalLength", T.Float, words.APERTURE / 2.0 / math.tan(part.fovy / 2.0))
