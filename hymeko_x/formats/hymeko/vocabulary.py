"""The fields of each kind of element in a few words, and the units, for editors."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko import (
    DOF_WORDS,
    LIMIT_WORDS,
    PARTS,
    SHAPE_ROLES,
    SHAPE_WORDS,
    SOLIDS,
)
from hymeko_x.formats.hymeko.units import BASE_UNITS, unit_exponents, unit_factor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.formats.hymeko import FieldWord

_SI = ("m", "kg", "s", "rad")
_FORMS = {"vec3": "[x y z]", "rgba": "[r g b] or [r g b a]", "flag": "true or false", "pixels": "[width height]"}
_LENGTHS = {"box": "[x y z]", "sphere": "r", "ellipsoid": "[x y z]", "cylinder": "[r l]", "capsule": "[r l]", "plane": "[x y]"}
_BODY = {
    "mass": "number, dimension mass",
    "com": "[x y z], dimension length: the centre of mass in the body",
    "inertia": "[xx yy zz] or [xx yy zz xy xz yz] in kg m^2, about the centre of mass",
    "axes": "[roll pitch yaw] or [w x y z]: the axes in which the inertia is given",
    **dict.fromkeys(SHAPE_ROLES.values(), "a shape: to see, to collide with, or for both"),
}
_JOINT = {
    "axis": "[x y z], or a direction: axis=Y, axis=-Z; z by default",
    "limit": "[lower upper], an angle or a length",
    "mimic": "mimic - leader: follows another joint",
    "dof": "a degree of freedom of a compound joint",
}
_SHAPE = {
    **{name: f"{_LENGTHS[name]}, dimension length" for name in SOLIDS},
    "mesh": "a file, or mesh=name",
    "scale": "a number or [x y z]",
    "at": "a pose: [x y z] or [[x y z] [roll pitch yaw]]",
    "material": "material=name",
    "color": "[r g b] or [r g b a]",
}


@cache
def fields_of(kind: str) -> Mapping[str, str]:
    """The fields of elements of this kind, with the form and the dimension of each; none of a kind that is not there."""
    if kind == "body":
        return _BODY
    if kind == "joint":
        return {**_JOINT, **_described((*LIMIT_WORDS, *DOF_WORDS))}
    if kind == "shape":
        return {**_SHAPE, **_described(SHAPE_WORDS)}
    return _described(PARTS[kind].words) if kind in PARTS else {}


def units() -> tuple[str, ...]:
    """The units with a name of their own."""
    return tuple(unit for names in BASE_UNITS.values() for unit in names)


def si_of(unit: str) -> tuple[float, str] | None:
    """The factor of a unit to SI, and that unit; None of what is no unit."""
    factor = unit_factor(unit)
    if factor is None:
        return None
    exponents = unit_exponents(unit) or (0, 0, 0, 0)
    parts = [name if power == 1 else f"{name}^{power}" for name, power in zip(_SI, exponents, strict=True) if power]
    return factor, "*".join(parts)


def _described(words: tuple[FieldWord, ...]) -> dict[str, str]:
    return {word.word: _description(word) for word in words}


def _description(word: FieldWord) -> str:
    dimension = {"": "", "motion": ", an angle or a length"}.get(word.dimension, f", dimension {word.dimension}")
    return f"{_FORMS.get(word.form, word.form)}{dimension}"
