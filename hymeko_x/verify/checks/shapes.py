"""Shapes: every collision and visual shape of one robot has a counterpart of its kind, size and pose in the other.

Compared: sizes and poses in m, up to the shape's own symmetry; the meshes of a body together, because one file on one side may be several
on the other (see :mod:`hymeko_x.verify.meshes`), relative to their extent. Allowed: 1e-8 m; 3e-6.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.diagnostics import with_article
from hymeko_x.verify.checks.pair import Differences, Pair, counted
from hymeko_x.verify.features import Feature
from hymeko_x.verify.meshes import ALLOWED, is_thickened, mesh_distance
from hymeko_x.verify.model import WORLD, Array, KinematicModel, MeshFile, Role, Shape

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.verify.meshes import Meshes
    from hymeko_x.verify.verdict import Check

_LENGTH = 1e-8
"""In m: both sides read sizes and poses of primitives from text, and angles in degrees or quaternions."""

_SAME_PLANE = 1e-8
"""In m, relative beyond 1 m, and as the sine of an angle: a box that stands for a plane is written with these numbers."""

_SAME_SURFACE = 1e-5
"""Of its radius a point of a mesh may be off the ellipsoid that it stands for: meshes hold floats."""

_INFINITE = ("plane", "hfield", "none")
_ROLES = {Feature.COLLISIONS: ("collision", (Role.COLLISION, Role.BOTH)), Feature.VISUALS: ("visual", (Role.VISUAL, Role.BOTH))}


class _Result(Struct, frozen=True):
    """How well two lists of shapes fit: the ``unmatched``, the worst distance in m, and that of meshes (relative)."""

    unmatched: tuple[str, ...]
    solids: float
    meshes: float
    at: str = ""
    mesh_at: str = ""
    missing: str = ""
    lost: tuple[str, ...] = ()
    """Meshes of the first robot that its reader cannot load, and that the second one does not have."""
    flat: bool = False
    """Whether flat meshes on one side are thin solids on the other, whose format has no flat ones that collide."""

    @property
    def misfit(self) -> tuple[int, float, float]:
        return len(self.unmatched), self.solids, self.meshes


def check_shapes(pair: Pair) -> Iterator[Check]:
    """Collision shapes and visual shapes of every pair of bodies."""
    for feature, (word, roles) in _ROLES.items():
        if not pair.both_represent(feature):
            pair.add_unrepresented(feature, partial(_bodies_with, roles))
            continue
        results = [(i, _compare_body(pair, i, j, roles, pair.meshes)) for i, j in pair.match.bodies if _is_compared(pair, i, j, word)]
        if results:
            yield from _summed_up(pair, word, results)


def _bodies_with(roles: tuple[Role, Role], model: KinematicModel) -> list[str]:
    """A label for every shape of these roles: the body that it is on."""
    return [model.body_label(index) for index, body in enumerate(model.bodies) for shape in body.shapes if shape.role in roles]


def _is_compared(pair: Pair, i: int, j: int, word: str) -> bool:
    ours, theirs = pair.a.bodies[i].shapes, pair.b.bodies[j].shapes
    if i == WORLD and bool(ours) != bool(theirs):
        pair.notes.append(f"{word} shapes: only one of the two has shapes on the world")
        return False
    return bool(ours or theirs)


def _summed_up(pair: Pair, word: str, results: Sequence[tuple[int, _Result]]) -> Iterator[Check]:
    solids, meshes = Differences(f"{word} shapes, size and pose", "m"), Differences(f"{word} meshes", "relative")
    for i, result in results:
        solids.add(result.solids, pair.allowed(_LENGTH), f"{result.at} of {pair.a.body_label(i)}")
        meshes.add(result.meshes, ALLOWED, f"{result.mesh_at} of {pair.a.body_label(i)}")
    yield counted(f"{word} shapes", [f"{words} of {pair.a.body_label(i)}" for i, result in results for words in result.unmatched])
    yield from solids.checks()
    if any(result.meshes for _, result in results) or any(shape.kind == "mesh" for i, _ in results for shape in pair.a.bodies[i].shapes):
        yield from meshes.checks()
    lost = [f"{label} of {pair.a.body_label(i)}" for i, result in results for label in result.lost]
    pair.add_gap(pair.b, None, lost, f"{word} meshes that cannot be loaded")
    flat = [pair.a.body_label(i) for i, result in results if result.flat]
    pair.add_gap(pair.b if Feature.FLAT_COLLISIONS in pair.a.features else pair.a, Feature.FLAT_COLLISIONS, flat)
    missing = [result.missing for _, result in results if result.missing]
    if missing:
        pair.notes.append(f"{word} meshes of {len(missing)} bodies: {missing[0]}")


def _compare_body(pair: Pair, i: int, j: int, roles: tuple[Role, Role], meshes: Meshes) -> _Result:
    """The best fit among the readings of the two bodies' shapes.

    A shape that collides is often drawn as well, and not every format represents that: a shape of both roles may be missing among
    the visual ones of the other robot.
    """
    ours, theirs = _in_common_kinds(pair, pair.a.bodies[i].shapes, pair.b.bodies[j].shapes, meshes)
    best: _Result | None = None
    for left in _readings(ours, roles):
        for right in _readings(theirs, roles):
            result = _fit(pair, left, right)
            if best is None or result.misfit < best.misfit:
                best = result
            if not best.unmatched and best.solids <= _LENGTH and best.meshes <= ALLOWED:
                return best
    assert best is not None
    return best


def _in_common_kinds(pair: Pair, ours: Sequence[Shape], theirs: Sequence[Shape], meshes: Meshes) -> tuple[Sequence[Shape], Sequence[Shape]]:
    """Without the kinds of shapes that one format lacks and what stands for them; a capsule is a cylinder with two spheres there."""
    lacking = pair.a.row.missing_shapes, pair.b.row.missing_shapes
    if lacking[0] == lacking[1]:
        return ours, theirs
    is_first = lacking[0] > lacking[1]
    side, rich, poor = (pair.a, theirs, ours) if is_first else (pair.b, ours, theirs)
    missing = lacking[0] ^ lacking[1]
    poor = _without_stand_ins(pair, side, [shape for shape in rich if shape.kind in missing], poor, meshes)
    capsules = not any(shape.kind == "capsule" for shape in poor)
    rich = [part for shape in rich if shape.kind not in missing for part in (_split_capsule(shape) if capsules else [shape])]
    return (poor, rich) if is_first else (rich, poor)


def _without_stand_ins(pair: Pair, side: KinematicModel, missing: Sequence[Shape], poor: Sequence[Shape], meshes: Meshes) -> list[Shape]:
    """The shapes of the poorer format but those that stand for one that it cannot represent, one for each role of it."""
    waiting = list(poor)
    for shape in missing:
        stands = []
        for role in (Role.VISUAL, Role.COLLISION):
            if shape.role in (role, Role.BOTH):
                stands += [other for other in waiting if other.role is role and stands_for(other, shape, meshes)][:1]
        waiting = [other for other in waiting if other not in stands]
        kind = stands[0].kind if stands else ""
        if stands:
            pair.notes.append(f"shapes: {side.format} has no {shape.kind}; a {kind} stands for {_label(shape)}")
        else:
            pair.add_gap(side, None, [_label(shape)], f"shapes of kind {shape.kind}")
    return waiting


def stands_for(shape: Shape, missing: Shape, meshes: Meshes) -> bool:
    """Whether a box has a face in a plane, or a mesh is an ellipsoid, which the shape's format cannot represent."""
    if missing.kind == "plane" and shape.kind == "box":
        return _has_face_in(shape, missing.pose)
    return missing.kind == "ellipsoid" and shape.kind == "mesh" and _is_ellipsoid(shape, missing, meshes)


