"""The words of URDF that its reader and its writer share, and the few rules that both go by.

Source: the urdfdom schema and its parser; URDF 1.0.
"""

from __future__ import annotations

from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.parts import DofKind, Role

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import Joint

FORMAT = "urdf"


class JointType(NamedTuple):
    """A word of ``<joint type>``: the kinds of the joint's dofs, and whether ``<limit>`` bounds the position."""

    dofs: tuple[DofKind, ...] = ()
    bounded: bool = False


JOINT_TYPES: Mapping[str, JointType] = MappingProxyType(
    {
        "fixed": JointType(),
        "revolute": JointType((DofKind.HINGE,), bounded=True),
        "continuous": JointType((DofKind.HINGE,)),
        "prismatic": JointType((DofKind.SLIDE,), bounded=True),
        "floating": JointType((DofKind.FREE,)),
        "planar": JointType((DofKind.SLIDE, DofKind.SLIDE, DofKind.HINGE)),
        "spherical": JointType((DofKind.BALL,)),
        "ball": JointType((DofKind.BALL,)),
    }
)
"""The last two are not in the standard. MuJoCo and Bullet read ``spherical``; both are written only where they were read."""


def default_type(joint: Joint) -> str | None:
    """The word for a joint by its dofs; None when URDF has none. A slide is always bounded, a hinge if it has limits."""
    dofs = joint.dofs
    if len(dofs) != 1:
        kinds = tuple(dof.kind for dof in dofs)
        return "planar" if kinds == JOINT_TYPES["planar"].dofs else None if dofs else "fixed"
    kind, limits = dofs[0].kind, dofs[0].limits
    if kind is DofKind.HINGE:
        return "continuous" if limits.lower is None and limits.upper is None else "revolute"
    return "prismatic" if kind is DofKind.SLIDE else "floating" if kind is DofKind.FREE else None


NO_LIMIT = 1.7976931348623157e308
"""The largest double: what Pinocchio takes for "no limit", and what is written where URDF requires a number."""

ROLES: Mapping[str, Role] = MappingProxyType({"visual": Role.VISUAL, "collision": Role.COLLISION})
"""The elements of a link that hold a shape."""

VERSIONS = ("1.0", "1.1", "1.2")
"""Known values of ``<robot version>``; from 1.1 on readers of 1.1 understand ``quat_xyzw`` and ``<capsule>``."""

MEANINGLESS_IF_FIXED = ("axis", "limit", "dynamics")
"""What many exporters write into fixed joints, where it means nothing."""

SINGLE = frozenset(
    (
        *("inertial", "origin", "mass", "inertia", "geometry", "material", "color", "texture"),
        *("parent", "child", "axis", "limit", "dynamics", "safety_controller", "calibration", "mimic"),
    )
)
"""What stands at most once in its link, joint, visual or collision."""

# ---- notations ---------------------------------------------------------------------------------------------------------------

STYLE = "urdf.style"
"""Mechanism: words for what the author wrote although he could have left it out. The writer then always writes it."""

STYLE_JOINT_ORIGIN = "joint"
STYLE_VISUAL_ORIGIN = "visual"
STYLE_COLLISION_ORIGIN = "collision"
STYLE_INERTIAL_ORIGIN = "inertial"
STYLE_CAPSULE = "capsule"
STYLE_DYNAMICS = "dynamics"
STYLE_SCALE = "scale"
STYLE_VERSION = "version"

FIXED = "urdf.fixed"
"""Mechanism: the meaningless elements that most fixed joints carry, verbatim."""

TYPE = "urdf.type"
"""Joint: the word of its type where another one would be written by default."""

# Choices that most elements make alike. The usual one is a word of the style (``defined=inline``), and an element that
# differs has a notation (``urdf.defined``). The first value of each is the default.

DEFINED = "defined"
"""Material: where it is defined, a value of :class:`Defined`."""

REDUCTION = "reduction"
"""Drive: which element says the mechanical reduction of a simple transmission: actuator, joint or transmission."""

TYPE_AS = "type-as"
"""Drive: whether the transmission's type is a ``child`` (ROS 1) or an ``attribute`` (PR2)."""

DEFAULT_CHOICES: Mapping[str, str] = MappingProxyType({DEFINED: "robot", REDUCTION: "actuator", TYPE_AS: "child"})


def notation(choice: str) -> str:
    """The key of the notation of an element that chose differently."""
    return f"urdf.{choice}"


class Defined(Enum):
    """Where a named material's colour and texture stand."""

    ROBOT = "robot"
    INLINE = "inline"
    FIRST = "first"
    BOTH = "both"
