"""What the attributes of MJCF joints and tendons mean."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.formats.mjcf.codec import (
    AttributeGroup,
    BadAttribute,
    Settings,
    angle_text,
    angles_text,
    first_real,
    numbers_of,
    radians,
    real,
    reals,
    seen_numbers,
    vector_of,
)
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.parts import (
    DofKind,
)
from hymeko_x.ir.values import ZERO, Written, Z, unit
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.values import Vec3

# ---- joints ------------------------------------------------------------------------------------------------------------------

DOF_KINDS = {"hinge": DofKind.HINGE, "slide": DofKind.SLIDE, "ball": DofKind.BALL, "free": DofKind.FREE}
_DOF_WORDS = {kind: word for word, kind in DOF_KINDS.items()}
_TYPE = frozenset(("type",))
_TURNING = (None, "hinge", "ball")


def read_kind(attributes: Mapping[str, str], settings: Settings) -> DofKind:
    """The kind of dof of a <joint>. Raises: BadAttribute for an unknown type."""
    word = attributes.get("type", "hinge")
    if word not in DOF_KINDS:
        raise BadAttribute("type", f"one of {', '.join(DOF_KINDS)}")
    return DOF_KINDS[word]


def _read_axis(attributes: Mapping[str, str], settings: Settings) -> tuple[Vec3, Written | None]:
    if attributes.get("type") in ("ball", "free"):
        return Z, None
    raw = vector_of(attributes, "axis", Z)
    try:
        axis = unit(raw)
    except ZeroDivisionError as error:
        raise BadAttribute("axis", "a direction") from error
    return axis, None if axis == raw else Written("axis", raw)


def _write_axis(value: tuple[Vec3, Written | None], settings: Settings) -> dict[str, str]:
    axis, written = value
    return {"axis": numbers_text(written.numbers if written and written.kind == "axis" else axis)}


def _motion(name: str) -> AttributeGroup:
    """A coordinate of a joint: an angle in the unit of the file, or a length."""

    def in_degrees(attributes: Mapping[str, str], settings: Settings) -> bool:
        return settings.degree and attributes.get("type") in _TURNING

    def read(attributes: Mapping[str, str], settings: Settings) -> float:
        found = numbers_of(attributes, name, 1, 1)
        if found is None:
            return 0.0
        return radians(found[0]) if in_degrees(attributes, settings) else found[0]

    def write(value: tuple[float, DofKind], settings: Settings) -> dict[str, str]:
        coordinate, kind = value
        return {name: angle_text(coordinate, settings.degree and kind is not DofKind.SLIDE)}

    def read_both(attributes: Mapping[str, str], settings: Settings) -> tuple[float, DofKind]:
        return read(attributes, settings), read_kind(attributes, settings)

    return AttributeGroup(name, (name,), read_both, write, seen_numbers(name, 0.0), _TYPE)


Span = tuple[float, float] | None


def _is_limited(attributes: Mapping[str, str], settings: Settings, span: str, flag: str) -> bool:
    found = numbers_of(attributes, span, 2, 2)
    word = attributes.get(flag, "auto")
    if word not in ("true", "false", "auto"):
        raise BadAttribute(flag, "true, false or auto")
    ordered = found is not None and found[0] < found[1]
    if word == "auto" and not settings.autolimits and found is not None and any(found):
        raise BadAttribute(flag, f"true or false beside {span}, since <compiler autolimits> is false")
    if word == "true" and not ordered and attributes.get("type") not in ("ball", "free"):
        raise BadAttribute(span, f"a lower and a greater number, since {flag} is true")
    if span == "range" and (ordered or word == "true") and found is not None and found[0] != 0.0 and attributes.get("type") == "ball":
        raise BadAttribute(span, "0 and the greatest angle of a ball joint")
    return ordered and (word == "true" or (word == "auto" and settings.autolimits))


def span(name: str, flag: str, *, angular: bool = False) -> AttributeGroup:
    """An interval with its flag; None where it does not hold."""

    def read(attributes: Mapping[str, str], settings: Settings) -> tuple[Span, DofKind]:
        kind = read_kind(attributes, settings) if angular else DofKind.SLIDE
        if not _is_limited(attributes, settings, name, flag):
            return None, kind
        low, high = numbers_of(attributes, name, 2, 2) or (0.0, 0.0)
        if angular and settings.degree and kind is not DofKind.SLIDE:
            return (radians(low), radians(high)), kind
        return (low, high), kind

    def write(value: tuple[Span, DofKind], settings: Settings) -> dict[str, str]:
        found, kind = value
        if found is None:
            return {flag: "false"}
        degree = angular and settings.degree and kind is not DofKind.SLIDE
        attributes = {name: angles_text(found, degree)}
        return attributes if settings.autolimits else {flag: "true", **attributes}

    def seen(attributes: Mapping[str, str], settings: Settings) -> Any:
        found, word = read_numbers(attributes.get(name, "0 0")) or (0.0, 0.0), attributes.get(flag, "auto")
        return found, word == "true" or (word == "auto" and settings.autolimits and found[0] < found[-1])

    return AttributeGroup(name, (name, flag), read, write, seen, _TYPE if angular else frozenset())


KIND = AttributeGroup(
    "type",
    ("type",),
    read_kind,
    lambda value, settings: {"type": _DOF_WORDS[value]},
    lambda attributes, settings: attributes.get("type", "hinge"),
)
AXIS = AttributeGroup(
    "axis",
    ("axis",),
    _read_axis,
    _write_axis,
    lambda attributes, settings: read_numbers(attributes.get("axis", "0 0 1")),
    _TYPE,
)
ANCHOR = AttributeGroup(
    "pos",
    ("pos",),
    lambda attributes, settings: vector_of(attributes, "pos", ZERO),
    lambda value, settings: {"pos": numbers_text(value)},
    lambda attributes, settings: read_numbers(attributes.get("pos", "0 0 0")),
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
    first_real("stiffness"),
    first_real("damping"),
    real("frictionloss", 0.0),
    real("armature", 0.0),
    span("actuatorfrcrange", "actuatorfrclimited"),
)


TENDON = (
    span("range", "limited"),
    first_real("stiffness"),
    first_real("damping"),
    real("frictionloss", 0.0),
    real("armature", 0.0),
    real("width"),
    reals("rgba", 4, 4),
)
