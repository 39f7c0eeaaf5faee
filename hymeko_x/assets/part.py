"""What mesh files consist of: triangles, all of one look in each part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hymeko_x.ir.parts import Mesh

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Rgba

MOST_FACES = 20_000_000


class Unreadable(Exception):
    """The bytes are not the mesh that their name says; the text says why."""


@dataclass(frozen=True, slots=True)
class Look:
    """A surface as a mesh file describes it: its name there, its colour, and its image as PNG bytes."""

    name: str
    rgba: Rgba | None
    image: bytes | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The triangles of a mesh file that have one look (None = the file says nothing about it).

    ``points`` is (n, 3) in m in the frame of the file, ``faces`` (m, 3) rows of ``points``, ``uv`` (n, 2) or None.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.signedinteger[Any]]
    uv: NDArray[np.float64] | None = None
    look: Look | None = None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FilledMesh(Mesh):
    """A mesh on its way to a format that holds triangles itself, with those of its file; its own lists stay empty."""

    part: Part
