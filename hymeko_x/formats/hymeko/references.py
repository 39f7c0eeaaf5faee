"""What a name in HyMeKo text refers to where its kind, or the name itself, is left open: for the reader and the writer."""

from __future__ import annotations

from hymeko_x.formats.hymeko import ATTACHED, TARGETS

_AT_FRAMES = frozenset({"touch", "accelerometer", "velocimeter", "gyro", "force", "torque", "magnetometer", "rangefinder"})
"""The sensors at a frame."""
_MEASURED = {"joint": "joint", "ball": "joint", "tendon": "tendon", "actuator": "actuator"}
"""What other sensors measure, by the beginning of their type: ``jointpos``, ``ballquat``, ``tendonvel``."""
_DRIVEN = ("joint", "tendon", "frame", "body", "actuator")


def attached_kinds(kind: str, type: str) -> tuple[str, ...]:
    """The kinds that a reference in the block of a vertex of this kind and type may mean, the likeliest first.

    A motor drives the joint of a name and no body of it; a touch sensor measures at a frame.
    """
    kinds = TARGETS[ATTACHED[kind]]
    if kind == "actuator":
        return _DRIVEN
    if kind != "sensor":
        return kinds
    first = "frame" if type in _AT_FRAMES else next((found for start, found in _MEASURED.items() if type.startswith(start)), kinds[0])
    return (first, *(other for other in kinds if other != first))


def child_names(joint: str) -> tuple[str, ...]:
    """The names of the body that a joint without a child leads to, of which the first that there is counts.

    Its own name, that with ``link`` for ``joint``, and that without ``_joint``.
    """
    return (joint, joint.replace("joint", "link").replace("Joint", "Link"), joint.removesuffix("_joint"))
