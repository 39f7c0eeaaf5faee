"""The documents as types, from which msgspec makes both the checks and the schema: the vertices and edges are the parts of the IR.

An element is one object: its kind, its id, the fields of its part, its arcs, and what the side tables have about it.
"""

from __future__ import annotations

from functools import reduce
from operator import or_
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, get_args

from msgspec import NODEFAULT, Struct, defstruct, field

from hymeko_x.formats.json import MARK, VERSION
from hymeko_x.ir import parts
from hymeko_x.ir.fields import layout_of
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import Extra, Id
from hymeko_x.ir.types import hints_of
from hymeko_x.ir.values import Pose  # noqa: TC001 - msgspec evaluates the types of fields

if TYPE_CHECKING:
    from collections.abc import Mapping

Notations = tuple[tuple[str, str], ...]


class Arc(Struct, frozen=True, forbid_unknown_fields=True):
    """One end of an edge: +1 into the edge, -1 out of it, 0 undirected. The weight is a pose or a list of numbers."""

    to: Id
    sign: Literal[1, 0, -1] = 0
    weight: Pose | tuple[float, ...] | None = None
    role: str = ""


class FreeArc(Struct, frozen=True, forbid_unknown_fields=True):
    """One end of a relation of a plain hypergraph. The weight is a list of any shape."""

    to: Id
    sign: Literal[1, 0, -1] = 0
    weight: tuple[Any, ...] | None = None
    role: str = ""


_ARCS: Any = tuple[Arc, ...]
_FREE_ARCS: Any = tuple[FreeArc, ...]
_ABOUT: tuple[tuple[str, Any, Any], ...] = (
    ("extras", tuple[Extra, ...], ()),
    ("notations", Notations, ()),
    ("classes", tuple[str, ...], ()),
)
"""The keys of an element for what the side tables of a mechanism have about it."""


def _element(part: type, *own: tuple[str, Any, Any]) -> Any:
    """The type of the objects for the elements with this part."""
    layout = layout_of(part)
    assert layout is not None
    hints = hints_of(part)
    fields: list[Any] = [("id", str)]
    for item in layout.attributes:
        fields.append((item.name, hints[item.name]) if item.default is NODEFAULT else (item.name, hints[item.name], item.default))
    return defstruct(
        f"{part.__name__}Element",
        [*fields, *own, *_ABOUT],
        namespace={"__doc__": part.__doc__},
        kw_only=True,
        tag_field="type",
        tag=KINDS[part],
        forbid_unknown_fields=True,
    )


VERTICES: Mapping[type, Any] = MappingProxyType({part: _element(part) for part in get_args(parts.VertexPart)})
"""The type of the objects for each part of a vertex."""
EDGES: Mapping[type, Any] = MappingProxyType(
    {part: _element(part, ("arcs", _FREE_ARCS if part is parts.Relation else _ARCS, ())) for part in get_args(parts.EdgePart)}
)
"""The type of the objects for each part of an edge."""
PARTS: Mapping[type, type] = MappingProxyType({element: part for table in (VERTICES, EDGES) for part, element in table.items()})
"""The part of each type of objects."""

Vertices: Any = tuple[reduce(or_, VERTICES.values()), ...]  # type: ignore[misc]
Edges: Any = tuple[reduce(or_, EDGES.values()), ...]  # type: ignore[misc]


class Document(Struct, forbid_unknown_fields=True, kw_only=True):
    """A mechanism in JSON. SI units and radians; extras, notations and classes of the mechanism as a whole are in the root."""

    version: Literal[VERSION] = field(name=MARK)  # type: ignore[valid-type]
    schema: str = field(name="$schema", default="")
    name: str
    vertices: Vertices = ()
    edges: Edges = ()
    layout: tuple[Id, ...] = ()
    extras: tuple[Extra, ...] = ()
    notations: Notations = ()
    classes: tuple[str, ...] = ()
