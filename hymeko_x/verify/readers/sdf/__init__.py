"""SDF as libsdformat reads it, through Drake's MultibodyPlant.

Drake has bodies, joints, limits, damping, inertia and shapes; mimic joints, which it does not hand out, and gearboxes, which it refuses,
are taken from the text.
Source: pydrake.multibody.plant, pydrake.geometry.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from msgspec.structs import replace
from pydrake.geometry import Box, Capsule, Convex, Cylinder, Ellipsoid, HalfSpace, Mesh, Sphere
from pydrake.geometry import Role as GeometryRole
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import DiagramBuilder

from hymeko_x import codes
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Origin, Refusal, refuse
from hymeko_x.verify.features import Feature
from hymeko_x.verify.model import (
    WORLD,
    Array,
    Body,
    Dof,
    Joint,
    Kind,
    KinematicModel,
    Loop,
    MeshFile,
    Role,
    Shape,
    between_frames,
    parents_first,
    world_body,
)
from hymeko_x.verify.readers import native_output
from hymeko_x.verify.readers.sdf.couplings import gearboxes, mimics
from hymeko_x.verify.readers.sdf.stand_ins import without_stand_ins
from hymeko_x.verify.readers.sdf.text import PLANE, readable_text, root_of
from hymeko_x.verify.spatial import frame_with_z, shifted_tensor

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.verify.readers.lookup import Lookup

FEATURES = frozenset(
    {
        *(Feature.VELOCITY_LIMITS, Feature.DAMPING, Feature.FIXED_JOINT_NAMES, Feature.POSITION_LIMITS),
        *(Feature.LOOPS, Feature.SLIDING_LOOPS, Feature.SCREW_LOOPS),
    }
)
_SHAPES = frozenset({Feature.VISUALS, Feature.COLLISIONS, Feature.FLAT_COLLISIONS})
_LIMITS = (Feature.POSITION_LIMITS, Feature.VELOCITY_LIMITS)
UNREAD = _SHAPES | {Feature.FRICTION, Feature.EFFORT_LIMITS, Feature.SPRINGS, Feature.REFS, Feature.SENSORS}
"""What SDF represents and this reader leaves out."""
UNREPRESENTED = frozenset({*((limit, kind) for limit in _LIMITS for kind in (Kind.BALL, Kind.FREE)), (Feature.DAMPING, Kind.FREE)})
"""A free base is a link without a joint, which has no damping and no limits; the axes of a ball have no limits either."""
_PACKAGE = re.compile(rb"(?:model|package)://([^/<>\s]+)")
_ROLES = {Role.VISUAL: GeometryRole.kIllustration, Role.COLLISION: GeometryRole.kProximity}
_LEAST = 2e-10
"""kg and kg m^2: a link cannot be without mass, and so little stands for none."""
_STATIC = "sdformat_model_static_"
"""How the names of the joints begin that Drake adds to static models."""


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """The robot that libsdformat reads. Raises: Refusal HX302 in its words.

    Where Drake refuses nothing but a mesh file, the robot is read without its shapes.
    """
    plant, scene = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.0)
    try:
        _load(path, plant, lookup)
    except Refusal:
        plant, scene = MultibodyPlant(0.0), None
        _load(path, plant, lookup)
    return _model(plant, None if scene is None else scene.model_inspector(), path, _screw_axes(path, plant, lookup))


def _screw_axes(path: Path, plant: Any, lookup: Lookup) -> dict[int, Array]:
    """The axis of each screw, by the number of the joint: Drake tells how a screw moves, and only when the plant is complete."""
    screws = [index for index in plant.GetJointIndices() if plant.get_joint(index).type_name() == "screw"]
    if not screws:
        return {}
    complete = MultibodyPlant(0.0)
    _load(path, complete, lookup)
    complete.Finalize()
    found = {}
    for index in screws:
        joint, context = complete.get_joint(index), complete.CreateDefaultContext()
        q: Any = np.zeros(complete.num_positions())
        for start, count in ((body.floating_positions_start(), 4) for body in _floating(complete)):
            q[start : start + count] = (1.0, 0.0, 0.0, 0.0)
        q[joint.position_start()] = 1.0
        complete.SetPositions(context, q)
        turn = joint.frame_on_child().CalcPose(context, joint.frame_on_parent()).rotation().ToAngleAxis()
        found[int(index)] = np.array(turn.axis()) * (1.0 if turn.angle() > 0.0 else -1.0)
    return found


def _floating(plant: Any) -> Iterator[Any]:
    """The bodies that float, whose first four coordinates are a quaternion."""
    bodies = (plant.get_body(BodyIndex(index)) for index in range(1, plant.num_bodies()))
    return (body for body in bodies if body.is_floating_base_body())


def _load(path: Path, plant: Any, lookup: Lookup) -> None:
    parser = Parser(plant)
    for name, folder in _packages(path, lookup).items():
        parser.package_map().Add(name, folder)
    with native_output() as output:
        try:
            _parse(path, parser)
        except (RuntimeError, SystemExit, MemoryError) as error:
            reason = " ".join(str(error).split()) or output()
            raise refuse(codes.ENGINE_REFUSED, f"libsdformat refuses the file: {reason}", Origin(str(path))) from error


def _packages(path: Path, lookup: Lookup) -> dict[str, Path]:
    """The folders of the packages and models that a file names, those that files in these name, and the user's own."""
    files = DiskFiles(path.parent, lookup.packages, lookup.search_path)
    found: dict[str, Path] = {}
    waiting = [path]
    while waiting:
        names = dict.fromkeys(name.decode("utf-8", "replace") for name in _PACKAGE.findall(waiting.pop().read_bytes()))
        folders = {name: Path(folder) for name in names if name not in found and (folder := files.find_package(name)) is not None}
        found |= folders
        waiting += [file for folder in folders.values() for file in sorted(folder.glob("*.sdf"))]
    return {**found, **lookup.packages}


