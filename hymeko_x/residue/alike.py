"""Whether something is still what it was, for programs that save a file: they round its numbers, and may name its elements otherwise."""

from __future__ import annotations

import re
import struct
from typing import TYPE_CHECKING

from msgspec import NODEFAULT
from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.ir.digits import are_numbers
from hymeko_x.ir.fields import NUMBERS, layout_of
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import pose_weight
from hymeko_x.ir.parts import Role, Shape
from hymeko_x.ir.values import IDENTITY, Pose

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable

    from hymeko_x.ir.mechanism import Extra, RobotArc, RobotEdge

_UPWARD = re.compile(r"^(?:\.\.?/)+")
_FEWEST_DIGITS = 6
"""To how many digits MuJoCo rounds what it saves; other programs keep more."""
_ROUNDED = 6e-6
"""By how much rounding changes a number at most, as a part of it."""
_COMPUTED = 1e-10
"""By how much a number differs at most, as a part of it, that was computed again from others."""
_TURNED = 1e-5
"""The same for a quaternion: of three angles that are rounded, each turns it by half of its error."""
URI = "uri"
"""The field of a mesh or an image that names its file."""
_NOISE = 1e-12
"""In m, and of a direction: less than this is left of zero where poses are composed and taken apart again."""
_WHOLES = frozenset({4, 6})
"""Lengths of quaternions and tensors, which programs compute anew from axes and angles: only their largest number counts."""


def is_alike(now: object, then: object) -> bool:
    """Whether a value is what it was but for rounding, notations and names; a part with its fields, an edge with its arcs."""
    if now is then:
        return True
    if isinstance(then, tuple):
        return isinstance(now, tuple) and len(now) == len(then) and _are_alike(now, then)
    if isinstance(then, NUMBERS) and isinstance(now, NUMBERS):
        return is_rounded(float(now), float(then))
    if isinstance(then, Edge) and isinstance(now, Edge):
        then = _without_lost_colour(now, then)
        return len(now.arcs) == len(then.arcs) and is_alike(now.data, then.data) and all(map(_is_alike_arc, now.arcs, then.arcs))
    layout = layout_of(type(then))
    if layout is None or type(now) is not type(then):
        return now == then
    pairs = zip(layout.counting, layout.compared(now), layout.compared(then), strict=True)
    return all(item.name == "name" or (is_moved(a, b) if item.name == URI else is_alike(a, b)) for item, a, b in pairs)


def is_moved(now: object, then: object) -> bool:
    """Whether a file is the one that it was, perhaps seen from another folder: one path without ``../`` is the end of the other."""
    if not isinstance(now, str) or not isinstance(then, str):
        return now == then
    a, b = (f"/{_UPWARD.sub('', path)}" for path in (now, then))
    return a.endswith(b) or b.endswith(a)


def _without_lost_colour(now: Edge, then: Edge) -> Edge:  # type: ignore[type-arg]
    """What an edge was; without the colour of a shape for collision alone that has none now: urdfdom drops it, and nothing shows it."""
    if not (isinstance(now.data, Shape) and isinstance(then.data, Shape) and now.data.role is then.data.role is Role.COLLISION):
        return then
    if now.data.rgba is not None or any(arc.role == "material" for arc in now.arcs):
        return then
    return without_colour(then)


def without_colour(edge: RobotEdge) -> RobotEdge:
    """A shape without its colour and its material; any other edge as it is."""
    if not isinstance(edge.data, Shape):
        return edge
    return Edge(replace(edge.data, rgba=None), tuple([arc for arc in edge.arcs if arc.role != "material"]))


def without_surface(edge: RobotEdge) -> RobotEdge:
    """A shape without what weighs nothing: its colour, material and friction; any other edge as it is."""
    plain = without_colour(edge)
    return Edge(replace(plain.data, friction=()), plain.arcs) if isinstance(plain.data, Shape) else plain


def _is_alike_arc(now: RobotArc, then: RobotArc) -> bool:
    if (now.sign, now.target.kind, bool(now.role)) != (then.sign, then.target.kind, bool(then.role)):
        return False
    if isinstance(now.weight, Pose) or isinstance(then.weight, Pose):
        return is_alike(pose_weight(now), pose_weight(then))
    return is_alike(now.weight, then.weight)


def _are_alike(now: tuple[object, ...], then: tuple[object, ...]) -> bool:
    if now == then:
        return True
    if len(then) in _WHOLES and are_numbers(now) and are_numbers(then):
        room = (_TURNED if len(then) == len(IDENTITY.quat) else _ROUNDED) * max(map(abs, then))  # type: ignore[arg-type]
        return any(all(abs(sign * a - b) <= room for a, b in zip(now, then, strict=True)) for sign in _signs(then))  # type: ignore[operator]
    if len(then) == len(IDENTITY.xyz) and are_numbers(now) and are_numbers(then):
        return all(is_rounded(a, b) or abs(a - b) <= _NOISE for a, b in zip(now, then, strict=True))  # type: ignore[arg-type, operator]
    return all(map(is_alike, now, then))


def _signs(numbers: tuple[object, ...]) -> Iterable[float]:
    """A quaternion and its opposite are the same rotation."""
    return (1.0, -1.0) if len(numbers) == 4 else (1.0,)


def is_rounded(now: float, then: float) -> bool:
    """Whether a number is another one, or that one computed again or rounded: to six or more digits, or to single precision."""
    if now == then or (now != now and then != then):
        return True
    if not abs(now - then) <= _ROUNDED * abs(then):
        return False
    if abs(now - then) <= _COMPUTED * abs(then):
        return True
    return any(now == float(f"{then:.{digits}g}") for digits in range(_FEWEST_DIGITS, 17)) or now == _single(then)


def _single(number: float) -> float:
    try:
        found: float = struct.unpack("f", struct.pack("f", number))[0]
    except OverflowError:
        return number
    return found


def holds(now: object, then: object, default: object) -> bool:
    """The same for a field; ``then`` is NODEFAULT where it had its default."""
    return is_alike(now, default if then is NODEFAULT else then)


def without_inherited(extra: Extra) -> Hashable:
    """An extra without what elements inherit from it and have in a field, where an edit would be seen."""
    inherited = next((row.inherited for row in formats.FORMATS if row.name == extra.format), None)
    text = extra.text if inherited is None or extra.path else formats.loaded(inherited)(extra.text)
    return extra.format, extra.path, text
