"""How authors wrote MJCF, where several ways mean the same."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.ir.digits import number_text
from hymeko_x.ir.notations import Notation, flag, word


@cache
def attribute(name: str, prefix: str = "") -> Notation[str]:
    """An attribute, verbatim, where printing its value would not give it again; ``prefix`` is that of a dof or of ``inertial/``."""
    return word(f"{prefix}@{name}")


@cache
def frame_of(prefix: str = "") -> Notation[str]:
    """The number of the <frame> that an element is in; ``prefix`` as of :func:`attribute`."""
    return word(f"{prefix}frame")


class MjcfFrame(NamedTuple):
    """A <frame> in a body: the number of the one around it (0 = none), and its attributes."""

    outer: str
    attributes: dict[str, str]


def _frame_text(frame: MjcfFrame) -> str:
    return " ".join([frame.outer, *(f'{name}="{value}"' for name, value in frame.attributes.items())])


def _frame(text: str) -> MjcfFrame:
    outer, _, rest = text.partition(" ")
    return MjcfFrame(outer, parse_text(f"<frame {rest}/>").attributes)


def frame(number: int) -> Notation[MjcfFrame]:
    """The <frame> of this number in a body, counted from 1."""
    return Notation(f"frame{number}", _frame_text, _frame)


@cache
def is_joint(prefix: str) -> Notation[str]:
    """The tag of a free dof that is a <joint> instead of a <freejoint>."""
    return word(f"{prefix}tag")


CHILDCLASS = word("childclass")
"""Body: the default class of the elements in it."""
LAYERS = flag("layers", "yes")
"""Material: its only texture is in a <layer>."""
GRID = Notation("grid", number_text, float)
"""Plane: the distance in m of the lines that are drawn on it."""
