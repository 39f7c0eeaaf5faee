"""Attributes of types that USD does not know have no value that anybody could use; they are said, and left out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import Tf

from hymeko_x import codes
from hymeko_x.diagnostics import Origin
from hymeko_x.frontends.usd.size import specs

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source


def drop_unknown_types(layers: list[Any], source: Source, report: Report) -> None:
    """Remove such attributes from the layers, which are copies of ours."""
    for layer in layers:
        for prim in specs(layer):
            unknown = [attribute for attribute in prim.attributes if attribute.typeName.type == Tf.Type.Unknown]
            for attribute in unknown:
                said = f"'{attribute.path}' has the type '{attribute.typeName}', which USD does not know; it is left out"
                report.error(codes.BAD_VALUE, said, Origin(source.name), element=str(prim.path))
                prim.RemoveProperty(attribute)
