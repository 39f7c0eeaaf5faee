"""Which mesh files and images MuJoCo refuses, and the same content in a file that it reads."""

from __future__ import annotations

from hymeko_x.formats.mjcf import MOST_STL_FACES
from hymeko_x.memory import remembered


@remembered
def refused(suffix: str, data: bytes) -> str | None:
    """Why MuJoCo refuses a file of a type that it reads; None where it does not, or the type is another one.

    Source: the loaders of MuJoCo 4.0, each case tried.
    """
    if suffix == ".png":
        from hymeko_x.meshes.png import png_fault

        fault = png_fault(data)
        return None if fault is None else f"is a PNG image that MuJoCo does not read: {fault}"
    if suffix == ".stl":
        from hymeko_x.meshes.stl import stl_faces, stl_is_exact

        if not stl_is_exact(data):
            return "is STL as text or with a wrong length; MuJoCo reads only exact binary STL"
        if stl_faces(data) > MOST_STL_FACES:
            return f"has {stl_faces(data)} triangles, and MuJoCo reads STL only up to {MOST_STL_FACES}"
    if suffix == ".obj":
        from hymeko_x.meshes.normals import lacks_normals
        from hymeko_x.meshes.polygons import MOST_CORNERS, leaves_polygons_out

        if lacks_normals(data):
            return "has normals, but not for every corner; MuJoCo reads all or none"
        if leaves_polygons_out(data):
            return f"has polygons of more than {MOST_CORNERS} corners, and MuJoCo leaves them out"
    return None


def mended(suffix: str, data: bytes) -> tuple[str, bytes]:
    """The suffix and the content of a file with the same triangles or pixels that MuJoCo reads. Raises: UnreadableImage, Unreadable."""
    if suffix == ".png":
        from hymeko_x.meshes.images import png_bytes

        return suffix, png_bytes(data)
    from hymeko_x.meshes.obj import obj_bytes
    from hymeko_x.meshes.reader import read_whole
    from hymeko_x.meshes.stl import stl_bytes

    part = read_whole(data, suffix, _nothing_beside)
    return (suffix, stl_bytes(part)) if suffix == ".stl" and len(part.faces) <= MOST_STL_FACES else (".obj", obj_bytes(part))


def _nothing_beside(name: str) -> bytes:
    raise FileNotFoundError(name)
