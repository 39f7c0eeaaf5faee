"""URDF through yourdfpy: the second opinion on kinematics, and the shapes, which urdfdom does not hand to Python."""

from __future__ import annotations

import contextlib
import io
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct

from hymeko_x.verify.kinematics import draw, prepare
from hymeko_x.verify.model import WORLD, Array, Body, Dof, Joint, Kind, KinematicModel, MeshFile, Role, Shape, grounded
from hymeko_x.verify.spatial import angle_between

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.source import Files
    from hymeko_x.verify.readers import Places

_MOVING = ("revolute", "continuous", "prismatic")
_SLACK = 1e-9  # m and rad; both readers work in doubles


class Mimic(Struct, frozen=True):
    """follower = multiplier * leader + offset."""

    follower: str
    leader: str
    multiplier: float
    offset: float


class Second(Struct, frozen=True, eq=False):
    """What yourdfpy read; ``robot`` and ``shapes`` are None when it refused the file, and ``notes`` say so.

    ``still`` is a joint whose axis is zero, which urdfdom takes for a default.
    """

    robot: Any | None
    shapes: Mapping[str, tuple[Shape, ...]] | None
    mimics: tuple[Mimic, ...]
    still: str = ""
    notes: tuple[str, ...] = ()


def load(data: bytes, path: Path, places: Places) -> Second:
    """The file through yourdfpy; its refusal is a note, not an error, because urdfdom decides."""
    import yourdfpy
    from lxml import etree

    try:
        with _hushed("yourdfpy.urdf"):
            robot = yourdfpy.URDF.load(_well_formed(data), build_scene_graph=False, load_meshes=False).robot
    except (yourdfpy.urdf.URDFError, etree.LxmlError, ValueError, TypeError, KeyError, AttributeError) as error:
        words = " ".join(str(error).split()) or type(error).__name__
        said = f"yourdfpy refuses the file ({words}): shapes are not compared, and there is no second opinion"
        return Second(None, None, (), notes=(said,))
    mimics = tuple(
        Mimic(j.name, j.mimic.joint, 1.0 if j.mimic.multiplier is None else j.mimic.multiplier, j.mimic.offset or 0.0)
        for j in robot.joints
        if j.mimic
    )
    shapes, notes = _all_shapes(robot, places.files(path.parent))
    still = next((j.name for j in robot.joints if j.type in _MOVING and j.axis is not None and not np.any(j.axis)), "")
    return Second(robot, shapes, mimics, still, notes)


def _all_shapes(robot: Any, files: Files) -> tuple[dict[str, tuple[Shape, ...]] | None, tuple[str, ...]]:
    """The shapes by link; none, and why, where yourdfpy hands out sizes that are none."""
    link = None
    try:
        found = {}
        for link in robot.links:
            found[link.name] = tuple(_shapes(link, files))
    except (ValueError, TypeError) as error:
        words = " ".join(str(error).split())
        return None, (f"a shape of link '{link and link.name}' has another size than it may have ({words}): shapes are not compared",)
    return found, ()


@contextlib.contextmanager
def _hushed(name: str) -> Iterator[None]:
    """yourdfpy logs what it repairs; urdfdom is the judge of that."""
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
            shape = _shape(element, role, files)
            if shape is not None:
                yield shape


def _shape(element: Any, role: Role, files: Files) -> Shape | None:
    pose = np.eye(4) if element.origin is None else np.asarray(element.origin, dtype=float)
    geometry = element.geometry
    if geometry is None:
        return None
    if geometry.box is not None:
        return Shape("box", role, pose, tuple(float(x) for x in geometry.box.size), element.name)
    if geometry.sphere is not None:
        return Shape("sphere", role, pose, (float(geometry.sphere.radius),), element.name)
    if geometry.cylinder is not None:
        return Shape("cylinder", role, pose, (float(geometry.cylinder.radius), float(geometry.cylinder.length)), element.name)
    if geometry.mesh is None:
        return None
    scale = np.asarray(1.0 if geometry.mesh.scale is None else geometry.mesh.scale, dtype=float).reshape(-1)
    if scale.size not in (1, 3):
        raise ValueError(f"a scale of {scale.size} numbers")
    uri = str(geometry.mesh.filename)
    mesh = MeshFile(uri, _found(files.find(uri)), (float(scale[0]), float(scale[1 % scale.size]), float(scale[2 % scale.size])))
    return Shape("mesh", role, pose, (), element.name, mesh)