def _has_face_in(box: Shape, plane: Array) -> bool:
    """Whether a face of the box lies in the xy plane of a pose, with its normal along the z axis."""
    normal = plane[:3, 2]
    along = box.pose[:3, :3].T @ normal
    axis = int(np.abs(along).argmax())
    if 1.0 - abs(along[axis]) > _SAME_PLANE:
        return False
    height = float(normal @ (box.pose[:3, 3] - plane[:3, 3])) + box.size[axis] / 2.0
    return abs(height) <= _SAME_PLANE * max(1.0, float(np.abs(plane[:3, 3]).max()))


def _is_ellipsoid(mesh: Shape, ellipsoid: Shape, meshes: Meshes) -> bool:
    """Whether all points of the mesh are on the ellipsoid and span it; of a mesh that is missing only its pose is compared."""
    surface = meshes.surface(mesh.mesh)
    if isinstance(surface, str):
        return bool(np.abs(mesh.pose - ellipsoid.pose).max() <= _SAME_PLANE)
    points = surface.vertices @ mesh.pose[:3, :3].T + mesh.pose[:3, 3]
    unit = (points - ellipsoid.pose[:3, 3]) @ ellipsoid.pose[:3, :3] / np.asarray(ellipsoid.size)
    on_it = np.abs(np.linalg.norm(unit, axis=1) - 1.0).max() <= _SAME_SURFACE
    spanned = np.abs(np.abs(unit).max(axis=0) - 1.0).max() <= _SAME_SURFACE
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
    """The shapes of a role: all of them, and of visual shapes also those alone that do not collide."""
    everything = [shape for shape in shapes if shape.role in roles]
    only = [shape for shape in everything if shape.role is not Role.BOTH]
    return [everything] if roles[0] is Role.COLLISION or len(only) == len(everything) else [everything, only]


