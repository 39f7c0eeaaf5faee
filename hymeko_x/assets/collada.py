"""The triangles of plain COLLADA files, straight into arrays, and the colours that they are shown in.

Normals and texture coordinates, most of the text of such a file, are not even turned into numbers, and of materials only their
colour counts. Whatever is not plain (skins, instances of nodes, other primitives than triangles and polygons, other
transformations than the usual ones, damage of any kind) is left to the loader that knows all of COLLADA.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from lxml import etree

from hymeko_x.assets.numerals import numbers_in
from hymeko_x.assets.polygons import fans

if TYPE_CHECKING:
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


class Table(NamedTuple):
    """A primitive: points (n, 3), triangles (m, 3) as rows of them, and the name and colour of its material, if it has any."""

    points: NDArray[np.float64]
    faces: NDArray[Any]
    material: str = ""
    rgba: Rgba | None = None


class NotPlain(Exception):
    """The file has something that this reader leaves to others."""


def collada_tables(data: bytes) -> list[Table] | None:
    """The points in m and the triangles of all that the scene of a COLLADA file shows; None where the file is not plain.

    Nodes move what is below them and the file's unit counts; its up axis does not. Numbers are read in single precision.
    Source: COLLADA 1.4.1, sections 5 and 6 (core elements, geometry).
    """
    try:
        return _File(_root(data)).tables()
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
    geometries: dict[str | None, list[Element]] = field(init=False)
    materials: dict[str | None, list[Element]] = field(init=False)
    effects: dict[str | None, list[Element]] = field(init=False)
    known: dict[str, list[Table]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.geometries = _by_id(self.root, "{*}library_geometries/{*}geometry")
        self.materials = _by_id(self.root, "{*}library_materials/{*}material")
        self.effects = _by_id(self.root, "{*}library_effects/{*}effect")

    def tables(self) -> list[Table]:
        metres = self._metres()
        found = []
        for shown, matrix in _shown(self._scene()):
            given = _given_materials(shown)
            tables = self._geometry(_reference(shown.get("url")))
            found += [self._coloured(_placed(table, matrix, metres), given) for table in tables]
        return found

    def _coloured(self, table: Table, given: dict[str | None, Element]) -> Table:
        """With the material that an instance of a geometry gives to the name that a primitive has for it."""
        if table.material not in given:
            return table._replace(material="")
        name = _reference(given[table.material].get("target"))
        return table._replace(material=name, rgba=self._colour(name))

    def _colour(self, name: str) -> Rgba | None:
        """The diffuse colour of a material; None where it is an image or is not said."""
        effect = self.materials[name][-1].find("{*}instance_effect") if name in self.materials else None
        wanted = "" if effect is None else _reference(effect.get("url"))
        if wanted not in self.effects:
            return None
        colour = self.effects[wanted][0].find("{*}profile_COMMON/{*}technique/*/{*}diffuse/{*}color")
        return None if colour is None else _rgba(_numbers(colour, np.float64).tolist())

    def _metres(self) -> float:
        unit = self.root.find("{*}asset/{*}unit")
        metres = 1.0 if unit is None else float(unit.get("meter", "1"))
        return 1.0 if abs(metres - 1.0) <= _NEAR_ONE else metres

    def _scene(self) -> Element:
        shown = self.root.find("{*}scene/{*}instance_visual_scene")
        wanted = _reference(shown.get("url") if shown is not None else None)
        return _only([scene for scene in self.root.iterfind("{*}library_visual_scenes/{*}visual_scene") if scene.get("id") == wanted])

    def _geometry(self, name: str) -> list[Table]:
        if name not in self.known:
            self.known[name] = _mesh_tables(_only(_only(self.geometries.get(name, [])).findall("{*}mesh")))
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


def _matrix(said: NDArray[Any]) -> NDArray[Any]:
    return said.reshape(4, 4)


def _translation(said: NDArray[Any]) -> NDArray[Any]:
    matrix = np.eye(4, dtype=_SINGLE)
    matrix[:3, 3] = said.reshape(3)
    return matrix


def _scaling(said: NDArray[Any]) -> NDArray[Any]:
    return np.diag([*said.reshape(3), 1.0]).astype(_SINGLE)


def _rotation(said: NDArray[Any]) -> NDArray[Any]:
    """A turn by an angle in degrees about an axis, a unit vector."""
    x, y, z, angle = said.reshape(4).astype(np.float64).tolist()
    if abs(math.hypot(x, y, z) - 1.0) > _NEAR_ONE:
        raise NotPlain
    matrix = np.eye(4, dtype=_SINGLE)
    axis, turn = np.array([x, y, z]), math.radians(angle)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix[:3, :3] = math.cos(turn) * np.eye(3) + math.sin(turn) * across + (1.0 - math.cos(turn)) * np.outer(axis, axis)
    return matrix


_MOVES = {"matrix": _matrix, "translate": _translation, "scale": _scaling, "rotate": _rotation}


def _placed(table: Table, matrix: NDArray[np.float64], metres: float) -> Table:
    """The triangles where a node puts them, in m; a mirror turns them around, so that they still look outwards."""
    points, faces = table.points, table.faces
    if not np.array_equal(matrix, np.eye(4)):
        points = points @ matrix[:3, :3].T + matrix[:3, 3]
    return table._replace(points=points * metres, faces=faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0.0 else faces)


# ---- geometry ----------------------------------------------------------------------------------------------------------------


def _mesh_tables(mesh: Element) -> list[Table]:
    """One table for each primitive."""
    sources = {f"#{child.get('id')}": child for child in mesh if _tag(child) in ("source", "vertices")}
    known: dict[str, NDArray[np.float64]] = {}
    found = []
    for child in mesh:
        tag = _tag(child)
        if tag in ("triangles", "polylist"):
            name, index = _input(child, "VERTEX"), _index(child)
            if name not in known:
                known[name] = _points(sources.get(name), sources)
            points = known[name]
            faces = index.reshape(-1, 3) if tag == "triangles" else fans(_numbers(_only(child.findall("{*}vcount")), _INDEX), index)
            if faces.size and (faces.min() < 0 or faces.max() >= len(points)):
                raise NotPlain
            found.append(Table(*_used(points, faces), child.get("material", "")))
        elif tag not in ("source", "vertices") and tag not in _PASSED_OVER:
            raise NotPlain
    return found


def _used(points: NDArray[np.float64], faces: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[Any]]:
    """Where a primitive shares many points with others, its own ones."""
    if len(points) <= faces.size:
        return points, faces
    rows, index = np.unique(faces, return_inverse=True)
    return points[rows], index.reshape(faces.shape)


def _index(primitive: Element) -> NDArray[Any]:
    """For each corner of a primitive the row of its point; the rows of its normals and the rest stand between them."""
    inputs = [(int(item.get("offset", "")), item.get("semantic")) for item in primitive.iterfind("{*}input")]
    places = [offset for offset, semantic in inputs if semantic == "VERTEX"]
    if len(places) != 1 or min(offset for offset, _ in inputs) < 0:
        raise NotPlain
    width = max(offset for offset, _ in inputs) + 1
    lists = [_numbers(item, _INDEX).reshape(-1, width)[:, places[0]] for item in primitive.iterfind("{*}p")]
    return np.concatenate(lists) if lists else np.zeros(0, dtype=_INDEX)


def _points(vertices: Element | None, sources: dict[str, Element]) -> NDArray[np.float64]:
    source = sources.get(_input(vertices, "POSITION")) if vertices is not None else None
    if source is None:
        raise NotPlain
    accessor = _only(source.findall("{*}technique_common/{*}accessor"))
    is_plain = accessor.get("stride", "1") == str(_COMPONENTS) and accessor.get("offset", "0") == "0"
    if not is_plain or len(accessor.findall("{*}param")) != _COMPONENTS:
        raise NotPlain
    points = _numbers(_only(source.findall("{*}float_array")), _SINGLE)
    if not np.isfinite(points).all():
        raise NotPlain
    return points.reshape(-1, _COMPONENTS).astype(np.float64)


def _input(element: Element, semantic: str) -> str:
    return str(_only([item for item in element.iterfind("{*}input") if item.get("semantic") == semantic]).get("source", ""))


def _numbers(element: Element, kind: Any) -> NDArray[Any]:
    """The numbers of an element. Raises: ValueError where there is anything else."""
    return numbers_in(element.text or "", kind)


def _rgba(said: list[float]) -> Rgba | None:
    if len(said) not in (3, 4) or not all(0.0 <= value <= 1.0 for value in said):
        return None
    r, g, b, a = (*said, 1.0)[:4]
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
