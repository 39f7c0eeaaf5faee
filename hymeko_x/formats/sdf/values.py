"""Values of SDF: how texts are read and written, and which element of a joint or a material holds which field."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from hymeko_x.ir.digits import number_text, numbers_text
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Sphere
from hymeko_x.ir.values import ZERO, Pose, pose, pose_from_rpy
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.formats.sdf.notations import WrittenPose
    from hymeko_x.ir.parts import Geometry

UNBOUNDED = 1e16
"""From here on a limit means none, as in SDF up to 1.9."""
_INFINITE = {"inf": math.inf, "+inf": math.inf, "-inf": -math.inf, "infinity": math.inf, "-infinity": -math.inf}


class BadText(Exception):
    """A text that is no value; the text of the exception is what was expected."""


class Codec(NamedTuple):
    """How a value is read from text (raises BadText) and written; ``is_plain`` when a value is the numbers of its text, or None."""

    read: Callable[[str], Any]
    write: Callable[[Any], str]
    is_plain: bool = False


def _number(text: str) -> float:
    found = read_numbers(text)
    if found is None or len(found) != 1:
        raise BadText("one finite number")
    return found[0]


def _numbers(count: int) -> Callable[[str], tuple[float, ...]]:
    def read(text: str) -> tuple[float, ...]:
        found = read_numbers(text)
        if found is None or len(found) != count:
            raise BadText(f"{count} finite numbers separated by blanks")
        return found

    return read


def _bound(text: str) -> float | None:
    """A limit; None = unlimited."""
    value = _INFINITE.get(text.lower())
    value = _number(text) if value is None else value
    return value if abs(value) < UNBOUNDED else None


def _strength(text: str) -> float | None:
    """A limit of effort or velocity, for which negative numbers mean none."""
    value = _bound(text)
    return None if value is None or value < 0.0 else value


def _truth(text: str) -> bool:
    word = text.lower()
    if word not in ("true", "false", "1", "0"):
        raise BadText("true or false")
    return word in ("true", "1")


def _colour(text: str) -> tuple[float, ...]:
    """Red, green, blue and alpha from 0 to 1; alpha may be left out."""
    found = read_numbers(text)
    if found is None or len(found) not in (3, 4):
        raise BadText("3 or 4 finite numbers separated by blanks")
    return found if len(found) == 4 else (*found, 1.0)


NUMBER = Codec(_number, number_text, is_plain=True)
VECTOR = Codec(_numbers(3), numbers_text, is_plain=True)
PAIR = Codec(_numbers(2), numbers_text, is_plain=True)
BOUND = Codec(_bound, lambda value: "inf" if value is None else number_text(value), is_plain=True)
STRENGTH = Codec(_strength, lambda value: "inf" if value is None else number_text(value), is_plain=True)
TRUTH = Codec(_truth, lambda value: "true" if value else "false")
COLOUR = Codec(_colour, numbers_text)
PITCH = Codec(lambda text: _number(text) / math.tau, lambda value: number_text(value * math.tau))
"""``screw_thread_pitch``: m per turn, right-handed; the IR has m per rad."""


def _old_pitch(text: str) -> float:
    value = _number(text)
    if not value:
        raise BadText("a number other than zero")
    return -1.0 / value


OLD_PITCH = Codec(_old_pitch, lambda value: number_text(-1.0 / value))
"""``thread_pitch``: rad per m, left-handed."""


class ValueField(NamedTuple):
    """A value below an element: where it stands, the attribute of the part that holds it, its codec and its default."""

    path: str
    name: str
    codec: Codec
    default: Any = None


DYNAMICS = (
    ValueField("damping", "damping", NUMBER, 0.0),
    ValueField("friction", "friction", NUMBER, 0.0),
    ValueField("spring_reference", "spring_ref", NUMBER, 0.0),
    ValueField("spring_stiffness", "stiffness", NUMBER, 0.0),
)
"""What <dynamics> contains."""
STRENGTH_LIMITS = (ValueField("effort", "effort", STRENGTH), ValueField("velocity", "velocity", STRENGTH))
LIMITS = (ValueField("lower", "lower", BOUND), ValueField("upper", "upper", BOUND), *STRENGTH_LIMITS)
"""What <limit> contains."""

TENSOR = (
    ValueField("ixx", "xx", NUMBER, 1.0),
    ValueField("iyy", "yy", NUMBER, 1.0),
    ValueField("izz", "zz", NUMBER, 1.0),
    ValueField("ixy", "xy", NUMBER, 0.0),
    ValueField("ixz", "xz", NUMBER, 0.0),
    ValueField("iyz", "yz", NUMBER, 0.0),
)
"""What <inertia> contains, in the order of the IR's tensors, with the values that libsdformat takes for missing ones."""

_RADIUS, _LENGTH = ValueField("radius", "radius", NUMBER, 1.0), ValueField("length", "length", NUMBER, 1.0)
SOLIDS: Mapping[str, tuple[type[Geometry], tuple[ValueField, ...]]] = MappingProxyType(
    {
        "box": (Box, (ValueField("size", "size", VECTOR, (1.0, 1.0, 1.0)),)),
        "sphere": (Sphere, (_RADIUS,)),
        "cylinder": (Cylinder, (_RADIUS, _LENGTH)),
        "capsule": (Capsule, (_RADIUS._replace(default=0.5), _LENGTH)),
        "ellipsoid": (Ellipsoid, (ValueField("radii", "radii", VECTOR, (1.0, 1.0, 1.0)),)),
    }
)
"""The geometries that the IR has as well, by their elements, with the values that libsdformat takes for missing ones."""


def is_same_text(written: str, text: str) -> bool:
    """Whether two texts are the same, or the same numbers."""
    if written == text:
        return True
    numbers = read_numbers(text)
    return numbers is not None and numbers == read_numbers(written)


def read_pose(written: WrittenPose) -> Pose:
    """The pose that a <pose> means in the frame that it is relative to: position in m, fixed-axis angles or a quaternion (x, y, z, w).

    Raises: BadText.
    """
    if not written.text:
        return Pose()
    as_quaternion = written.rotation_format == "quat_xyzw"
    numbers = read_numbers(written.text)
    if numbers is None or len(numbers) != (7 if as_quaternion else 6):
        raise BadText(f"{7 if as_quaternion else 6} finite numbers separated by blanks")
    x, y, z, *rotation = numbers
    if as_quaternion:
        qx, qy, qz, qw = rotation
        return pose((x, y, z), (qw, qx, qy, qz)) if any(rotation) else Pose((x, y, z))
    roll, pitch, yaw = (map(math.radians, rotation)) if (written.degrees or "").lower() in ("true", "1") else rotation
    return pose_from_rpy((x, y, z), (roll, pitch, yaw)) if (roll, pitch, yaw) != ZERO else Pose((x, y, z))


def is_unit(numbers: tuple[float, ...]) -> bool:
    """Whether a quaternion has unit length up to what its author's digits allow."""
    return abs(math.hypot(*numbers) - 1.0) < 1e-6
