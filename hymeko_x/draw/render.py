"""Pictures of a robot, drawn by MuJoCo without a screen: light, ground, and a camera that fits."""

from __future__ import annotations

import json
import os
from ctypes.util import find_library
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x import api, codes, formats
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.draw.scene import COLLISION, FIELD_OF_VIEW, GROUND, VISUAL, add_scene, remove_surroundings
from hymeko_x.ir.holder import mechanism_of
from hymeko_x.verify.readers import in_own_thread
from hymeko_x.verify.readers.bounded import hint_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import mujoco
    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.draw.camera import Corners
    from hymeko_x.formats import Format
    from hymeko_x.ir.holder import Holder
    from hymeko_x.ir.mechanism import Mechanism

    Picture = NDArray[np.uint8]
    """Rows, columns and three colours from 0 to 255."""

_FRAMES_PER_JOINT = 24


class PictureOptions(Struct, frozen=True):
    """How a picture is made. ``size`` is width and height in pixels; ``pose`` the name of a keyframe, or a JSON file of joint positions.

    ``is_authored``: in the pose in which the file places the bodies, whatever keyframes there are: for comparisons.
    """

    size: tuple[int, int] = (960, 720)
    view: str = "iso"
    pose: str | None = None
    collision: bool = False
    frames: bool = False
    inertia: bool = False
    is_authored: bool = False


