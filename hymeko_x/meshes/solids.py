"""Meshes as solids, by trimesh: exact for closed meshes, the convex hull for open ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.solids import Solid

if TYPE_CHECKING:
    from hymeko_x.ir.values import Vec3
    from hymeko_x.meshes.submesh import Submesh


def solid_of_mesh(part: Submesh, scale: Vec3, *, as_hull: bool) -> tuple[Solid, bool] | None:
    """The solid of density 1 that a mesh bounds, else its convex hull, and whether it is the hull; None where it is flat.

    A mesh bounds a solid when each edge has two triangles that go round it in opposite directions, and the volume is positive.
    """
    import numpy as np
    import trimesh
    from scipy.spatial import QhullError

    mesh = trimesh.Trimesh(part.points * np.array(scale), part.faces, process=True)
    is_hull = as_hull or not mesh.is_volume
    if is_hull:
        try:
            mesh = mesh.convex_hull
        except (QhullError, ValueError):  # no volume at all
            return None
    found = mesh.mass_properties
    if not found.mass > 0.0:
        return None
    rows = found.inertia.tolist()
    x, y, z = found.center_mass.tolist()
    return Solid(float(found.mass), (x, y, z), (rows[0][0], rows[1][1], rows[2][2], rows[0][1], rows[0][2], rows[1][2])), is_hull
