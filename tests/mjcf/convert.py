"""URDF to a compiled MuJoCo model in memory, and what Pinocchio and MuJoCo say of one robot."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
from msgspec import Struct
from numpy.typing import NDArray

from hymeko_x import formats
from hymeko_x.assets.pack import pack
from hymeko_x.assets.shelf import Shelf
from hymeko_x.backends import mjcf
from hymeko_x.diagnostics import Report
from hymeko_x.frontends import urdf
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options, choose, legalize
from hymeko_x.source import Source
from tests.robots import MemoryFiles

FIXED = Options(base="fixed")


class Converted(Struct, frozen=True):
    """All stages of one conversion."""

    source: Mechanism
    legal: Mechanism
    text: str
    assets: dict[str, bytes]
    report: Report

    def reported(self, *codes: str) -> list[str]:
        """The diagnostics with these codes, after reading."""
        return [f"{d.severity.value} {d.code.id} {d.message}" for d in self.report if d.code.id in codes]

    def model(self) -> mujoco.MjModel:
        return mujoco.MjModel.from_xml_string(self.text, assets=self.assets)


def convert(source: Source, options: Options = FIXED) -> Converted:
    report = Report()
    mechanism = urdf.read(source, report).mechanism
    legal = legalize(choose(mechanism, options, report), "mjcf", report)
    packed, files, copies = pack(legal, formats.MJCF, source.files, Shelf("copy", None), report)
    assets = files | {name: source.files.read(path) for name, path in copies.items()}
    return Converted(mechanism, legal, mjcf.write(packed, options, report).main.decode(), assets, report)


def convert_text(text: str, files: dict[str, bytes] | None = None, options: Options = FIXED) -> Converted:
    return convert(Source("robot.urdf", text.encode(), MemoryFiles(files or {})), options)


def worst_pose_error(path: Path, model: mujoco.MjModel, names: dict[str, str], samples: int = 50) -> float:
    """The largest difference of any link's position (m) or rotation matrix between Pinocchio on the URDF and MuJoCo.

    ``names`` are the bodies of links that were renamed. Joints take the same random coordinates in both.
    """
    reference = pin.buildModelFromUrdf(str(path))
    known, data = reference.createData(), mujoco.MjData(model)
    frames = [
        (number, model.body(names.get(frame.name, frame.name)).id)
        for number, frame in enumerate(reference.frames)
        if frame.type == pin.FrameType.BODY
    ]
    random, worst = np.random.default_rng(0), 0.0
    for _ in range(samples):
        q = pin.neutral(reference)
        for name, joint in list(zip(reference.names, reference.joints, strict=True))[1:]:
            value = random.uniform(-3.0, 3.0)
            data.qpos[model.joint(name).qposadr[0]] = value
            q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.framesForwardKinematics(reference, known, q)
        mujoco.mj_kinematics(model, data)
        for frame, body in frames:
            worst = max(worst, float(np.abs(known.oMf[frame].translation - data.xpos[body]).max()))
            worst = max(worst, float(np.abs(known.oMf[frame].rotation - data.xmat[body].reshape(3, 3)).max()))
    return worst


def tensor_in_body(model: mujoco.MjModel, body: int) -> NDArray[np.float64]:
    """The inertia tensor about the centre of mass in body axes, 3 x 3."""
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.body_iquat[body])
    axes = rotation.reshape(3, 3)
    return axes @ np.diag(model.body_inertia[body]) @ axes.T
