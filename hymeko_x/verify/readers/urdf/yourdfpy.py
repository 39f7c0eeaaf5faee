"""URDF through yourdfpy: a second reading of the kinematics, and the shapes, which Pinocchio does not hand to Python."""

from __future__ import annotations

import contextlib
import io
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct

from hymeko_x.verify import kinematics
from hymeko_x.verify.model import WORLD, Array, Body, Dof, Joint, Kind, KinematicModel, MeshFile, Role, Shape, parents_first, world_body
from hymeko_x.verify.readers.urdf.deferred import without_trimesh

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.source import Files
    from hymeko_x.verify.readers.lookup import Lookup

_MOVING = ("revolute", "continuous", "prismatic")


class Mimic(Struct, frozen=True):
    """follower = multiplier * leader + offset."""

    follower: str
    leader: str
    multiplier: float
    offset: float


class Second(Struct, frozen=True, eq=False):
    """The robot by yourdfpy; ``robot`` and ``shapes`` are None when it refused the file, with the reason in ``notes``.

    ``axisless`` is a joint whose axis is zero, which urdfdom replaces by its default.
    """

    robot: Any | None
    shapes: Mapping[str, tuple[Shape, ...]] | None
    mimics: tuple[Mimic, ...]
    axisless: str = ""
    notes: tuple[str, ...] = ()


