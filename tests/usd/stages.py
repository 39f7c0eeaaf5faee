"""Stages of the tests: text in, mechanism out and back, and what UsdPhysics' own parser sees of a file."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from msgspec import Struct, field
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from hymeko_x import formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Report
from hymeko_x.frontends import usd
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source

HEADER = '#usda 1.0\n(\n    defaultPrim = "robot"\n    metersPerUnit = 1\n    kilogramsPerUnit = 1\n    upAxis = "Z"\n)\n'


class Texts(Struct, frozen=True):
    """Files by name, from a dictionary."""

    files: Mapping[str, str | bytes] = field(default_factory=dict)

    def find(self, uri: str) -> str | None:
        name = uri.removeprefix("./")
        return name if name in self.files else None

    def read(self, path: str) -> bytes:
        content = self.files[path]
        return content if isinstance(content, bytes) else content.encode()


def stage_with_body(folder: Path) -> Usd.Stage:
    """The new stage ``r.usda`` in a new folder: a robot ``/r`` with a body ``/r/b`` of 1 kg."""
    folder.mkdir()
    found = Usd.Stage.CreateNew(str(folder / "r.usda"))
    UsdGeom.SetStageUpAxis(found, "Z")
    UsdGeom.SetStageMetersPerUnit(found, 1.0)
    found.SetDefaultPrim(UsdGeom.Xform.Define(found, "/r").GetPrim())
    body = UsdGeom.Xform.Define(found, "/r/b").GetPrim()
    UsdPhysics.RigidBodyAPI.Apply(body)
    UsdPhysics.MassAPI.Apply(body).CreateMassAttr(1.0)
    return found


def read_text(
    text: str, report: Report | None = None, files: Mapping[str, str | bytes] | None = None, name: str = "robot.usda"
) -> Mechanism:
    """The mechanism of a stage; without a report there may be no diagnostics."""
    reported = report if report is not None else Report()
    mechanism = usd.read(Source(name, text.encode(), Texts(files or {})), reported).mechanism
    assert report is not None or [str(item) for item in reported] == []
    return mechanism


def read_file(path: Path) -> Mechanism:
    """The mechanism of a file on disk, whatever it says about it."""
    return usd.read(Source(path.name, path.read_bytes(), DiskFiles(path.parent)), Report()).mechanism


def written(mechanism: Mechanism, format: str = "usd") -> bytes:
    """The mechanism as USD."""
    return pipeline.convert(mechanism, formats.by_name(format), Options(keep="inside"), NoFiles(), Report()).package.main


def again(mechanism: Mechanism) -> Mechanism:
    """The mechanism written and read back."""
    return pipeline.read(Source("robot.usda", written(mechanism), NoFiles()), formats.USD, Report())


# ---- UsdPhysics' own parser ------------------------------------------------------------------------------------------------------


class Parsed(Struct, frozen=True):
    """What the parser sees: numbers by prim path, lengths in the units of the stage."""

    bodies: dict[str, tuple[float, ...]]
    joints: dict[str, tuple[object, ...]]
    shapes: dict[str, tuple[object, ...]]
    masses: dict[str, tuple[float, ...]]


def parsed(stage: Any) -> Parsed:
    """Bodies, joints, shapes and masses as UsdPhysics' parser describes them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        found = UsdPhysics.LoadUsdPhysicsFromRange(stage, ["/"])
    kinds = UsdPhysics.ObjectType
    bodies, joints, shapes = {}, {}, {}
    for kind, (paths, descriptions) in found.items():
        for path, description in zip(paths, descriptions, strict=True):
            if kind == kinds.RigidBody:
                bodies[str(path)] = (*description.position, *_quat(description.rotation))
            elif "Joint" in str(kind):
                joints[str(path)] = _joint(stage, kind, description)
            elif "Shape" in str(kind):
                shapes[str(path)] = (str(kind), *map(float, description.localPos), description.collisionEnabled)
    masses = {path: _mass(stage.GetPrimAtPath(path)) for path in bodies}
    return Parsed(bodies, joints, shapes, masses)


def _joint(stage: Any, kind: Any, description: Any) -> tuple[object, ...]:
    """Kind, ends, frames and limits. Frames of a hinge or slide that differ by a turn about x, y, z alone mean the same: what
    counts is its axis in either body, and how the bodies stand to each other at zero."""
    ends: list[object] = []
    for body, position, turn in (
        (description.body0, description.localPose0Position, description.localPose0Orientation),
        (description.body1, description.localPose1Position, description.localPose1Orientation),
    ):
        ends += [str(body), tuple(position), _quat(turn)]
    if hasattr(description, "axis") and str(description.axis) in "XYZ" and "Spherical" not in str(kind):
        first, second = (Gf.Rotation(Gf.Quatd(turn)) for turn in (description.localPose0Orientation, description.localPose1Orientation))
        axis = Gf.Vec3d(*(1.0 if letter == str(description.axis) else 0.0 for letter in "XYZ"))
        zero = _quat((second.GetInverse() * first).GetQuat())
        ends = [*ends[:2], tuple(first.TransformDir(axis)), *ends[3:5], tuple(second.TransformDir(axis)), zero]
    limits: list[object] = []
    if hasattr(description, "limit"):
        limits = [description.limit.enabled and (description.limit.lower, description.limit.upper)]
    if hasattr(description, "jointLimits"):
        limits = [(str(item.first), item.second.enabled and (item.second.lower, item.second.upper)) for item in description.jointLimits]
    return (str(kind), *ends, description.excludeFromArticulation, description.jointEnabled, *limits)


def _quat(quat: Any) -> tuple[float, ...]:
    numbers = (quat.GetReal(), *quat.GetImaginary())
    first = next((value for value in numbers if abs(value) > 1e-4), 1.0)
    return tuple(value if first > 0 else -value for value in numbers)


def _mass(prim: Any) -> tuple[float, ...]:
    """Mass, centre of mass and the explicit tensor in body axes."""
    api = UsdPhysics.MassAPI(prim)
    mass = api.GetMassAttr().Get() if api.GetMassAttr() else None
    if not mass:
        return ()
    return (mass,)


def world_points(stage: Any) -> dict[str, tuple[float, ...]]:
    """Where each transformable prim is: the images of the origin and of three points near it."""
    cache = UsdGeom.XformCache()
    found = {}
    for prim in stage.Traverse():
        if UsdGeom.Xformable(prim) and prim.IsA(UsdGeom.Gprim):
            matrix = cache.GetLocalToWorldTransform(prim)
            found[str(prim.GetPath())] = tuple(
                v for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)) for v in matrix.Transform(Gf.Vec3d(*p))
            )
    return found


def opened(data: bytes, tmp_path: Path, name: str = "written.usda") -> Any:
    """A stage from bytes."""
    path = tmp_path / name
    path.write_bytes(data)
    return Usd.Stage.Open(str(path))
