"""Meshes that have no file: each is written as a Wavefront OBJ file beside the URDF file."""

from __future__ import annotations

import re
from itertools import count
from typing import TYPE_CHECKING

from hymeko_x.ir.legalize import WITHIN
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Mesh
from hymeko_x.ir.values import numbers_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.mechanism import Id, Mechanism

FOLDER = "shapes"


def files_of_meshes(mechanism: Mechanism) -> dict[Id, str]:
    """The relative path of every mesh that carries its points, made of what is harmless in its name. Equal points share a file."""
    within = mechanism.notation(ROOT, WITHIN) or ""
    found: dict[Id, str] = {}
    taken: set[str] = set()
    known: dict[tuple[tuple[float, ...], tuple[int, ...]], str] = {}
    for key, mesh in mechanism.vertices(Mesh):
        if mesh.uri is None and mesh.vertices:
            content = mesh.vertices, mesh.faces
            if content in known:
                found[key] = known[content]
                continue
            stem = re.sub(r"[^A-Za-z0-9_-]+", "_", key.name).strip("_") or "mesh"
            name = next(name for name in _numbered(stem) if name.lower() not in taken)
            taken.add(name.lower())
            found[key] = known[content] = f"{within}{FOLDER}/{name}.obj"
    return found


def _numbered(stem: str) -> Iterator[str]:
    yield stem
    yield from (f"{stem}_{number}" for number in count(2))


def obj_text(mesh: Mesh) -> bytes:
    """The points and faces of a mesh, unscaled, as Wavefront OBJ."""
    points = [f"v {numbers_text(mesh.vertices[at : at + 3])}" for at in range(0, len(mesh.vertices), 3)]
    corners = [str(corner + 1) for corner in mesh.faces]
    faces = [f"f {' '.join(corners[at : at + 3])}" for at in range(0, len(corners), 3)]
    lines = [*points, *faces, ""]
    return "\n".join(lines).encode()
