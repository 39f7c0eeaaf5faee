"""Two mechanisms compared element by element and field by field. The ledger, `hymeko-x diff` and the tests all use it."""

from __future__ import annotations

import math
from collections import Counter
from enum import Enum
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from msgspec import Struct

from hymeko_x import formats
from hymeko_x.compare.extras import as_meant, as_written, unshared
from hymeko_x.compare.leaves import TURN, leaves_between, leaves_of
from hymeko_x.ir.digits import are_numbers, number_text, numbers_text
from hymeko_x.ir.fields import NUMBERS, layout_of
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.holder import mechanism_of
from hymeko_x.ir.mechanism import ROOT, Extra, Id, Mechanism
from hymeko_x.ir.values import IDENTITY, Pose, rotation_angle

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.compare.leaves import Leaves, Path
    from hymeko_x.ir.fields import FieldLayout
    from hymeko_x.ir.holder import Holder
    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.ir.values import Quat

P = TypeVar("P")


class Difference(NamedTuple):
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


class Tolerance(Struct, frozen=True):
    """How far numbers may be apart: |a - b| <= absolute + relative * max(|a|, |b|); rotations by their angle in rad.

    ``by_vector``: the largest number of a vector is the measure for all of its numbers.
    """

    absolute: float = 0.0
    relative: float = 0.0
    by_vector: bool = False

    def accepts(self, a: float, b: float) -> bool:
        """Whether two numbers count as equal; infinities and NaN equal themselves, and nothing else."""
        if a == b or (a != a and b != b):
            return True
        if math.isinf(a) or math.isinf(b):
            return False
        return abs(a - b) <= self.absolute + self.relative * max(abs(a), abs(b))

    def accepts_all(self, a: tuple[float, ...], b: tuple[float, ...]) -> bool:
        """Whether two vectors of one length count as equal."""
        if self.by_vector:
            size = max(map(abs, (*a, *b)), default=0.0)
            allowed = self.absolute + self.relative * size
            return size < math.inf and all(abs(x - y) <= allowed for x, y in zip(a, b, strict=True))
        return all(map(self.accepts, a, b))


EXACT = Tolerance()

_LONG, _SHOWN = 64, 8
"""Tuples with more items are the numbers of meshes, of which only a few are shown."""


def diff(
    a: Mechanism | Holder, b: Mechanism | Holder, tolerance: Tolerance = EXACT, leaves: Mapping[Id, Leaves] | None = None
) -> tuple[Difference, ...]:
    """Everything that differs from ``a`` to ``b``: the name, elements, their fields and arcs, and their extras.

    Order (of elements and of parameters) does not count, but for that of constraints, nor do places and notations. Linear in the size of
    both. ``leaves`` are the leaves of the elements that both have, if they are known.
    """
    a, b = mechanism_of(a), mechanism_of(b)
    return tuple(_differences(a, b, tolerance, leaves_between(a, b) if leaves is None else leaves))


def _differences(a: Mechanism, b: Mechanism, tolerance: Tolerance, leaves: Mapping[Id, Leaves]) -> Iterator[Difference]:
    if a.name != b.name:
        yield Difference(ROOT, "name", repr(a.name), repr(b.name))
    yield from _elements(a.graph.vertices, b.graph.vertices, tolerance, leaves)
    yield from _elements(a.graph.edges, b.graph.edges, tolerance, leaves)
    yield from _order(a, b)
    for key in _union(a.extras, b.extras):
        yield from _extras(key, a.extras.get(key, ()), b.extras.get(key, ()))


def _order(a: Mechanism, b: Mechanism) -> Iterator[Difference]:
    """The order of constraints, where the format of one of both numbers them."""
    if not any(row is not None and row.numbers_constraints for row in map(formats.of_source, (a, b))):
        return
    ours, theirs = a.constraints, b.constraints
    common = set(ours) & set(theirs)
    before, after = ([key for key in keys if key in common] for keys in (ours, theirs))
    if before != after:
        yield Difference(ROOT, "order of constraints", " ".join(map(str, before)), " ".join(map(str, after)))


