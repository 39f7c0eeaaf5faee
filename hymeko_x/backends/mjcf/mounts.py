"""<site>, <camera> and <light>."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.formats.mjcf import LIGHTS
from hymeko_x.formats.mjcf.places import CAMERA, LIGHT, SITE, seen_from
from hymeko_x.ir.parts import Camera, Frame, Light

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.frames import BodyTag
    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.formats.mjcf.codec import AttributeGroup
    from hymeko_x.ir.mechanism import Id, MountView
    from hymeko_x.ir.parts import Parameters

_PLAIN_LIGHT = (LIGHT[1], LIGHT[0], LIGHT[2])
"""With its type first, as one reads it."""


def write_mount(sheet: MjcfSheet, body: BodyTag, mount: MountView) -> None:
    """A frame, camera or light on its body."""
    key, pose = mount.mounted, mount.pose
    match sheet.mechanism.graph.vertices.get(key):
        case Frame(size=size):
            _add(sheet, body, key, "site", SITE, {"pose": pose, "size": size}, ())
        case Camera(fovy, resolution, parameters):
            numbers = () if resolution is None else tuple(map(float, resolution))
            _add(sheet, body, key, "camera", CAMERA, {"pose": pose, "fovy": fovy, "resolution": numbers}, parameters)
        case Light(kind, diffuse, parameters):
            known = kind if kind in LIGHTS or sheet.from_mjcf else LIGHTS[0]
            groups = LIGHT if sheet.from_mjcf else _PLAIN_LIGHT
            _add(sheet, body, key, "light", groups, {"pose": pose, "kind": known, "diffuse": diffuse or ()}, parameters)
        case _:
            return


def _add(
    sheet: MjcfSheet, body: BodyTag, key: Id, tag: str, groups: tuple[AttributeGroup, ...], values: dict[str, Any], parameters: Parameters
) -> None:
    notations, kept = sheet.notations(key), sheet.kept_attributes(key)
    frame = body.frame_of(sheet, key)
    own_class = sheet.own_class(key)
    base = sheet.base(tag, own_class, body.childclass if frame is None else frame.childclass)
    if frame is not None:
        groups = (seen_from(groups[0], frame.pose), *groups[1:])
    attributes = {
        "name": sheet.name(key),
        "class": own_class,
        **sheet.attributes(values, groups, base, notations, kept),
        **sheet.parameters(parameters, f"body/{tag}", base),
        **kept,
    }
    body.add(tag_of(tag, attributes, sheet.inside(key)), frame)
