"""Two mechanisms compared element by element and field by field. The ledger, `hymeko-x diff` and the tests all use it."""

from __future__ import annotations

import math
from dataclasses import dataclass, is_dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING, TypeVar

from hymeko_x.ir.fields import attributes_of, layout_of
from hymeko_x.ir.mechanism import ROOT, Extra, Id, Mechanism
from hymeko_x.ir.values import Pose, number_text, rotation_angle

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.ir.fields import Layout
    from hymeko_x.ir.mechanism import RobotArc, RobotEdge

P = TypeVar("P")


@dataclass(frozen=True, slots=True)
class Difference:
    """One field of one element that differs; ``before`` or ``after`` is None where it is not there at all."""

    element: Id
    field: str
    before: str | None
    after: str | None

    def __str__(self) -> str:
        where = "mechanism" if self.element == ROOT else str(self.element)
        place = f"{where} {self.field}".rstrip()
        if self.before is None:
            return f"{place}: added {self.after}"
        if self.after is None:
            return f"{place}: removed {self.before}"
        return f"{place}: {self.before} -> {self.after}"


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far numbers may be apart: |a - b| <= absolute + relative * max(|a|, |b|); rotations by their angle in rad."""

    absolute: float = 0.0
    relative: float = 0.0

    def accepts(self, a: float, b: float) -> bool:
        """Whether two numbers count as equal; infinities and NaN equal themselves, and nothing else."""
        if a == b or (a != a and b != b):
            return True
        if math.isinf(a) or math.isinf(b):
            return False
        return abs(a - b) <= self.absolute + self.relative * max(abs(a), abs(b))


EXACT = Tolerance()

_LONG, _SHOWN = 64, 8
"""Tuples with more items are the numbers of meshes, of which only a few are shown."""


def diff(a: Mechanism, b: Mechanism, tolerance: Tolerance = EXACT) -> tuple[Difference, ...]:
    """Everything that differs from ``a`` to ``b``: the name, elements, their fields and arcs, and their extras.

    Order, places and notations do not count. Linear in the size of both.
    """
    return tuple(_differences(a, b, tolerance))


def _differences(a: Mechanism, b: Mechanism, tolerance: Tolerance) -> Iterator[Difference]:
    if a.name != b.name:
        yield Difference(ROOT, "name", repr(a.name), repr(b.name))
    yield from _elements(a.graph.vertices, b.graph.vertices, tolerance)
    yield from _elements(a.graph.edges, b.graph.edges, tolerance)
    for key in _union(a.extras, b.extras):
        yield from _extras(key, a.extras.get(key, ()), b.extras.get(key, ()))


def _elements(a: Mapping[Id, P], b: Mapping[Id, P], tolerance: Tolerance) -> Iterator[Difference]:
    for key, before in a.items():
        after = b.get(key)
        if after is None:
            yield Difference(key, "", _short(before), None)
        elif before is not after:
            found: list[Found] = []
            _values("", before, after, tolerance, found)
            yield from (Difference(key, *leaf) for leaf in found)
    for key, after in b.items():
        if key not in a:
            yield Difference(key, "", None, _short(after))


Found = tuple[str, str | None, str | None]


def _values(where: str, a: object, b: object, tolerance: Tolerance, found: list[Found]) -> None:
    """The differing leaves of two values, with the path to each. Depth is that of the parts, which is small."""
    kind = type(a)
    layout = layout_of(kind) if kind is type(b) else None
    if isinstance(a, float | int) and isinstance(b, float | int) and not isinstance(a, bool):
        if not tolerance.accepts(a, b):
            found.append((where, number_text(a), number_text(b)))
    elif isinstance(a, Pose) and isinstance(b, Pose):
        _poses(where, a, b, tolerance, found)
    elif layout is not None:
        _fields(where, layout, a, b, tolerance, found)
    elif isinstance(a, tuple) and isinstance(b, tuple) and not isinstance(a, Id):
        _tuples(where, a, b, tolerance, found)
    elif a != b:
        found.append((where, _short(a), _short(b)))


def _fields(where: str, layout: Layout, a: object, b: object, tolerance: Tolerance, found: list[Found]) -> None:
    for item, before, after in zip(layout.attributes, layout.values(a), layout.values(b), strict=True):
        if before is not after and item.compare and before != after:
            name = item.name if item.name not in ("data", "arcs") else ""
            _values(_join(where, name), before, after, tolerance, found)


def _poses(where: str, a: Pose, b: Pose, tolerance: Tolerance, found: list[Found]) -> None:
    if a.xyz != b.xyz:
        _values(_join(where, "xyz"), a.xyz, b.xyz, tolerance, found)
    if a.quat != b.quat and rotation_angle(a.quat, b.quat) > tolerance.absolute + tolerance.relative:
        found.append((_join(where, "rotation"), _short(a.quat), _short(b.quat)))


def _tuples(where: str, a: tuple[object, ...], b: tuple[object, ...], tolerance: Tolerance, found: list[Found]) -> None:
    if _is_array(a) or _is_array(b):
        found += _arrays(where, a, b, tolerance)
        return
    if all(isinstance(x, float | int) for x in (*a, *b)):
        if len(a) != len(b) or not all(tolerance.accepts(x, y) for x, y in zip(a, b, strict=True)):  # type: ignore[arg-type]
            found.append((where, _short(a), _short(b)))
        return
    for number in range(max(len(a), len(b))):
        path = f"{where}[{number}]"
        if number >= len(a):
            found.append((path, None, _short(b[number])))
        elif number >= len(b):
            found.append((path, _short(a[number]), None))
        elif a[number] is not b[number]:
            _values(path, a[number], b[number], tolerance, found)


def _arrays(where: str, a: tuple[object, ...], b: tuple[object, ...], tolerance: Tolerance) -> Iterator[Found]:
    """The same for the numbers of meshes, of which there may be millions: those from the first difference on stand for all."""
    if len(a) != len(b):
        yield where, _short(a), _short(b)
        return
    if a == b:
        return
    first = next((place for place, (x, y) in enumerate(zip(a, b, strict=True)) if x != y and not _accepts(x, y, tolerance)), None)
    if first is not None:
        yield where, _excerpt(a, first), _excerpt(b, first)


def _is_array(values: tuple[object, ...]) -> bool:
    return len(values) > _LONG and isinstance(values[0], float | int)


def _accepts(a: object, b: object, tolerance: Tolerance) -> bool:
    return isinstance(a, float | int) and isinstance(b, float | int) and tolerance.accepts(a, b)


def _excerpt(values: tuple[object, ...], first: int = 0) -> str:
    """Some items of a long tuple, and how many there are."""
    shown = " ".join(_short(item) for item in values[first : first + _SHOWN])
    return f"[{'... ' if first else ''}{shown}{' ...' if first + _SHOWN < len(values) else ''}] of {len(values)}"


def _extras(key: Id, a: tuple[Extra, ...], b: tuple[Extra, ...]) -> Iterator[Difference]:
    """Extras have no identity beyond format, path and text: they are compared as multisets. How XML is laid out does not count."""
    rest = list(b)
    left: list[Extra] = []
    for extra in a:
        if extra in rest:
            rest.remove(extra)
        else:
            left.append(extra)
    places = {(extra.format, extra.path) for extra in left} & {(extra.format, extra.path) for extra in rest}
    essences = [_essence(extra) if (extra.format, extra.path) in places else extra for extra in rest]
    for extra in left:
        if (extra.format, extra.path) in places and (essence := _essence(extra)) in essences:
            place = essences.index(essence)
            del essences[place], rest[place]
        else:
            yield Difference(key, f"{extra.format} {extra.path or 'content'}", extra.text, None)
    for extra in rest:
        yield Difference(key, f"{extra.format} {extra.path or 'content'}", None, extra.text)


def _essence(extra: Extra) -> Extra:
    """An extra that is an XML element without its comments, the blanks between its elements and the order of its attributes."""
    if not extra.text.startswith("<"):
        return extra
    from xml.etree.ElementTree import ParseError, canonicalize

    try:
        return replace(extra, text=canonicalize(extra.text, strip_text=True))
    except ParseError:
        return extra


def _union(a: Iterable[Id], b: Iterable[Id]) -> list[Id]:
    """The keys of both, those of the first one first."""
    return list(dict.fromkeys([*a, *b]))


def _join(where: str, name: str) -> str:
    return f"{where}.{name}" if where and name else where or name


def _short(value: object) -> str:
    """A value in a few words."""
    if value is None:
        return "none"
    if isinstance(value, float):
        return number_text(value)
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, Id):
        return str(value)
    if isinstance(value, tuple):
        if _is_array(value):
            return _excerpt(value)
        return "[" + " ".join(_short(item) for item in value) + "]"
    if is_dataclass(value):
        return _short_part(value)
    return repr(value) if isinstance(value, str) else str(value)


def _short_part(value: object) -> str:
    from hymeko_x.ir.graph import Arc, Edge

    match value:
        case Edge():
            return _short_edge(value)
        case Arc():
            return _short_arc(value)
        case _:
            said = [f"{item.name} {_short(getattr(value, item.name))}" for item in attributes_of(value) if item.compare]
            return f"{type(value).__name__.lower()}({', '.join(said)})"


def _short_edge(edge: RobotEdge) -> str:
    return f"{_short(edge.data)} {{{', '.join(_short_arc(arc) for arc in edge.arcs)}}}"


def _short_arc(arc: RobotArc) -> str:
    weight = "" if arc.weight is None else f"{_short(arc.weight)} "
    return f"{weight}{'-~+'[arc.sign + 1]} {arc.target}"
