"""The names of USD that its reader and its writer share. Data and plain values only; nothing here imports the USD libraries."""

from __future__ import annotations

import math
import struct
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir import values
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.notations import Notation, flag, word, words

if TYPE_CHECKING:
    from collections.abc import Mapping

FORMAT = "usd"

RESIDUE = "hymeko:residue"
"""The string in the custom data of the root layer that contains a residue."""
PATH = words("usd.path")
"""The notation that keeps the path of the prim that an element was read from; several paths where it was made of several."""
TYPE = word("usd.type")
"""The notation of a joint that keeps the type of its prim where the dofs alone would make it another one."""
REVERSED = flag("usd.reversed")
"""The notation of a joint whose parent in the tree is its ``body1``."""
EQUALITY = flag("usd.equality")
"""The notation of a coupling that has MuJoCo's schema alone, without Newton's."""
SITE = word("usd.site")
"""The notation of a frame that has one schema for sites alone, with the name of it."""
PHYSX = words("usd.physx")
"""The notation of a joint with the names of its values that PhysX' schema has too, in a stage that is not neutral."""
NORMALS = flag("usd.normals", "faces")
"""The notation of a mesh shape whose prim has the normal of each triangle as computed from its points."""
CORNER_NORMALS = flag("usd.corner_normals", "corners")
"""The notation of a mesh shape whose prim has normals by corner with indices, in the form that the writer uses."""
TEXCOORDS = flag("usd.texcoords", "corners")
"""The notation of a mesh shape whose prim has texture coordinates by corner with indices, in the form that the writer uses."""
MATERIAL_BIND = "materialBind"
"""The family of the subsets of a mesh that show other materials."""
FAMILY = f"subsetFamily:{MATERIAL_BIND}:familyType"
"""The attribute of a mesh for the type of that family; the writer sets it to: no face is in two subsets."""
NON_OVERLAPPING = "nonOverlapping"
FACE = "face"
"""What a subset is made of."""
HELD = flag("usd.held")
"""The notation of a joint without a prim: its body is fixed because its simulation is switched off."""
ARTICULATED = flag("usd.articulated")
"""The notation of a closure whose joint is part of the articulation."""


def _pose_text(pose: values.Pose) -> str:
    return numbers_text((*pose.xyz, *pose.quat))


def _pose(text: str) -> values.Pose | None:
    try:
        x, y, z, qw, qx, qy, qz = map(float, text.split())
    except ValueError:
        return None
    return values.Pose((x, y, z), values.unit_quat((qw, qx, qy, qz))) if any((qw, qx, qy, qz)) else None


POSE = Notation("usd.pose", _pose_text, _pose)
"""The notation of a body with the pose of its prim where that is not the pose that its joints give."""
GROUND = (word("usd.body0"), word("usd.body1"))
"""The notations of a joint that keep the group that stood for the world on either side."""
PROFILE = word("usd.profile")
"""The notation of the mechanism with the name of the profile whose rules the stage follows."""
REP_158 = "rep158"
"""The profile of USD for ROS: a layer per concern, and every value in its neutral form."""
ROOT_PRIM = word("usd.root")
"""The notation of the mechanism with the path of the prim that represents the robot."""

WRAPS = ("inputs:wrapS", "inputs:wrapT")
SCALE = "inputs:scale"
"""By which the colours of an image are multiplied."""
WHITE = (1.0, 1.0, 1.0, 1.0)
REPEAT = "repeat"
"""The wrapping of images in every format that does not specify one."""
WITHIN = "xformOp:scale:within"
"""The operation that undoes the scale of the body above."""

PREFIX = "hymeko:"

LIGHTS: Mapping[str, str] = MappingProxyType({"DistantLight": "directional", "SphereLight": "point", "DomeLight": "image"})
"""The lights of UsdLux that the IR can represent; a sphere light with a cone is a spot."""
CONE = "ShapingAPI"
SITES = ("MjcSiteAPI", "NewtonSiteAPI")
"""The schemas of a prim that marks a place, MuJoCo's and Newton's."""


class MimicSchema(NamedTuple):
    """A schema by which a joint follows another one, and the names of its attributes."""

    schema: str
    leader: str
    offset: str
    factor: str
    enabled: str


NEWTON_MIMIC = MimicSchema("NewtonMimicAPI", "newton:mimicJoint", "newton:mimicCoef0", "newton:mimicCoef1", "newton:mimicEnabled")
NEUTRAL_MIMIC = MimicSchema(
    "ExtendedPhysicsMimicAPI", *(f"ext_physics:mimic:{name}" for name in ("joint", "offset", "multiplier", "enabled"))
)
"""The same in the schema of no engine, incubated by REP 158. Source: ``ros-simulation/openusd-schemas``."""
APERTURE = 15.2908
"""The default vertical aperture of a camera, in mm as is its focal length."""
# ---- single precision ----------------------------------------------------------------------------------------------------


_pack = struct.Struct("f").pack


def single(value: float) -> float:
    """The shortest decimal that names a single-precision number: 0.1 for the float that is closest to 0.1.

    Hence an author's number comes back without its rounding error; the float that it rounds to is the same.
    """
    if not math.isfinite(value) or value == int(value):
        return float(value)
    packed = _pack(value)
    for digits in ("%.6g", "%.7g", "%.8g"):
        short = float(digits % value)
        if _pack(short) == packed:
            return short
    return float(f"{value:.9g}")


def single_in(value: float, unit: float) -> float:
    """A single-precision number in another unit: 10 for the float of 10 pi/180 that is read in radians."""
    short = single(value * unit)
    return short if math.isfinite(short) and _pack(short / unit) == _pack(value) else value * unit
