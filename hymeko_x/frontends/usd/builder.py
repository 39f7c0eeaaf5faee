"""The mechanism while a stage is read, and which properties of each prim have been read: the unread ones become extras."""

from __future__ import annotations

import math
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import field

from hymeko_x import codes
from hymeko_x.diagnostics import Origin
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import single
from hymeko_x.formats.usd.joints import AXES
from hymeko_x.frontends.usd.places import line_of, lines_of_prims
from hymeko_x.frontends.usd.transforms import Transforms, numbers_of
from hymeko_x.ir.builder import Builder

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Code, Report
    from hymeko_x.frontends.usd.places import Lines
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.frontends.usd.stage import OpenStage
    from hymeko_x.frontends.usd.transforms import Transform
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.source import Source

_SINGLE = frozenset(("float", "float2", "float3", "float4", "point3f", "vector3f", "normal3f", "color3f", "color4f", "quatf", "half"))

_SIZES = MappingProxyType(
    {
        **dict.fromkeys(("physics:localPos0", "physics:localPos1", "physics:centerOfMass", "physics:diagonalInertia", "inputs:color"), 3),
        **dict.fromkeys(("physics:localRot0", "physics:localRot1", "physics:principalAxes"), 4),
    }
)
"""How many numbers the values have that are unpacked: a file may give a property another type than its schema."""

ORIGINAL_NAME = "cyberwave:name"
"""The attribute in which cyberwave-robot-format keeps a name that is no legal name of a prim."""


class UsdBuilder(Builder, dict=True):
    """A robot of a stage so far.

    ``bodies`` and ``elements`` lead from a prim's path to its body and to all elements that were read from it; ``taken`` holds,
    by prim path, the names of properties that are typed now, with ``apiSchemas`` entries as ``@Name`` and the type as ``@type``.
    """

    source: Source
    report: Report
    scene: OpenStage
    bodies: dict[str, Id] = field(default_factory=dict)
    elements: dict[str, list[Id]] = field(default_factory=dict)
    read_names: dict[str, set[str]] = field(default_factory=dict)
    meshes: dict[str, Id] = field(default_factory=dict)
    materials: dict[str, Id] = field(default_factory=dict)

    @cached_property
    def transforms(self) -> Transforms:
        """The transforms of the prims in the scene."""
        return Transforms(self.scene)

    def prim_at(self, path: str) -> Prim:
        """The prim at a path that something was read from."""
        return self.scene.prims[path]

    @property
    def origin(self) -> Origin:
        """The file."""
        return Origin(self.source.name)

    @cached_property
    def _lines(self) -> Lines:
        return lines_of_prims(self.source.data)

    def origin_of(self, prim: Prim) -> Origin:
        """The file and, where it is text, the line of a prim."""
        return Origin(self.source.name, line_of(prim.path, self._lines))

    def warn(self, prim: Prim, code: Code, message: str) -> None:
        """Report a warning about a prim."""
        self.report.warn(code, message, self.origin_of(prim), element=prim.path)

    def error(self, prim: Prim, code: Code, message: str) -> None:
        """Report an error about a prim."""
        self.report.error(code, message, self.origin_of(prim), element=prim.path)

    def refuse_value(self, prim: Prim, name: str, value: object, what: str) -> None:
        """Report an error about the value of an attribute, which is not used."""
        self.error(prim, codes.BAD_NUMBER, f"'{name}' is {value}, which is no {what}; it is not used")

    def check_transform(self, prim: Prim, transform: Transform) -> None:
        """Report what a pose and a scale cannot represent of the transform of a prim."""
        if transform.flaw:
            self.warn(prim, codes.NOT_REPRESENTED, f"{prim.path} {transform.flaw}")

    def new_id(self, prim: Prim, kind: str, fallback: str | None = None) -> Id:
        """A fresh id for the element that a prim represents, after the name that it has."""
        key = self.fresh(kind, self._name(prim, fallback), self.origin_of(prim))
        path = prim.path
        self.elements.setdefault(path, []).append(key)
        if fallback is None:
            self.note(key, words.PATH, (path,))
        return key

    def _name(self, prim: Prim, fallback: str | None) -> str:
        if fallback is not None:
            return fallback
        own = prim.value(ORIGINAL_NAME)
        if isinstance(own, str) and own:
            self.mark_read(prim, ORIGINAL_NAME)
            return own
        return prim.display_name or prim.name

    def part_name(self, prim: Prim) -> str:
        """The name that a part keeps by itself, whatever its id is: the display name of the prim."""
        self.mark_read(prim, "displayName")
        return prim.display_name or prim.name

    def mark_read(self, prim: Prim, *names: str) -> None:
        """These properties, ``@Api`` schemas or the ``@type`` of a prim are typed now."""
        self.read_names.setdefault(prim.path, set()).update(names)

    def get(self, prim: Prim, name: str) -> Any:
        """An authored value, single precision as the shortest decimal; None without one. The property counts as read.

        A value that changes with time stays an extra as well.
        """
        if name not in prim.types:
            return None
        value = prim.value(name)
        if value is None:
            value = prim.earliest(name)
        if value is None:
            return None
        kind = prim.types[name]
        read = _numbers(value, kind) if name in _SIZES else _rounded(value, kind)
        if name in _SIZES and (read is None or len(read) != _SIZES[name]):
            has = "is no row of numbers" if read is None else f"has {len(read)} numbers"
            self.error(prim, codes.BAD_VALUE, f"'{name}' {has} and takes {_SIZES[name]}; it is not used")
            return None
        if _has_no_number(read):
            self.refuse_value(prim, name, value, "number")
            return None
        if not prim.is_animated(name):
            self.mark_read(prim, name)
        return read

    def axis(self, prim: Prim, name: str, default: str) -> str:
        """An authored axis: X, Y or Z. Any other word is reported and stays an extra, and the axis is the default."""
        word = str(self.get(prim, name) or default)
        if word in AXES:
            return word
        self.read_names.get(prim.path, set()).discard(name)
        self.warn(prim, codes.UNKNOWN_WORD, f"{prim.path}: {name} is '{word}'; {default} instead")
        return default

    def number(self, prim: Prim, name: str, default: float) -> float:
        """An authored number, or the default (not a number for none). One that equals the default and is not written stays an extra."""
        if name not in prim.types:
            return default
        value = self.get(prim, name)
        is_nothing = value == 0.0 or (isinstance(value, float) and math.isinf(value))
        if is_nothing and (value == default or math.isnan(default)):
            self.read_names.get(prim.path, set()).discard(name)
        return float(value) if isinstance(value, int | float) else default


def _numbers(value: Any, kind: str) -> tuple[float, ...] | None:
    """The numbers of a vector, a quaternion or a row, whatever their precision; None for anything else."""
    try:
        numbers = [value.real, *numbers_of(value.imaginary)] if hasattr(value, "imaginary") else numbers_of(value)
    except TypeError:  # no number, and none beside another
        return None
    if not isinstance(numbers, list) or not all(isinstance(number, int | float) for number in numbers):
        return None
    return tuple(map(single if kind.removesuffix("[]") in _SINGLE else float, numbers))


def _has_no_number(value: Any) -> bool:
    """Whether a number, or one of a few, is NaN; infinite ones stand for limits and centres that are not given."""
    numbers = value if isinstance(value, tuple) else (value,)
    return any(isinstance(number, float) and math.isnan(number) for number in numbers)


def _rounded(value: Any, kind: str) -> Any:
    if kind not in _SINGLE:
        return value
    if isinstance(value, float):
        return single(value)
    return _numbers(value, kind)
