"""<site>, <camera> and <light>: what is mounted on bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.mjcf.codec import parameter_value
from hymeko_x.formats.mjcf.notations import frame_of
from hymeko_x.formats.mjcf.places import CAMERA, LIGHT, SITE
from hymeko_x.formats.mjcf.words import PLAIN_ATTRIBUTES
from hymeko_x.frontends.mjcf.builder import BodyScope, placed
from hymeko_x.ir.mechanism import mount_edge
from hymeko_x.ir.parts import Camera, Frame, Light

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.formats.mjcf.codec import AttributeGroup
    from hymeko_x.frontends.mjcf.builder import MjcfBuilder, Values
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.xml.tree import XmlNode

    Names = tuple[str, ...]


def read_site(element: XmlNode, scope: BodyScope, builder: MjcfBuilder) -> None:
    """A named pose on a body."""
    key, found, _ = _read(element, scope, "frame", SITE, builder)
    builder.vertices[key] = Frame(found["size"])
    builder.keep(element, key)


def read_camera(element: XmlNode, scope: BodyScope, builder: MjcfBuilder) -> None:
    """A camera; the body that it follows is among its parameters."""
    key, found, base = _read(element, scope, "camera", CAMERA, builder)
    width, height = found["resolution"] or (0.0, 0.0)
    resolution = (int(width), int(height)) if found["resolution"] else None
    builder.vertices[key] = Camera(found["fovy"], resolution, take_parameters(element, base))
    builder.keep(element, key)


def read_light(element: XmlNode, scope: BodyScope, builder: MjcfBuilder) -> None:
    """A light."""
    key, found, base = _read(element, scope, "light", LIGHT, builder)
    x, y, z = found["diffuse"] or (0.0, 0.0, 0.0)
    builder.vertices[key] = Light(found["kind"], (x, y, z) if found["diffuse"] else None, take_parameters(element, base))
    builder.keep(element, key)


def take_parameters(element: XmlNode, base: Mapping[str, str], resolved: Names = (), law: Names = ()) -> Parameters:
    """Every unread attribute that differs from the class's, as a parameter.

    Those in ``resolved`` and ``law`` are parameters even where the class gives them; the former come first, of the latter come last
    those that only the class gives.
    """
    own = {name: element.attributes.pop(name) for name in list(element.attributes) if name not in PLAIN_ATTRIBUTES}
    first = [(name, own.get(name, base.get(name))) for name in resolved]
    found = [(name, parameter_value(name, text)) for name, text in first if text is not None]
    for name, text in own.items():
        value = parameter_value(name, text)
        if name not in resolved and (name in law or name not in base or parameter_value(name, base[name]) != value):
            found.append((name, value))
    found += [(name, parameter_value(name, base[name])) for name in law if name in base and name not in own]
    return tuple(found)


def _read(
    element: XmlNode, scope: BodyScope, kind: str, groups: tuple[AttributeGroup, ...], builder: MjcfBuilder
) -> tuple[Id, Values, Mapping[str, str]]:
    key = builder.own(element, kind, f"{scope.body.name}/{element.tag}")
    base = builder.base(element, key, scope.childclass)
    if scope.frame:
        builder.note(key, frame_of(), scope.frame)
    found = builder.values(element, groups, base, key, always=bool(scope.frame))
    builder.show(key)
    mount = builder.names.take("mount", key.name)
    builder.edges[mount] = mount_edge(scope.body, key, placed(found["pose"], scope))
    builder.show(mount)
    return key, found, base
