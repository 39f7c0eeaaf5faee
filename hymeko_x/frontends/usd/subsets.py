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
    counts = np.maximum(sizes - 2, 0)
    starts, is_plain = np.cumsum(counts) - counts, bool((sizes == 3).all())
    free = np.ones(len(sizes), dtype=bool)
    for prim in found:
        faces = np.asarray(prim.value("indices"), dtype=np.int64)
        why = _broken(faces, free)
        if why is not None:
            said = f"subset '{prim.path}' {why}; it is kept as written"
            draft.report.warn(codes.ASSET_UNREADABLE, said, draft.origin, element=prim.path)
            continue
        free[faces] = False
        ordered = np.sort(faces)
        triangles = ordered if is_plain else _triangles(counts[ordered], starts[ordered])
        _add_subset(prim, triangles, shape, draft, is_ours=is_plain and np.array_equal(ordered, faces))
    if mesh.value(words.FAMILY) == words.APART and not free.all():
        draft.take(mesh, words.FAMILY)


def _is_bound(prim: Prim, draft: Draft) -> bool:
    """Whether a prim says of some faces that they show a material that was read."""
    if prim.kind != "GeomSubset" or not prim.is_real or prim.value("familyName") != words.LOOKS:
        return False
    if not prim.value("indices"):
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


def _triangles(counts: NDArray[Any], starts: NDArray[Any]) -> NDArray[Any]:
    """The triangles of polygons, given by how many each has and the number of its first one."""
    import numpy as np

    before = np.cumsum(counts) - counts
    return np.repeat(starts - before, counts) + np.arange(int(counts.sum()))


def _add_subset(prim: Prim, triangles: NDArray[Any], shape: Id, draft: Draft, *, is_ours: bool) -> None:
    """The edge of a subset. Where its faces are no triangles, or in an order of the author's own, they stay beside it as well."""
    material = bound_material(prim, draft) if len(triangles) else None
    if material is None:
        return
    draft.take(prim, "@type", "familyName", "elementType", *(["indices"] if is_ours else []))
    draft.edges[draft.own(prim, "subset")] = subset_edge(tuple(triangles.tolist()), shape, material)
