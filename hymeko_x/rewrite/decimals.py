"""Numbers that rewriting computed, as a person would write them: each the shortest decimal of the same quantity.

What the source has keeps its digits. A number is computed where it is in an element that rewriting made or changed, and nowhere in the
source.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from msgspec import Struct
from msgspec.json import encode
from msgspec.structs import replace

from hymeko_x.ir.decimals import clean_quat, shortest, shortest_of
from hymeko_x.ir.fields import layout_of
from hymeko_x.ir.parts import Inertial, Mesh, Subset
from hymeko_x.ir.values import Pose, unit_quat
from hymeko_x.rewrite.inertia import physical

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism

_LONG = re.compile(rb"(?<![\w.])-?(?:(?=[\d.]{16})\d+(?:\.\d+)?(?:e-?\d+)?|\d+(?:\.\d+)?e-(?:1[1-9]|[2-9]\d|\d{3}))(?![\w.])")
"""Numbers with so many digits, or so close to zero, that they may be computed."""
_BLANKS = bytes(code if code in b"0123456789.-e" else 32 for code in range(256))
"""The characters of numbers, and blanks for all others."""
_AS_THEY_ARE = Mesh | Subset
"""Parts whose numbers are data of files."""


def shorten_computed(mechanism: Mechanism, source: Mechanism) -> Mechanism:
    """The mechanism, made from ``source``, with every computed number as the shortest decimal that is equal to rounding."""
    if mechanism.graph is source.graph:
        return mechanism
    vertices, edges = (
        _changed(parts, before)
        for parts, before in ((mechanism.graph.vertices, source.graph.vertices), (mechanism.graph.edges, source.graph.edges))
    )
    if not vertices and not edges:
        return mechanism
    known = _known(source)
    return mechanism.replace(
        vertices={key: _shortened(part, known) for key, part in vertices.items()},
        edges={key: _shortened(edge, known) for key, edge in edges.items()},
    )


def _changed(parts: Mapping[Id, Any], before: Mapping[Id, Any]) -> dict[Id, Any]:
    """The parts with long numbers that the source's part of this id does not have."""
    found: dict[Id, Any] = {}
    for key, part in parts.items():
        old = before.get(key)
        numbers = [] if part is old else _long_numbers((part,))
        if numbers and (old is None or not {*numbers} <= {*_long_numbers((old,))}):
            found[key] = part
    return found


def _known(source: Mechanism) -> frozenset[float]:
    """The long numbers of the source, and their absolute values."""
    numbers = {float(text) for text in _long_numbers((*source.graph.vertices.values(), *source.graph.edges.values()))}
    return frozenset(numbers | {*map(abs, numbers)})


def _long_numbers(parts: Iterable[Any]) -> list[bytes]:
    """The long numbers of parts, but for data of files. Splitting at blanks first takes a tenth of the time that the expression takes."""
    text = encode([part for part in parts if not isinstance(part, _AS_THEY_ARE)])
    words = [word for word in {*text.translate(_BLANKS).split()} if len(word) > 15 or b"e-" in word]
    return _LONG.findall(b" ".join(words)) if words else []


def _shortened(value: Any, known: Collection[float]) -> Any:
    """The value with short numbers, but for those known. Depth is that of the parts, which is small."""
    kind = type(value)
    if kind is float:
        return value if value in known or (new := shortest(value)) == value else new
    if kind is tuple:
        return _tuple(value, known)
    if kind is Pose:
        return _pose(value, known)
    layout = layout_of(kind) if isinstance(value, Struct) else None
    if layout is None or (isinstance(value, Inertial) and value.written is not None):
        return value
    fields = {item.name: getattr(value, item.name) for item in layout.counting}
    short: dict[str, Any] = {name: _point(field, known) if name in _POINTS else _shortened(field, known) for name, field in fields.items()}
    changed: dict[str, Any] = {name: field for name, field in short.items() if field is not fields[name]}
    if "tensor" in changed and physical(changed["tensor"]) != changed["tensor"]:
        del changed["tensor"]  # that of a thin rod or plate, which rounding would make one of no body
    return replace(value, **changed) if changed else value


_POINTS = frozenset(("com", "anchor"))
"""Fields that are places in a body, in m."""


def _tuple(value: tuple[Any, ...], known: Collection[float]) -> tuple[Any, ...]:
    if {*map(type, value)} == {float}:
        return _point(value, known, 0.0)
    short = tuple([_shortened(item, known) for item in value])
    return value if all(a is b for a, b in zip(short, value, strict=True)) else short


def _point(value: tuple[float, ...], known: Collection[float], least: float = 1.0) -> tuple[float, ...]:
    """The components of a quantity, relative to the largest of them; places relative to 1 m at least."""
    short = tuple([a if a in known else b for a, b in zip(value, shortest_of(value, least), strict=True)])
    return value if short == value else short


def _pose(value: Pose, known: Collection[float]) -> Pose:
    xyz = _point(value.xyz, known)
    quat = value.quat
    if value.written is None and not all(number in known for number in quat):
        quat = unit_quat(clean_quat(quat))
    if xyz == value.xyz and quat == value.quat:
        return value
    return replace(value, xyz=xyz, quat=quat, written=value.written if xyz == value.xyz else _turn_only(value))


def _turn_only(value: Pose) -> Any:
    """The notation of the rotation; one that also tells the place does not fit any more."""
    return None if value.written is not None and value.written.kind == "fromto" else value.written
