"""<site>, <camera> and <light>."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.backends.mjcf.native.parameters import parameter_attributes
from hymeko_x.backends.mjcf.native.spot import Op, Spot
from hymeko_x.formats.mjcf_places import CAMERA, LIGHT, SITE, seen_from
from hymeko_x.ir.mechanism import pose_weight
from hymeko_x.ir.parts import Camera, Frame, Light, Mount

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.formats.mjcf_codec import Group
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.ir.values import Pose

Mounts = dict["Id", list[tuple["Id", "Pose"]]]


def mounts_of(mechanism: Mechanism) -> Mounts:
    """For each body what is mounted on it, with its pose there."""
    found: Mounts = {}
    for _, _, arcs in mechanism.edges(Mount):
        body = next((arc for arc in arcs if arc.sign > 0), None)
        thing = next((arc for arc in arcs if arc.sign < 0), None)
        if body is not None and thing is not None:
            found.setdefault(body.target, []).append((thing.target, pose_weight(body)))
    return found


def mount_ops(sheet: Sheet, spot: Spot, mounts: Mounts) -> list[Op]:
    """What is mounted on a body."""
    ops = []
    for key, pose in mounts.get(spot.body, ()):
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
