"""Texture coordinates of meshes: the primvar ``st``, for each corner or point, with or without indices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim

Places = tuple[tuple[float, ...], tuple[int, ...]]
"""Places in an image (flat, 2 numbers each), and their row at each corner of the triangles."""

_ST = "primvars:st"
_TYPES = ("texCoord2f[]", "float2[]")
_BY_CORNER = ("faceVarying", "vertex", "varying")
_OURS = frozenset(("typeName", "variability", "custom", "default", "interpolation"))


def read_places(prim: Prim, sizes: NDArray[Any], corners: NDArray[Any]) -> Places:
    """The places of a mesh in an image, and for each corner of its triangles the row of its place; nothing where it has none."""
    said = prim.value(_ST)
    if said is None or prim.types[_ST] not in _TYPES or prim.is_animated(_ST):
        return (), ()
    import numpy as np

    from hymeko_x.meshes.polygons import fans

    places, rows = np.asarray(said, dtype=np.float64).reshape(-1, 2), prim.value(f"{_ST}:indices")
    spread = prim.spec.attributes[_ST].GetInfo("interpolation")
    index = np.arange(len(corners)) if spread == "faceVarying" else corners
    if rows is not None:
        rows = np.asarray(rows, dtype=np.int64)
    is_broken = spread not in _BY_CORNER or (rows is not None and index.size and index.max() >= len(rows))
    if is_broken:
        return (), ()
    index = index if rows is None else rows[index]
    if not np.isfinite(places).all() or (index.size and (index.min() < 0 or index.max() >= len(places))):
        return (), ()
    return tuple(places.ravel().tolist()), tuple(fans(sizes, index).ravel().tolist())


def says_places(prim: Prim, draft: Draft) -> bool:
    """Whether a mesh says the place of each corner of its triangles as we would, so that nobody has to keep it."""
    if prim.value(_ST) is None or prim.value(f"{_ST}:indices") is None or "faceVertexCounts" not in draft.taken.get(prim.path, ()):
        return False
    specs = [prim.spec.attributes[name] for name in (_ST, f"{_ST}:indices")]
    is_plain = set(specs[0].ListInfoKeys()) <= _OURS and set(specs[1].ListInfoKeys()) <= _OURS
    if not is_plain or specs[0].GetInfo("interpolation") != "faceVarying" or prim.types[_ST] != _TYPES[0]:
        return False
    if len(prim.value(f"{_ST}:indices")) != len(prim.value("faceVertexIndices")) or any(map(prim.is_animated, (_ST, f"{_ST}:indices"))):
        return False
    draft.take(prim, _ST, f"{_ST}:indices")
    return True
