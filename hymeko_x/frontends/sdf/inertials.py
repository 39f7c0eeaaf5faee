"""Inertials that SDF leaves to the program that reads it, where a collision is a mesh: other formats need the numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.fragments import parsed
from hymeko_x.ir.parts import Body, Role
from hymeko_x.ir.solids import joined
from hymeko_x.rewrite.context import Context
from hymeko_x.rewrite.densities import Solids
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.solids import Solid
    from hymeko_x.source import Files


def with_computed_inertials(mechanism: Mechanism, files: Files, report: Report) -> Mechanism:
    """The mechanism in which bodies with ``<inertial auto="true">`` have the inertial of their collisions, meshes among them.

    A mesh that is not closed counts as its convex hull; what cannot be measured is reported and weighs nothing. Without weight, or where
    the numbers overflow, a body stays without an inertial.
    """
    bare = [key for key, body in mechanism.vertices(Body) if body.inertial is None and mechanism.notation(key, notations.AUTO)]
    if not bare:
        return mechanism
    solids = Solids(mechanism, Context(report, files), as_hull=False)
    found = {key: solid for key in bare if (solid := _solid_of(key, mechanism, solids)) is not None}
    endless = [key for key, solid in found.items() if not all(map(math.isfinite, (solid.mass, *solid.com, *solid.tensor)))]
    for key in endless:
        message = f"{key}: the inertial of its collisions is not finite; it is left unspecified"
        report.error(codes.BAD_NUMBER, message, mechanism.origin(key), element=str(key))
    for mesh in solids.missing:
        message = f"{mesh} is flat, missing or unreadable; it adds nothing to the inertial that is computed from collisions"
        report.warn(codes.INERTIA_REPAIRED, message, mechanism.origin(mesh), element=str(mesh))
    return mechanism.replace(vertices={key: Body(solid.inertial()) for key, solid in found.items() if key not in endless})


def _solid_of(body: Id, mechanism: Mechanism, solids: Solids) -> Solid | None:
    """The collisions of a body as one solid, of the mass that the file gives; None without weight."""
    views = [view for view in mechanism.shapes.get(body, ()) if view.shape.role is not Role.VISUAL]
    densities = [words.DENSITY if view.shape.density is None else view.shape.density for view in views]
    parts = [solid.times(density) for view, density in zip(views, densities, strict=True) if (solid := solids.of(view)) is not None]
    whole = joined(parts) if parts else None
    if whole is None or whole.mass == 0.0:
        return None
    mass = _given_mass(body, mechanism)
    return whole if mass is None else whole.times(mass / whole.mass)


def _given_mass(body: Id, mechanism: Mechanism) -> float | None:
    """The mass in kg in the <inertial> that the file has, which then replaces that by density."""
    nodes = [parsed(extra.text) for extra in mechanism.extras.get(body, ()) if extra.text.startswith("<inertial")]
    masses = [child.text or "" for node in nodes if node is not None for child in node.children if child.tag == "mass"]
    numbers = read_numbers(masses[0]) if masses else None
    return numbers[0] if numbers else None