def _elements(a: Mapping[Id, P], b: Mapping[Id, P], tolerance: Tolerance, leaves: Mapping[Id, Leaves]) -> Iterator[Difference]:
    for key, before in a.items():
        if key in leaves:
            yield from [Difference(key, *found) for found in _found("", leaves[key], tolerance)]
        elif key not in b:
            yield Difference(key, "", _short(before), None)
    for key, after in b.items():
        if key not in a:
            yield Difference(key, "", None, _short(after))


Found = tuple[str, str | None, str | None]


def _found(where: str, leaves: Leaves, tolerance: Tolerance) -> Iterator[Found]:
    """What of the leaves is a difference, with the path to each."""
    for path, a, b, _, counts in leaves:
        if not counts:
            continue
        if path and path[-1] == TURN:
            yield from _turns(_joined(where, path[:-1]), a, b, tolerance)  # type: ignore[arg-type]
        elif isinstance(a, NUMBERS) and isinstance(b, NUMBERS) and not isinstance(a, bool):
            if not tolerance.accepts(a, b):
                yield _joined(where, path), number_text(a), number_text(b)
        elif tolerance != EXACT and isinstance(a or b, Pose) and path[-1:] == ("weight",) and _same_pose(a, b, tolerance):
            continue
        elif path and path[-1] == "parameters":
            yield from _parameters(_joined(where, path), a, b, tolerance)  # type: ignore[arg-type]
        elif isinstance(a, tuple) and isinstance(b, tuple) and not isinstance(a, Id):
            yield from _tuples(_joined(where, path), a, b, tolerance)
        elif a != b:
            yield _joined(where, path), _short(a), _short(b)


def _same_pose(a: object, b: object, tolerance: Tolerance) -> bool:
    """Whether two weights are the same pose; an arc without one stands for the identity."""
    return not any(_found("", leaves_of(a or IDENTITY, b or IDENTITY), tolerance))


def _parameters(where: str, a: Parameters, b: Parameters, tolerance: Tolerance) -> Iterator[Found]:
    """Parameters have names: where one stands does not count, nor whether a number stands in a list of its own."""
    before, after = _by_name(a), _by_name(b)
    for name in dict.fromkeys([*before, *after]):
        path = f"{where}.{name}"
        if name not in after:
            yield path, _short(before[name]), None
        elif name not in before:
            yield path, None, _short(after[name])
        else:
            yield from _found(path, leaves_of(before[name], after[name]), tolerance)


def _by_name(parameters: Parameters) -> dict[str, object]:
    """The value of each parameter; one that comes again has a number (``name[2]``)."""
    found: dict[str, object] = {}
    counts: Counter[str] = Counter()
    for name, *values in parameters:
        counts[name] += 1
        key = name if counts[name] == 1 else f"{name}[{counts[name]}]"
        value = values[0] if len(values) == 1 else tuple(values)
        found[key] = value[0] if isinstance(value, tuple) and len(value) == 1 else value
    return found


def _turns(where: str, a: tuple[Quat, object], b: tuple[Quat, object], tolerance: Tolerance) -> Iterator[Found]:
    """Two rotations with their notations, which do not count."""
    if a[0] != b[0] and rotation_angle(a[0], b[0]) > tolerance.absolute + tolerance.relative:
        yield _joined(where, ("rotation",)), _short(a[0]), _short(b[0])


