"""The triangles of plain COLLADA files, straight into arrays, and the colours that they are shown in.

Normals that are not asked for, and texture coordinates in a file without images, are not even turned into numbers, and of materials
only their colour or image counts. Whatever is not plain (skins, instances of nodes, other primitives than triangles and polygons, other
transformations than the usual ones, damage of any kind) is left to the loader for all of COLLADA, with which alone a whole
conversion of a robot with COLLADA meshes takes up to 35 % longer (`python -m benchmarks.meshes`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

import numpy as np
from lxml import etree

from hymeko_x.meshes.normals import turned_normals
from hymeko_x.meshes.numerals import numbers_in
from hymeko_x.meshes.submesh import MaterialEntry, MaterialGroup, fans, used_rows

if TYPE_CHECKING:
    from collections.abc import Mapping

    from lxml.etree import _Element as Element
    from numpy.typing import NDArray

    from hymeko_x.ir.parts import Rgba

_DEEPEST = 1000
_NEAR_ONE = 1e-5
_COMPONENTS = 3
_PASSED_OVER = frozenset({"extra", "lines", "linestrips"})
_NOT_SHOWN = frozenset({"extra", "asset", "instance_camera", "instance_light"})
_INDEX = np.int32  # as in the file format's own reader
_SINGLE = np.float32


class NotPlain(Exception):
    """The file has something that this reader leaves to others."""


def collada_groups(data: bytes, *, normals: bool = False) -> list[MaterialGroup] | None:
    """The points in m and the triangles of all that the scene of a COLLADA file shows; None where the file is not plain.

    Nodes move what is below them and the file's unit counts; its up axis does not. Numbers are read in single precision. Groups have
    ``normals`` if asked for and the file has them.
    Source: COLLADA 1.4.1, sections 5 and 6 (core elements, geometry).
    """
    try:
        return _File(_root(data), normals=normals).groups()
    except (NotPlain, ValueError, OverflowError):  # what is not a number, and numbers that are too large
        return None


def _root(data: bytes) -> Element:
    try:
        return etree.fromstring(data, etree.XMLParser(huge_tree=True, resolve_entities=False, remove_comments=True, remove_pis=True))
    except etree.XMLSyntaxError as error:
        raise NotPlain from error


@dataclass(slots=True)
class _File:
    """One file while it is read: its libraries by id, and the numbers of each geometry, which are read once."""

    root: Element
    normals: bool
    geometries: dict[str | None, list[Element]] = field(init=False)
    materials: dict[str | None, list[Element]] = field(init=False)
    effects: dict[str | None, list[Element]] = field(init=False)
    images: dict[str | None, list[Element]] = field(init=False)
    known: dict[str, list[MaterialGroup]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.geometries = _by_id(self.root, "{*}library_geometries/{*}geometry")
        self.materials = _by_id(self.root, "{*}library_materials/{*}material")
        self.effects = _by_id(self.root, "{*}library_effects/{*}effect")
        self.images = _by_id(self.root, "{*}library_images/{*}image")

    def groups(self) -> list[MaterialGroup]:
        metres = self._metres()
        found = []
        for shown, matrix in _shown(self._scene()):
            given = _given_materials(shown)
            groups = self._geometry(_reference(shown.get("url")))
            found += [self._coloured(_placed(group, matrix, metres), given) for group in groups]
        return found

    def _coloured(self, group: MaterialGroup, given: dict[str | None, Element]) -> MaterialGroup:
        """With the material that an instance of a geometry gives to the name that a primitive has for it."""
        if group.material not in given:
            return group._replace(material="", uv=None, corners=None)
        name = _reference(given[group.material].get("target"))
        entry = self._entry(name)
        if group.uv is None or not entry.image:
            return group._replace(material=name, entry=entry._replace(image=""), uv=None, corners=None)
        return group._replace(material=name, entry=entry)

    def _entry(self, name: str) -> MaterialEntry:
        """The diffuse colour or image of a material."""
        effect = self.materials[name][-1].find("{*}instance_effect") if name in self.materials else None
        wanted = "" if effect is None else _reference(effect.get("url"))
        if wanted not in self.effects:
            return MaterialEntry()
        profile = self.effects[wanted][0].find("{*}profile_COMMON")
        diffuse = None if profile is None else profile.find("{*}technique/*/{*}diffuse")
        if profile is None or diffuse is None:
            return MaterialEntry()
        colour, texture = diffuse.find("{*}color"), diffuse.find("{*}texture")
        rgba = None if colour is None else _rgba(_numbers(colour, np.float64).tolist())
        return MaterialEntry(rgba, "" if texture is None else self._image(profile, texture.get("texture", "")))

    def _image(self, profile: Element, name: str) -> str:
        """The file that a sampler, or a careless exporter at once, means; empty where there is none."""
        parameters = {item.get("sid"): item for item in profile.iterfind("{*}newparam")}
        for path in ("{*}sampler2D/{*}source", "{*}surface/{*}init_from"):
            found = parameters[name].find(path) if name in parameters else None
            name = name if found is None else (found.text or "").strip()
        values = self.images[name][0].find("{*}init_from") if name in self.images else None
        return "" if values is None else unquote((values.text or "").strip().removeprefix("file://"))

    def _metres(self) -> float:
        unit = self.root.find("{*}asset/{*}unit")
        metres = 1.0 if unit is None else float(unit.get("meter", "1"))
        return 1.0 if abs(metres - 1.0) <= _NEAR_ONE else metres

    def _scene(self) -> Element:
        shown = self.root.find("{*}scene/{*}instance_visual_scene")
        wanted = _reference(shown.get("url") if shown is not None else None)
        return _only([scene for scene in self.root.iterfind("{*}library_visual_scenes/{*}visual_scene") if scene.get("id") == wanted])

    def _geometry(self, name: str) -> list[MaterialGroup]:
        if name not in self.known:
            mesh = _only(_only(self.geometries.get(name, [])).findall("{*}mesh"))
            self.known[name] = _mesh_tables(mesh, has_images=bool(self.images), normals=self.normals)
        return self.known[name]


def _by_id(root: Element, path: str) -> dict[str | None, list[Element]]:
    """The elements of a library by id, which damaged files give twice."""
    found: dict[str | None, list[Element]] = {}
    for item in root.iterfind(path):
        found.setdefault(item.get("id"), []).append(item)
    return found


def _given_materials(shown: Element) -> dict[str | None, Element]:
    """What an instance of a geometry gives to each name of a material, the first one where there are several."""
    found: dict[str | None, Element] = {}
    for item in shown.iterfind("{*}bind_material/{*}technique_common/{*}instance_material"):
        found.setdefault(item.get("symbol"), item)
    return found


# ---- scene -------------------------------------------------------------------------------------------------------------------


def _shown(scene: Element) -> list[tuple[Element, NDArray[np.float64]]]:
    """Every instance of a geometry in a scene, in its order, with where it is."""
    found: list[tuple[Element, NDArray[np.float64]]] = []
    waiting = [(node, np.eye(4), 0) for node in reversed(scene.findall("{*}node"))]
    while waiting:
        element, matrix, depth = waiting.pop()
        if _tag(element) == "instance_geometry":
            found.append((element, matrix))
            continue
        if depth > _DEEPEST:
            raise NotPlain
        moved, below = _moved(element, matrix)
        waiting += [(child, moved, depth + 1) for child in reversed(below)]
    return found


def _moved(node: Element, matrix: NDArray[np.float64]) -> tuple[NDArray[np.float64], list[Element]]:
    """Where the content of a node is, and its content."""
    own = np.eye(4, dtype=_SINGLE)
    below = []
    for child in node:
        tag = _tag(child)
        if tag in ("node", "instance_geometry"):
            below.append(child)
        elif tag in _MOVES:
            own = own @ _MOVES[tag](_numbers(child, _SINGLE))
        elif tag not in _NOT_SHOWN:
            raise NotPlain
    return matrix @ own, below


def _matrix(values: NDArray[Any]) -> NDArray[Any]:
    return values.reshape(4, 4)


def _translation(values: NDArray[Any]) -> NDArray[Any]:
    matrix = np.eye(4, dtype=_SINGLE)
    matrix[:3, 3] = values.reshape(3)
    return matrix


def _scaling(values: NDArray[Any]) -> NDArray[Any]:
    return np.diag([*values.reshape(3), 1.0]).astype(_SINGLE)


def _rotation(values: NDArray[Any]) -> NDArray[Any]:
    """A turn by an angle in degrees about an axis, a unit vector."""
    x, y, z, angle = values.reshape(4).astype(np.float64).tolist()
    if abs(math.hypot(x, y, z) - 1.0) > _NEAR_ONE:
        raise NotPlain
    matrix = np.eye(4, dtype=_SINGLE)
    if angle == 0.0:
        return matrix
    axis, turn = np.array([x, y, z]), math.radians(angle)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix[:3, :3] = math.cos(turn) * np.eye(3) + math.sin(turn) * across + (1.0 - math.cos(turn)) * np.outer(axis, axis)
    return matrix


_MOVES = {"matrix": _matrix, "translate": _translation, "scale": _scaling, "rotate": _rotation}


def _placed(group: MaterialGroup, matrix: NDArray[np.float64], metres: float) -> MaterialGroup:
    """The triangles where a node puts them, in m; a mirror turns them around, so that they still face outwards."""
    points = group.points
    if not np.array_equal(matrix, np.eye(4)):
        points = points @ matrix[:3, :3].T + matrix[:3, 3]
    if group.normals is not None:
        normals = turned_normals(group.normals, matrix[:3, :3])
        group = group._replace(normals=normals, normal_corners=None if normals is None else group.normal_corners)
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        rows = {name: getattr(group, name) for name in ("faces", "corners", "normal_corners")}
        group = group._replace(**{name: found[:, ::-1] for name, found in rows.items() if found is not None})
    return group._replace(points=points * metres)


# ---- geometry ----------------------------------------------------------------------------------------------------------------


def _mesh_tables(mesh: Element, *, has_images: bool, normals: bool) -> list[MaterialGroup]:
    """One group for each primitive; with texture coordinates only where there are images."""
    sources = {f"#{child.get('id')}": child for child in mesh if _tag(child) in ("source", "vertices")}
    known: dict[str, NDArray[np.float64]] = {}
    found = []
    for child in mesh:
        tag = _tag(child)
        if tag in ("triangles", "polylist"):
            name, rows = _input(child, "VERTEX"), _index(child)
            if name not in known:
                known[name] = _points(sources.get(name), sources)
            faces = _triangles(child, rows["VERTEX"], known[name])
            group = MaterialGroup(*used_rows(known[name], faces), child.get("material", ""))
            if has_images and "TEXCOORD" in rows:
                group = _with_places(group, child, rows["TEXCOORD"], sources, known)
            found.append(_with_normals(group, child, rows, sources, known) if normals else group)
        elif tag not in ("source", "vertices") and tag not in _PASSED_OVER:
            raise NotPlain
    return found


def _with_places(
    group: MaterialGroup, primitive: Element, rows: NDArray[Any], sources: Mapping[str, Element], known: dict[str, NDArray[np.float64]]
) -> MaterialGroup:
    """With the first texture coordinates of the corners, of which ``rows`` are the numbers."""
    name = _source_name(primitive, "TEXCOORD")
    if name not in sources:
        return group
    if name not in known:
        known[name] = _floats(sources[name], (2, 3))[:, :2]
    return group._replace(uv=known[name], corners=_triangles(primitive, rows, known[name]))


def _with_normals(
    group: MaterialGroup,
    primitive: Element,
    rows: Mapping[str, NDArray[Any]],
    sources: Mapping[str, Element],
    known: dict[str, NDArray[np.float64]],
) -> MaterialGroup:
    """With the normals of the corners, which may be those of its points; without where they do not fit: any viewer computes some."""
    name, own = _source_name(primitive, "NORMAL"), "NORMAL"
    if not name:
        name, own = _source_name(sources[_input(primitive, "VERTEX")], "NORMAL"), "VERTEX"
    if name not in sources or own not in rows:
        return group
    try:
        if name not in known:
            known[name] = _floats(sources[name], (_COMPONENTS,))
        normals, corners = used_rows(known[name], _triangles(primitive, rows[own], known[name]))
    except (NotPlain, ValueError):
        return group
    return group._replace(normals=normals, normal_corners=corners)


def _triangles(primitive: Element, index: NDArray[Any], rows: NDArray[Any]) -> NDArray[Any]:
    """The triangles of a primitive as rows of an array, of which ``index`` has one for each of its corners."""
    is_cut = _tag(primitive) == "triangles"
    faces = index.reshape(-1, 3) if is_cut else fans(_numbers(_only(primitive.findall("{*}vcount")), _INDEX), index)
    if faces.size and (faces.min() < 0 or faces.max() >= len(rows)):
        raise NotPlain
    return faces


def _index(primitive: Element) -> dict[str, NDArray[Any]]:
    """For each corner of a primitive the row of its point, of its place in an image, and of its normal, as far as it has them.

    The rows of other inputs are between them.
    """
    inputs = [(int(item.get("offset", "")), item.get("semantic", "")) for item in primitive.iterfind("{*}input")]
    if [semantic for _, semantic in inputs].count("VERTEX") != 1 or min(offset for offset, _ in inputs) < 0:
        raise NotPlain
    places = {semantic: offset for offset, semantic in reversed(inputs) if semantic in ("VERTEX", "TEXCOORD", "NORMAL")}
    width = max(offset for offset, _ in inputs) + 1
    lists = [_numbers(item, np.int64).reshape(-1, width)[:, list(places.values())] for item in primitive.iterfind("{*}p")]
    rows = np.concatenate(lists) if lists else np.zeros((0, len(places)), dtype=np.int64)
    if rows.size and rows.max() > np.iinfo(_INDEX).max:
        raise NotPlain
    return dict(zip(places, rows.astype(_INDEX).T, strict=True))


def _source_name(primitive: Element, semantic: str) -> str:
    """The source of the first input of a primitive that has this meaning."""
    found = [item.get("source", "") for item in primitive.iterfind("{*}input") if item.get("semantic") == semantic]
    return found[0] if found else ""


def _points(vertices: Element | None, sources: dict[str, Element]) -> NDArray[np.float64]:
    source = sources.get(_input(vertices, "POSITION")) if vertices is not None else None
    if source is None:
        raise NotPlain
    return _floats(source, (_COMPONENTS,))


def _floats(source: Element, widths: tuple[int, ...]) -> NDArray[np.float64]:
    """The rows of a source, which have one of these widths."""
    accessor = _only(source.findall("{*}technique_common/{*}accessor"))
    width = int(accessor.get("stride", "1"))
    if width not in widths or accessor.get("offset", "0") != "0" or len(accessor.findall("{*}param")) != width:
        raise NotPlain
    rows = _numbers(_only(source.findall("{*}float_array")), _SINGLE)
    if not np.isfinite(rows).all():
        raise NotPlain
    return rows.reshape(-1, width).astype(np.float64)


def _input(element: Element, semantic: str) -> str:
    return str(_only([item for item in element.iterfind("{*}input") if item.get("semantic") == semantic]).get("source", ""))


def _numbers(element: Element, kind: Any) -> NDArray[Any]:
    """The numbers of an element. Raises: ValueError where there is anything else."""
    return numbers_in(element.text or "", kind)


def _rgba(values: list[float]) -> Rgba | None:
    if len(values) not in (3, 4) or not all(0.0 <= value <= 1.0 for value in values):
        return None
    r, g, b, a = (*values, 1.0)[:4]
    return (r, g, b, a)


# ---- elements ----------------------------------------------------------------------------------------------------------------


def _tag(element: Element) -> str:
    name: str = element.tag
    return name.rpartition("}")[2]


def _reference(url: str | None) -> str:
    if url is None or not url.startswith("#"):
        raise NotPlain
    return url[1:]


def _only(found: list[Element]) -> Element:
    if len(found) != 1:
        raise NotPlain
    return found[0]
