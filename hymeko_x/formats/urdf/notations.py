"""How authors wrote URDF, where several ways mean the same."""

from __future__ import annotations

import re
from enum import Enum
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x.ir.notations import Notation, choice, flag, word, words

if TYPE_CHECKING:
    from collections.abc import Mapping


class Defined(Enum):
    """Where a named material's colour and texture stand."""

    ROBOT = "robot"
    INLINE = "inline"
    FIRST = "first"
    BOTH = "both"


class Reduction(Enum):
    """Which element of a simple transmission has its mechanical reduction."""

    ACTUATOR = "actuator"
    JOINT = "joint"
    TRANSMISSION = "transmission"


class TypeAs(Enum):
    """Whether a transmission's type is a child (ROS 1) or an attribute (PR2)."""

    CHILD = "child"
    ATTRIBUTE = "attribute"


TYPE = word("urdf.type")
"""Joint: its type where another one would be written by default."""
DEFINED = choice("urdf.defined", Defined)
"""Material: where it is defined, if not where most are."""
REDUCTION = choice("urdf.reduction", Reduction)
"""Drive: where its reduction is, if not where most are."""
TYPE_AS = choice("urdf.type-as", TypeAs)
"""Drive: how its type is written, if not as most are."""

VIRTUAL = flag("urdf.virtual", "yes")
"""Joint: it lets the base float, and stands in the SRDF as a virtual joint, not in the URDF."""

USUAL: Mapping[Notation[Any], Enum] = MappingProxyType(
    {DEFINED: Defined.ROBOT, REDUCTION: Reduction.ACTUATOR, TYPE_AS: TypeAs.CHILD},
)
"""The choices that most elements of a file make alike, with the usual one of files in general."""


CAPSULE, VERSION = "capsule", "version"
"""Habits of a file: it has <capsule>; its <robot> has version="1.0"."""
DYNAMICS, SCALE, NO_AXIS = "dynamics", "scale", "no-axis"
"""Habits of joints and shapes: zeros and ones are written; the axis x is left out."""


@cache
def origin_habits(tag: str) -> tuple[str, str, str]:
    """The habits of <origin> in such an element: it is written where it is the identity; its zero xyz, or rpy, is left out."""
    return tag, f"no-{tag}-xyz", f"no-{tag}-rpy"


def without(attribute: str) -> str:
    """The habit of leaving out an attribute with its default value."""
    return f"no-{attribute}"


class Style(Struct, frozen=True):
    """What holds for a whole file: its habits with default values, and its usual choices where they are not those of :data:`USUAL`.

    A habit is what most elements with a default value do, where it is not what the writer does for new ones.
    """

    habits: frozenset[str] = frozenset()
    usual: tuple[tuple[str, str], ...] = ()


def _style_text(style: Style) -> str:
    return " ".join(sorted([*style.habits, *(f"{name}={value}" for name, value in style.usual)]))


def _style(text: str) -> Style:
    items = text.split()
    usual = [item.partition("=")[::2] for item in items if "=" in item]
    return Style(frozenset(item for item in items if "=" not in item), tuple(usual))


STYLE = Notation("urdf.style", _style_text, _style)
"""Mechanism: the style of the file."""
OTHERWISE = words("urdf.otherwise")
"""Body, joint, shape: the habits in which it differs from its file."""

_ELEMENT = re.compile(r"<([\w:.-]+)[^>]*/>")
FIXED = Notation[tuple[tuple[str, str], ...]](
    "urdf.fixed",
    lambda elements: "".join(text for _, text in elements),
    lambda text: tuple((found[1], found[0]) for found in _ELEMENT.finditer(text)),
)
"""Mechanism: tag and text of the meaningless elements that most fixed joints have."""
