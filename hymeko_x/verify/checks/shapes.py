"""Shapes: every collision and visual shape of one robot has a counterpart of its kind, size and pose in the other.

Poses are compared up to the shape's own symmetry. The meshes of a body are compared together, by bounding box, area, volume
and points, because one file on one side may be several on the other.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.verify.checks.pair import Pair, counted, worst
from hymeko_x.verify.meshes import EMPTY, measures, used
from hymeko_x.verify.model import WORLD, Array, Feature, Index, MeshFile, Role, Shape

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.verify.meshes import Meshes
    from hymeko_x.verify.verdict import Check

_LENGTH = 1e-8  # m; primitive sizes and poses are read from text by both sides
_MESH = 3e-6  # relative to the mesh's extent: engines keep vertices as floats
_POLYGONS = 0.05  # by so much may area and volume differ where larger faces are split otherwise
_MOST_POINTS = 4000  # of each side are looked up among all points of the other
_NOT_IN_URDF = ("plane", "hfield", "ellipsoid")
_NEAR = 1e-8  # m, and sine of an angle
_ROUND = 1e-5  # by which part of its radius a point of a mesh may be off the ellipsoid
_INFINITE = ("plane", "hfield", "none")
_ROLES = {Feature.COLLISIONS: ("collision", (Role.COLLISION, Role.BOTH)), Feature.VISUALS: ("visual", (Role.VISUAL, Role.BOTH))}


class _Result(Struct, frozen=True):
    """How well two lists of shapes fit: those without a counterpart, the worst distance in m, and that of meshes (relative)."""

    lone: tuple[str, ...]
    apart: float
    meshes: float
    at: str = ""
    mesh_at: str = ""
    missing: str = ""

    @property
    def misfit(self) -> tuple[int, float, float]:
        return len(self.lone), self.apart, self.meshes


def check_shapes(pair: Pair) -> Iterator[Check]:
    """Collision shapes and visual shapes of every pair of bodies."""
    for feature, (word, roles) in _ROLES.items():
        if not pair.both_say(feature):
            pair.notes.append(
                f"{feature.value}: the reader of {pair.a.format if feature not in pair.a.says else pair.b.format} cannot tell"
            )
            continue
        results = [(i, _compare_body(pair, i, j, roles, pair.meshes)) for i, j in pair.match.bodies if _is_compared(pair, i, j, word)]
        if not results:
            continue
        yield from _summed_up(pair, word, results)


def _is_compared(pair: Pair, i: int, j: int, word: str) -> bool:
    ours, theirs = pair.a.bodies[i].shapes, pair.b.bodies[j].shapes
    if i == WORLD and bool(ours) != bool(theirs):
        pair.notes.append(f"{word} shapes: only one of the two has shapes on the world")
        return False
    return bool(ours or theirs)


def _summed_up(pair: Pair, word: str, results: Sequence[tuple[int, _Result]]) -> Iterator[Check]:
    lone = [f"{words} of {pair.a.body_label(i)}" for i, result in results for words in result.lone]
    apart, meshes = (np.array([getattr(result, name) for _, result in results]) for name in ("apart", "meshes"))
    missing = [result.missing for _, result in results if result.missing]
    yield counted(f"{word} shapes", lone)
    yield worst(
        f"{word} shapes, size and pose",
        "m",
        apart,
        pair.allowed(_LENGTH, 1.0),
        lambda k: f"{results[k][1].at} of {pair.a.body_label(results[k][0])}",
    )
    if meshes.any() or any(shape.kind == "mesh" for i, _ in results for shape in pair.a.bodies[i].shapes):
        yield worst(f"{word} meshes", "relative", meshes, _MESH, lambda k: f"{results[k][1].mesh_at} of {pair.a.body_label(results[k][0])}")
    if missing:
        pair.notes.append(f"{word} meshes of {len(missing)} bodies: {missing[0]}")


def _compare_body(pair: Pair, i: int, j: int, roles: tuple[Role, Role], meshes: Meshes) -> _Result:
    """The best fit among the readings of the two bodies' shapes.

    What collides is often drawn as well, and formats differ in whether they say so: a shape of both roles may be missing
    among the visual ones of the other robot.
    """
    ours, theirs = _in_common_words(pair, pair.a.bodies[i].shapes, pair.b.bodies[j].shapes, meshes)
    best: _Result | None = None
    for left in _readings(ours, roles):
        for right in _readings(theirs, roles):
            result = _fit(pair, left, right)
            if best is None or result.misfit < best.misfit:
                best = result
            if not best.lone and best.apart <= _LENGTH and best.meshes <= _MESH:
                return best
    assert best is not None
    return best


def _in_common_words(pair: Pair, ours: Sequence[Shape], theirs: Sequence[Shape], meshes: Meshes) -> tuple[Sequence[Shape], Sequence[Shape]]:
    """Against URDF a capsule is a cylinder with two spheres; what URDF cannot say at all is left out with what stands for it."""
    if (pair.a.format == "urdf") == (pair.b.format == "urdf"):
        return ours, theirs
    rich, poor = (theirs, ours) if pair.a.format == "urdf" else (ours, theirs)
    unsaid = [shape for shape in rich if shape.kind in _NOT_IN_URDF]
    poor = _without_stand_ins(pair, unsaid, poor, meshes)
    capsules = not any(shape.kind == "capsule" for shape in poor)
    rich = [part for shape in rich if shape.kind not in _NOT_IN_URDF for part in (_split_capsule(shape) if capsules else [shape])]
    return (poor, rich) if pair.a.format == "urdf" else (rich, poor)


def _without_stand_ins(pair: Pair, unsaid: Sequence[Shape], poor: Sequence[Shape], meshes: Meshes) -> list[Shape]:
    """The shapes of the poorer format but those that stand for one that it has no word for, one for each role of it."""
    waiting = list(poor)
    for shape in unsaid:
        stands = []
        for role in (Role.VISUAL, Role.COLLISION):
            if shape.role in (role, Role.BOTH):
                stands += [other for other in waiting if other.role is role and stands_for(other, shape, meshes)][:1]
        waiting = [other for other in waiting if other not in stands]
        kind = stands[0].kind if stands else ""
        words = f"a {kind} stands for {_label(shape)}" if stands else f"{_label(shape)} was not compared"
        pair.notes.append(f"shapes: URDF has no {shape.kind}; {words}")
    return waiting


def stands_for(shape: Shape, unsaid: Shape, meshes: Meshes) -> bool:
    """Whether a shape is where one of another kind is, as far as its own kind can say that."""
    if unsaid.kind == "plane" and shape.kind == "box":
        return _has_face_in(shape, unsaid.pose)
    if unsaid.kind == "ellipsoid" and shape.kind == "mesh":
        return _is_ellipsoid(shape, unsaid, meshes)
    return False


def _has_face_in(box: Shape, plane: Array) -> bool:
    """Whether a face of the box lies in the xy plane of a pose, looking the way of its z axis."""
    normal = plane[:3, 2]
    along = box.pose[:3, :3].T @ normal
    axis = int(np.abs(along).argmax())
    if 1.0 - abs(along[axis]) > _NEAR:
        return False
    height = float(normal @ (box.pose[:3, 3] - plane[:3, 3])) + box.size[axis] / 2.0
    return abs(height) <= _NEAR * max(1.0, float(np.abs(plane[:3, 3]).max()))


def _is_ellipsoid(mesh: Shape, ellipsoid: Shape, meshes: Meshes) -> bool:
    """Whether all points of the mesh are on the ellipsoid and span it. Of a mesh that is not there its pose has to do."""
    surface = meshes.surface(mesh.mesh)
    if isinstance(surface, str):
        return bool(np.abs(mesh.pose - ellipsoid.pose).max() <= _NEAR)
    points = surface.vertices @ mesh.pose[:3, :3].T + mesh.pose[:3, 3]
    unit = (points - ellipsoid.pose[:3, 3]) @ ellipsoid.pose[:3, :3] / np.asarray(ellipsoid.size)
    on_it = np.abs(np.linalg.norm(unit, axis=1) - 1.0).max() <= _ROUND
    spanned = np.abs(np.abs(unit).max(axis=0) - 1.0).max() <= _ROUND
    return bool(on_it and spanned)


def _split_capsule(shape: Shape) -> list[Shape]:
    """A capsule as a cylinder and a sphere at each end; any other shape as it is."""
    if shape.kind != "capsule":
        return [shape]
    radius, length = shape.size
    ends = []
    for side in (-0.5, 0.5):
        place = shape.pose.copy()
        place[:3, 3] += side * length * shape.pose[:3, 2]
        ends.append(replace(shape, kind="sphere", size=(radius,), pose=place))
    return [replace(shape, kind="cylinder"), *ends]


def _readings(shapes: Sequence[Shape], roles: tuple[Role, Role]) -> list[list[Shape]]:
    """The shapes of a role: all of them, and for the eye also without those that collide as well."""
    everything = [shape for shape in shapes if shape.role in roles]
    only = [shape for shape in everything if shape.role is not Role.BOTH]
    return [everything] if roles[0] is Role.COLLISION or len(only) == len(everything) else [everything, only]


def _fit(pair: Pair, left: Sequence[Shape], right: Sequence[Shape]) -> _Result:
    solid_left, solid_right = [s for s in left if s.kind != "mesh"], [s for s in right if s.kind != "mesh"]
    lone, apart, at = _fit_solids(solid_left, solid_right)
    mesh_left, mesh_right = [s for s in left if s.kind == "mesh"], [s for s in right if s.kind == "mesh"]
    gone = _unreadable(mesh_left, pair.meshes) if mesh_left and not mesh_right else ""
    if gone:
        return _Result(tuple(lone), apart, 0.0, at, "", gone)
    if bool(mesh_left) != bool(mesh_right):
        which, words = (mesh_left, "has no counterpart") if mesh_left else (mesh_right, "is new")
        return _Result((*lone, *(f"{_label(shape)} {words}" for shape in which)), apart, 0.0, at)
    if not mesh_left:
        return _Result(tuple(lone), apart, 0.0, at)
    difference, where, missing = _distance_once(pair, mesh_left, mesh_right)
    return _Result(tuple(lone), apart, difference, at, where, missing)


def _label(shape: Shape) -> str:
    return f"{shape.kind} '{shape.name}'" if shape.name else f"{'an' if shape.kind[0] in 'aeiouh' else 'a'} {shape.kind}"


# ---- primitives ------------------------------------------------------------------------------------------------------


def _fit_solids(left: Sequence[Shape], right: Sequence[Shape]) -> tuple[list[str], float, str]:
    """Each shape with the nearest one of its kind that is not taken: those left over, and the worst pair's distance."""
    waiting = list(right)
    lone: list[str] = []
    apart, at = 0.0, ""
    for shape in left:
        candidates = [(solid_distance(shape, other), k) for k, other in enumerate(waiting) if other.kind == shape.kind]
        if not candidates:
            lone.append(f"{_label(shape)} has no counterpart")
            continue
        distance, k = min(candidates)
        waiting.pop(k)
        if distance > apart:
            apart, at = distance, _label(shape)
    return [*lone, *(f"{_label(shape)} is new" for shape in waiting)], apart, at


