"""Mesh files of all types as trimesh reads them; the only user of that library. Nothing is loaded from a network."""

from __future__ import annotations

import io
import json
import struct
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import ParseError

import numpy as np

from hymeko_x.meshes.normals import turned_normals
from hymeko_x.meshes.obj import opacity
from hymeko_x.meshes.submesh import MOST_FACES, Appearance, Submesh, Unreadable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Rgba


def read_scene(data: bytes, suffix: str, fetch: Callable[[str], bytes], *, with_appearance: bool = True) -> list[Submesh]:
    """Every geometry of the file at the pose of its node, in m; with its normals, and its appearance if wanted."""
    import trimesh

    try:
        if suffix == ".dae":
            return _collada_parts(data, fetch, with_appearance=with_appearance)
        if suffix in GLTF:
            check_accessors(data, suffix)
        scene = trimesh.load_scene(io.BytesIO(data), suffix[1:], resolver=_resolver(fetch), process=False)
        placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
        return [
            part
            for matrix, name in placed
            for part in _placed_part(scene.geometry[name], matrix, _file_normals(scene.geometry[name]), with_appearance=with_appearance)
        ]
    except raised_by_loaders(suffix) as error:
        raise Unreadable(str(error).split("\n")[0][:200] or type(error).__name__) from error


GLTF = (".gltf", ".glb")
"""The types of glTF, whose triangles may be in files of their own."""
_MOST_ZEROS = 3 * MOST_FACES
"""Elements of accessors without data, for which a few letters of a glTF file ask."""


def check_accessors(data: bytes, suffix: str) -> None:
    """Raises: Unreadable when a glTF file asks for more zeros than a mesh may have corners. What is no glTF is left to trimesh."""
    text = data if suffix == ".gltf" else data[20 : 20 + int.from_bytes(data[12:16], "little")]
    try:
        header = json.loads(text)
    except (ValueError, RecursionError):
        return
    accessors = header.get("accessors") if isinstance(header, dict) else None
    bare = [found for found in accessors or () if isinstance(found, dict) and "bufferView" not in found]
    count = sum(found["count"] for found in bare if isinstance(found.get("count"), int))
    if count > _MOST_ZEROS:
        raise Unreadable(f"it has {count} elements without data, at most {_MOST_ZEROS} are read")


def _collada_parts(data: bytes, fetch: Callable[[str], bytes], *, with_appearance: bool) -> list[Submesh]:
    """The same for COLLADA, of which a scene would merge points that are close to one another, and take its time for that."""
    import trimesh
    from trimesh.exchange.dae import load_collada

    loaded = load_collada(io.BytesIO(data), resolver=_resolver(fetch))  # type: ignore[no-untyped-call]
    normals = {name: arguments.pop("vertex_normals", None) for name, arguments in loaded["geometry"].items()}
    meshes = {name: trimesh.Trimesh(**arguments, process=False, validate=False) for name, arguments in loaded["geometry"].items()}
    return [
        part
        for node in loaded["graph"]
        for name in (node["geometry"],)
        for part in _placed_part(meshes[name], node["matrix"], normals[name], with_appearance=with_appearance)
    ]


def _file_normals(mesh: Any) -> Any:
    """The normals that a file has for its points; None where trimesh would compute them."""
    return mesh.vertex_normals if "vertex_normals" in getattr(mesh, "_cache", ()) else None


def _placed_part(mesh: Any, matrix: Any, normals: Any, *, with_appearance: bool) -> Iterable[Submesh]:
    import trimesh

    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        return
    if len(mesh.faces) > MOST_FACES:
        raise Unreadable(f"it has {len(mesh.faces)} triangles, at most {MOST_FACES} are read")
    points = trimesh.transform_points(mesh.vertices, matrix) * _metres(mesh.units)
    faces = np.asarray(mesh.faces, dtype=np.int64)
    if faces.min() < 0 or faces.max() >= len(points):
        raise Unreadable("a triangle has a corner that does not exist")
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        faces = faces[:, ::-1]
    appearance, uv = _appearance_of(mesh) if with_appearance else (None, None)
    turned = None if normals is None or len(normals) != len(points) else turned_normals(normals, matrix[:3, :3])
    yield Submesh(points, faces, uv, appearance, normals=turned)


