"""Convex shapes around a mesh: its hull by scipy, or several parts by CoACD."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from typing import Any

    from hymeko_x.ir.values import Vec3
    from hymeko_x.meshes.submesh import Submesh

_CONCAVE = 1.01
"""A closed mesh is concave where its hull has more than so many times its volume."""
_SEARCH = {
    "threshold": 0.08,
    "max_convex_hull": 32,
    "preprocess_resolution": 30,
    "mcts_iterations": 40,
    "mcts_nodes": 10,
    "resolution": 500,
}
"""CoACD's search: parts at most 8 % of the size of the mesh from their hulls, found several times faster than with its defaults."""


class Convex(NamedTuple):
    """A convex mesh: points in m, flat, and the rows of them at the corners of triangles, flat; its volume in m^3."""

    vertices: tuple[float, ...]
    faces: tuple[int, ...]
    volume: float


def is_convex(part: Submesh) -> bool:
    """Whether a mesh is closed and as large as its hull; a flat one counts as convex."""
    mesh = _solid(part, (1.0, 1.0, 1.0))
    hull = hull_of(part)
    return hull is None or (bool(mesh.is_volume) and hull.volume <= _CONCAVE * float(mesh.volume))


def hull_of(part: Submesh, scale: Vec3 = (1.0, 1.0, 1.0)) -> Convex | None:
    """The convex hull of a scaled mesh; None where it is flat."""
    from scipy.spatial import QhullError

    try:
        hull = _solid(part, scale).convex_hull
    except (QhullError, ValueError):  # no volume at all
        return None
    return _convex(hull.vertices, hull.faces, float(hull.volume))


def parts_of(part: Submesh, scale: Vec3 = (1.0, 1.0, 1.0)) -> list[Convex]:
    """Convex parts that together have nearly the shape of a scaled mesh. The same mesh gives the same parts.

    Source: Wei et al., Approximate convex decomposition for 3D meshes with collision-aware concavity and tree search, SIGGRAPH 2022.
    """
    import coacd
    import trimesh

    mesh = _solid(part, scale)
    coacd.set_log_level("error")
    found = coacd.run_coacd(coacd.Mesh(mesh.vertices, mesh.faces), seed=0, **_SEARCH)
    return [_convex(points, faces, float(trimesh.Trimesh(points, faces).volume)) for points, faces in found]


def _solid(part: Submesh, scale: Vec3) -> Any:
    import numpy as np
    import trimesh

    return trimesh.Trimesh(part.points * np.array(scale), part.faces, process=True)


def _convex(points: Any, faces: Any, volume: float) -> Convex:
    """Points in single precision, which is all that mesh files have."""
    import numpy as np

    flat = np.asarray(points, dtype=np.float32).astype(float).ravel().tolist()
    return Convex(tuple(flat), tuple(np.asarray(faces, dtype=int).ravel().tolist()), volume)