def _parse(path: Path, parser: Any) -> None:
    text = readable_text(path)
    if text is None and path.suffix == ".sdf":
        parser.AddModels(path)
    else:
        parser.AddModelsFromString(path.read_text("utf-8") if text is None else text, "sdf")


def _model(plant: Any, scene: Any | None, path: Path, screws: Mapping[int, Array]) -> KinematicModel:
    joints: dict[int, Any] = {}
    closing: list[Any] = []
    for joint in (plant.get_joint(index) for index in plant.GetJointIndices()):
        child = int(joint.child_body().index())
        closing.append(joint) if child in joints or child == WORLD else joints.setdefault(child, joint)
    children: dict[int, list[int]] = {}
    for index in range(1, plant.num_bodies()):
        children.setdefault(_parent(joints[index]) if index in joints else WORLD, []).append(index)
    order = parents_first(children.get(WORLD, ()), children)
    numbers = {WORLD: WORLD} | {index: number for number, index in enumerate(order, start=1)}
    words = _Words(_scopes(plant), screws)
    is_alone = len(order) - len(joints) == 1
    bodies = [_body(plant, scene, index, joints.get(index), numbers, words, is_alone=is_alone) for index in order]
    world = world_body(shapes=tuple(_shapes(plant, scene, WORLD)))
    found, loops = without_stand_ins([world, *bodies], [_loop(joint, numbers, words) for joint in closing])
    model = KinematicModel(
        name=path.stem,
        format="sdf",
        engine="libsdformat in Drake",
        bodies=found,
        loops=loops,
        features=FEATURES if scene is None else FEATURES | _SHAPES,
        unread=UNREAD,
        unrepresented=UNREPRESENTED,
    )
    root = root_of(path)
    return model if root is None else replace(model, couplings=(*mimics(root, model), *gearboxes(root, model, plant)))


def _parent(joint: Any) -> int:
    return int(joint.parent_body().index())


