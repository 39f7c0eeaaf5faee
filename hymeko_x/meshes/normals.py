"""Normals of mesh files: turned with their triangles, and those of OBJ files, of which MuJoCo refuses some and not all."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.meshes.tables import faces_of_first_object

if TYPE_CHECKING:
    from numpy.typing import NDArray

_INCOMPLETE = re.compile(rb"^[ \t]*f(?:[ \t]+-?\d+/-?\d*/-?\d+)*[ \t]+(?!-?\d+/-?\d*/-?\d+(?:\s|\Z))[^\s#]", re.MULTILINE)
_NUMBER = re.compile(rb"/(-?\d+)(?=[ \t\r\n]|\Z)")


def turned_normals(normals: NDArray[Any], matrix: NDArray[Any]) -> NDArray[np.float64] | None:
    """Normals (n, 3) of points that a matrix (3, 3) moves, as unit vectors; None where one has no direction."""
    with np.errstate(all="ignore"):
        try:
            turned = np.asarray(normals, dtype=np.float64) @ np.linalg.inv(np.asarray(matrix, dtype=np.float64))
        except np.linalg.LinAlgError:
            return None
        lengths = np.linalg.norm(turned, axis=1, keepdims=True)
        is_sound = bool(np.isfinite(lengths).all() and (lengths > 0.0).all())
        return np.asarray(turned / lengths) if is_sound else None


def lacks_normals(data: bytes) -> bool:
    """Whether an OBJ file has normals, and a corner of its first object has none of them: MuJoCo refuses the model."""
    count = data.count(b"\nvn") + data.startswith(b"vn")
    if not count or not _lacks(data, count):
        return False
    return _lacks(b"\n".join(b"f " + row for row in faces_of_first_object(data)), count)


def _lacks(data: bytes, count: int) -> bool:
    """Whether a corner has no number of a normal, or one that the file does not have."""
    return bool(_INCOMPLETE.search(data)) or any(not 0 < abs(int(number)) <= count for number in {*_NUMBER.findall(data)})
