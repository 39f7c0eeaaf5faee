"""A scene around a model for MuJoCo: a floor below it, light, and what the viewer looks at."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Plane
from hymeko_x.targets.engine import compiled, extent
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options
    from hymeko_x.source import Files, Package

_NAME = "scene"
_SCENE = """<mujoco model="{name} scene">
  <include file="{file}"/>

  <statistic center="{center}" extent="{extent}"/>

  <visual>
    <headlight diffuse="0.6 0.6 0.6" ambient="0.3 0.3 0.3" specular="0 0 0"/>
    <global azimuth="130" elevation="-20"/>
  </visual>

  <asset>
    <texture name="sky" type="skybox" builtin="gradient" rgb1="0.4 0.5 0.6" rgb2="0 0 0" width="512" height="3072"/>
    <texture name="{ground}" type="2d" builtin="checker" mark="edge" rgb1="0.3 0.35 0.4" rgb2="0.2 0.25 0.3" width="300" height="300"/>
    <material name="{ground}" texture="{ground}" texuniform="true" texrepeat="5 5" reflectance="0.2"/>
  </asset>

  <worldbody>
    <light pos="0 0 3" dir="0 0 -1" directional="true"/>
    <geom name="{ground}" type="plane" size="0 0 0.05"{place} material="{ground}"/>
  </worldbody>
</mujoco>
"""


def scene_beside(printed: Mechanism, package: Package, files: Files, options: Options) -> Mapping[str, bytes]:
    """``scene.xml``, which includes the model; nothing where the model is a scene itself, or MuJoCo refuses it.

    The floor is at height 0, or at the lowest point that collides at the first keyframe where that is below.
    """
    has_floor = any(isinstance(view.shape.geometry, Plane) for view in printed.shapes.get(WORLD, ()))
    if has_floor or options.beside == _NAME:
        return {}
    try:
        model = compiled(package, files)
    except ValueError:  # a rule of the target has reported it
        return {}
    lowest, center, size = extent(model)
    ground = "ground" if b'name="ground"' not in package.main else "scene_ground"
    place = f' pos="0 0 {lowest:g}"' if lowest < 0.0 else ""
    middle = " ".join(f"{value:g}" for value in center)
    name, file = escaped(printed.name), escaped(f"{options.beside}.xml")
    text = _SCENE.format(name=name, file=file, center=middle, extent=f"{size:g}", ground=ground, place=place)
    return {f"{options.within.removesuffix('/')}_{_NAME}.xml" if options.within else f"{_NAME}.xml": text.encode()}