def solid_distance(a: Shape, b: Shape) -> float:
    """By how much two primitives of one kind differ, in m: centres, sizes, and orientation up to their own symmetry.

    A size of the first that is not positive counts as the second's: no engine can hold it.
    """
    if min(a.size, default=1.0) <= 0.0:
        a = replace(a, size=tuple(x if x > 0.0 else y for x, y in zip(a.size, b.size, strict=True)))
    shift = float(np.linalg.norm(a.pose[:3, 3] - b.pose[:3, 3]))
    relative = a.pose[:3, :3].T @ b.pose[:3, :3]
    sizes = np.asarray(a.size), np.asarray(b.size)
    if a.kind in _INFINITE:
        return max(shift, float(np.abs(relative[:, 2] - [0, 0, 1]).max()))
    if a.kind == "sphere":
        return max(shift, float(np.abs(sizes[0] - sizes[1]).max()))
    if a.kind in ("box", "ellipsoid"):
        return max(shift, _box_distance(sizes, relative))
    tilt = float(np.hypot(relative[0, 2], relative[1, 2])) * float(sizes[0].max())
    return max(shift, tilt, float(np.abs(sizes[0] - sizes[1]).max()))


def _box_distance(sizes: tuple[Array, Array], relative: Array) -> float:
    """Boxes are alike after a permutation of their axes; axes of equal ellipsoid radii are not told apart, which is stricter."""
    permutation = np.rint(relative)
    if np.abs(permutation @ permutation.T - np.eye(3)).max() > 0.5:
        permutation = np.eye(3)
    tilt = float(np.abs(relative - permutation).max()) * float(sizes[0].max())
    return max(tilt, float(np.abs(sizes[0] - np.abs(permutation) @ sizes[1]).max()))