def _fit(pair: Pair, left: Sequence[Shape], right: Sequence[Shape]) -> _Result:
    unmatched, distance, at = _fit_solids([s for s in left if s.kind != "mesh"], [s for s in right if s.kind != "mesh"])
    mesh_left, mesh_right = [s for s in left if s.kind == "mesh"], [s for s in right if s.kind == "mesh"]
    if mesh_left and mesh_right:
        difference, where, missing = _distance_once(pair, mesh_left, mesh_right)
        if difference > ALLOWED and _may_be_thickened(pair, left) and is_thickened(mesh_left, mesh_right, pair.meshes):
            return _Result(tuple(unmatched), distance, 0.0, at, flat=True)
        return _Result(tuple(unmatched), distance, difference, at, where, missing)
    unreadable = pair.meshes.why_none(mesh_left) if mesh_left else ""
    if not unreadable:
        unmatched += [f"{_label(shape)} has no counterpart" for shape in mesh_left] + [f"{_label(shape)} is new" for shape in mesh_right]
    lost = tuple(_label(shape) for shape in mesh_left) if unreadable else ()
    return _Result(tuple(unmatched), distance, 0.0, at, "", unreadable, lost)


def _may_be_thickened(pair: Pair, shapes: Sequence[Shape]) -> bool:
    return not pair.both_represent(Feature.FLAT_COLLISIONS) and any(shape.role is not Role.VISUAL for shape in shapes)


def _label(shape: Shape) -> str:
    return f"{shape.kind} '{shape.name}'" if shape.name else with_article(shape.kind)


# ---- primitives ------------------------------------------------------------------------------------------------------


def _fit_solids(left: Sequence[Shape], right: Sequence[Shape]) -> tuple[list[str], float, str]:
    """Each shape with the nearest free one of its kind: those left over, and the worst pair's distance."""
    waiting = list(right)
    unmatched: list[str] = []
    worst, at = 0.0, ""
    for shape in left:
        candidates = [(solid_distance(shape, other), k) for k, other in enumerate(waiting) if other.kind == shape.kind]
        if not candidates:
            unmatched.append(f"{_label(shape)} has no counterpart")
            continue
        distance, k = min(candidates)
        waiting.pop(k)
        if distance > worst:
            worst, at = distance, _label(shape)
    return [*unmatched, *(f"{_label(shape)} is new" for shape in waiting)], worst, at


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
    """Boxes are equal after a permutation of their axes; ellipsoids of equal radii may be turned further, which is not allowed for."""
    permutation = np.rint(relative)
    if np.abs(permutation @ permutation.T - np.eye(3)).max() > 0.5:
        permutation = np.eye(3)
    tilt = float(np.abs(relative - permutation).max()) * float(sizes[0].max())
    return max(tilt, float(np.abs(sizes[0] - np.abs(permutation) @ sizes[1]).max()))


# ---- meshes ----------------------------------------------------------------------------------------------------------


def _distance_once(pair: Pair, left: Sequence[Shape], right: Sequence[Shape]) -> tuple[float, str, str]:
    """:func:`mesh_distance`, computed once where the same meshes are both collision and visual shapes."""
    key = tuple(_placed(shape) for shape in left), tuple(_placed(shape) for shape in right)
    if key not in pair.mesh_distances:
        pair.mesh_distances[key] = mesh_distance(left, right, pair.meshes)
    return pair.mesh_distances[key]


def _placed(shape: Shape) -> tuple[object, bytes]:
    """A mesh with its pose: the file, or the triangles by their identity, which they keep as long as the pair lives."""
    return shape.mesh if isinstance(shape.mesh, MeshFile) else id(shape.mesh), shape.pose.tobytes()
