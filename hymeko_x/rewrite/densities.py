"""Inertials of bodies that have none, from their shapes and a density."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.formats import native_format
from hymeko_x.ir.parts import Body, Mesh, MeshShape, Role
from hymeko_x.ir.solids import joined, solid_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.ir.solids import Solid
    from hymeko_x.rewrite.context import Context

Source = Literal["collision", "visual", "hull"]
WATER = 1000.0
"""The density in kg/m^3 that is taken where the user gives none."""
_SHOWN = 3
_BY_SOURCE = {"collision": "their collision shapes", "visual": "their visual shapes", "hull": "the convex hulls of their shapes"}


class Solids:
    """The solids of meshes, each measured once; ``hulls`` are the meshes that are open, ``missing`` those that cannot be measured."""

    def __init__(self, mechanism: Mechanism, context: Context, *, as_hull: bool) -> None:
        self.mechanism, self.context, self.as_hull = mechanism, context, as_hull
        self.hulls: list[Id] = []
        self.missing: list[Id] = []
        self._found: dict[Id, Solid | None] = {}

    def of(self, view: ShapeView) -> Solid | None:
        """The solid of a shape in the frame of its body, of density 1; None for a plane, and for a mesh that is not there or flat."""
        if isinstance(view.shape.geometry, MeshShape):
            solid = None if view.mesh is None else self._of_mesh(view.mesh)
        else:
            solid = solid_of(view.shape.geometry)
        return solid.at(view.pose) if solid is not None and solid.mass > 0.0 else None

    def _of_mesh(self, key: Id) -> Solid | None:
        if key not in self._found:
            self._found[key] = self._measured(key)
        return self._found[key]

    def _measured(self, key: Id) -> Solid | None:
        from hymeko_x.meshes.reader import triangles_of
        from hymeko_x.meshes.solids import solid_of_mesh

        mesh = self.mechanism.vertex(key, Mesh)
        part = triangles_of(mesh, self.context.files)
        found = None if part is None else solid_of_mesh(part, mesh.scale, as_hull=self.as_hull)
        if found is None:
            self.missing.append(key)
            return None
        solid, is_hull = found
        if is_hull and not self.as_hull:
            self.hulls.append(key)
        return solid


def give_inertials(mechanism: Mechanism, density: float, source: Source | None, context: Context) -> Mechanism:
    """Each body without an inertial gets that of its shapes with this density in kg/m^3: of those that collide, unless asked otherwise.

    Primitives and closed meshes count exactly, open meshes as their convex hull; where shapes overlap, both count.
    """
    bare = [key for key, body in mechanism.vertices(Body) if body.inertial is None]
    if not bare or native_format(mechanism) is not None:
        message = "its engine computes masses from shapes" if bare else "every body has an inertial"
        context.report.note(codes.FOR_TARGET, f"{context.reason}: {message}; nothing is changed", element="mechanism")
        return mechanism
    return _weighed(mechanism, bare, density, source, context)


def weigh_colliders(mechanism: Mechanism, context: Context) -> Mechanism:
    """Each body without an inertial gets that of its colliders with the density of water, as engines for USD compute it. Idempotent.

    Source: UsdPhysics, Mass Properties: 1000 kg/m^3 where nothing else is known; so do Newton's readers of other formats.
    """
    if native_format(mechanism) is not None:
        return mechanism
    bare = [key for key, body in mechanism.vertices(Body) if body.inertial is None and _collides(mechanism, key)]
    return _weighed(mechanism, bare, WATER, "collision", context) if bare else mechanism


def _collides(mechanism: Mechanism, body: Id) -> bool:
    return any(view.shape.role is not Role.VISUAL for view in mechanism.shapes.get(body, ()))


def _weighed(mechanism: Mechanism, bare: list[Id], density: float, source: Source | None, context: Context) -> Mechanism:
    solids = Solids(mechanism, context, as_hull=source == "hull")
    found: dict[Id, Body] = {}
    for key in bare:
        shapes = [solid for view in _chosen(mechanism.shapes.get(key, ()), source) if (solid := solids.of(view))]
        if shapes:
            found[key] = Body(joined(shapes).times(density).inertial())
    _report(found, bare, solids, source, context)
    return mechanism.replace(vertices=found)


def _chosen(views: Iterable[ShapeView], source: Source | None) -> list[ShapeView]:
    """The shapes of the asked role; where a body has none, the others."""
    unwanted = Role.COLLISION if source == "visual" else Role.VISUAL
    views = list(views)
    return [view for view in views if view.shape.role is not unwanted] or views


def _report(found: dict[Id, Body], bare: list[Id], solids: Solids, source: Source | None, context: Context) -> None:
    mass = sum(body.inertial.mass or 0.0 for body in found.values() if body.inertial)
    what = _BY_SOURCE[source or "collision"]
    message = f"{context.reason}: {counted(len(found), 'body', 'bodies')} with masses and inertias of {what}, {mass:.4g} kg together"
    context.report.note(codes.FOR_TARGET, message, element=str(bare[0]))
    if solids.hulls:
        message = f"{context.reason}: {_meshes(solids.hulls)} not closed, taken as convex hulls: {_listed(solids.hulls)}"
        context.report.note(codes.FOR_TARGET, message, element=str(solids.hulls[0]))
    if solids.missing:
        message = f"{context.reason}: {_meshes(solids.missing)} flat, missing or unreadable: {_listed(solids.missing)}"
        context.report.warn(codes.INERTIA_REPAIRED, message, element=str(solids.missing[0]))


def _meshes(found: list[Id]) -> str:
    return counted(len(found), "mesh", "meshes")


def _listed(keys: list[Id]) -> str:
    return listed([f"'{key.name}'" for key in keys], _SHOWN)
