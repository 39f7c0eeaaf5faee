"""Mechanism to JSON: one object for each element, in order; fields that have their default are left out."""

from __future__ import annotations

from enum import Enum
from math import isfinite
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.json import Encoder

from hymeko_x.formats.json import ENDLESS, MARK, VERSION
from hymeko_x.ir.digits import are_numbers
from hymeko_x.ir.fields import attributes_of, identical
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.provenance import kept_notations
from hymeko_x.source import Package

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc
    from hymeko_x.rewrite.context import Options

    Json = Mapping[str, object]


def _text_of(value: object) -> str:
    """A text of a class of its own, as names that were quoted are."""
    if not isinstance(value, str):
        raise TypeError(f"{type(value).__name__} has no place in a mechanism")
    return str(value)


encode = Encoder(enc_hook=_text_of).encode


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The document as the only file of a package; other files stay where they are and are referred to."""
    return Package(_text(document(mechanism)))


def document(mechanism: Mechanism) -> Json:
    """The mechanism as values of JSON."""
    notations = kept_notations(mechanism.notations, mechanism.source)

    def about(key: Id) -> dict[str, object]:
        return {
            "extras": _plain(mechanism.extras.get(key, ())),
            "notations": tuple(notations.get(key, {}).items()),
            "classes": mechanism.stereotypes.get(key, ()),
        }

    def element(key: Id, part: Struct, own: dict[str, object]) -> Json:
        fields = {"type": key.kind, "id": key.name, **_fields(part)}
        return {**fields, **{name: value for name, value in (own | about(key)).items() if value}}

    graph = mechanism.graph
    root = {
        "vertices": [element(key, part, {}) for key, part in graph.vertices.items()],
        "edges": [element(key, edge.data, {"arcs": [_arc(arc) for arc in edge.arcs]}) for key, edge in graph.edges.items()],
        "layout": [key for key in mechanism.layout if key in graph.vertices or key in graph.edges],
        **about(ROOT),
    }
    return {MARK: VERSION, "name": mechanism.name, **{name: value for name, value in root.items() if value}}


def _arc(arc: RobotArc) -> Json:
    found: dict[str, object] = {"to": arc.target}
    if arc.sign:
        found["sign"] = arc.sign
    if arc.weight is not None:
        found["weight"] = _plain(arc.weight)
    if arc.role:
        found["role"] = arc.role
    return found


def _fields(part: Struct) -> dict[str, object]:
    """The fields of a part that differ from their defaults."""
    values = ((item.name, getattr(part, item.name), item.default) for item in attributes_of(part))
    return {name: _plain(value) for name, value, default in values if not identical(value, default)}


def _plain(value: object) -> object:
    """A value of a field as JSON has it. No deeper than parts are nested."""
    if isinstance(value, float):
        return value if isfinite(value) else {ENDLESS: str(value)}
    if isinstance(value, tuple):
        return value if are_numbers(value) and all(map(isfinite, value)) else [_plain(item) for item in value]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Struct):
        tag = value.__struct_config__.tag
        return {**({"type": tag} if tag else {}), **_fields(value)}
    return value


def _text(root: Json) -> bytes:
    """The document with each element on a line of its own."""
    lines = []
    for key, value in root.items():
        if key in ("vertices", "edges"):
            assert isinstance(value, list)
            inside = b",\n    ".join(map(encode, value))
            lines.append(encode(key) + b": [\n    " + inside + b"\n  ]")
        else:
            lines.append(encode(key) + b": " + encode(value))
    return b"{\n  " + b",\n  ".join(lines) + b"\n}\n"