class Studio:
    """A robot that MuJoCo has compiled, in a scene with light and ground.

    ``like``: for a comparison with that one: in its scene, by its camera, and with the joints where they are in it.

    Raises: Refusal HX302 when MuJoCo refuses the robot, HX501 when nothing is visible, HX502 when this machine cannot draw.
    """

    def __init__(self, spec: Any, name: str, wanted: PictureOptions, like: Studio | None = None) -> None:
        import mujoco

        self._name = name
        self._wanted = wanted
        if wanted.is_authored:
            remove_surroundings(spec)
        if like is not None:  # its scene fits this robot, which is compiled once then
            add_scene(spec, like.corners, wanted.size, is_compared=wanted.is_authored)
        self.model = _compiled(spec, name)
        self.data = mujoco.MjData(self.model)
        self._place(wanted.pose)
        self._groups = _groups(self.model, collision=wanted.collision)
        self.corners: Corners = self._own_corners() if like is None else like.corners
        if like is None:
            add_scene(spec, self.corners, wanted.size, is_compared=wanted.is_authored)
            self.model = _compiled(spec, name)
            placed, self.data = self.data, mujoco.MjData(self.model)
            self.data.qpos[:] = placed.qpos
            mujoco.mj_forward(self.model, self.data)
        else:
            self._take_joints_of(like)
        self._options = _options(wanted, self._groups)

    def still(self, *, tendons: bool = True) -> Picture:
        """One picture of the robot in its pose. ``tendons``: with those that lead along a path."""
        import mujoco

        self._options.flags[mujoco.mjtVisFlag.mjVIS_TENDON] = tendons
        return next(self._drawn([self.data.qpos.copy()], self.corners, mujoco))

    def covered(self) -> NDArray[np.bool_]:
        """The pixels of the picture that show the robot, not ground or sky."""
        import mujoco
        import numpy as np

        found = next(self._drawn([self.data.qpos.copy()], self.corners, mujoco, segmented=True))
        is_geom = found[..., 1] == mujoco.mjtObj.mjOBJ_GEOM
        return np.asarray(is_geom & (self.model.geom_type[np.where(is_geom, found[..., 0], 0)] != mujoco.mjtGeom.mjGEOM_PLANE))

    def sweep(self) -> Iterator[Picture]:
        """Pictures in which each joint in turn goes through its limits and back; joints without limits go half a turn or 0.1 m."""
        import mujoco

        rest = self.data.qpos.copy()
        positions = [*_swept(self.model, rest)]
        datas = []
        for qpos in positions[:: max(1, _FRAMES_PER_JOINT // 4)] or [rest]:
            data = mujoco.MjData(self.model)
            data.qpos[:] = qpos
            mujoco.mj_forward(self.model, data)
            datas.append(data)
        from hymeko_x.draw.camera import corners_of

        yield from self._drawn(positions or [rest], corners_of(self.model, datas, self._groups), mujoco)

    def _drawn(
        self, positions: list[NDArray[np.float64]], corners: Corners, mujoco: Any, *, segmented: bool = False
    ) -> Iterator[NDArray[Any]]:
        """Pictures in these configurations, or which object each pixel shows: its number and its type."""
        from hymeko_x.draw.camera import fitted_camera

        width, height = self._wanted.size
        camera = fitted_camera(corners, self._wanted.view, width / height, FIELD_OF_VIEW)
        renderer = _renderer(self.model, width, height)
        if segmented:
            renderer.enable_segmentation_rendering()
        try:
            for qpos in positions:
                self.data.qpos[:] = qpos
                mujoco.mj_forward(self.model, self.data)
                renderer.update_scene(self.data, camera, self._options)
                yield renderer.render()
        finally:
            renderer.close()

    def _own_corners(self) -> Corners:
        from hymeko_x.draw.camera import corners_of

        return corners_of(self.model, [self.data], self._groups)

    def _place(self, pose: str | None) -> None:
        """Put the robot into a keyframe, into the positions of a file, or into its home keyframe if it has one."""
        import mujoco

        keys = {self.model.key(number).name: number for number in range(self.model.nkey)}
        pose = pose or ("home" if "home" in keys and not self._wanted.is_authored else None)
        if pose is not None and pose in keys:
            mujoco.mj_resetDataKeyframe(self.model, self.data, keys[pose])
        elif pose is not None and pose.endswith(".json"):
            self._take_positions(_positions(Path(pose)), pose)
        elif pose is not None and pose != "home":
            known = ", ".join(sorted(name for name in keys if name)) or "none"
            raise refuse(codes.UNDEFINED_REFERENCE, f"{self._name} has no pose '{pose}'", hint=f"keyframes: {known}; or a file NAME.json")
        mujoco.mj_forward(self.model, self.data)

    def _take_joints_of(self, other: Studio) -> None:
        """Move each joint with one dof to where it is in another robot: formats differ in the positions in which they place bodies."""
        import mujoco

        scalar = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
        theirs = {
            other.model.joint(joint).name: joint for joint, kind in enumerate(other.model.jnt_type) if mujoco.mjtJoint(kind) in scalar
        }
        for joint in range(self.model.njnt):
            name = self.model.joint(joint).name
            same = theirs.get(name, theirs.get(name.removesuffix("_joint")))  # which stands behind names that a body has as well
            if same is not None and self.model.jnt_type[joint] == other.model.jnt_type[same]:
                self.data.qpos[self.model.jnt_qposadr[joint]] = other.data.qpos[other.model.jnt_qposadr[same]]
        mujoco.mj_forward(self.model, self.data)

    def _take_positions(self, positions: Mapping[str, float], file: str) -> None:
        import mujoco

        for name, value in positions.items():
            joint = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name)
            if joint < 0:
                raise refuse(codes.UNDEFINED_REFERENCE, f"{self._name} has no joint '{name}'", Origin(file))
            self.data.qpos[self.model.jnt_qposadr[joint]] = value


def is_drawn(format: Format) -> bool:
    """Whether MuJoCo, which draws, reads the format itself; robots in other formats are written in such a one first."""
    return "mujoco" in format.memory


def open_studio(robot: Mechanism | Holder, path: str | None, wanted: PictureOptions, like: Studio | None = None) -> Studio:
    """The scene of a robot. ``path`` is its file where MuJoCo reads that format itself; other formats go through our own writer.

    A holder that has ``files`` finds its meshes and images itself; those of a mechanism are looked for beside the file that it was read
    from.
    ``like`` as for :class:`Studio`.

    Raises: Refusal as :class:`Studio`.
    """
    choose_backend()
    import mujoco

    if path is not None:
        try:
            return Studio(in_own_thread(lambda: mujoco.MjSpec.from_file(path)), path, wanted, like)
        except (ValueError, RuntimeError) as error:
            raise refuse(codes.ENGINE_REFUSED, f"MuJoCo refuses it: {_first_line(error)}", Origin(path), hint=hint_for(error)) from error
    row = next(row for row in formats.FORMATS if is_drawn(row))
    with TemporaryDirectory(prefix="hymeko-x-") as folder:
        file = Path(folder) / f"robot{row.suffixes[0]}"
        api.dump(robot, file, row.name)
        return Studio(mujoco.MjSpec.from_file(str(file)), mechanism_of(robot).name, wanted, like)


def _compiled(spec: Any, name: str) -> mujoco.MjModel:
    import mujoco

    try:
        return in_own_thread(spec.compile)
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        raise refuse(codes.ENGINE_REFUSED, f"MuJoCo refuses it: {_first_line(error)}", Origin(name), hint=hint_for(error)) from error


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]


