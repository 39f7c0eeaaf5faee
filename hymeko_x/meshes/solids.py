"""The volume of a mesh and how it is spread, by trimesh: exact for closed meshes, of the convex hull for open ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from hymeko_x.ir.values import Tensor, Vec3
    from hymeko_x.meshes.submesh import Submesh


class Solid(NamedTuple):
    """A volume in m^3 with its centre in m, and the tensor in m^5 about that centre of a body of density 1 (xx, yy, zz, xy, xz, yz).

    ``is_hull`` says that it is that of the convex hull.
    """

    volume: float
    centre: Vec3
    tensor: Tensor
    is_hull: bool


def solid_of(part: Submesh, scale: Vec3 = (1.0, 1.0, 1.0), *, as_hull: bool = False) -> Solid | None:
    """The solid that a mesh bounds, else its convex hull; None where it is flat.

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
    tensor = (rows[0][0], rows[1][1], rows[2][2], rows[0][1], rows[0][2], rows[1][2])
    return Solid(float(found.mass), (x, y, z), tensor, is_hull)
