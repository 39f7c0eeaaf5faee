"""What is around a robot in its picture: light, sky and ground; and what its file has there, which a comparison leaves out."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from hymeko_x.rewrite.shapes import FACETS

if TYPE_CHECKING:
    from hymeko_x.draw.camera import Corners

VISUAL = frozenset({0, 1, 2})
COLLISION = frozenset({3, 4, 5})
FIELD_OF_VIEW = 35.0
"""The vertical angle of the camera in degrees: long enough that an arm does not look bent."""
_GLOSS = (0.5, 0.5, 0.0)
"""Specular, shininess and reflectance of what has no material."""
_AWAY = 8.0
"""How many times its size from the robot the light is: near ones leave the ground dark at the edges of the picture."""
GROUND = "hymeko-x ground"
"""The name of the ground, and of its material and texture."""
_SHADOWED = 0.15
"""The part of the light's cone in which shadows are drawn: so far away, about twice the robot."""


def remove_surroundings(spec: Any) -> None:
    """Take away sky, floors, terrain, gloss, skins, marks on patterns and settings of the view, which other formats cannot represent.

    The robot alone is compared.
    """
    import mujoco

    for material in spec.materials:
        material.specular, material.shininess, material.reflectance = _GLOSS
    plain = mujoco.MjSpec().visual
    for part in ("headlight", "map", "rgba", "quality"):
        setattr(spec.visual, part, getattr(plain, part))
    spec.visual.headlight.specular = [0.0] * 3  # MuJoCo dims gloss by a texture, which a pattern is, and not by the colour in its place
    for texture in [texture for texture in spec.textures if texture.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX]:
        spec.delete(texture)
    for texture in spec.textures:
        texture.mark = mujoco.mjtMark.mjMARK_NONE
    if spec.skins:
        _show_below_skins(spec)
    for geom in spec.worldbody.geoms:
        if geom.type in (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD):
            geom.material, geom.rgba = "", [0.0] * 4


def _show_below_skins(spec: Any) -> None:
    """Skins away, and the shapes for the eye that they stand for, such as bones in a group that viewers hide, in a group that they show."""
    for skin in tuple(spec.skins):
        spec.delete(skin)
    for geom in spec.geoms:
        if not geom.contype and not geom.conaffinity and geom.group in COLLISION:
            geom.group = max(VISUAL)


def add_scene(spec: Any, corners: Corners, size: tuple[int, int], *, is_compared: bool) -> None:
    """Add a sky, one light, and ground under the robot if it has none, or if it is compared. ``size`` is that of the picture in pixels."""
    import mujoco

    spec.visual.global_.offwidth, spec.visual.global_.offheight = size
    spec.visual.global_.fovy = FIELD_OF_VIEW
    spec.visual.headlight.ambient = [0.35] * 3
    spec.visual.headlight.diffuse = [0.45] * 3
    spec.visual.quality.shadowsize = 2048
    spec.visual.quality.numslices, spec.visual.quality.numstacks = FACETS
    spec.visual.map.znear = 0.01
    if not any(texture.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX for texture in spec.textures):
        gradient = mujoco.mjtBuiltin.mjBUILTIN_GRADIENT
        colours = {"rgb1": [0.93, 0.95, 0.98], "rgb2": [0.66, 0.72, 0.8]}
        spec.add_texture(name="hymeko-x sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=gradient, width=256, height=1536, **colours)
    for light in spec.lights:
        spec.delete(light)  # so that a robot has the same picture in every format
    centre = (corners.points.min(axis=0) + corners.points.max(axis=0)) / 2.0
    spec.stat.center, spec.stat.extent = centre, corners.size  # else they are those of the collision shapes, and shadows end elsewhere
    beam = (0.35, 0.3, -1.0)
    light = spec.worldbody.add_light(type=mujoco.mjtLightType.mjLIGHT_SPOT, castshadow=True, cutoff=89.0, exponent=0.0)
    light.pos, light.dir = [at - _AWAY * corners.size * along for at, along in zip(centre, beam, strict=True)], beam
    spec.visual.map.shadowscale = _SHADOWED
    light.diffuse, light.specular = [0.6] * 3, [0.0 if is_compared else 0.2] * 3
    if is_compared or not any(geom.type == mujoco.mjtGeom.mjGEOM_PLANE for geom in spec.geoms):
        _add_ground(spec, corners)


def _add_ground(spec: Any, corners: Corners) -> None:
    """A chequered plane just below the robot, with squares of a round size that suits it."""
    import mujoco

    square = 10.0 ** round(math.log10(corners.size / 5.0))
    spec.add_texture(
        name=GROUND,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        width=256,
        height=256,
        rgb1=[0.86, 0.88, 0.9],
        rgb2=[0.8, 0.83, 0.86],
    )
    plain = {"rgba": [1.0] * 4, "emission": 0.0, "specular": 0.5, "shininess": 0.5, "reflectance": 0.0}  # whatever the file's defaults are
    material = spec.add_material(name=GROUND, texuniform=True, texrepeat=[1.0 / (2.0 * square)] * 2, **plain)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = GROUND
    centre = corners.points.mean(axis=0)
    spec.worldbody.add_geom(
        name=GROUND,
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0.0, 0.0, square],
        pos=[centre[0], centre[1], corners.lowest - 1e-4 * corners.size],
        material=GROUND,
        rgba=[0.5, 0.5, 0.5, 1.0],  # which leaves the colour to the material
        group=0,
        contype=0,
        conaffinity=0,
    )
