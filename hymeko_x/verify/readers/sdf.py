"""SDF as libsdformat reads it, through Drake's MultibodyPlant.

Drake has bodies, joints, limits, damping and inertia; it does not hand out shapes and mimic joints, which verdicts note.
Source: pydrake.multibody.plant.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.verify.model import (
    WORLD,
    Array,
    Body,
    Dof,
    Feature,
    Joint,
    Kind,
    KinematicModel,
    Loop,
    between_frames,
    parents_first,
    world_body,
)
from hymeko_x.verify.readers import native_output
from hymeko_x.verify.spatial import shifted_tensor

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from hymeko_x.verify.readers import Lookup

FEATURES = frozenset({Feature.VELOCITY_LIMITS, Feature.DAMPING, Feature.FIXED_JOINT_NAMES, Feature.LOOPS, Feature.CURVES})
_TURNS = {"ball_rpy": Kind.BALL, "quaternion_floating": Kind.FREE, "rpy_floating": Kind.FREE}


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """The robot that libsdformat reads. Raises: Refusal HX302 in its words."""
    plant = MultibodyPlant(0.0)
    parser = Parser(plant)
    for name, folder in lookup.packages.items():
        parser.package_map().Add(name, folder)
    with native_output() as output:
        try:
            parser.AddModelsFromString(path.read_text("utf-8"), "sdf") if path.suffix != ".sdf" else parser.AddModels(path)
        except (RuntimeError, SystemExit, MemoryError) as error:
            reason = " ".join(str(error).split()) or output()
            raise refuse(codes.ENGINE_REFUSED, f"libsdformat refuses the file: {reason}", Origin(str(path))) from error
    return _model(plant, path.stem)


def _model(plant: Any, name: str) -> KinematicModel:
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
    return KinematicModel(
        name=name,
        format="sdf",
        engine="libsdformat in Drake",
        bodies=(world_body(), *(_body(plant, index, joints.get(index), numbers) for index in order)),
        loops=tuple(_loop(joint, numbers) for joint in closing),
        features=FEATURES,
    )


def _parent(joint: Any) -> int:
    return int(joint.parent_body().index())


def _body(plant: Any, index: int, joint: Any | None, numbers: Mapping[int, int]) -> Body:
    from pydrake.multibody.tree import BodyIndex

    body = plant.get_body(BodyIndex(index))
    inertia = body.default_spatial_inertia()
    mass, com = float(inertia.get_mass()), np.array(inertia.get_com())
    tensor = shifted_tensor(-mass, com, np.array(inertia.CalcRotationalInertia().CopyToFullMatrix3()))
    if joint is None:
        return Body(body.name(), WORLD, Joint(open=True), mass, com, tensor)
    return Body(body.name(), numbers[_parent(joint)], _joint(joint), mass, com, tensor)


def _joint(joint: Any) -> Joint:
    return between_frames(joint.name(), _fixed_pose(joint.frame_on_parent()), tuple(_dofs(joint)), _fixed_pose(joint.frame_on_child()))


def _fixed_pose(frame: Any) -> Array:
    return np.array(frame.GetFixedPoseInBodyFrame().GetAsMatrix4())


def _dofs(joint: Any) -> Iterator[Dof]:
    """Drake's joint types; a universal joint turns about x and then y, a planar one slides in x and y and turns about z."""
    kind, name = joint.type_name(), joint.name()
    x, y, z = np.eye(3)
    match kind:
        case "weld":
            return
        case "revolute":
            yield _scalar(joint, Kind.HINGE, np.array(joint.revolute_axis()), 0, name)
        case "prismatic":
            yield _scalar(joint, Kind.SLIDE, np.array(joint.translation_axis()), 0, name)
        case "screw":
            yield _scalar(joint, Kind.SCREW, np.array(joint.screw_axis()), 0, name, float(joint.screw_pitch()) / (2 * math.pi))
        case "universal":
            yield _scalar(joint, Kind.HINGE, x, 0, None)
            yield _scalar(joint, Kind.HINGE, y, 1, None)
        case "planar":
            yield _scalar(joint, Kind.SLIDE, x, 0, None)
            yield _scalar(joint, Kind.SLIDE, y, 1, None)
            yield _scalar(joint, Kind.HINGE, z, 2, None)
        case _:
            yield Dof(_TURNS.get(kind, Kind.FREE), z, name=name)


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


def _loop(joint: Any, numbers: Mapping[int, int]) -> Loop:
    ends = numbers[_parent(joint)], numbers[int(joint.child_body().index())]
    frames = _fixed_pose(joint.frame_on_parent()), _fixed_pose(joint.frame_on_child())
    kind = {"weld": "weld", "ball_rpy": "connect"}.get(joint.type_name(), "other")
    return Loop(kind, ends[0], frames[0], ends[1], frames[1], joint.name(), joint.type_name() if kind == "other" else "")