def _well_formed(data: bytes) -> io.BytesIO:
    """The text as a file, mended where lxml would refuse it and urdfdom does not."""
    from lxml import etree

    try:
        etree.fromstring(data)
    except etree.XMLSyntaxError:
        mended = etree.fromstring(data, etree.XMLParser(recover=True))
        return io.BytesIO(data if mended is None else etree.tostring(mended))
    return io.BytesIO(data)


def _found(path: str | None) -> Path | None:
    return None if path is None else Path(path)


# ---- second opinion --------------------------------------------------------------------------------------------------


def disagreement(model: KinematicModel, second: Second) -> str:
    """Where yourdfpy's kinematics differ from the model's at random configurations; "" when they agree everywhere.

    yourdfpy keeps axes as they are written while urdfdom's users normalise them, so they are normalised here.
    """
    if second.robot is None:
        return ""
    other = _kinematics(second.robot, model)
    if sorted(str(body.name) for body in model.bodies) != sorted(str(body.name) for body in other.bodies):
        return "they disagree on the links"
    q = draw(model, 3, np.random.default_rng(0))
    ours, theirs = prepare(model).poses(q), prepare(other).poses(_same_coordinates(model, other, q))
    places = {body.name: index for index, body in enumerate(other.bodies[1:], start=1)}
    theirs = theirs[:, [WORLD, *(places[body.name] for body in model.bodies[1:])]]
    distance = np.linalg.norm(ours[..., :3, 3] - theirs[..., :3, 3], axis=-1).max(axis=0)
    angle = angle_between(ours[..., :3, :3], theirs[..., :3, :3]).max(axis=0)
    worst = int(np.argmax(np.maximum(distance, angle)))
    if not max(distance[worst], angle[worst]) <= _SLACK * (1 + float(np.abs(ours[..., :3, 3]).max())):
        return f"{model.body_label(worst)} is {distance[worst]:.3g} m and {angle[worst]:.3g} rad apart"
    return ""


def _kinematics(robot: Any, model: KinematicModel) -> KinematicModel:
    """yourdfpy's joints as a model; joints with several dofs are taken from the first reader, yourdfpy does not move them."""
    above = {joint.child: joint for joint in robot.joints}
    below: dict[str, list[str]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint.child)
    roots = [link.name for link in robot.links if link.name not in above]
    a_body_too = any(body.name == "world" for body in model.bodies[1:])
    bodies: list[Body] = [grounded()]
    places: dict[str, int] = {}
    stack = list(reversed(roots))
    while stack:
        name = stack.pop()
        stack.extend(reversed(below.get(name, [])))
        if name not in above and name == "world" and not a_body_too:
            places[name] = WORLD
            continue
        joint = above.get(name)
        places[name] = len(bodies)
        parent = WORLD if joint is None else places[joint.parent]
        bodies.append(Body(name, parent, Joint(open=True) if joint is None else _joint(joint, model)))
    return KinematicModel(robot.name or "", "urdf", "yourdfpy", tuple(bodies))


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
    places = {body.name: index for index, body in enumerate(model.bodies[1:], start=1)}
    for body in other.bodies[1:]:
        first = model.first_dof[places.get(body.name, WORLD)]
        for place, dof in enumerate(body.joint.dofs):
            start = model.columns[first + place] if first + place < len(model.columns) else 0
            columns.extend(range(start, start + dof.kind.width))
    return q[:, columns]
