"""Prims as plain values until all of them are known; then they are authored through Sdf, each property once.

Every call into USD costs more than all that Python does for a property; so what is changed or looked up on the way is kept here.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pxr import Sdf

from hymeko_x.formats.usd import FAMILY

if TYPE_CHECKING:
    from collections.abc import Iterable

T = Sdf.ValueTypeNames
_UNIFORM = frozenset(
    (
        *("physics:axis", "axis", "purpose", "xformOpOrder", "physics:approximation", "subdivisionScheme", "info:id"),
        *("elementType", "familyName", FAMILY),
    )
)
_FLOAT = T.Float


@dataclass(slots=True, eq=False)
class Prim:
    """A prim in the making: its type, metadata, API schemas, attributes (type and value), and the targets of its relationships.

    ``connections`` lead an attribute to that whose value it takes; ``spread`` are the attributes with values
    for each face or corner, and for which; ``reference`` is the path of a prim of the same layer.
    """

    path: Any
    kind: str = "Xform"
    specifier: Any = Sdf.SpecifierDef
    info: dict[str, Any] = field(default_factory=dict)
    schemas: list[str] = field(default_factory=list)
    attributes: dict[str, tuple[Any, Any]] = field(default_factory=dict)
    targets: dict[str, list[Any]] = field(default_factory=dict)
    connections: dict[str, Any] = field(default_factory=dict)
    spread: dict[str, str] = field(default_factory=dict)
    reference: Any = None

    @property
    def name(self) -> str:
        """The last step of the path."""
        return str(self.path.name)


def author(prims: Iterable[Prim], layer: Any) -> None:
    """Write every prim into the layer, parents before their children.

    No spec is kept: of a layer of which many were held at once the text takes longer per prim the more there were.
    """
    above, parent = Sdf.Path.absoluteRootPath, layer
    for prim in prims:
        path = prim.path
        if path.GetParentPath() != above:
            above = path.GetParentPath()
            parent = layer if above.IsAbsoluteRootPath() else layer.GetPrimAtPath(above)
        spec = Sdf.PrimSpec(parent, path.name, prim.specifier, prim.kind)
        for name, value in prim.info.items():
            spec.SetInfo(name, value)
        if prim.schemas:
            set_schemas(spec, prim.schemas)
        if prim.reference is not None:
            spec.referenceList.prependedItems = [Sdf.Reference(primPath=prim.reference)]
        for name, (kind, value) in prim.attributes.items():
            attribute = add_attribute(spec, name, kind, value)
            if name in prim.connections:
                attribute.connectionPathList.explicitItems = [prim.connections[name]]
            if name in prim.spread:
                attribute.SetInfo("interpolation", prim.spread[name])
        for name, targets in prim.targets.items():
            Sdf.RelationshipSpec(spec, name, False).targetPathList.explicitItems = targets


def add_attribute(spec: Any, name: str, kind: Any, value: Any) -> Any:
    """A new attribute of a prim that is authored already."""
    is_uniform = name in _UNIFORM or name.startswith("mjc:")
    attribute = Sdf.AttributeSpec(spec, name, kind, Sdf.VariabilityUniform if is_uniform else Sdf.VariabilityVarying)
    if value is not None:
        attribute.default = value
    return attribute


def set_schemas(spec: Any, schemas: list[str]) -> None:
    """Say which API schemas a prim has."""
    spec.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=schemas))
