"""Images that the colour of their material multiplies."""

from __future__ import annotations

import pytest
from pxr import Usd, UsdShade

import hymeko_x as hx
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.parts import Material

MJCF = """<mujoco><asset><texture name="t" type="2d" file="wood.png"/><material name="m" texture="t" {rgba}/></asset>
<worldbody><body name="b"><geom size="1" material="m"/></body></worldbody></mujoco>"""


def stage_of(rgba: str) -> str:
    return hx.dumps(hx.loads(MJCF.format(rgba=rgba), "mjcf"), "usd")


def colour(mechanism: Mechanism) -> tuple[float, ...] | None:
    return next(material.rgba for _, material in mechanism.vertices(Material))


@pytest.mark.unread
@pytest.mark.parametrize(
    ("rgba", "scale", "back"),
    [
        ('rgba=".5 .25 1 .75"', (0.5, 0.25, 1.0, 1.0), (0.5, 0.25, 1.0, 0.75)),
        ('rgba="1 1 1 .5"', None, None),
        ("", None, None),
    ],
)
def test_a_colour_is_the_scale_of_the_image_and_comes_back(
    rgba: str, scale: tuple[float, ...] | None, back: tuple[float, ...] | None
) -> None:
    text = stage_of(rgba)
    stage = Usd.Stage.CreateInMemory(".usda")
    assert stage.GetRootLayer().ImportFromString(text)
    (image,) = (shader for prim in stage.Traverse() if (shader := UsdShade.Shader(prim)) and shader.GetShaderId() == "UsdUVTexture")
    found = image.GetInput("scale")
    assert (tuple(found.Get()) if found else None) == scale
    assert colour(hx.loads(text, "usd").mechanism) == back


@pytest.mark.unread
def test_a_network_with_a_scale_is_typed_in_full() -> None:
    """Nothing of it is kept as text, so that another colour is written."""
    mechanism = hx.loads(stage_of('rgba=".5 .25 1 1"'), "usd").mechanism
    assert not any("scale" in extra.path or "UVTexture" in extra.text for found in mechanism.extras.values() for extra in found)
