"""Mesh files: reading any type that robots use, and writing the two that every engine reads (binary STL and OBJ).

The only place that knows trimesh. Nothing is loaded from a network, and sizes are checked before anything is allocated.
"""

from __future__ import annotations

import io
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import ParseError

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Rgba
    from hymeko_x.ir.values import Vec3

READABLE = (".stl", ".obj", ".dae", ".glb", ".gltf", ".ply", ".off")
"""The types of mesh files that can be read, by suffix."""
_IN_SEVERAL_FILES = (".gltf", ".glb")
"""Types whose triangles may stand in files of their own."""

MOST_BYTES = 2**28
MOST_FACES = 20_000_000
_STL_HEADER = 80
_STL_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])


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
    faces: NDArray[np.int64]
    uv: NDArray[np.float64] | None = None
    look: Look | None = None


# ---- reading ---------------------------------------------------------------------------------------------------------------


def read_parts(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> tuple[Part, ...]:
    """The parts of a mesh file, one per look, in the order of the file.

    Node transformations and the file's unit are applied. The up axis of a COLLADA file is not, as in RViz and Gazebo:
    robot descriptions are written for readers that ignore it. ``fetch`` returns the content of a file that the mesh refers
    to, by the name it uses, or raises OSError.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix == ".stl":
        return (_welded(read_stl(data), None),)
    groups = _by_look(_loaded(data, suffix, fetch))
    return sound(tuple(_welded(*_corners(group), group[0].look) for group in groups))


def check_file(data: bytes, suffix: str) -> None:
    """Raises: Unreadable for what is too large, of a type that is not read, or made to do harm."""
    if len(data) > MOST_BYTES:
        raise Unreadable(f"it has {len(data)} bytes, at most {MOST_BYTES} are read")
    if suffix not in READABLE:
        raise Unreadable(f"meshes of type '{suffix}' are not read; known: {', '.join(READABLE)}")
    if suffix == ".dae":
        _check_collada(data)


def sound(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """The parts, if there are any and every coordinate is a number."""
    if not parts:
        raise Unreadable("it has no triangles")
    if not all(np.isfinite(part.points).all() for part in parts):
        raise Unreadable("a coordinate is not a finite number")
    return parts


def read_stl(data: bytes) -> NDArray[np.float64]:
    """The corners of the triangles of an STL file, binary or text, as (faces, 3, 3) in its own unit.

    Raises: Unreadable.
    """
    corners = _binary_corners(data) if not _is_text_stl(data) else _text_corners(data)
    if len(corners) == 0:
        raise Unreadable("it has no triangles")
    if not np.isfinite(corners).all():
        raise Unreadable("a coordinate is not a finite number")
    return corners


def stl_is_exact(data: bytes) -> bool:
    """Whether the bytes are a binary STL file whose length is what its header says."""
    return len(data) > _STL_HEADER + 4 and len(data) == _STL_HEADER + 4 + stl_faces(data) * _STL_FACE.itemsize


def stl_faces(data: bytes) -> int:
    """The number of triangles in the header of a binary STL file."""
    (count,) = struct.unpack_from("<I", data, _STL_HEADER)
    return int(count)


def _is_text_stl(data: bytes) -> bool:
    """Text begins with ``solid``, but so do some binary files: those have the length that their header says."""
    return data[:80].lstrip().lower().startswith(b"solid") and not stl_is_exact(data) and b"facet" in data[:4096].lower()


def _binary_corners(data: bytes) -> NDArray[np.float64]:
    if len(data) < _STL_HEADER + 4:
        raise Unreadable(f"it has {len(data)} bytes, and an STL file has at least {_STL_HEADER + 4}")
    count, room = stl_faces(data), (len(data) - _STL_HEADER - 4) // _STL_FACE.itemsize
    if count > room:
        raise Unreadable(f"its header promises {count} triangles, and there is room for {room}")
    faces = np.frombuffer(data, _STL_FACE, count, _STL_HEADER + 4)
    return faces["corners"].astype(np.float64)


def _text_corners(data: bytes) -> NDArray[np.float64]:
    rows = [line.split()[1:4] for line in data.splitlines() if line.lstrip()[:7].lower() == b"vertex "]
    try:
        values = np.array(rows, dtype=np.float64)
    except ValueError as error:
        raise Unreadable(f"a vertex is not three numbers ({error})") from error
    if values.size % 9:
        raise Unreadable("the number of its vertices is not a multiple of three")
    return values.reshape(-1, 3, 3)


# ---- reading with trimesh ----------------------------------------------------------------------------------------------------


def _loaded(data: bytes, suffix: str, fetch: Callable[[str], bytes], *, looks: bool = True) -> list[Part]:
    """Every geometry of the file where its node puts it, in m; with its look, if that matters."""
    import trimesh

    try:
        if suffix == ".dae":
            return _collada_parts(data, fetch, looks=looks)
        scene = trimesh.load_scene(io.BytesIO(data), suffix[1:], resolver=_resolver(fetch), process=False)
        placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
        return [part for matrix, name in placed for part in _placed_part(scene.geometry[name], matrix, looks=looks)]
    except _raised_by_loaders(suffix) as error:
        raise Unreadable(str(error).split("\n")[0][:200] or type(error).__name__) from error


def _collada_parts(data: bytes, fetch: Callable[[str], bytes], *, looks: bool) -> list[Part]:
    """The same for COLLADA, of which a scene would merge points that are close to one another, and take its time for that."""
    import trimesh
    from trimesh.exchange.dae import load_collada

    loaded = load_collada(io.BytesIO(data), resolver=_resolver(fetch))  # type: ignore[no-untyped-call]
    meshes = {
        name: trimesh.Trimesh(**{**said, "vertex_normals": None}, process=False, validate=False)
        for name, said in loaded["geometry"].items()
    }
    return [part for node in loaded["graph"] for part in _placed_part(meshes[node["geometry"]], node["matrix"], looks=looks)]


def _check_collada(data: bytes) -> None:
    """Entities would be expanded, and an archive unpacked to any size."""
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise Unreadable("it declares XML entities, which are not expanded")
    if b"PK\x05\x06" in data[-70_000:]:
        raise Unreadable("it is a ZIP archive, which is not unpacked")


def _placed_part(mesh: Any, matrix: Any, *, looks: bool) -> Iterable[Part]:
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
    look, uv = _look_of(mesh) if looks else (None, None)
    yield Part(points, faces, uv, look)


def _metres(units: str | None) -> float:
    """The length of the file's unit in m; 1 where it says nothing."""
    import trimesh

    return 1.0 if units is None else float(trimesh.units.unit_conversion(units, "meters"))


def _look_of(mesh: Any) -> tuple[Look | None, NDArray[np.float64] | None]:
    """The material of a geometry and its texture coordinates; colours of vertices or faces become their mean."""
    visual = mesh.visual
    if not visual.defined:
        return None, None
    if visual.kind in ("vertex", "face"):
        return Look("", _rgba(visual.main_color)), None
    material = visual.material
    name = str(getattr(material, "name", None) or "")
    if type(material).__name__ == "SimpleMaterial":
        return _simple_look(name, material, visual.uv)
    image = _png(material.baseColorTexture)
    look = Look(name, None if image else _rgba(material.main_color), image)
    return look, _uv(visual.uv) if image else None


def _simple_look(name: str, material: Any, uv: Any) -> tuple[Look | None, NDArray[np.float64] | None]:
    """The look of an OBJ material. One without colour and without a named image is what trimesh makes up itself."""
    image = _png(material.image) if material.image is not None and "file_path" in material.image.info else None
    color = material.kwargs.get("kd")
    rgba = (float(color[0]), float(color[1]), float(color[2]), 1.0) if isinstance(color, list) and len(color) == 3 else None
    if image is None and rgba is None:
        return None, None
    return Look(name, None if image else rgba, image), _uv(uv) if image else None


def _uv(uv: Any) -> NDArray[np.float64] | None:
    return None if uv is None else np.asarray(uv, dtype=np.float64)[:, :2]


def _rgba(color: Any) -> Rgba | None:
    """A colour of 0..255 as 0..1, with as many digits as 8 bits are worth."""
    if color is None:
        return None
    r, g, b, a = (round(float(value) / 255.0, 4) for value in color)
    return (r, g, b, a)


def _png(image: Any) -> bytes | None:
    """The image as PNG bytes: those of the file where it is PNG and was not decoded yet, else encoded anew."""
    if image is None:
        return None
    stream = getattr(image, "fp", None)
    if image.format == "PNG" and isinstance(stream, io.BytesIO):
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
    ValueError,
    struct.error,
)
"""What the loaders behind trimesh raise on damaged files; they check little before they index."""


