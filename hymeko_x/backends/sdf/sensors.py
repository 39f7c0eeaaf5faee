"""<sensor> and <light>."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf.sensors import CAMERA_TURN, DOWN, HFOV, IMAGE, LIGHTS
from hymeko_x.formats.sdf.values import COLOUR, NUMBER, VECTOR, BadText, ValueField
from hymeko_x.ir.parts import Camera, Light, Sensor
from hymeko_x.ir.values import NO_ROTATION, Pose, compose, inverse, quat_from_z, scaled, unit
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from hymeko_x.backends.sdf.sheet import SdfSheet
    from hymeko_x.ir.mechanism import Id, MountView

_RATE = ValueField("update_rate", "rate", NUMBER)


def sensor_tag(view: MountView, scope: str, body: Id, sheet: SdfSheet) -> Tag:
    """The <sensor> of a sensor or a camera on a link."""
    key = view.mounted
    part = sheet.mechanism.graph.vertices[key]
    tag = Tag("sensor", {"name": _name(key, scope, sheet), "type": part.kind if isinstance(part, Sensor) else "camera"})
    turn = Pose(quat=CAMERA_TURN) if isinstance(part, Camera) else Pose()
    sheet.add_pose(tag, key, scope, body, pose=compose(view.pose, inverse(turn)))
    if isinstance(part, Camera):
        _add_camera(tag.add("camera"), part, key, sheet)
    elif isinstance(part, Sensor):
        sheet.put(tag, _RATE, part.rate, sheet.written(key))
    sheet.put_back(tag, key)
    return tag


def joint_sensor_tag(key: Id, scope: str, sheet: SdfSheet) -> Tag:
    """The <sensor> of a joint."""
    part = sheet.mechanism.vertex(key, Sensor)
    tag = Tag("sensor", {"name": _name(key, scope, sheet), "type": part.kind})
    sheet.put(tag, _RATE, part.rate, sheet.written(key))
    sheet.put_back(tag, key)
    return tag


def _name(key: Id, scope: str, sheet: SdfSheet) -> str:
    return words.split_scope(sheet.name(key, scope))[1]


def _add_camera(tag: Tag, camera: Camera, key: Id, sheet: SdfSheet) -> None:
    """The horizontal field of view, from the vertical one and the shape of the image."""
    width, height = camera.resolution or tuple(int(field.default) for field in IMAGE)
    texts = sheet.written(key)
    own = texts.get("camera/horizontal_fov")
    if camera.fovy is not None and width > 0 and height > 0:
        across = 2.0 * math.atan(math.tan(camera.fovy / 2.0) * width / height)
        if own is not None and abs(NUMBER.read(own) - across) < 1e-12:
            tag.add("horizontal_fov").children.append(own)
        elif own is not None or not sheet.from_sdf or abs(across - HFOV.default) > 1e-12:
            sheet.put(tag, ValueField(HFOV.path, HFOV.name, NUMBER), across, {})
    for field, value in zip(IMAGE, (width, height), strict=True):
        if camera.resolution is not None:
            sheet.put(
                tag, ValueField(field.path, field.name, NUMBER, field.default if sheet.from_sdf else None), float(value), texts, "camera/"
            )


def light_tag(view: MountView, scope: str, body: Id, sheet: SdfSheet) -> Tag:
    """The <light> of a light; its direction is along its own -z unless its author gave it another one."""
    key = view.mounted
    light = sheet.mechanism.vertex(key, Light)
    texts = sheet.written(key)
    tag = Tag("light", {"name": _name(key, scope, sheet), "type": LIGHTS.get(light.kind, light.kind if sheet.from_sdf else "point")})
    turn, direction = Pose(), texts.get("direction")
    if direction is not None:
        try:
            quat = quat_from_z(unit(scaled(VECTOR.read(direction), -1.0)))
            turn = turn if quat == NO_ROTATION else Pose(quat=quat)
        except (BadText, ZeroDivisionError):
            direction = None
    sheet.add_pose(tag, key, scope, body, pose=compose(view.pose, inverse(turn)))
    if light.diffuse is not None:
        own = texts.get("diffuse")
        kept = own is not None and COLOUR.read(own)[:3] == light.diffuse
        tag.add("diffuse").children.append(own if kept and own is not None else COLOUR.write((*light.diffuse, 1.0)))
    if direction is not None:
        tag.add("direction").children.append(direction)
    elif not sheet.from_sdf:
        tag.add("direction").children.append(VECTOR.write(DOWN))
    sheet.put_back(tag, key)
    return tag
