"""Subsets of meshes: faces that are bound to a material of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.bindings import bound_to
from hymeko_x.frontends.usd.materials import bound_material
from hymeko_x.frontends.usd.prims import BINDING
from hymeko_x.ir.mechanism import subset_edge

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id


def read_subsets(mesh: Prim, shape: Id, draft: Draft) -> None:
    """Add the faces of a mesh that show a material which we know. What is no such subset, or is broken, stays an extra."""
    found = [prim for prim in mesh.children if _is_bound(prim, draft)]
    if not found:
        return
    import numpy as np

    sizes = np.asarray(mesh.value("faceVertexCounts"), dtype=np.int64)
    free = np.ones(len(sizes), dtype=bool)
    for prim in found:
        faces = np.asarray(prim.value("indices"), dtype=np.int64)
        why = _broken(faces, free)
        if why is not None:
            said = f"subset '{prim.path}' {why}; it is kept as written"
            draft.report.warn(codes.ASSET_UNREADABLE, said, draft.origin, element=prim.path)
            continue
        free[faces] = False
        _add_subset(prim, faces, sizes, shape, draft)
    if mesh.value(words.FAMILY) == words.APART and not free.all():
        draft.take(mesh, words.FAMILY)


def _is_bound(prim: Prim, draft: Draft) -> bool:
    """Whether a prim says of some faces that they show a material that was read."""
    if prim.kind != "GeomSubset" or not prim.is_real or prim.value("familyName") != words.LOOKS or not prim.value("indices"):
        return False
    if prim.value("elementType") not in (None, words.FACE) or any(map(prim.is_animated, ("indices", "elementType", "familyName"))):
        return False
    targets, bound = prim.targets(BINDING), bound_to(prim, draft.scene)
    return bound is not None and targets == [bound.path] and bound.path in draft.materials


def _broken(faces: NDArray[Any], free: NDArray[Any]) -> str | None:
    import numpy as np

    if faces.min() < 0 or faces.max() >= len(free):
        return "has a face that the mesh does not have"
    return None if free[faces].all() and len(np.unique(faces)) == len(faces) else "has a face that shows a material already"


def _add_subset(prim: Prim, faces: NDArray[Any], sizes: NDArray[Any], shape: Id, draft: Draft) -> None:
    """The edge of a subset, in triangles; polygons, and an order of the author's own, stay beside it."""
    import numpy as np

    is_shown = np.zeros(len(sizes), dtype=bool)
    is_shown[faces] = True
    triangles = np.flatnonzero(np.repeat(is_shown, np.maximum(sizes - 2, 0)))
    material = bound_material(prim, draft) if len(triangles) else None
    if material is None:
        return
    draft.take(prim, "@type", "familyName", "elementType")
    if (sizes == 3).all() and np.array_equal(triangles, faces):
        draft.take(prim, "indices")
    draft.edges[draft.own(prim, "subset")] = subset_edge(tuple(triangles.tolist()), shape, material)