# ---- meshes ----------------------------------------------------------------------------------------------------------


def _distance_once(pair: Pair, left: Sequence[Shape], right: Sequence[Shape]) -> tuple[float, str, str]:
    """What :func:`_mesh_distance` says: what collides is often what is drawn, and is looked at once."""
    key = tuple(_placed(shape) for shape in left), tuple(_placed(shape) for shape in right)
    if key not in pair.mesh_distances:
        pair.mesh_distances[key] = _mesh_distance(left, right, pair.meshes)
    return pair.mesh_distances[key]


def _placed(shape: Shape) -> tuple[object, bytes]:
    """A mesh where it is: the file, or the triangles by their identity, which they keep as long as the pair lives."""
    return shape.mesh if isinstance(shape.mesh, MeshFile) else id(shape.mesh), shape.pose.tobytes()


def _mesh_distance(left: Sequence[Shape], right: Sequence[Shape], meshes: Meshes) -> tuple[float, str, str]:
    """How differently two bodies' meshes look, relative to their extent; where it shows most; or why nobody can say."""
    ours, theirs = _together(left, meshes), _together(right, meshes)
    if isinstance(theirs, str) and theirs.endswith(EMPTY) and not isinstance(ours, str):
        return math.inf, "nothing is left", ""
    for side in (ours, theirs):
        if isinstance(side, str):
            return 0.0, "", side
    assert not isinstance(ours, str)
    assert not isinstance(theirs, str)
    extent = float((used(*ours).max(axis=0) - used(*ours).min(axis=0)).max()) or 1.0
    if len(ours[0]) == len(theirs[0]) and np.array_equal(ours[1], theirs[1]):
        in_order = float(np.linalg.norm(ours[0] - theirs[0], axis=1).max()) / extent
        if in_order <= _MESH:  # the same triangles: box, area and volume cannot differ by more
            return in_order, "the points of the meshes", ""
    box_a, area_a, volume_a = measures(ours[0], ours[1])
    box_b, area_b, volume_b = measures(theirs[0], theirs[1])
    split = _POLYGONS if any(_has_polygons(shape, meshes) for shape in (*left, *right)) else 0.0
    area = abs(area_a - area_b) / max(area_a, extent * extent * 1e-3)
    volume = abs(abs(volume_a) - abs(volume_b)) / extent**3
    candidates = [
        (float(np.abs(box_a - box_b).max()) / extent, "the bounding box"),
        (0.1 * area if area > split else 0.0, "the area"),
        (0.1 * volume if volume > split else 0.0, "the volume"),
        (_points_distance(used(*ours), used(*theirs)) / extent, "the points"),
    ]
    difference, where = max(candidates)
    return difference, f"{where} of the meshes", ""


