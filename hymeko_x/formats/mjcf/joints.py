"""What the attributes of MJCF joints and tendons mean, and how they are said."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.formats.mjcf.codec import (
    BadAttribute,
    Group,
    Settings,
    angle_text,
    first_real,
    numbers_of,
    radians,
    real,
    reals,
    seen_numbers,
    vector_of,
)
from hymeko_x.ir.parts import (
    DofKind,
)
from hymeko_x.ir.values import (
    ZERO,
    Written,
    Z,
    numbers_text,
    unit,
)
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.values import Vec3

# ---- joints ------------------------------------------------------------------------------------------------------------------

DOF_KINDS = {"hinge": DofKind.HINGE, "slide": DofKind.SLIDE, "ball": DofKind.BALL, "free": DofKind.FREE}
_DOF_WORDS = {kind: word for word, kind in DOF_KINDS.items()}
_TURNING = (None, "hinge", "ball")


def read_kind(said: Mapping[str, str], settings: Settings) -> DofKind:
    word = said.get("type", "hinge")
    if word not in DOF_KINDS:
        raise BadAttribute("type", f"one of {', '.join(DOF_KINDS)}")
    return DOF_KINDS[word]


def _read_axis(said: Mapping[str, str], settings: Settings) -> tuple[Vec3, Written | None]:
    if said.get("type") in ("ball", "free"):
        return Z, None
    raw = vector_of(said, "axis", Z)
    try:
        axis = unit(raw)
    except ZeroDivisionError as error:
        raise BadAttribute("axis", "a direction") from error
    return axis, None if axis == raw else Written("axis", raw)


def _write_axis(value: tuple[Vec3, Written | None], settings: Settings) -> dict[str, str]:
    axis, written = value
    return {"axis": numbers_text(written.numbers if written and written.kind == "axis" else axis)}


def _motion(name: str) -> Group:
    """A coordinate of a joint: an angle in the unit of the file, or a length."""

    def in_degrees(said: Mapping[str, str], settings: Settings) -> bool:
        return settings.degree and said.get("type") in _TURNING

    def read(said: Mapping[str, str], settings: Settings) -> float:
        found = numbers_of(said, name, 1, 1)
        if found is None:
            return 0.0
        return radians(found[0]) if in_degrees(said, settings) else found[0]

    def write(value: tuple[float, DofKind], settings: Settings) -> dict[str, str]:
        coordinate, kind = value
        return {name: angle_text(coordinate, settings.degree and kind is not DofKind.SLIDE)}

    return Group(name, (name,), lambda said, s: (read(said, s), read_kind(said, s)), write, seen_numbers(name, 0.0), ("type",))


Span = tuple[float, float] | None


def _is_limited(said: Mapping[str, str], settings: Settings, span: str, flag: str) -> bool:
    found = numbers_of(said, span, 2, 2)
    word = said.get(flag, "auto")
    if word not in ("true", "false", "auto"):
        raise BadAttribute(flag, "true, false or auto")
    ordered = found is not None and found[0] < found[1]
    if word == "auto" and not settings.autolimits and found is not None and any(found):
        raise BadAttribute(flag, f"true or false beside {span}, since <compiler autolimits> is false")
    if word == "true" and not ordered and said.get("type") not in ("ball", "free"):
        raise BadAttribute(span, f"a lower and a greater number, since {flag} is true")
    if span == "range" and (ordered or word == "true") and found is not None and found[0] != 0.0 and said.get("type") == "ball":
        raise BadAttribute(span, "0 and the greatest angle of a ball joint")
    return ordered and (word == "true" or (word == "auto" and settings.autolimits))


def span(name: str, flag: str, *, angular: bool = False) -> Group:
    """An interval with its flag; None where it does not hold."""

    def read(said: Mapping[str, str], settings: Settings) -> tuple[Span, DofKind]:
        kind = read_kind(said, settings) if angular else DofKind.SLIDE
        if not _is_limited(said, settings, name, flag):
            return None, kind
        low, high = numbers_of(said, name, 2, 2) or (0.0, 0.0)
        if angular and settings.degree and kind is not DofKind.SLIDE:
            return (radians(low), radians(high)), kind
        return (low, high), kind

    def write(value: tuple[Span, DofKind], settings: Settings) -> dict[str, str]:
        found, kind = value
        if found is None:
            return {flag: "false"}
        degree = angular and settings.degree and kind is not DofKind.SLIDE
        said = {name: f"{angle_text(found[0], degree)} {angle_text(found[1], degree)}"}
        return said if settings.autolimits else {flag: "true", **said}

    def seen(said: Mapping[str, str], settings: Settings) -> Any:
        found, word = read_numbers(said.get(name, "0 0")) or (0.0, 0.0), said.get(flag, "auto")
        return found, word == "true" or (word == "auto" and settings.autolimits and found[0] < found[-1])

    def repeats(value: tuple[Span, DofKind], said: Mapping[str, str], settings: Settings) -> bool:
        return value[0] is not None and flag not in said and settings.autolimits and not (angular and settings.degree)

    return Group(name, (name, flag), read, write, seen, ("type",) if angular else (), repeats=repeats)


KIND = Group(
    "type", ("type",), read_kind, lambda value, settings: {"type": _DOF_WORDS[value]}, lambda said, settings: said.get("type", "hinge")
)
AXIS = Group(
    "axis",
    ("axis",),
    _read_axis,
    _write_axis,
    lambda said, settings: read_numbers(said.get("axis", "0 0 1")),
    ("type",),
    repeats=lambda value, said, settings: "axis" in said and said.get("type") not in ("ball", "free"),
)
ANCHOR = Group(
    "pos",
    ("pos",),
    lambda said, settings: vector_of(said, "pos", ZERO),
    lambda value, settings: {"pos": numbers_text(value)},
    lambda said, settings: read_numbers(said.get("pos", "0 0 0")),
    repeats=lambda value, said, settings: "pos" in said,
)
REF = _motion("ref")
SPRING_REF = _motion("springref")

JOINT = (
    KIND,
    AXIS,
    ANCHOR,
    span("range", "limited", angular=True),
    REF,
    SPRING_REF,
    first_real("stiffness", 0.0),
    first_real("damping", 0.0),
    real("frictionloss", 0.0),
    real("armature", 0.0),
    span("actuatorfrcrange", "actuatorfrclimited"),
)


TENDON = (
    span("range", "limited"),
    first_real("stiffness", 0.0),
    first_real("damping", 0.0),
    real("frictionloss", 0.0),
    real("armature", 0.0),
    real("width"),
    reals("rgba", 4, 4),
)