def _metres(units: str | None) -> float:
    """The length of the file's unit in m; 1 where it has none."""
    import trimesh

    return 1.0 if units is None else float(trimesh.units.unit_conversion(units, "meters"))


def _appearance_of(mesh: Any) -> tuple[Appearance | None, NDArray[np.float64] | None]:
    """The material of a geometry and its texture coordinates; colours of vertices or faces become their mean."""
    visual = mesh.visual
    if not visual.defined:
        return None, None
    if visual.kind in ("vertex", "face"):
        return Appearance("", _rgba(visual.main_color)), None
    material = visual.material
    name = str(getattr(material, "name", None) or "")
    if type(material).__name__ == "SimpleMaterial":
        return _simple_appearance(name, material, visual.uv)
    image = _bytes_of(material.baseColorTexture)
    appearance = Appearance(name, None if image else _rgba(material.main_color), image)
    return appearance, _uv(visual.uv) if image else None


def _simple_appearance(name: str, material: Any, uv: Any) -> tuple[Appearance | None, NDArray[np.float64] | None]:
    """The appearance of an OBJ material. One without colour and without a named image is what trimesh makes up itself."""
    image = _bytes_of(material.image) if material.image is not None and "file_path" in material.image.info else None
    color, alpha = material.kwargs.get("kd"), opacity(material.kwargs.get("d", ()), material.kwargs.get("tr", ()))
    rgba = (float(color[0]), float(color[1]), float(color[2]), alpha) if isinstance(color, list) and len(color) == 3 else None
    if image is None and rgba is None:
        return None, None
    return Appearance(name, None if image else rgba, image), _uv(uv) if image else None


def _uv(uv: Any) -> NDArray[np.float64] | None:
    return None if uv is None else np.asarray(uv, dtype=np.float64)[:, :2]


def _rgba(color: Any) -> Rgba | None:
    """A colour of 0..255 as 0..1, with as many digits as 8 bits are worth."""
    if color is None:
        return None
    r, g, b, a = (round(float(value) / 255.0, 4) for value in color)
    return (r, g, b, a)


def _bytes_of(image: Any) -> bytes | None:
    """The bytes of the image's file where it is PNG or JPEG and was not decoded yet, else the image encoded as PNG."""
    if image is None:
        return None
    stream = getattr(image, "fp", None)
    if image.format in ("PNG", "JPEG") and isinstance(stream, io.BytesIO):
        data = stream.getvalue()
        image.load()
        return data
    out = io.BytesIO()
    image.convert("RGBA" if "A" in image.getbands() else "RGB").save(out, "PNG", compress_level=3)
    return out.getvalue()


def _resolver(fetch: Callable[[str], bytes]) -> Any:
    """What trimesh asks for the files that a mesh refers to."""
    from trimesh.resolvers import Resolver

    class Fetching(Resolver):
        def __init__(self) -> None:
            self._found: dict[str, bytes] = {}

        def get(self, key: str) -> bytes:
            name = str(key).strip()
            if name not in self._found:
                self._found[name] = fetch(name)
            return self._found[name]

        def write(self, name: str, data: Any) -> None:
            raise OSError(f"'{name}' is not written")

        def namespaced(self, namespace: str) -> Resolver:
            del namespace
            return self

        def keys(self) -> list[str]:
            return list(self._found)

    return Fetching()


_DAMAGED = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    ImportError,
    LookupError,
    MemoryError,
    OSError,
    ParseError,
    RuntimeError,
    SyntaxError,
    TypeError,
    UnboundLocalError,
    ValueError,
    struct.error,
)
"""What the loaders behind trimesh raise on damaged files; they check little before they index."""


def raised_by_loaders(suffix: str) -> tuple[type[Exception], ...]:
    """What loading a file of this type may raise."""
    if suffix != ".dae":
        return _DAMAGED
    from collada.common import DaeError

    return (*_DAMAGED, DaeError)
