"""What mesh files consist of: triangles, all of one look in each part."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec import Struct

from hymeko_x.ir.parts import Mesh

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Rgba

MOST_FACES = 20_000_000


class Unreadable(Exception):
    """The bytes are not the mesh that their name says; the text says why."""


class Finish(NamedTuple):
    """What a mesh file says of a material: its colour, and the file of its image as it is called there."""

    rgba: Rgba | None = None
    image: str = ""


class Table(NamedTuple):
    """What a file shows in one material: points (n, 3), triangles (m, 3) as rows of them, and the material's name.

    ``uv`` are places in an image (k, 2) from its lower left corner, ``corners`` (m, 3) the rows of them; None where there are none.
    ``order`` (m) are ascending numbers by which the triangles of all tables are in the order of the file; None where they are already.
    """

    points: NDArray[np.float64]
    faces: NDArray[Any]
    material: str = ""
    finish: Finish = Finish()
    uv: NDArray[np.float64] | None = None
    corners: NDArray[Any] | None = None
    order: NDArray[np.intp] | None = None


class Look(Struct, frozen=True):
    """A surface as a mesh file describes it: its name there, its colour, and the bytes of its image with the name of its file."""

    name: str
    rgba: Rgba | None
    image: bytes | None = None
    file: str = ""


class Part(Struct, frozen=True, eq=False):
    """The triangles of a mesh file that have one look (None = the file says nothing about it).

    ``points`` is (n, 3) in m in the frame of the file, ``faces`` (m, 3) rows of ``points``, ``uv`` (k, 2) or None; ``corners``
    are the rows of ``uv`` of the triangles, None where they are those of ``points``.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.signedinteger[Any]]
    uv: NDArray[np.float64] | None = None
    look: Look | None = None
    corners: NDArray[np.signedinteger[Any]] | None = None


class Painted(NamedTuple):
    """All triangles of a mesh file, and for each look those that have it, by their rows in ``part.faces``; the others have none."""

    part: Part
    looks: tuple[tuple[Look, NDArray[np.intp]], ...] = ()


class FilledMesh(Mesh, frozen=True, eq=False, kw_only=True):
    """A mesh on its way to a format that holds triangles itself, with those of its file; its own lists stay empty."""

    part: Part
