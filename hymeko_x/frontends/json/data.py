"""The values of plain data: lists of any shape, which no type of a document describes to its leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.parts import Datum, Relation

if TYPE_CHECKING:
    from hymeko_x.formats.json.document import Document
    from hymeko_x.ir.parts import DataValue

_PLAIN = frozenset({KINDS[Datum], KINDS[Relation]})
MAX_DEPTH = 200
"""Lists inside of lists."""


def settle(document: Document, file: str) -> None:
    """Make the values of plain data those that the IR has: lists are tuples, and every number is a double.

    Raises: Refusal (HX066) for a value that is no number, text, list or null, HX007 for lists that are nested too deep.
    """
    for table, items in (("vertices", document.vertices), ("edges", document.edges)):
        for number, item in enumerate(items):
            if item.__struct_config__.tag in _PLAIN:
                path = f"$.{table}[{number}]"
                item.parameters = tuple(
                    (name, _settled(value, f"{path}.parameters[{place}][1]", file, 0))
                    for place, (name, value) in enumerate(item.parameters)
                )
                if table == "edges":
                    item.arcs = tuple(
                        arc if arc.weight is None else replace(arc, weight=_settled(arc.weight, f"{path}.arcs[{place}].weight", file, 0))
                        for place, arc in enumerate(item.arcs)
                    )


def _settled(value: Any, path: str, file: str, depth: int) -> DataValue:
    if depth > MAX_DEPTH:
        raise refuse(codes.TOO_LARGE, f"{path}: lists are nested more than {MAX_DEPTH} levels deep", Origin(file))
    if isinstance(value, list | tuple):
        return tuple([_settled(item, f"{path}[{place}]", file, depth + 1) for place, item in enumerate(value)])
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, bool) or not isinstance(value, float | int):
        raise refuse(codes.BAD_DOCUMENT, f"{path}: expected a number, a text, a list or null", Origin(file))
    return float(value)