def _positions(path: Path) -> Mapping[str, float]:
    """Joint positions (rad or m) by name. Raises: Refusal when the file is no JSON object of numbers."""
    try:
        found = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise refuse(codes.CANNOT_READ, f"cannot be read: {error}", Origin(str(path))) from error
    if not isinstance(found, dict) or not all(isinstance(value, int | float) for value in found.values()):
        raise refuse(codes.BAD_VALUE, "expected one JSON object: joint names with their positions in rad or m", Origin(str(path)))
    return found


# ---- the scene ---------------------------------------------------------------------------------------------------------------


def _groups(model: mujoco.MjModel, *, collision: bool) -> frozenset[int]:
    """The groups of geoms to draw: the visual ones, or those for collision where they are asked for or there are no others."""
    if collision:
        return COLLISION if any(group in COLLISION for group in model.geom_group) else VISUAL
    own = [geom for geom in range(model.ngeom) if model.geom(geom).name != GROUND]
    moving = [geom for geom in own if model.geom_bodyid[geom] != 0]
    return VISUAL if any(model.geom_group[geom] in VISUAL for geom in (moving or own)) else VISUAL | COLLISION


def _options(wanted: PictureOptions, groups: frozenset[int]) -> mujoco.MjvOption:
    import mujoco

    options = mujoco.MjvOption()
    options.geomgroup[:] = [group in groups or group == 0 for group in range(mujoco.mjNGROUP)]
    options.sitegroup[:] = 0
    options.flags[mujoco.mjtVisFlag.mjVIS_INERTIA] = wanted.inertia
    options.flags[mujoco.mjtVisFlag.mjVIS_RANGEFINDER] = not wanted.is_authored  # rays, which depend on sensors that formats lack
    options.flags[mujoco.mjtVisFlag.mjVIS_TRANSPARENT] = wanted.frames or wanted.inertia
    if wanted.frames:
        options.frame = mujoco.mjtFrame.mjFRAME_BODY
    return options


def _swept(model: mujoco.MjModel, rest: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    """Configurations in which one joint after the other leaves its place, goes to both limits and comes back."""
    import mujoco
    import numpy as np

    wave = np.sin(np.linspace(0.0, 2.0 * np.pi, _FRAMES_PER_JOINT, endpoint=False))
    for joint in range(model.njnt):
        kind = mujoco.mjtJoint(model.jnt_type[joint])
        if kind not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            continue
        address = model.jnt_qposadr[joint]
        reach = np.pi if kind == mujoco.mjtJoint.mjJNT_HINGE else 0.1
        lower, upper = model.jnt_range[joint] if model.jnt_limited[joint] else (rest[address] - reach, rest[address] + reach)
        for height in wave:
            qpos = rest.copy()
            qpos[address] += height * ((upper - rest[address]) if height > 0 else (rest[address] - lower))
            yield qpos


# ---- the machine -------------------------------------------------------------------------------------------------------------


def choose_backend() -> None:
    """Draw through EGL where it is there, no screen is, and the environment names no other way. MuJoCo decides when it is imported."""
    if "DISPLAY" not in os.environ and find_library("EGL"):
        os.environ.setdefault("MUJOCO_GL", "egl")


def _renderer(model: mujoco.MjModel, width: int, height: int) -> mujoco.Renderer:
    import mujoco

    try:
        return mujoco.Renderer(model, height, width)
    except (AttributeError, ImportError, RuntimeError, Warning, mujoco.FatalError) as error:  # glfw warns where there is no screen
        way = os.environ.get("MUJOCO_GL", "the screen")
        hint = "install EGL (Debian: libegl1 libgl1-mesa-dri), or OSMesa (libosmesa6) and set MUJOCO_GL=osmesa"
        raise refuse(codes.CANNOT_DRAW, f"MuJoCo cannot draw through {way} on this machine: {_first_line(error)}", hint=hint) from error
