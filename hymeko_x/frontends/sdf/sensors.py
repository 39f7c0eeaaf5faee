"""<sensor> and <light>: what is mounted on links, joints and the world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf.sensors import CAMERA_TURN, DOWN, HFOV, IMAGE, LIGHTS
from hymeko_x.formats.sdf.values import COLOUR, NUMBER, VECTOR
from hymeko_x.ir.mechanism import WORLD, mount_edge, sense_edge
from hymeko_x.ir.parts import Camera, Light, Sensor, World
from hymeko_x.ir.values import NO_ROTATION, Pose, compose, quat_from_z, scaled, unit

if TYPE_CHECKING:
    from hymeko_x.frontends.sdf.builder import SdfBuilder, SdfModel
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.xml.tree import XmlNode


def read_link_sensor(node: XmlNode, body: Id, model: SdfModel, builder: SdfBuilder) -> None:
    """A sensor on a link; a plain camera is a camera. What its kind has of its own stays as written."""
    camera = node.child("camera")
    if node.attributes.get("type") == "camera" and camera is not None:
        key = _own(node, "camera", model.scope, builder)
        pose = compose(_pose(node, key, body, model, builder), Pose(quat=CAMERA_TURN))
        node.take("type")
        camera.taken = True
        builder.vertices[key] = _read_camera(camera, key, builder)
    else:
        key = _own(node, "sensor", model.scope, builder)
        pose = _pose(node, key, body, model, builder)
        builder.vertices[key] = _read_sensor(node, key, builder)
    builder.edges[builder.names.take("mount", key.name)] = mount_edge(body, key, pose)


def read_joint_sensor(node: XmlNode, joint: Id, model: SdfModel, builder: SdfBuilder) -> None:
    """A sensor of a joint, which measures it; its pose stays as written."""
    key = _own(node, "sensor", model.scope, builder)
    builder.vertices[key] = _read_sensor(node, key, builder)
    builder.edges[builder.names.take("sense", key.name)] = sense_edge(joint, key)


def _own(node: XmlNode, kind: str, scope: str, builder: SdfBuilder) -> Id:
    """The id of a sensor or light; another link may have one of the same name."""
    name = node.take("name") or node.tag
    wanted = words.scoped(scope, name).removeprefix(words.WORLD_SCOPE)
    node.owner = key = builder.fresh(kind, wanted, node.origin)
    if key.name != wanted:
        builder.written.setdefault(key, {})["@name"] = name
    return key


def _pose(node: XmlNode, key: Id, body: Id, model: SdfModel, builder: SdfBuilder) -> Pose:
    pose, name = builder.pose(node, key)
    frame = builder.base_of(node, model.scope, name, body)
    return pose if frame == body else compose(builder.frames.relative(frame, body), pose)


def _read_sensor(node: XmlNode, key: Id, builder: SdfBuilder) -> Sensor:
    rate = builder.child_value(node, "update_rate", NUMBER, None, key, "update_rate")
    return Sensor(node.take("type") or "none", rate)


def _read_camera(node: XmlNode, key: Id, builder: SdfBuilder) -> Camera:
    """A camera with its vertical field of view, from the horizontal one and the shape of the image."""
    has_field = node.has(HFOV.path)
    across = builder.value(node, HFOV, key, "camera/")
    width, height = (builder.value(node, field, key, "camera/") for field in IMAGE)
    if not (0.0 < across < math.pi and width > 0 and height > 0):
        return Camera(None, (int(width), int(height)) if width > 0 and height > 0 else None)
    if has_field:
        builder.written.setdefault(key, {}).setdefault("camera/horizontal_fov", NUMBER.write(across))
    return Camera(2.0 * math.atan(math.tan(across / 2.0) * height / width), (int(width), int(height)))


# ---- lights ------------------------------------------------------------------------------------------------------------------


def read_light(node: XmlNode, body: Id, model: SdfModel, builder: SdfBuilder) -> None:
    """A light on a link, or on the world; it shines along its own -z, whatever direction the file gives in its frame."""
    key = _own(node, "light", model.scope, builder)
    kind = node.take("type") or "point"
    pose = _pose(node, key, body, model, builder)
    diffuse = builder.child_value(node, "diffuse", COLOUR, None, key, "diffuse")
    direction = builder.child_value(node, "direction", VECTOR, DOWN, key, "direction")
    if direction != DOWN and any(direction):
        builder.written.setdefault(key, {})["direction"] = VECTOR.write(direction)
        turn = quat_from_z(unit(scaled(direction, -1.0)))
        pose = pose if turn == NO_ROTATION else compose(pose, Pose(quat=turn))
    if diffuse is not None:
        builder.written.setdefault(key, {}).setdefault("diffuse", COLOUR.write(diffuse))
    builder.vertices[key] = Light(LIGHTS.get(kind, kind), None if diffuse is None else diffuse[:3])
    if body == WORLD:
        builder.vertices.setdefault(WORLD, World())
    builder.edges[builder.names.take("mount", key.name)] = mount_edge(body, key, pose)
