"""The colours of patterns and of cubes of six images, which other formats cannot represent.

MuJoCo multiplies the image of a <texture>, whether it makes it itself or reads it, with the colour of material or shape.
"""

from __future__ import annotations

import contextlib
import math
from operator import mul
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.formats.mjcf.classes import Classes, merge
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.formats.mjcf.words import NAME, compilers, joined, settings_of
from hymeko_x.ir.mechanism import ROOT, end_of
from hymeko_x.ir.parts import Layer, Material, Texture
from hymeko_x.source import NO_FILES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.ir.parts import Rgba
    from hymeko_x.source import Files

_WHITE = (1.0, 1.0, 1.0, 1.0)
_DECIMALS = 4
"""Finer than the 256 steps of a screen."""
_DEFAULTS = {"builtin": "none", "type": "cube", "rgb1": "0.8 0.8 0.8", "rgb2": "0.5 0.5 0.5", "markrgb": "0 0 0", "random": "0.01"}
_FIRST = {"flat cube": 5.0 / 6.0, "flat 2d": 1.0, "checker cube": 0.5, "checker 2d": 0.5, "gradient cube": 0.5, "gradient 2d": 0.24}
"""The part of the pixels that have the first colour of a pattern, by its type: a flat cube has the second colour on its lower side."""


_SIDES = ("fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")


def with_mean_colours(mechanism: Mechanism, *, files: Files = NO_FILES) -> Mechanism:
    """The mechanism in which materials and shapes with a pattern have the mean colour that MuJoCo shows, and the pattern is gone.

    A cube of six images is treated as a pattern.
    """
    layers = _patterned(mechanism, files)
    if not layers:
        return mechanism
    means = dict(layers.values())
    materials = {key: replace(part, rgba=_times(part.rgba, means[key])) for key, part in mechanism.vertices(Material) if key in means}
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.every_shape():
        if view.shape.rgba is not None and view.material in means:
            shape = replace(view.shape, rgba=_times(view.shape.rgba, means[view.material]))
            edges[view.id] = replace(mechanism.graph.edges[view.id], data=shape)
    return mechanism.replace(vertices=materials, edges=edges, without=layers)


def _patterned(mechanism: Mechanism, files: Files) -> dict[Id, tuple[Id, Rgba]]:
    """The layers that colour a material with a pattern: the material, and the mean colour of the pattern."""
    patterns = [key for key, texture in mechanism.vertices(Texture) if texture.uri is None]
    if not patterns:
        return {}
    classes = Classes(parse_text(extra.text) for extra in mechanism.extras.get(ROOT, ()) if extra.text.startswith("<default"))
    made = {key: _attributes(mechanism, key, classes) for key in patterns}
    settings = settings_of([parse_text(text).attributes for text in compilers(mechanism)])
    means = {key: _mean(texture) or _mean_of_sides(texture, settings, files) for key, texture in made.items()}
    found: dict[Id, tuple[Id, Rgba]] = {}
    for key, layer, arcs in mechanism.edges(Layer):
        mean = next((means.get(arc.target) for arc in arcs if arc.sign > 0), None)
        material = end_of(arcs, -1)
        if layer.use == "rgb" and mean is not None and material is not None:
            found[key] = material, mean
    return found


def _attributes(mechanism: Mechanism, texture: Id, classes: Classes) -> Mapping[str, str]:
    """What a texture has of its own, of its class, and of MuJoCo."""
    own = {extra.path[1:]: extra.text for extra in mechanism.extras.get(texture, ()) if extra.format == NAME and extra.path.startswith("@")}
    given = classes.of("texture", next(iter(mechanism.stereotypes.get(texture, ())), None))
    return {**_DEFAULTS, **merge(given, own)}


def _mean(texture: Mapping[str, str]) -> Rgba | None:
    """The mean colour of a pattern; None for a texture that is none, or has colours that are no numbers."""
    first = _FIRST.get(f"{texture['builtin']} {texture['type']}")
    if first is None:
        return None
    marked = _marked(texture)
    parts = ((1.0 - marked) * first, (1.0 - marked) * (1.0 - first), marked)
    colours = ([float(number) for number in texture[name].split()] for name in ("rgb1", "rgb2", "markrgb"))
    red, green, blue = (sum(map(mul, parts, channels)) for channels in zip(*colours, strict=True))
    return (red, green, blue, 1.0) if all(map(math.isfinite, (red, green, blue))) else None


def _mean_of_sides(texture: Mapping[str, str], settings: Settings, files: Files) -> Rgba | None:
    """The mean colour of the images of the sides of a cube; None where there is none that can be read."""
    from hymeko_x.meshes.images import UnreadableImage, pixels

    means = []
    for uri in [joined(settings.texture_folder, texture[side], settings) for side in _SIDES if side in texture]:
        path = files.find(uri)
        with contextlib.suppress(OSError, UnreadableImage):  # which MuJoCo refuses by itself
            means.append(pixels(files.read(path or uri)).mean())
    if not means:
        return None
    red, green, blue = (sum(channel) / len(means) for channel in zip(*means, strict=True))
    return red, green, blue, 1.0


def _marked(texture: Mapping[str, str]) -> float:
    """The part of the pixels of a pattern that a mark covers; the sides of a cube are squares."""
    width = max(1.0, float(texture.get("width", "1")))
    height = width if texture["type"] == "cube" else max(1.0, float(texture.get("height", "1")))
    match texture.get("mark"):
        case "edge":
            return 1.0 - max(0.0, 1.0 - 2.0 / width) * max(0.0, 1.0 - 2.0 / height)
        case "cross":
            return 1.0 - (1.0 - 1.0 / width) * (1.0 - 1.0 / height)
        case "random":
            return float(texture["random"])
        case _:
            return 0.0


def _times(rgba: Rgba | None, mean: Rgba) -> Rgba:
    red, green, blue, alpha = (round(value * factor, _DECIMALS) for value, factor in zip(rgba or _WHITE, mean, strict=True))
    return red, green, blue, alpha
