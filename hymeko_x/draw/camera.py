"""Where a camera stands so that a robot fills its picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import mujoco
import numpy as np

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

VIEWS: Mapping[str, tuple[float, float]] = {
    "front": (180.0, -8.0),
    "side": (90.0, -8.0),
    "top": (180.0, -89.0),
    "iso": (145.0, -22.0),
}
"""Azimuth and elevation of the camera in degrees, by the name of the view. Robots look along +x."""
_FILLED = 0.78
"""The part of the picture's width or height, whichever is scarcer, between the outermost points of the robot."""
_STEPS = 6


class Corners(NamedTuple):
    """The corners of the boxes around the geoms of a robot, in the world frame: an (n, 3) array in m."""

    points: NDArray[np.float64]

    @property
    def lowest(self) -> float:
        """The height of the lowest corner in m."""
        return float(self.points[:, 2].min())

    @property
    def size(self) -> float:
        """The diagonal of the box around all corners in m."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))


def corners_of(model: mujoco.MjModel, datas: Iterable[mujoco.MjData], groups: frozenset[int]) -> Corners:
    """The corners of all geoms of these groups, planes left out, over all configurations.

    Raises: Refusal HX501 when nothing is visible.
    """
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    geoms = [
        geom
        for geom in range(model.ngeom)
        if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_PLANE and model.geom_group[geom] in groups and _is_opaque(model, geom)
    ]
    found = [
        data.geom_xpos[geom] + (model.geom_aabb[geom, :3] + signs * model.geom_aabb[geom, 3:]) @ data.geom_xmat[geom].reshape(3, 3).T
        for data in datas
        for geom in geoms
    ]
    if not found:
        raise refuse(codes.NOTHING_TO_DRAW, "no shape of the robot is visible", hint="--collision draws the collision shapes")
    return Corners(np.concatenate(found))


def _is_opaque(model: mujoco.MjModel, geom: int) -> bool:
    material = model.geom_matid[geom]
    return bool((model.mat_rgba[material, 3] if material >= 0 else model.geom_rgba[geom, 3]) > 0.0)


def fitted_camera(corners: Corners, view: str, aspect: float, field_of_view: float) -> mujoco.MjvCamera:
    """A free camera from which all corners are just inside the picture.

    ``aspect`` is the width of the picture divided by its height, ``field_of_view`` its vertical angle in degrees.
    """
    azimuth, elevation = VIEWS[view]
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.azimuth, camera.elevation = azimuth, elevation
    ahead, right, up = _axes(azimuth, elevation)
    half = np.tan(np.radians(field_of_view) / 2.0) * _FILLED
    points = corners.points
    target = (points.min(axis=0) + points.max(axis=0)) / 2.0
    distance = max(corners.size, 1e-6)
    for _ in range(_STEPS):  # each step centres the picture of the corners, and then goes as near as possible
        relative = points - target
        depth, across, height = relative @ ahead, relative @ right, relative @ up
        distance = float(np.max(np.maximum(np.abs(across) / (half * aspect), np.abs(height) / half) - depth))
        away = distance + depth
        for axis, seen in ((right, across / away), (up, height / away)):
            target = target + axis * (seen.min() + seen.max()) / 2.0 * distance
    camera.lookat[:] = target
    camera.distance = distance
    return camera


def _axes(azimuth: float, elevation: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The directions ahead, to the right and up of a free camera, as MuJoCo defines its two angles (degrees)."""
    a, e = np.radians((azimuth, elevation))
    ahead = np.array((np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)))
    right = np.array((np.sin(a), -np.cos(a), 0.0))
    return ahead, right, np.cross(right, ahead)
