"""The values that elements are given: numbers of any library as floats, and positions as poses."""

from __future__ import annotations

import math

from msgspec.structs import replace

from hymeko_x.ir.geometry import Geometry
from hymeko_x.ir.values import Pose, pose
from hymeko_x.ir.written import is_as_written
from hymeko_x.robot.errors import EditError


def plain_value(value: object) -> object:
    """Numbers of numpy as floats, and arrays and lists as tuples."""
    if isinstance(value, bool | str | bytes) or value is None:
        return value
    if isinstance(value, int):
        return float(value)
    if isinstance(value, float):
        return float(value)
    if isinstance(value, Geometry):
        return replace(value, **{field: plain_value(getattr(value, field)) for field in value.__struct_fields__})
    if isinstance(value, list | tuple) or hasattr(value, "tolist"):
        items = value.tolist() if hasattr(value, "tolist") else value
        return tuple(map(plain_value, items)) if isinstance(items, list | tuple) else plain_value(items)
    return value


def as_pose(element: object, value: object) -> Pose:
    """A pose, or the one of a position. Raises: EditError for anything else."""
    if isinstance(value, Pose):
        return value if value.written is not None and is_as_written(value) else pose(value.xyz, value.quat)
    plain = plain_value(value)
    if isinstance(plain, tuple) and len(plain) == 3 and all(isinstance(number, float) and math.isfinite(number) for number in plain):
        return Pose(plain)
    raise EditError(f"{element}: a pose is a Pose or a position of three numbers in m, found {value!r}")