def _scopes(plant: Any) -> dict[int, str]:
    """What stands before the names in each model; the only one at top level has nothing."""
    from pydrake.multibody.tree import ModelInstanceIndex

    names = {index: str(plant.GetModelInstanceName(ModelInstanceIndex(index))) for index in range(2, plant.num_model_instances())}
    tops = {name.partition("::")[0] for name in names.values()}
    if len(tops) != 1:
        return {index: f"{name}::" for index, name in names.items()}
    return {index: f"{rest}::" if rest else "" for index, rest in ((index, name.partition("::")[2]) for index, name in names.items())}


class _Words(NamedTuple):
    """What stands before the names in each model, and the axis of each screw."""

    scopes: Mapping[int, str]
    screws: Mapping[int, Array]

    def name(self, element: Any) -> str:
        """The name of a body or joint with the models around it."""
        return self.scopes.get(int(element.model_instance()), "") + str(element.name())


def _body(
    plant: Any, scene: Any | None, index: int, joint: Any | None, numbers: Mapping[int, int], words: _Words, *, is_alone: bool
) -> Body:
    """A body; for an inertia that is not physical Drake takes a ball of water, of which the file knows nothing."""
    body = plant.get_body(BodyIndex(index))
    inertia = body.default_spatial_inertia()
    mass, com = float(inertia.get_mass()), np.array(inertia.get_com())
    tensor = shifted_tensor(-mass, com, np.array(inertia.CalcRotationalInertia().CopyToFullMatrix3()))
    known = not np.allclose(tensor, np.eye(3) * 0.4 * mass * (mass * 0.75e-3 / math.pi) ** (2 / 3), rtol=1e-9, atol=0.0)
    if mass <= _LEAST and float(np.abs(tensor).max()) <= _LEAST:
        mass, com, tensor = 0.0, np.zeros(3), np.zeros((3, 3))
    name, shapes = words.name(body), tuple(_shapes(plant, scene, index))
    parent, above = (WORLD, _base(plant, body, is_alone=is_alone)) if joint is None else (numbers[_parent(joint)], _joint(joint, words))
    return Body(name, parent, above, mass, com, tensor, shapes, inertia_is_known=known)


# ---- joints ------------------------------------------------------------------------------------------------------------------


def _base(plant: Any, body: Any, *, is_alone: bool) -> Joint:
    """The joint of a body without one: libsdformat says where it is, and that it floats; the only one is open at the origin."""
    pose = np.array(plant.GetDefaultFloatingBaseBodyPose(body).GetAsMatrix4())
    return (
        Joint(open=True)
        if is_alone and np.array_equal(pose, np.eye(4))
        else Joint(None, pose, (Dof(Kind.FREE, np.array([0.0, 0.0, 1.0])),))
    )


def _joint(joint: Any, words: _Words) -> Joint:
    """A joint; Drake does not say in which model one between two models is, nor who named one of a static model."""
    is_inside = joint.parent_body().index() == WORLD or joint.parent_body().model_instance() == joint.child_body().model_instance()
    name = None if str(joint.name()).startswith(_STATIC) or not is_inside else words.name(joint)
    parent_pose = _fixed_pose(joint.frame_on_parent())
    if joint.type_name() == "weld":
        parent_pose = parent_pose @ np.array(joint.X_FM().GetAsMatrix4())
    return between_frames(name, parent_pose, tuple(_dofs(joint, name, words)), _fixed_pose(joint.frame_on_child()))


def _fixed_pose(frame: Any) -> Array:
    return np.array(frame.GetFixedPoseInBodyFrame().GetAsMatrix4())


# ---- shapes ------------------------------------------------------------------------------------------------------------------


