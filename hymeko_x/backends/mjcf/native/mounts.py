"""<site>, <camera> and <light>."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.backends.mjcf.native.parameters import parameter_attributes
from hymeko_x.backends.mjcf.native.spot import Op, Spot
from hymeko_x.formats.mjcf.places import CAMERA, LIGHT, SITE, seen_from
from hymeko_x.ir.parts import Camera, Frame, Light

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.formats.mjcf.codec import Group
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Parameters


def mount_ops(sheet: Sheet, spot: Spot) -> list[Op]:
    """What is mounted on a body."""
    ops = []
    for _, key, _, pose in sheet.mechanism.mounts.get(spot.body, ()):
        match sheet.mechanism.graph.vertices.get(key):
            case Frame(size=size):
                ops.append(_op(sheet, spot, key, "site", SITE, {"pose": pose, "size": size}, ()))
            case Camera(fovy, resolution, parameters):
                numbers = () if resolution is None else tuple(map(float, resolution))
                ops.append(_op(sheet, spot, key, "camera", CAMERA, {"pose": pose, "fovy": fovy, "resolution": numbers}, parameters))
            case Light(kind, diffuse, parameters):
                ops.append(_op(sheet, spot, key, "light", LIGHT, {"pose": pose, "kind": kind, "diffuse": diffuse or ()}, parameters))
            case _:
                continue
    return ops


def _op(sheet: Sheet, spot: Spot, key: Id, tag: str, groups: tuple[Group, ...], values: dict[str, Any], parameters: Parameters) -> Op:
    notes, said = sheet.notes(key), sheet.said(key)
    around = spot.around(notes.get("frame"))
    own_class = sheet.own_class(key)
    base = sheet.base(tag, own_class, spot.childclass_in(around))
    if around is not None:
        groups = (seen_from(groups[0], around.pose), *groups[1:])
    attributes: Attributes = {
        "name": sheet.name(key),
        "class": own_class,
        **sheet.attributes(values, groups, base, notes, said),
        **parameter_attributes(parameters, base),
        **said,
    }
    return Op("leaf", tag, attributes, tuple(sheet.inside(key)), around)