def _raised_by_loaders(suffix: str) -> tuple[type[Exception], ...]:
    if suffix != ".dae":
        return _DAMAGED
    from collada.common import DaeError

    return (*_DAMAGED, DaeError)


# ---- parts -------------------------------------------------------------------------------------------------------------------


def _by_look(parts: list[Part]) -> list[list[Part]]:
    """The parts that have the same look, in the order of their first appearance."""
    groups: dict[Look | None, list[Part]] = {}
    for part in parts:
        groups.setdefault(part.look, []).append(part)
    return list(groups.values())


def _corners(group: list[Part]) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """The corners (faces, 3, 3) of all triangles of the parts, and their texture coordinates where all have some."""
    corners = np.concatenate([part.points[part.faces] for part in group])
    maps = [part.uv[part.faces] for part in group if part.uv is not None]
    return corners, np.concatenate(maps) if len(maps) == len(group) else None


def _welded(corners: NDArray[np.float64], uv: NDArray[np.float64] | None, look: Look | None = None) -> Part:
    """Triangles with their common points shared; triangles with two equal corners are left out."""
    flat = corners.reshape(-1, 3)
    rows = flat if uv is None else np.hstack([flat, uv.reshape(-1, 2)])
    unique, index = _unique_rows(rows)
    return Part(unique[:, :3], _without_degenerate(index.reshape(-1, 3)), unique[:, 3:] if uv is not None else None, look)