def _shapes(plant: Any, scene: Any | None, index: int) -> Iterator[Shape]:
    if scene is None:
        return
    frame = plant.GetBodyFrameIdOrThrow(BodyIndex(index))
    for role, kind in _ROLES.items():
        for geometry in scene.GetGeometries(frame, kind):
            word, size, mesh = _geometry(scene.GetShape(geometry))
            pose = np.array(scene.GetPoseInFrame(geometry).GetAsMatrix4())
            name = str(scene.GetName(geometry)).rpartition("::")[2]
            is_contact = role is Role.COLLISION or name.startswith(PLANE)
            yield Shape(word, Role.COLLISION if is_contact else role, pose, size, name.removeprefix(PLANE), mesh)


def _geometry(shape: Any) -> tuple[str, tuple[float, ...], MeshFile | None]:
    match shape:
        case Box():
            return "box", tuple(map(float, shape.size())), None
        case Sphere():
            return "sphere", (shape.radius(),), None
        case Cylinder() | Capsule():
            return type(shape).__name__.lower(), (shape.radius(), shape.length()), None
        case Ellipsoid():
            return "ellipsoid", (shape.a(), shape.b(), shape.c()), None
        case HalfSpace():
            return "plane", (), None
        case Mesh() | Convex():
            path, (x, y, z) = str(shape.source().path()), map(float, shape.scale3())
            return "mesh", (), MeshFile(path, Path(path), (x, y, z))
        case other:
            return type(other).__name__.lower(), (), None


# ---- dofs ----------------------------------------------------------------------------------------------------------


def _dofs(joint: Any, name: str | None, words: _Words) -> Iterator[Dof]:
    """Drake's joint types; a universal joint turns about x and then y, a planar one slides in x and y and turns about z."""
    kind = joint.type_name()
    x, y, z = np.eye(3)
    match kind:
        case "weld":
            return
        case "revolute":
            yield _scalar(joint, Kind.HINGE, np.array(joint.revolute_axis()), 0, name)
        case "prismatic":
            yield _scalar(joint, Kind.SLIDE, np.array(joint.translation_axis()), 0, name)
        case "screw":
            yield _scalar(joint, Kind.SCREW, words.screws[int(joint.index())], 0, name, float(joint.screw_pitch()) / (2 * math.pi))
        case "universal":
            yield _scalar(joint, Kind.HINGE, x, 0, None)
            yield _scalar(joint, Kind.HINGE, y, 1, None)
        case "planar":
            yield _scalar(joint, Kind.SLIDE, x, 0, None)
            yield _scalar(joint, Kind.SLIDE, y, 1, None)
            yield _scalar(joint, Kind.HINGE, z, 2, None)
        case "ball_rpy":
            yield Dof(Kind.BALL, z, name=name, damping=float(joint.default_damping_vector()[0]))
        case _:
            yield Dof(Kind.FREE, z, name=name)


def _scalar(joint: Any, kind: Kind, axis: Array, index: int, name: str | None, pitch: float = 0.0) -> Dof:
    return Dof(
        kind,
        axis / np.linalg.norm(axis),
        name=name,
        lower=float(joint.position_lower_limits()[index]),
        upper=float(joint.position_upper_limits()[index]),
        velocity=float(joint.velocity_upper_limits()[index]),
        damping=float(joint.default_damping_vector()[index]),
        pitch=pitch,
    )


def _loop(joint: Any, numbers: Mapping[int, int], words: _Words) -> Loop:
    ends = numbers[_parent(joint)], numbers[int(joint.child_body().index())]
    frames = _fixed_pose(joint.frame_on_parent()), _fixed_pose(joint.frame_on_child())
    kind = {"weld": "weld", "ball_rpy": "connect"}.get(joint.type_name(), "other")
    dofs = tuple(_dofs(joint, None, words))
    if len(dofs) == 1 and dofs[0].kind in (Kind.HINGE, Kind.SLIDE):
        kind, along = dofs[0].kind.value, frame_with_z(dofs[0].axis, dofs[0].anchor)
        frames = frames[0] @ along, frames[1] @ along
    return Loop(kind, ends[0], frames[0], ends[1], frames[1], words.name(joint), joint.type_name() if kind == "other" else "")
