"""MJCF to URDF, judged by MuJoCo and Pinocchio alone: which joints of the one move which of the other, and how they then stand."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
import yourdfpy
from msgspec import Struct
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from hymeko_x.ir.mechanism import Mechanism

Array = NDArray[np.float64]


class Twins(Struct, frozen=True):
    """One robot as MuJoCo compiles its MJCF, without merging bodies, and as Pinocchio and yourdfpy read its URDF."""

    model: Any
    reference: Any
    links: Any
    names: list[str]
    """The link of each of MuJoCo's bodies; the world has no link that counts."""

    def worst_pose_error(self, samples: int = 50) -> float:
        """The largest difference of any body's position (m) or rotation matrix at random configurations."""
        data, known = mujoco.MjData(self.model), self.reference.createData()
        frames = [self.reference.getFrameId(name, pin.FrameType.BODY) for name in self.names[1:]]
        random, worst = np.random.default_rng(0), 0.0
        for _ in range(samples):
            data.qpos[:], q = self._same_coordinates(random)
            mujoco.mj_kinematics(self.model, data)
            pin.framesForwardKinematics(self.reference, known, q)
            for body, frame in enumerate(frames, 1):
                worst = max(worst, float(np.abs(known.oMf[frame].translation - data.xpos[body]).max()))
                worst = max(worst, float(np.abs(known.oMf[frame].rotation - data.xmat[body].reshape(3, 3)).max()))
        return worst

    def worst_inertia_error(self) -> float:
        """The largest difference of any body's mass (kg), centre (m) or tensor (kg m^2) in its own axes, relative above 1."""
        worst = 0.0
        for body, name in list(enumerate(self.names))[1:]:
            inertial = self.links[name].inertial
            mass = float(self.model.body_mass[body])
            if inertial is None:
                worst = max(worst, mass)
                continue
            origin = np.eye(4) if inertial.origin is None else inertial.origin
            turn = Rotation.from_quat(np.roll(self.model.body_iquat[body], -1)).as_matrix()
            tensor = turn @ np.diag(self.model.body_inertia[body]) @ turn.T
            found = origin[:3, :3] @ inertial.inertia @ origin[:3, :3].T
            apart = [abs(inertial.mass - mass), np.abs(found - tensor).max()]
            if mass > 0.0:
                apart.append(np.abs(origin[:3, 3] - self.model.body_ipos[body]).max())
            scale = max(1.0, mass, float(np.abs(tensor).max()))
            worst = max(worst, *(float(value) / scale for value in apart))
        return worst

    def _same_coordinates(self, random: np.random.Generator) -> tuple[Array, Array]:
        """A random configuration in MuJoCo's coordinates and in Pinocchio's."""
        qpos, q = self.model.qpos0.copy(), pin.neutral(self.reference)
        for body in range(1, self.model.nbody):
            joints = self._chain(body)
            for number in range(self.model.body_jntnum[body]):
                self._move(int(self.model.body_jntadr[body]) + number, body, joints, random, (qpos, q))
            assert next(joints, None) is None, f"more joints above {self.names[body]} than in MJCF"
        return qpos, q

    def _move(self, joint: int, body: int, joints: Iterator[Any], random: np.random.Generator, out: tuple[Array, Array]) -> None:
        qpos, q = out
        at, kind = int(self.model.jnt_qposadr[joint]), int(self.model.jnt_type[joint])
        if kind in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            qpos[at] = random.uniform(-3.0, 3.0)
            _set(q, next(joints), float(qpos[at]))
            return
        turn = Rotation.random(random_state=random)
        if kind == mujoco.mjtJoint.mjJNT_BALL:
            qpos[at : at + 4] = np.roll(turn.as_quat(), 1)
            for angle in turn.as_euler("XYZ"):
                _set(q, next(joints), float(angle))
            return
        place = pin.SE3(turn.as_matrix(), random.uniform(-1.0, 1.0, 3))
        rest = Rotation.from_quat(np.roll(self.model.body_quat[body], -1)).as_matrix()
        whole = pin.SE3(rest, self.model.body_pos[body]) * place
        qpos[at : at + 7] = [*whole.translation, *np.roll(pin.Quaternion(whole.rotation).coeffs(), 1)]
        first = next(joints).idx_q
        q[first : first + 7] = pin.SE3ToXYZQUAT(place)

    def _frame(self, body: int) -> Any:
        return self.reference.frames[self.reference.getFrameId(self.names[body], pin.FrameType.BODY)]

    def _chain(self, body: int) -> Iterator[Any]:
        """Pinocchio's joints between a body and its parent, from the top."""
        frame = self._frame(body)
        top = self.model.body_parentid[body]
        end = self._frame(top).parentJoint if top else 0
        found = []
        number = frame.parentJoint
        while number not in (0, end):
            found.append(number)
            number = self.reference.parents[number]
        return iter([self.reference.joints[number] for number in reversed(found)])


def _set(q: Array, joint: Any, value: float) -> None:
    q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]


def twins(source: Path, target: Path, mechanism: Mechanism) -> Twins:
    """A robot in MJCF, and in the URDF that it was converted to. Bodies of ``mechanism`` have the names of links."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spec = mujoco.MjSpec.from_file(str(source))
        spec.compiler.fusestatic = False
        model = spec.compile()
    names = ["world", *(key.name for key in mechanism.depth_first())]
    robot = yourdfpy.URDF.load(str(target), build_scene_graph=False, load_meshes=False).robot
    return Twins(model, pin.buildModelFromUrdf(str(target)), {link.name: link for link in robot.links}, names)