def _without_degenerate(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """The triangles with three different corners."""
    first, second, third = faces.T
    return np.asarray(faces[(first != second) & (second != third) & (third != first)])


def _unique_rows(rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The different rows in lexical order, and for each given row its place there.

    Equal rows are brought together by one key for each, so that only the different ones, which are few, are sorted column by column.
    """
    rows = np.ascontiguousarray(rows + 0.0)  # so that the zeros of both signs are the same
    keys = _keys(rows)
    order = np.argsort(keys)
    keys = keys[order]
    starts = np.ones(len(rows), dtype=bool)
    starts[1:] = keys[1:] != keys[:-1]
    unique = rows[order[starts]]
    second = np.lexsort(unique.T[::-1])
    places = np.empty(len(unique), dtype=np.int64)
    places[second] = np.arange(len(unique))
    index = np.empty(len(rows), dtype=np.int64)
    index[order] = places[np.cumsum(starts) - 1]
    unique = unique[second]
    if not np.array_equal(unique[index], rows):  # different rows with one key, or not a number
        return _sorted_rows(rows)
    return unique, index


def _keys(rows: NDArray[np.float64]) -> NDArray[np.uint64]:
    """A number for each row that is the same for equal rows, and hardly ever for others."""
    keys = np.zeros(len(rows), dtype=np.uint64)
    for column in rows.view(np.uint64).T:
        keys = (keys ^ column ^ (column >> np.uint64(31))) * np.uint64(0x9E3779B97F4A7C15)
        keys ^= keys >> np.uint64(32)
    return keys


def _sorted_rows(rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The same by sorting all rows."""
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    starts = np.ones(len(rows), dtype=bool)
    starts[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    index = np.empty(len(rows), dtype=np.int64)
    index[order] = np.cumsum(starts) - 1
    return ordered[starts], index


def inline_part(points: tuple[float, ...], faces: tuple[int, ...]) -> Part:
    """The triangles of a mesh that is given by flat lists; without faces, those of its convex hull are not computed.

    Raises: Unreadable.
    """
    table = np.array(points[: len(points) // 3 * 3], dtype=np.float64).reshape(-1, 3)
    index = np.array(faces[: len(faces) // 3 * 3], dtype=np.int64).reshape(-1, 3)
    if len(table) == 0:
        raise Unreadable("it has no points")
    if len(index) and (index.min() < 0 or index.max() >= len(table)):
        raise Unreadable("a triangle has a corner that does not exist")
    if not np.isfinite(table).all():
        raise Unreadable("a coordinate is not a finite number")
    return Part(table, index)


def read_whole(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> Part:
    """All triangles of a mesh file as one part without a look, in the order of the file; no image is opened for that.

    Raises: Unreadable.
    """
    check_file(data, suffix)
    if suffix == ".stl":
        return _welded(read_stl(data), None)
    tables = _plain_tables(data, suffix)
    if tables is None:
        parts = _loaded(data, suffix, fetch if suffix in _IN_SEVERAL_FILES else _nothing_beside, looks=False)
        tables = [(part.points, part.faces) for part in parts]
    return sound((put_together(tables),))[0]


def put_together(tables: list[tuple[NDArray[np.float64], NDArray[Any]]]) -> Part:
    """Points and triangles of several meshes as one; common points are shared, and those of no triangle are left out.

    Raises: Unreadable when there is no triangle, or there are too many.
    """
    if not any(len(faces) for _, faces in tables):
        raise Unreadable("it has no triangles")
    starts = np.cumsum([0, *(len(points) for points, _ in tables)])
    points = np.concatenate([points for points, _ in tables])
    faces = np.concatenate([rows.astype(np.int64) + start for (_, rows), start in zip(tables, starts[:-1], strict=True)])
    if len(faces) > MOST_FACES:
        raise Unreadable(f"it has {len(faces)} triangles, at most {MOST_FACES} are read")
    used = np.zeros(len(points), dtype=bool)
    used[faces] = True
    unique, index = _unique_rows(points[used])
    places = np.zeros(len(points), dtype=np.int64)
    places[used] = index
    return Part(unique, _without_degenerate(places[faces]))


def _plain_tables(data: bytes, suffix: str) -> list[tuple[NDArray[np.float64], NDArray[Any]]] | None:
    """Points and triangles of the two text formats that most robots use, where nothing about them is unusual."""
    if suffix == ".dae":
        from hymeko_x.assets.collada import collada_tables

        return [(table.points, table.faces) for table in collada_tables(data) or ()] or None
    if suffix == ".obj":
        from hymeko_x.assets.obj import obj_table

        table = obj_table(data)
        return None if table is None else [table]
    return None


def _nothing_beside(name: str) -> bytes:
    """What a mesh refers to, where only its triangles matter."""
    raise FileNotFoundError(name)


def merged(parts: tuple[Part, ...]) -> Part:
    """All triangles as one part without a look."""
    if len(parts) == 1:
        return parts[0]
    return _welded(np.concatenate([part.points[part.faces] for part in parts]), None)


def face_normals(points: NDArray[np.float32], corners: NDArray[Any]) -> NDArray[np.float32]:
    """The unit normal of each triangle (n x 3, single precision), by the right hand; z where a triangle has none.

    ``points`` is (m, 3), ``corners`` the rows of ``points`` of all triangles, flat.
    """
    first, second, third = (points[corners[corner::3]].astype(np.float64) for corner in range(3))
    (ax, ay, az), (bx, by, bz) = (second - first).T, (third - first).T
    normals = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)
    lengths = np.sqrt(np.einsum("ij,ij->i", normals, normals))
    flat = ~(lengths > 0.0)
    normals[flat], lengths[flat] = (0.0, 0.0, 1.0), 1.0
    return np.asarray(normals / lengths[:, None], dtype=np.float32)


# ---- measures ------------------------------------------------------------------------------------------------------------------


def volume_of_sheets(part: Part) -> float:
    """The sum of the volumes of the pyramids from the mean point to all triangles, in m^3; zero for a flat mesh.

    Source: MuJoCo's volume of a mesh with ``inertia="legacy"``.
    """
    a, b, c = (part.points[part.faces[:, corner]] - part.points.mean(axis=0) for corner in range(3))
    return float(np.abs(np.einsum("ij,ij->i", a, np.cross(b, c))).sum() / 6.0)


def extents(part: Part) -> Vec3:
    """The lengths in m of the box along the principal axes of the points, ascending."""
    centred = part.points - part.points.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    low, middle, high = sorted(np.ptp(centred @ axes, axis=0).tolist())
    return (low, middle, high)


def thickened(part: Part, share: float) -> Part:
    """A flat part as a thin solid: a second layer lies below the first one, ``share`` of the largest extent away."""
    centred = part.points - part.points.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    below = part.points - axes[:, 0] * share * np.ptp(centred @ axes, axis=0).max()
    faces = np.concatenate([part.faces, part.faces[:, ::-1] + len(part.points)])
    uv = None if part.uv is None else np.concatenate([part.uv, part.uv])
    return Part(np.concatenate([part.points, below]), faces, uv, part.look)


# ---- writing -------------------------------------------------------------------------------------------------------------------


def obj_bytes(part: Part) -> bytes:
    """The part as a Wavefront OBJ file: points to float32 precision, texture coordinates, triangles."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in (part.points + 0.0).tolist()]
    if part.uv is not None:
        lines += [f"vt {u:.7g} {v:.7g}" for u, v in (part.uv + 0.0).tolist()]
        lines += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in (part.faces + 1).tolist()]
    else:
        lines += [f"f {a} {b} {c}" for a, b, c in (part.faces + 1).tolist()]
    return ("\n".join(lines) + "\n").encode()


def stl_bytes(part: Part) -> bytes:
    """The part as a binary STL file; its normals are computed."""
    corners = part.points[part.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    faces = np.zeros(len(corners), _STL_FACE)
    faces["corners"] = corners
    faces["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    return b"binary STL".ljust(_STL_HEADER) + struct.pack("<I", len(faces)) + faces.tobytes()