def load(data: bytes, path: Path, lookup: Lookup) -> Second:
    """The file through yourdfpy; its refusal is a note, not an error, because urdfdom is authoritative."""
    from lxml import etree

    yourdfpy = without_trimesh("yourdfpy")
    try:
        with _silent("yourdfpy.urdf"):
            robot = yourdfpy.URDF.load(_well_formed(data), build_scene_graph=False, load_meshes=False).robot
    except (yourdfpy.urdf.URDFError, etree.LxmlError, ValueError, TypeError, KeyError, AttributeError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        return Second(
            None, None, (), notes=(f"yourdfpy refuses the file ({reason}): shapes are not compared, and there is no second reading",)
        )
    mimics = tuple(
        Mimic(j.name, j.mimic.joint, 1.0 if j.mimic.multiplier is None else j.mimic.multiplier, j.mimic.offset or 0.0)
        for j in robot.joints
        if j.mimic
    )
    shapes, notes = _all_shapes(robot, lookup.files(path.parent))
    axisless = next((j.name for j in robot.joints if j.type in _MOVING and j.axis is not None and not np.any(j.axis)), "")
    return Second(robot, shapes, mimics, axisless, notes)


def _all_shapes(robot: Any, files: Files) -> tuple[dict[str, tuple[Shape, ...]] | None, tuple[str, ...]]:
    """The shapes by link; none, and why, where yourdfpy returns sizes of a wrong kind."""
    link = None
    try:
        found = {}
        for link in robot.links:
            found[link.name] = tuple(_shapes(link, files))
    except (ValueError, TypeError) as error:
        reason = " ".join(str(error).split())
        return None, (f"a shape of link '{link and link.name}' has another size than it may have ({reason}): shapes are not compared",)
    return found, ()


@contextlib.contextmanager
def _silent(name: str) -> Iterator[None]:
    """yourdfpy logs what it repairs; whether that is an error is for urdfdom to decide."""
    logger = logging.getLogger(name)
    before = logger.disabled
    logger.disabled = True
    try:
        yield
    finally:
        logger.disabled = before


def _shapes(link: Any, files: Files) -> Iterator[Shape]:
    for role, elements in ((Role.VISUAL, link.visuals), (Role.COLLISION, link.collisions)):
        for element in elements or ():
            kind, size, mesh = _geometry(element.geometry, files)
            if kind:
                pose = np.eye(4) if element.origin is None else np.asarray(element.origin, dtype=float)
                yield Shape(kind, role, pose, size, element.name, mesh)


def _geometry(geometry: Any, files: Files) -> tuple[str, tuple[float, ...], MeshFile | None]:
    """Kind, size in m, and mesh file; the kind is "" where there is no geometry."""
    if geometry is None:
        return "", (), None
    if geometry.box is not None:
        return "box", tuple(float(x) for x in geometry.box.size), None
    if geometry.sphere is not None:
        return "sphere", (float(geometry.sphere.radius),), None
    if geometry.cylinder is not None:
        return "cylinder", (float(geometry.cylinder.radius), float(geometry.cylinder.length)), None
    if geometry.mesh is None:
        return "", (), None
    scale = np.asarray(1.0 if geometry.mesh.scale is None else geometry.mesh.scale, dtype=float).reshape(-1)
    if scale.size not in (1, 3):
        raise ValueError(f"a scale of {scale.size} numbers")
    x, y, z = (float(number) for number in np.broadcast_to(scale, 3))
    uri = str(geometry.mesh.filename)
    path = files.find(uri)
    return "mesh", (), MeshFile(uri, None if path is None else Path(path), (x, y, z))


def _well_formed(data: bytes) -> io.BytesIO:
    """The text as a file, repaired where lxml refuses it and urdfdom does not."""
    from lxml import etree

    try:
        etree.fromstring(data)
    except etree.XMLSyntaxError:
        mended = etree.fromstring(data, etree.XMLParser(recover=True))
        return io.BytesIO(data if mended is None else etree.tostring(mended))
    return io.BytesIO(data)


# ---- second reading --------------------------------------------------------------------------------------------------


def disagreement(model: KinematicModel, second: Second) -> str:
    """Where yourdfpy's kinematics differ from the model's at random configurations; "" when they agree everywhere.

    yourdfpy keeps axes as they are written while urdfdom's users normalise them, so they are normalised here.
    """
    if second.robot is None:
        return ""
    other = _kinematics(second.robot, model)
    if sorted(str(body.name) for body in model.bodies) != sorted(str(body.name) for body in other.bodies):
        return "they disagree on the links"
    numbers = {body.name: index for index, body in enumerate(other.bodies[1:], start=1)}
    order = [WORLD, *(numbers[body.name] for body in model.bodies[1:])]
    return kinematics.disagreement(model, lambda q: kinematics.prepare(other).poses(_same_coordinates(model, other, q))[:, order])


def _kinematics(robot: Any, model: KinematicModel) -> KinematicModel:
    """yourdfpy's joints as a model; joints with several dofs are taken from the first reader, yourdfpy does not move them."""
    joints = {joint.child: joint for joint in robot.joints}
    children: dict[str, list[str]] = {}
    for joint in robot.joints:
        children.setdefault(joint.parent, []).append(joint.child)
    has_world_link = any(body.name == "world" for body in model.bodies[1:])
    bodies: list[Body] = [world_body()]
    numbers: dict[str, int] = {}
    for name in parents_first([link.name for link in robot.links if link.name not in joints], children):
        joint = joints.get(name)
        if joint is None and name == "world" and not has_world_link:
            numbers[name] = WORLD
            continue
        numbers[name] = len(bodies)
        parent = WORLD if joint is None else numbers[joint.parent]
        bodies.append(Body(name, parent, Joint(open=True) if joint is None else _joint(joint, model)))
    return KinematicModel(robot.name or "", model.format, "yourdfpy", tuple(bodies))


def _joint(joint: Any, model: KinematicModel) -> Joint:
    origin = np.eye(4) if joint.origin is None else np.asarray(joint.origin, dtype=float)
    if joint.type == "fixed":
        return Joint(joint.name, origin)
    if joint.type not in _MOVING:
        index = next((i for i, body in enumerate(model.bodies[1:], start=1) if body.name == joint.child), WORLD)
        return Joint(joint.name, origin, model.bodies[index].joint.dofs)
    axis: Array = np.asarray(joint.axis, dtype=float)
    length = float(np.linalg.norm(axis))
    kind = Kind.SLIDE if joint.type == "prismatic" else Kind.HINGE
    return Joint(joint.name, origin, (Dof(kind, axis / length if length > 0 else axis, name=joint.name),))


def _same_coordinates(model: KinematicModel, other: KinematicModel, q: Array) -> Array:
    """The configurations of one reader in the column order of the other."""
    columns: list[int] = []
    numbers = {body.name: index for index, body in enumerate(model.bodies[1:], start=1)}
    for body in other.bodies[1:]:
        first = model.first_dof[numbers.get(body.name, WORLD)]
        for number, dof in enumerate(body.joint.dofs, start=first):
            start = model.columns[number] if number < len(model.columns) else 0
            columns.extend(range(start, start + dof.kind.width))
    return q[:, columns]
