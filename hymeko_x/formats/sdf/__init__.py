"""The words of SDF that its reader and its writer share, and the few rules for both.

Source: the SDF schemas 1.3 to 1.12 and libsdformat; docs/mapping/sdf.md has the mapping.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.parts import DofKind, Role

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import Joint

FORMAT = "sdf"
RESIDUE = "hymeko:residue"
"""The element that contains a residue as the last child of the root; elements with a prefix are custom ones, which readers leave alone."""
RESIDUE_NAMESPACE = "urn:hymeko-x"

VERSIONS = tuple(f"1.{minor}" for minor in range(13))
DEFAULT_VERSION = "1.9"
"""What is written unless the file came from another version or needs a later one."""
VERSION_OF_MIMIC = "1.11"
VERSION_OF_AUTO = "1.11"
VERSION_OF_PITCH = "1.10"
"""From here on the pitch of a screw is ``screw_thread_pitch``."""
VERSION_OF_RELATIVE_TO = 7
"""The minor version from which on a pose names its frame in ``relative_to``, and an axis in ``expressed_in``."""
VERSION_OF_JOINT_AXES = 5
"""The minor version from which on an axis is given in the joint's own frame unless the file says otherwise."""
AROUND = ("preceding", "following")
"""The paths of extras outside the root element."""
DENSITY = 1000.0
"""kg/m^3 of collisions from which an inertial is computed."""

MODEL_FRAME = "__model__"
WORLD_FRAME = "world"
WORLD_LINK = "world_geometry"
"""The link for what is on the world, where only links have shapes and sensors; a fixed joint to the world holds it."""
ANCHOR = "_anchor"
"""How the name of a link ends that only holds the end of a closure."""
SCOPE = "::"
WORLD_SCOPE = "\0"
"""Stands before the names of frames and joints in the world where its only model has no scope of its own."""


def minor(version: str) -> int:
    """The number behind the point of a version."""
    return int(version.partition(".")[2] or 0)


def scoped(scope: str, name: str) -> str:
    """The name of an element of a model, as it is outside of that model; the scope is empty or ends in ``::``."""
    return scope + name


def split_scope(name: str) -> tuple[str, str]:
    """The scope of a name, empty or ending in ``::``, and the name in it."""
    scope, mark, own = name.rpartition(SCOPE)
    return scope + mark, own


def scope_around(scope: str) -> str:
    """The scope of the model around the one with this scope; empty for the outermost."""
    return split_scope(scope.removesuffix(SCOPE))[0]


# ---- joints ------------------------------------------------------------------------------------------------------------------


class SdfJointType(NamedTuple):
    """A value of ``<joint type>``: the kinds of the joint's dofs, and whether <limit> bounds the position."""

    dofs: tuple[DofKind, ...] = ()
    bounded: bool = True


JOINT_TYPES: Mapping[str, SdfJointType] = MappingProxyType(
    {
        "fixed": SdfJointType(),
        "revolute": SdfJointType((DofKind.HINGE,)),
        "continuous": SdfJointType((DofKind.HINGE,), bounded=False),
        "prismatic": SdfJointType((DofKind.SLIDE,)),
        "screw": SdfJointType((DofKind.SCREW,)),
        "ball": SdfJointType((DofKind.BALL,), bounded=False),
        "universal": SdfJointType((DofKind.HINGE, DofKind.HINGE)),
        "revolute2": SdfJointType((DofKind.HINGE, DofKind.HINGE)),
    }
)
"""``gearbox`` is none of them: it couples two joints (``gearboxes.py``). ``piston`` of old versions was never implemented."""

AXES = ("axis", "axis2")


def default_type(joint: Joint) -> str | None:
    """The type of a joint by its dofs; None when SDF has none."""
    kinds = tuple([dof.kind for dof in joint.dofs])
    if kinds == (DofKind.HINGE,):
        limits = joint.dofs[0].limits
        return "continuous" if limits.lower is None and limits.upper is None else "revolute"
    if kinds == (DofKind.HINGE, DofKind.HINGE):
        first, second = (dof.axis for dof in joint.dofs)
        return "universal" if abs(sum(a * b for a, b in zip(first, second, strict=True))) < 1e-9 else "revolute2"
    return _TYPES.get(kinds)


_TYPES: Mapping[tuple[DofKind, ...], str] = MappingProxyType({kind.dofs: word for word, kind in reversed([*JOINT_TYPES.items()])})


# ---- shapes ------------------------------------------------------------------------------------------------------------------

ROLES: Mapping[str, Role] = MappingProxyType({"visual": Role.VISUAL, "collision": Role.COLLISION})
"""The elements of a link that hold a shape."""


def shape_name(tag: str, number: int) -> str:
    """The name of the n-th visual or collision of a link, counted from 1, when its author gave it none: SDF requires one."""
    return tag if number == 1 else f"{tag}_{number}"


SENSORS = frozenset(
    (
        *("air_pressure", "air_speed", "altimeter", "boundingbox_camera", "camera", "contact", "depth", "depth_camera", "force_torque"),
        *("gps", "gpu_lidar", "gpu_ray", "imu", "lidar", "logical_camera", "magnetometer", "multicamera", "navsat", "ray", "rfid"),
        *("rfidtag", "rgbd", "rgbd_camera", "segmentation", "segmentation_camera", "sonar", "thermal", "thermal_camera"),
        *("wideanglecamera", "wireless_receiver", "wireless_transmitter", "custom", "none"),
    )
)
"""The types of sensors."""

GEOMETRIES = ("box", "capsule", "cone", "cylinder", "ellipsoid", "plane", "sphere", "mesh", "polyline", "heightmap", "image", "empty")
"""The elements of <geometry>; where there are several, libsdformat reads the first one in this order, whatever their order in the file."""
OTHER_GEOMETRIES = ("cone", "polyline", "heightmap", "image", "empty")
"""Geometries that the IR cannot represent; they are kept as written."""
