"""Patterns that MuJoCo makes itself: other formats have the mean colour of what MuJoCo shows."""

from __future__ import annotations

import itertools
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjmodels import read_text
from PIL import Image

import hymeko_x as hx
from hymeko_x.frontends.mjcf.colours import with_mean_colours
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.ir.parts import Layer, Material

RED_AND_GREEN = 'rgb1="1 0 0" rgb2="0 1 0" markrgb="0 0 1"'


def robot(texture: str, *, classes: str = "") -> Mechanism:
    """A body with two shapes in one material with the texture, of which the second has a colour of its own."""
    shapes = '<geom size="1" material="m"/><geom size="1" material="m" rgba=".8 .6 .4 .5"/>'
    assets = f'<texture name="t" {texture}/><material name="m" texture="t" rgba=".5 1 1 1"/>'
    return read_text(f'<mujoco>{classes}<asset>{assets}</asset><worldbody><body name="b">{shapes}</body></worldbody></mujoco>')


def colour(mechanism: Mechanism) -> tuple[float, ...] | None:
    return mechanism.vertex(Id("material", "m"), Material).rgba


@pytest.mark.parametrize(
    ("kind", "pattern", "mark"), [*itertools.product(("2d", "cube"), ("flat", "gradient", "checker"), ("none", "edge", "cross", "random"))]
)
def test_the_mean_colour_of_a_pattern_is_that_of_the_pixels_that_mujoco_makes(kind: str, pattern: str, mark: str) -> None:
    size = f'width="96" height="{96 if kind == "2d" else 576}"'
    texture = f'type="{kind}" builtin="{pattern}" mark="{mark}" {size} {RED_AND_GREEN}'
    model = mujoco.MjModel.from_xml_string(f'<mujoco><asset><texture name="t" {texture}/></asset></mujoco>')
    red, *others = model.tex_data.reshape(-1, 3).mean(axis=0) / 255.0
    assert colour(with_mean_colours(robot(texture))) == pytest.approx((0.5 * red, *others, 1.0), abs=0.012)
    assert np.sum((red, *others)) == pytest.approx(1.0, abs=0.005)


def test_a_colour_of_a_shape_is_multiplied_and_the_pattern_is_gone() -> None:
    found = with_mean_colours(robot(f'type="2d" builtin="checker" width="8" height="8" {RED_AND_GREEN}'))
    assert [view.shape.rgba for view in found.shapes[Id("body", "b")]] == [None, (0.4, 0.3, 0.0, 0.5)]
    assert not list(found.edges(Layer))
    assert with_mean_colours(found) is found


def test_a_pattern_of_a_default_class_counts() -> None:
    classes = '<default><texture type="2d" builtin="flat" rgb1="1 .5 0" width="8" height="8"/></default>'
    assert colour(with_mean_colours(robot("", classes=classes))) == (0.5, 0.5, 0.0, 1.0)


def test_an_image_stays() -> None:
    found = robot('type="2d" file="wood.png"')
    assert with_mean_colours(found) is found


@pytest.mark.parametrize("folder", ["", "images"])
def test_a_cube_of_six_images_has_their_mean_colour(folder: str, tmp_path: Path) -> None:
    sides = ("fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")
    (tmp_path / folder).mkdir(exist_ok=True)
    for number, side in enumerate(sides):
        Image.new("RGB", (4, 4), (51 * number, 255, 0)).save(tmp_path / folder / f"{side}.png")
    images = " ".join(f'{side}="{side}.png"' for side in sides)
    texture = f'<texture name="t" type="cube" {images}/>'
    assets = f'<asset>{texture}<material name="m" texture="t"/></asset>'
    head = f'<compiler texturedir="{folder}"/>' if folder else ""
    ball = '<body name="b"><geom size="1" material="m"/></body>'
    (tmp_path / "a.xml").write_text(f"<mujoco>{head}{assets}<worldbody>{ball}</worldbody></mujoco>")
    hx.convert(tmp_path / "a.xml", tmp_path / "a.urdf")
    assert '<color rgba="0.5 1 0 1"/>' in (tmp_path / "a.urdf").read_text()
    hx.convert(tmp_path / "a.xml", tmp_path / "a.sdf")
    assert "<diffuse>0.5 1 0 1</diffuse>" in (tmp_path / "a.sdf").read_text()


def test_urdf_has_the_mean_colour_and_mjcf_comes_back_with_its_pattern() -> None:
    source = hx.loads(
        robot_text := hx.dumps(hx.Robot(robot(f'type="cube" builtin="flat" width="8" {RED_AND_GREEN}')), "mjcf"), "mjcf"
    ).mechanism
    urdf = hx.dumps(source, "urdf", keep="inside")
    assert '<color rgba="0.4167 0.1667 0 1"/>' in urdf
    assert hx.dumps(hx.loads(urdf, "urdf"), "mjcf") == robot_text


@pytest.mark.parametrize("texture", ['width="0" height="0" mark="edge"', 'width="-3" mark="cross"', 'rgb1="nan 0 0"'])
def test_a_pattern_that_mujoco_would_refuse_ends_in_no_crash(texture: str) -> None:
    text = hx.dumps(hx.Robot(robot(f'type="2d" builtin="checker" {texture}')), "urdf")
    assert "nan" not in text
