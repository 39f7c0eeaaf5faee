"""The words of URDF that its reader and its writer share, and the few rules for both.

Source: the urdfdom schema and its parser; URDF 1.0.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.parts import DofKind, Role

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import Joint

FORMAT = "urdf"

RESIDUE = "hymeko:residue"
"""The element that contains a residue as the last child of the root, which all other readers ignore."""
RESIDUE_NAMESPACE = "urn:hymeko-x"


class UrdfJointType(NamedTuple):
    """A value of ``<joint type>``: the kinds of the joint's dofs, and whether ``<limit>`` bounds the position."""

    dofs: tuple[DofKind, ...] = ()
    bounded: bool = False


JOINT_TYPES: Mapping[str, UrdfJointType] = MappingProxyType(
    {
        "fixed": UrdfJointType(),
        "revolute": UrdfJointType((DofKind.HINGE,), bounded=True),
        "continuous": UrdfJointType((DofKind.HINGE,)),
        "prismatic": UrdfJointType((DofKind.SLIDE,), bounded=True),
        "floating": UrdfJointType((DofKind.FREE,)),
        "planar": UrdfJointType((DofKind.SLIDE, DofKind.SLIDE, DofKind.HINGE)),
        "spherical": UrdfJointType((DofKind.BALL,)),
        "ball": UrdfJointType((DofKind.BALL,)),
    }
)
"""The last two are not in the standard. MuJoCo and Bullet read ``spherical``; both are written only where they were read."""


def default_type(joint: Joint) -> str | None:
    """The type of a joint by its dofs; None when URDF has none. A slide is always bounded, a hinge if it has limits."""
    dofs = joint.dofs
    if len(dofs) != 1:
        kinds = tuple(dof.kind for dof in dofs)
        return "planar" if kinds == JOINT_TYPES["planar"].dofs else None if dofs else "fixed"
    kind, limits = dofs[0].kind, dofs[0].limits
    if kind is DofKind.HINGE:
        return "continuous" if limits.lower is None and limits.upper is None else "revolute"
    return "prismatic" if kind is DofKind.SLIDE else "floating" if kind is DofKind.FREE else None


NO_LIMIT, NO_LIMIT_TEXT = 1e9, "1e9"
"""Written where URDF requires a limit and there is none (rad, m, rad/s, m/s, N, Nm), and read as none: no robot comes near it."""
LARGEST = 1.7976931348623157e308
"""The largest double, which is "no limit" as well for Pinocchio."""
LIMITS = ("lower", "upper", "effort", "velocity", "acceleration", "jerk")
"""The attributes of <limit> in the order in which they are written, which are fields of the same names."""


def is_no_limit(value: float) -> bool:
    """Whether a number in <limit> stands for none."""
    return abs(value) == NO_LIMIT or abs(value) >= LARGEST


ROLES: Mapping[str, Role] = MappingProxyType({"visual": Role.VISUAL, "collision": Role.COLLISION})
"""The elements of a link that hold a shape."""

VERSIONS = ("1.0", "1.1", "1.2")
"""Known values of ``<robot version>``; from 1.1 on readers of 1.1 understand ``quat_xyzw`` and ``<capsule>``."""

MEANINGLESS_IF_FIXED = ("axis", "limit", "dynamics")
"""Elements that many exporters write into fixed joints, where they mean nothing."""

SINGLE = frozenset(
    (
        *("inertial", "origin", "mass", "inertia", "geometry", "material", "color", "texture"),
        *("parent", "child", "axis", "limit", "dynamics", "safety_controller", "calibration", "mimic"),
    )
)
"""Elements that a link, joint, visual or collision contains at most once."""
