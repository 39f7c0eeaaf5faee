"""How authors wrote SDF, where several ways mean the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.notations import Notation, flag, word
from hymeko_x.ir.values import Pose
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Mechanism

VERSION = word("sdf.version")
"""Mechanism: the version of the file. Its presence says that the mechanism came from SDF."""
WORLD = word("sdf.world")
"""Mechanism: the name of the <world> in which its models are."""
TYPE = word("sdf.type")
"""Joint: its type where another one would be written by default."""
ENDS = word("sdf.ends")
"""Joint: the frames that it names as parent and child, with a blank between them, where these are not links."""
GEARBOX: Notation[tuple[str, ...]] = Notation("sdf.gearbox", lambda names: "; ".join(names), lambda text: tuple(text.split("; ")))
"""Coupling: it is a joint of type gearbox, which names these as its parent, child and, where it does, reference body."""
ATTACHED = word("sdf.attached")
"""Frame: ``attached_to`` as written."""
NO_INERTIAL = flag("sdf.inertial", "missing")
"""Body: it has the inertial that libsdformat gives to a link without one."""
AUTO = flag("sdf.auto")
"""Body: its inertial is that of its collisions."""
SEVERAL = flag("sdf.models", "several")
"""Mechanism: its models are at top level, without a world."""
IN_WORLD = flag("sdf.place", "world")
"""Frame, joint: it stands in the world, beside the only model."""


def is_from_sdf(mechanism: Mechanism) -> bool:
    """Whether the mechanism was read from an SDF file."""
    return mechanism.notation(ROOT, VERSION) is not None


def _numbers(pose: Pose) -> str:
    return numbers_text((*pose.xyz, *pose.quat))


def _pose_of(text: str) -> Pose | None:
    numbers = read_numbers(text)
    if numbers is None or len(numbers) != 7:
        return None
    x, y, z, *quat = numbers
    return Pose((x, y, z), (quat[0], quat[1], quat[2], quat[3]))


MODEL = Notation("sdf.model", _numbers, _pose_of)
"""Mechanism: where the frame of its model is in the world, as a position and a quaternion (w, x, y, z); nowhere else without it."""
IMPLIED = flag("sdf.implied")
"""Joint: not in the file; a model without <static> floats, one with it stands."""

SHARED = flag("sdf.name", "shared")
"""Any element: another one beside it has the same name in the file, which libsdformat refuses; both keep it."""


class WrittenPose(Struct, frozen=True):
    """A <pose> as its author wrote it: its attributes in the order ``relative_to``, ``rotation_format``, ``degrees``, and its text."""

    relative_to: str | None = None
    rotation_format: str | None = None
    degrees: str | None = None
    text: str = ""


_MARKS = ("relative_to", "rotation_format", "degrees")


def _pose_text(pose: WrittenPose) -> str:
    marks = zip(_MARKS, (pose.relative_to, pose.rotation_format, pose.degrees), strict=True)
    return "; ".join([*[f"{name}={value}" for name, value in marks if value is not None], pose.text])


def _pose(text: str) -> WrittenPose:
    *items, numbers = text.split("; ")
    known = dict(item.partition("=")[::2] for item in items)
    return WrittenPose(known.get("relative_to"), known.get("rotation_format"), known.get("degrees"), numbers)


POSE = Notation("sdf.pose", _pose_text, _pose)
"""Link, joint, frame, model, shape, sensor, light: its <pose> as written."""

WRITTEN: Notation[Mapping[str, str]] = Notation(
    "sdf.written",
    lambda texts: "; ".join(f"{path}={text}" for path, text in texts.items()),
    lambda text: dict(item.partition("=")[::2] for item in text.split("; ") if "=" in item),
)
"""Any element: the texts of values, by path, that would not be written, or be written otherwise: defaults, other units, no limits."""
