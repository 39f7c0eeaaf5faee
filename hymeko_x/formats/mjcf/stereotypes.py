"""What the default classes of a file give to their elements, in the words of HyMeKo text: a default class is a stereotype there.

Only what a field of the text holds; all else, such as the group of a geom, stays an attribute of the class. A field that is
left out here costs letters and nothing more, because the text then gives it with each element.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.mjcf import MAIN
from hymeko_x.formats.mjcf.classes import ACTUATORS, TURNS, Classes
from hymeko_x.formats.mjcf.codec import parameter_value
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.formats.mjcf.words import LAW, RESOLVED

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from hymeko_x.xml.tree import XmlNode

Value = float | str | tuple["Value", ...]
Given = tuple[str, Value, str]
Fields = tuple[Given, ...]
"""Words of the text, with their values and the units of those, in order; no unit for numbers that have none."""

_PASSIVE = {"damping": "damping", "frictionloss": "friction", "stiffness": "stiffness", "armature": "armature"}
_BETWEEN = frozenset({"capsule", "cylinder"})
_SIZED: Mapping[str, int] = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


def fields_of_classes(texts: Iterable[str]) -> dict[str, dict[str, Fields]]:
    """By class and by kind of element what the class gives.

    Kinds: joint, prismatic, ball, shape, frame, mesh, material, and each type of actuator.

    ``texts``: the <compiler> and <default> elements.
    """
    elements = parse_text(f"<mujoco>{''.join(texts)}</mujoco>").children
    compilers = [element for element in elements if element.tag == "compiler"]
    angle = "deg" if _setting(compilers, "angle", "degree") == "degree" else "rad"
    is_limited = _setting(compilers, "autolimits", "true") == "true"
    classes = Classes(element for element in elements if element.tag == "default")
    return {name: _given(classes, name, angle=angle, is_limited=is_limited) for name in classes.names}


def _setting(compilers: list[XmlNode], name: str, otherwise: str) -> str:
    return next((element.attributes[name] for element in reversed(compilers) if name in element.attributes), otherwise)


def _given(classes: Classes, name: str, *, angle: str, is_limited: bool) -> dict[str, Fields]:
    own = None if name == MAIN else name
    joint = classes.of("joint", own)
    found: dict[str, Fields] = {kind: _joint(joint, unit, is_limited=is_limited) for kind, unit in (("joint", angle), ("prismatic", "m"))}
    found["ball"] = _passive(joint)
    found |= {kind: read(classes.of(tag, own)) for kind, tag, read in _KINDS}
    found |= {_TYPES.get(tag, f"actuator.{tag}"): _actuator(classes.of(tag, own)) for tag in sorted(ACTUATORS)}
    return {kind: fields for kind, fields in found.items() if fields}


def _joint(given: Mapping[str, str], unit: str, *, is_limited: bool) -> Fields:
    fields: list[Given] = []
    axis = _numbers(given, "axis", 3)
    if axis is not None and axis != (0.0, 0.0, 1.0):
        fields.append(("axis", axis, ""))
    span = _numbers(given, "range", 2)
    limited = given.get("limited", "auto")
    if span is not None and (limited == "true" or (limited == "auto" and is_limited)):
        fields.append(("limit", span, unit))
    return (*fields, *_passive(given))


def _passive(given: Mapping[str, str]) -> Fields:
    """What a joint of any type has."""
    return tuple((word, number[0], "") for name, word in _PASSIVE.items() if (number := _numbers(given, name, 1)) and number[0])


def _shape(given: Mapping[str, str]) -> Fields:
    kind = given.get("type", "sphere")
    fields = _solid(kind, given)
    between = _numbers(given, "fromto", 6)
    if between is not None:
        fields.append(("fromto", between, "m"))
    elif (place := _place(given)) is not None:
        fields.append(("at", place, "m"))
    if "material" in given:
        fields.append(("material", given["material"], ""))
    colour = _numbers(given, "rgba", 4)
    if colour is not None:
        fields.append(("rgba", colour[:3] if colour[3] == 1.0 else colour, ""))
    fields.extend((word, number[0], unit) for word, unit in (("mass", "kg"), ("density", "")) if (number := _numbers(given, word, 1)))
    friction = _numbers(given, "friction")
    if friction is not None:
        fields.append(("friction", friction if len(friction) > 1 else friction[0], ""))
    return tuple(fields)


def _solid(kind: str, given: Mapping[str, str]) -> list[Given]:
    """The geometry: full sizes and lengths, where MJCF has half of them."""
    size = _numbers(given, "size")
    if size is None or kind not in _SIZED:
        return []
    if kind in _BETWEEN and ("fromto" in given or len(size) == 1):
        return [(kind, size[0], "m")]
    if len(size) < _SIZED[kind]:
        return []
    match kind:
        case "sphere":
            return [(kind, size[0], "m")]
        case "capsule" | "cylinder":
            return [(kind, (size[0], 2.0 * size[1]), "m")]
        case _:
            return [(kind, tuple(2.0 * number for number in size[:3]), "m")]


def _place(given: Mapping[str, str]) -> Value | None:
    at = _numbers(given, "pos", 3) or (0.0, 0.0, 0.0)
    if any(turn in given for turn in TURNS if turn != "quat"):
        return None
    turn = _numbers(given, "quat", 4)
    if turn is not None:
        return (at, turn)
    return at if any(at) else None


def _frame(given: Mapping[str, str]) -> Fields:
    size = _numbers(given, "size")
    return () if size is None else (("size", size if len(size) > 1 else size[0], "m"),)


def _material(given: Mapping[str, str]) -> Fields:
    fields = [(name, number[0], "") for name in ("specular", "shininess", "reflectance") if (number := _numbers(given, name, 1))]
    colour = _numbers(given, "rgba", 4)
    rgba: list[Given] = [] if colour is None else [("rgba", colour[:3] if colour[3] == 1.0 else colour, "")]
    return (*rgba, *fields)


def _mesh(given: Mapping[str, str]) -> Fields:
    scale = _numbers(given, "scale", 3)
    return () if scale is None else (("scale", scale, ""),)


def _actuator(given: Mapping[str, str]) -> Fields:
    """The parameters that an actuator has even where its class gives them."""
    return tuple((name, parameter_value(name, given[name]), "") for name in (*RESOLVED, *LAW) if name in given)


_TYPES = {"motor": "motor", "position": "servo"}
_KINDS: tuple[tuple[str, str, Callable[[Mapping[str, str]], Fields]], ...] = (
    ("shape", "geom", _shape),
    ("frame", "site", _frame),
    ("material", "material", _material),
    ("mesh", "mesh", _mesh),
)


def _numbers(given: Mapping[str, str], name: str, count: int | None = None) -> tuple[float, ...] | None:
    """The numbers of an attribute; None where there is none, or another number of them."""
    try:
        numbers = tuple(map(float, given[name].split())) if name in given else ()
    except ValueError:
        return None
    return numbers if numbers and count in (None, len(numbers)) else None