def _has_polygons(shape: Shape, meshes: Meshes) -> bool:
    surface = meshes.surface(shape.mesh)
    return not isinstance(surface, str) and surface.polygons


def _unreadable(shapes: Sequence[Shape], meshes: Meshes) -> str:
    """Why none of these meshes can be shown, if none can: an engine that needs the files goes without them."""
    surfaces = [meshes.surface(shape.mesh) for shape in shapes]
    words = [surface for surface in surfaces if isinstance(surface, str)]
    return words[0] if len(words) == len(surfaces) else ""


def _together(shapes: Sequence[Shape], meshes: Meshes) -> tuple[Array, Index] | str:
    """All triangles of several mesh shapes in the body's frame; or why there are none."""
    vertices: list[Array] = []
    faces: list[Index] = []
    count = 0
    for shape in shapes:
        surface = meshes.surface(shape.mesh)
        if isinstance(surface, str):
            return surface
        vertices.append(surface.vertices @ shape.pose[:3, :3].T + shape.pose[:3, 3])
        faces.append(surface.faces + count)
        count += len(surface.vertices)
    return np.concatenate(vertices), np.concatenate(faces)


def _points_distance(a: Array, b: Array) -> float:
    """The largest distance from a point of one side to the nearest point of the other, both ways; of large meshes every n-th point."""
    if a.shape == b.shape:
        in_order = float(np.linalg.norm(a - b, axis=1).max())
        if in_order <= _MESH * float(np.abs(a).max()):
            return in_order
    from scipy.spatial import cKDTree

    def one_way(points: Array, others: Array) -> float:
        few = points[:: max(1, len(points) // _MOST_POINTS)]
        return float(cKDTree(others).query(few)[0].max())

    return max(one_way(a, b), one_way(b, a))
