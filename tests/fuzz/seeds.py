"""The texts that fuzzing starts from: our own robots in every format, and by hand what they do not say."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import hymeko_x as hx
from hymeko_x.ir.parts import Body
from tests.fuzz import texts
from tests.sdf.samples import SAMPLES

FOLDER = Path(__file__).parents[2] / "corpus"
SMALL = Path(__file__).parent / "small"
"""Texts of a few lines, each about one thing: read within a fraction of a millisecond, and damage hits what they are about."""

LARGEST = 4000
"""Small texts are read quickly, and a mutation hits something that means something."""

FORMATS = ("hymeko", "urdf", "mjcf", "usd", "sdf", "xacro", "xml")
"""The text formats that are fuzzed; ``xml`` is any XML, whose root decides what reads it."""


@cache
def seeds(format: str) -> tuple[bytes, ...]:
    """The texts of a format, in a fixed order."""
    if format == "xml":
        return (*(text.encode() for text in texts.SDF), *seeds("urdf")[:4], *seeds("mjcf")[:4])
    written = [text.encode() for text in texts.BY_FORMAT.get(format, ())]
    if format == "xacro":
        return tuple(written)
    found = [_converted(path, format) for path in sorted(FOLDER.glob("*/*.hymeko"))]
    return (*written, *(text for text in found if text is not None and len(text) <= LARGEST))


@cache
def small_seeds(format: str) -> tuple[bytes, ...]:
    """The small texts of a format, in a fixed order."""
    if format == "xml":
        return (*(text.encode() for text in texts.SDF), *small_seeds("urdf")[:4], *small_seeds("mjcf")[:4])
    if format == "sdf":
        return tuple(text.encode() for text in SAMPLES.values())
    return tuple(path.read_bytes() for path in sorted((SMALL / format).iterdir()))


def _converted(path: Path, format: str) -> bytes | None:
    """A robot in a format; None for graphs and lumped systems, which only HyMeKo represents."""
    if format == "hymeko":
        return path.read_bytes()
    robot = hx.load(path).mechanism
    return hx.dumps(robot, format).encode() if any(robot.vertices(Body)) else None
