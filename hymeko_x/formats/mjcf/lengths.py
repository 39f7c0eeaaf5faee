"""How many numbers a keyframe of MJCF has to have."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.formats.mjcf import NAME
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Actuator, DofKind
from hymeko_x.xml.text import unescaped

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Extra, Mechanism

COORDINATES: Mapping[DofKind, tuple[int, int]] = MappingProxyType({DofKind.FREE: (7, 6), DofKind.BALL: (4, 3)})
"""How many coordinates and velocities a dof has; one of each for all others."""
_KEY = re.compile(r"<key\b[^>]*?/>|<key\b.*?</key>", re.DOTALL)
_NAMED = re.compile(r'\sname="([^"]*)"')
_NUMBERS = re.compile(r'\b(qpos|qvel|ctrl)="([^"]*)"')


def controls_of(actuator: Actuator) -> int:
    """How many controls an actuator has: one for each word of ``input``, and a rotation has three, or four as a quaternion."""
    given = dict(actuator.parameters)
    words = str(given.get("input", "")).split()
    law = str(given.get("gaintype", actuator.kind))
    if law in ("so3", "orientation"):
        return 4 if words == ["quat"] else 3
    if words:
        return sum(word != "none" for word in words)
    return 2 if law == "pid" else 1


def is_keyframes(extra: Extra) -> bool:
    """Whether an extra is a <keyframe> section of MJCF."""
    return extra.format == NAME and extra.text.startswith("<keyframe")


class Misfit(Struct, frozen=True):
    """How many numbers an attribute of a keyframe has, and how many the robot has."""

    attribute: str
    found: int
    wanted: int

    def __str__(self) -> str:
        return f"{self.found} numbers in {self.attribute}, and the robot has {self.wanted}"


def without_misfits(mechanism: Mechanism) -> tuple[Mechanism, dict[Misfit, list[str]]]:
    """The mechanism without the keyframes that have too many or too few numbers, and the names of these by the reason.

    Keyframes of bodies that have coordinates of their own, which no joint counts, are not known to be misfits.
    """
    own = mechanism.extras.get(ROOT, ())
    misfits: dict[Misfit, list[str]] = {}
    if has_soft_bodies(mechanism) or not any(map(is_keyframes, own)):
        return mechanism, misfits
    counts = _counts(mechanism)
    kept = tuple(_with_fitting_keys(extra, counts, misfits) if is_keyframes(extra) else extra for extra in own)
    return (replace(mechanism, extras={**mechanism.extras, ROOT: kept}) if misfits else mechanism), misfits


def misfits(mechanism: Mechanism) -> list[tuple[str, bool]]:
    """What is odd about each keyframe of which the numbers do not fit the robot, and whether MuJoCo refuses it."""
    found = []
    for reason, names in without_misfits(mechanism)[1].items():
        is_refused = reason.found > reason.wanted
        effect = "MuJoCo refuses the file" if is_refused else "MuJoCo leaves the others at rest"
        found += [(f"keyframe {name} has {reason}; {effect}", is_refused) for name in names]
    return found


def has_soft_bodies(mechanism: Mechanism) -> bool:
    """Whether there are bodies that have coordinates of their own, which no joint of the robot counts."""
    return any("<flex" in extra.text or "<composite" in extra.text for extra in mechanism.extras.get(ROOT, ()))


def _counts(mechanism: Mechanism) -> dict[str, int]:
    """How many numbers each attribute of a keyframe has."""
    kinds = [dof.kind for view in mechanism.joints.values() for dof in view.joint.dofs]
    return {
        "qpos": sum(COORDINATES.get(kind, (1, 1))[0] for kind in kinds),
        "qvel": sum(COORDINATES.get(kind, (1, 1))[1] for kind in kinds),
        "ctrl": sum(controls_of(actuator) for _, actuator in mechanism.vertices(Actuator)),
    }


def _with_fitting_keys(extra: Extra, counts: Mapping[str, int], misfits: dict[Misfit, list[str]]) -> Extra:
    """The keyframes that fit the robot; the names of others are added to ``misfits``, by the reason."""

    def fitting(found: re.Match[str]) -> str:
        for name, numbers in _NUMBERS.findall(found[0]):
            if len(numbers.split()) != counts[name]:
                called = _NAMED.search(found[0])
                reason = Misfit(name, len(numbers.split()), counts[name])
                misfits.setdefault(reason, []).append(f"'{unescaped(called[1])}'" if called else "without a name")
                return ""
        return found[0]

    return replace(extra, text=_KEY.sub(fitting, extra.text))
