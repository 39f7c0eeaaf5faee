"""Polygons as triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def fans(sizes: NDArray[Any], corners: NDArray[Any]) -> NDArray[Any]:
    """Polygons, given by how many corners each has and all their corners, as fans of triangles (n, 3).

    Raises: ValueError when the corners are not as many as the sizes say, or a size is negative.
    """
    if sizes.size and (sizes.min() < 0 or sizes.sum() != corners.size):
        raise ValueError("another number of corners than the polygons have")
    if (sizes == 3).all():
        return corners.reshape(-1, 3)
    count = np.maximum(sizes - 2, 0)
    starts = np.repeat(np.cumsum(sizes) - sizes, count)
    step = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    return corners[np.stack([starts, starts + step + 1, starts + step + 2], axis=1)] if len(step) else corners[:0].reshape(0, 3)


def used_rows(table: NDArray[np.float64], faces: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[Any]]:
    """Triangles and the rows of a table that they are of; of a table that is much longer than their own, only those that they use."""
    if len(table) <= faces.size:
        return table, faces
    rows, index = np.unique(faces, return_inverse=True)
    return table[rows], index.reshape(faces.shape)