def _tuples(where: str, a: tuple[object, ...], b: tuple[object, ...], tolerance: Tolerance) -> Iterator[Found]:
    if _is_array(a) or _is_array(b):
        yield from _arrays(where, a, b, tolerance)
        return
    if all(isinstance(x, NUMBERS) for x in (*a, *b)):
        if len(a) != len(b) or not tolerance.accepts_all(a, b):  # type: ignore[arg-type]
            yield where, _short(a), _short(b)
        return
    for number in range(max(len(a), len(b))):
        path = f"{where}[{number}]"
        if number >= len(a):
            yield path, None, _short(b[number])
        elif number >= len(b):
            yield path, _short(a[number]), None
        elif a[number] != b[number]:
            yield from _found(path, leaves_of(a[number], b[number]), tolerance)


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
    return len(values) > _LONG and isinstance(values[0], NUMBERS)


def _accepts(a: object, b: object, tolerance: Tolerance) -> bool:
    return isinstance(a, NUMBERS) and isinstance(b, NUMBERS) and tolerance.accepts(a, b)


def _excerpt(values: tuple[object, ...], first: int = 0) -> str:
    """Some items of a long tuple, and how many there are."""
    shown = " ".join(_short(item) for item in values[first : first + _SHOWN])
    return f"[{'... ' if first else ''}{shown}{' ...' if first + _SHOWN < len(values) else ''}] of {len(values)}"


def _extras(key: Id, a: tuple[Extra, ...], b: tuple[Extra, ...]) -> Iterator[Difference]:
    """Extras have no identity beyond format, path and text: they are compared as multisets. How XML is laid out does not count."""
    left, rest = unshared(a, b, as_written, as_meant)
    for extra in left:
        yield Difference(key, f"{extra.format} {extra.path or 'content'}", extra.text, None)
    for extra in rest:
        yield Difference(key, f"{extra.format} {extra.path or 'content'}", None, extra.text)


def _union(a: Iterable[Id], b: Iterable[Id]) -> list[Id]:
    """The keys of both, those of the first one first."""
    return list(dict.fromkeys([*a, *b]))


def _joined(where: str, path: Path) -> str:
    """A path as it is shown: without what every element has."""
    for step in path:
        if isinstance(step, int):
            where = f"{where}[{step}]"
        elif step not in ("data", "arcs"):
            where = f"{where}.{step}" if where else step
    return where


def _short(value: object) -> str:
    """A value in a few words."""
    if value is None:
        return "none"
    kind = type(value)
    if kind is float:
        return number_text(value)  # type: ignore[arg-type]
    if kind is str:
        return repr(value)
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, Id):
        return str(value)
    if isinstance(value, tuple):
        if _is_array(value):
            return _excerpt(value)
        if are_numbers(value):
            return f"[{numbers_text(value)}]"
        return "[" + " ".join([_short(item) for item in value]) + "]"
    layout = layout_of(kind)
    if layout is not None:
        return _short_part(value, layout)
    return repr(value) if isinstance(value, str) else str(value)


def _short_part(value: object, layout: FieldLayout) -> str:
    if isinstance(value, Edge):
        return _short_edge(value)
    if isinstance(value, Arc):
        return _short_arc(value)
    kind: Any = type(value)
    fields = zip(layout.compared(value), _default_words(kind), strict=True)
    words = [word if inner is default else f"{name} {_short(inner)}" for inner, (name, default, word) in fields]
    return f"{kind.__name__.lower()}({', '.join(words)})"


@cache
def _default_words(kind: Any) -> tuple[tuple[str, object, str], ...]:
    """The fields of a class that count, with their defaults, and how those are shown."""
    layout = layout_of(kind)
    assert layout is not None
    return tuple((item.name, item.default, f"{item.name} {_short(item.default)}") for item in layout.counting)


def _short_edge(edge: RobotEdge) -> str:
    return f"{_short(edge.data)} {{{', '.join(_short_arc(arc) for arc in edge.arcs)}}}"


def _short_arc(arc: RobotArc) -> str:
    weight = "" if arc.weight is None else f"{_short(arc.weight)} "
    role = f" as {arc.role!r}" if arc.role else ""
    return f"{weight}{'-~+'[arc.sign + 1]} {arc.target}{role}"
