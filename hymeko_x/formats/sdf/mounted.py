"""Cameras and IMUs that <gazebo> fragments hold, as parts on the links that they name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.formats.sdf.fragments import TAG, parsed
from hymeko_x.formats.sdf.notations import WrittenPose
from hymeko_x.formats.sdf.sensors import CAMERA_TURN, HFOV, IMAGE
from hymeko_x.formats.sdf.values import NUMBER, BadText, read_pose
from hymeko_x.ir.decimals import shortest
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.parts import Camera, Frame
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse, rpy_of
from hymeko_x.xml.printing import Tag, ready

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.xml.tree import XmlNode

CAMERAS = frozenset({"camera", "depth", "depth_camera", "rgbd", "rgbd_camera", "openni_kinect"})
"""The types of sensors that see as one camera; ``depth`` and ``openni_kinect`` are those of older Gazebos."""
Mounted = tuple[str, str, Pose, Camera | Frame]


def mounted_in(text: str) -> Iterator[Mounted]:
    """Link, name and pose in the link of each camera of a fragment, and of each IMU, of which the part is its frame."""
    if not text.startswith(f"<{TAG}") or "<sensor" not in text:
        return
    fragment = parsed(text)
    if fragment is None:
        return
    link = fragment.attributes.get("reference", "")
    for node in (child for child in fragment.children if child.tag == "sensor" and link):
        kind, name, camera = node.attributes.get("type"), node.attributes.get("name", "sensor"), node.child("camera")
        if kind in CAMERAS and camera is not None:
            pose = compose(_pose(node), _pose(camera))
            yield link, name, compose(pose, Pose(quat=CAMERA_TURN)), _camera(camera)
        elif kind == "imu":
            yield link, name, _pose(node), Frame()


def fragment_of(mounted: Mounted) -> str:
    """The fragment of a camera on a link, or of an IMU of which the part is its frame: what :func:`mounted_in` reads."""
    link, name, pose, part = mounted
    sensor = Tag("sensor", {"name": name, "type": "camera" if isinstance(part, Camera) else "imu"})
    placed = compose(pose, inverse(Pose(quat=CAMERA_TURN))) if isinstance(part, Camera) else pose
    if placed != IDENTITY:
        sensor.add("pose").children.append(numbers_text((*placed.xyz, *rpy_of(placed))))
    if isinstance(part, Camera):
        _add_camera(sensor.add("camera"), part)
    return ready(Tag(TAG, {"reference": link}, [sensor]), 1)


def _add_camera(tag: Tag, camera: Camera) -> None:
    """The horizontal field of view, from the vertical one and the shape of the image."""
    width, height = camera.resolution or tuple(int(field.default) for field in IMAGE)
    if camera.fovy is not None and width > 0 and height > 0:
        across = 2.0 * math.atan(math.tan(camera.fovy / 2.0) * width / height)
        tag.add("horizontal_fov").children.append(NUMBER.write(shortest(across)))
    image = tag.add("image")
    for field, value in zip(IMAGE, (width, height), strict=True):
        image.add(field.name).children.append(NUMBER.write(float(value)))


def _camera(node: XmlNode) -> Camera:
    """A camera with its vertical field of view, from the horizontal one and the shape of the image."""
    across = _number(node, HFOV.path, HFOV.default)
    width, height = (_number(node, field.path, field.default) for field in IMAGE)
    if not (0.0 < across < math.pi and width > 0.0 and height > 0.0):
        return Camera()
    return Camera(2.0 * math.atan(math.tan(across / 2.0) * height / width), (int(width), int(height)))


def _number(node: XmlNode, path: str, usual: float) -> float:
    """The number below a node at a path of tags."""
    found: XmlNode | None = node
    for tag in path.split("/"):
        found = None if found is None else found.child(tag)
    try:
        return usual if found is None else float(NUMBER.read(" ".join((found.text or "").split())))
    except BadText:
        return usual


def _pose(node: XmlNode) -> Pose:
    """The pose of a node in its parent; the identity without one that can be read."""
    child = node.child("pose")
    if child is None:
        return IDENTITY
    text = " ".join((child.text or "").split())
    try:
        return read_pose(WrittenPose(None, child.attributes.get("rotation_format"), child.attributes.get("degrees"), text))
    except BadText:
        return IDENTITY
