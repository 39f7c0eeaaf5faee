"""Digests of values and of whole elements. Those of elements do not depend on names, so that a renamed element is found again."""

from __future__ import annotations

from enum import Enum
from functools import lru_cache
from hashlib import blake2b
from typing import TYPE_CHECKING

from msgspec import NODEFAULT

from hymeko_x import formats
from hymeko_x.ir.fields import NUMBERS, layout_of
from hymeko_x.ir.parts import Body, Joint, Shape
from hymeko_x.ir.values import Pose, are_numbers, shortest_texts

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import Extra, Id, Mechanism, RobotEdge

_LONG = 64
"""Tuples with more items are points and faces of meshes: plain numbers, and many."""


# ---- values ------------------------------------------------------------------------------------------------------------


def guard_of(value: object, default: object = NODEFAULT) -> str:
    """The digest of a value; empty for the default, which a field has in a format that cannot represent it."""
    return "" if default is not NODEFAULT and value == default else digest(value)


_DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"
_LETTERS = _DIGITS[10:]
_PAIRS = tuple(second + first for first in _DIGITS for second in _DIGITS)
"""The texts of the numbers below 36 * 36, lowest digit first."""
_HASH = blake2b(digest_size=5)
"""To be copied, which is quicker than making one."""


def digest(*values: object) -> str:
    """Six letters and digits, the first a letter, that tell one value from another. Notations do not count."""
    return digest_of_texts(map(canonical, values))


def digest_of_texts(texts: Iterable[str]) -> str:
    """The digest of values whose canonical texts these are."""
    hashed = _HASH.copy()
    hashed.update("\0".join(texts).encode("utf-8", "surrogatepass"))
    number, letter = divmod(int.from_bytes(hashed.digest()), 26)
    number, first = divmod(number, 1296)
    third, second = divmod(number, 1296)
    return f"{_LETTERS[letter]}{_PAIRS[first]}{_PAIRS[second]}{_PAIRS[third % 1296]}"


def canonical(value: object) -> str:
    """A text that is equal exactly for equal values; notations do not count, nor does the sign of zero."""
    kind = type(value)
    if kind is float:
        return repr(value) if value else "0.0"
    if isinstance(value, tuple):
        if len(value) > _LONG and isinstance(value[0], NUMBERS):
            return _array(value)
        return f"({_numbers(value) if are_numbers(value) else _joined(value)})"
    if kind is Pose:
        return f"Pose(({_numbers(value.xyz)}),({_numbers(value.quat)}))"  # type: ignore[attr-defined]
    layout = layout_of(kind)
    if layout is not None:
        return f"{kind.__name__}({_joined(layout.compared(value))})"
    if kind is str:
        return repr(value)
    if isinstance(value, Enum):
        return str(value._value_)
    if isinstance(value, bool) or value is None:
        return str(value)
    if isinstance(value, float | int):
        return repr(float(value) + 0.0)
    return repr(value)


def canonical_without_name(part: object) -> str:
    """The same for a part that goes by no name."""
    layout = layout_of(type(part))
    assert layout is not None
    values = [None if item.name == "name" else value for item, value in zip(layout.counting, layout.compared(part), strict=True)]
    return f"{type(part).__name__}({_joined(values)})"


@lru_cache(1024)
def _numbers(values: tuple[float, ...]) -> str:
    """The same for numbers and nothing else, of which axes and places without a distance or a turn come again and again."""
    text = shortest_texts(values)
    return f"{text},".replace("-0.0,", "0.0,")[:-1] if "-0.0" in text else text


def _joined(values: Iterable[object]) -> str:
    """Most are numbers, of which most are zero, or nothing."""
    return ",".join(
        [(repr(value) if value else "0.0") if type(value) is float else "None" if value is None else canonical(value) for value in values]
    )


def _array(numbers: tuple[float, ...]) -> str:
    """Many numbers at once; adding zero makes its two signs one."""
    import numpy as np

    return blake2b((np.fromiter(numbers, np.float64, len(numbers)) + 0.0).tobytes(), digest_size=16).hexdigest()


# ---- elements ---------------------------------------------------------------------------------------------------------

_SIGNS = {1: "1.0", -1: "-1.0", 0: "0.0"}


def digest_of(mechanism: Mechanism, key: Id) -> str:
    """The digest of an element with what it is on, or of a body with what is on it."""
    return Digests(mechanism).of(key)


def mass_digest(mechanism: Mechanism, body: Id) -> str:
    """The digest of everything that a body's mass may follow from."""
    return Digests(mechanism).of_weight(body)


class Digests:
    """The digests of the elements of a mechanism; what several of them are made from is put into words once.

    ``alike`` are those of a mechanism that shares most of its parts with this one and lives as long.
    """

    def __init__(self, mechanism: Mechanism, alike: Digests | None = None) -> None:
        self._mechanism = mechanism
        self._texts: dict[int, str] = {} if alike is None else alike._texts

    def of(self, key: Id) -> str:
        """The digest of an element with what it is on, or of a body with what is on it."""
        edge = self._mechanism.graph.edges.get(key)
        if edge is not None:
            return digest_of_texts(self._edge(edge))
        part = self._mechanism.graph.vertices[key]
        if not isinstance(part, Body):
            return digest_of_texts([self.nameless(part)])
        above = self._mechanism.parent_joint.get(key)
        joint = () if above is None else (self.nameless(above.joint), self.text(above.parent_pose), self.text(above.child_pose))
        return digest_of_texts([self.text(part), *joint, *self.shapes(key)])

    def of_weight(self, body: Id) -> str:
        """The digest of everything that a body's mass may follow from."""
        return digest_of_texts([self.text(self._mechanism.graph.vertices[body]), *self.shapes(body)])

    def text(self, value: object) -> str:
        """The canonical text of a value that the mechanism holds."""
        found = self._texts.get(id(value))
        if found is None:
            found = self._texts[id(value)] = canonical(value)
        return found

    def nameless(self, part: object) -> str:
        """The canonical text of a part of the mechanism, without the names that it may carry."""
        if isinstance(part, Joint):
            named = any(dof.name is not None for dof in part.dofs)
            return f"Joint(({','.join(map(canonical_without_name, part.dofs))}))" if named else self.text(part)
        return self.text(part) if getattr(part, "name", None) is None else canonical_without_name(part)

    def shapes(self, body: Id) -> list[str]:
        """The texts of the shapes on a body."""
        return [text for view in self._mechanism.shapes.get(body, ()) for text in (self.nameless(view.shape), self.text(view.pose))]

    def _edge(self, edge: RobotEdge) -> list[str]:
        texts = [self.nameless(edge.data)]
        for arc in edge.arcs:
            texts += [_SIGNS[arc.sign], repr(arc.role), repr(arc.target.kind), self.text(arc.weight)]
        return texts


def digest_of_extra(extra: Extra) -> str:
    """The digest of an extra, without what elements inherit from it and have in a field, where an edit would be seen."""
    inherited = next((row.inherited for row in formats.FORMATS if row.name == extra.format), None)
    text = extra.text if extra.path or inherited is None else formats.loaded(inherited)(extra.text)
    return digest(extra.format, extra.path, text)


def shape_group(edge: RobotEdge) -> str:
    """What a shape belongs to: all shapes of one name on one body stand or fall together. Empty for other edges."""
    if not isinstance(edge.data, Shape):
        return ""
    body = next((arc.target.name for arc in edge.arcs if arc.sign > 0), "")
    return digest(body, edge.data.name)
