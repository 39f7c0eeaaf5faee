"""Prims of one self-contained layer as plain values, looked up once.

Every call into USD costs more than all that Python does for a property; so types, schemas and names are gathered in one pass,
and values are looked up only where a reader asks for them.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field
from pxr import Gf, Sdf, Tf, Usd, Vt

from hymeko_x.formats.usd import PREFIX

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

BINDING = "material:binding"
_CLASSES = MappingProxyType(
    {
        **dict.fromkeys(("half", "float", "double"), float),
        **dict.fromkeys(("token", "string"), str),
        **dict.fromkeys(("point3f", "vector3f", "normal3f", "color3f", "float3"), Gf.Vec3f),
        "bool": bool,
        "int": int,
        "float2": Gf.Vec2f,
        "float4": Gf.Vec4f,
        "color4f": Gf.Vec4f,
        "quatf": Gf.Quatf,
        "int[]": Vt.IntArray,
        "float[]": Vt.FloatArray,
        "double[]": Vt.DoubleArray,
        "token[]": Vt.TokenArray,
        **dict.fromkeys(("point3f[]", "vector3f[]", "normal3f[]", "color3f[]", "float3[]"), Vt.Vec3fArray),
        **dict.fromkeys(("point3d[]", "vector3d[]", "normal3d[]", "color3d[]", "double3[]"), Vt.Vec3dArray),
        **dict.fromkeys(("point3h[]", "vector3h[]", "normal3h[]", "color3h[]", "half3[]"), Vt.Vec3hArray),
        **dict.fromkeys(("texCoord2f[]", "float2[]"), Vt.Vec2fArray),
    }
)
"""The Python types of the value types that are read: in a damaged file a value may be anything else."""

_TRIPLES = frozenset(kind for kind, found in _CLASSES.items() if found in (Vt.Vec3fArray, Vt.Vec3dArray, Vt.Vec3hArray))
_TYPES_OF = MappingProxyType(
    {
        **dict.fromkeys(("points", "extent", "normals", "primvars:normals", "primvars:displayColor"), _TRIPLES),
        **dict.fromkeys(("faceVertexCounts", "faceVertexIndices", "indices"), frozenset(("int[]",))),
        **dict.fromkeys(("primvars:st:indices", "primvars:normals:indices"), frozenset(("int[]",))),
        "primvars:displayOpacity": frozenset(("float[]", "double[]", "half[]")),
        "xformOpOrder": frozenset(("token[]",)),
    }
)
"""The types that attributes of UsdGeom's schemas may have; the value of one of another type is not used."""


class Prim(Struct, eq=False):
    """A prim: its path, name, type and API schemas (also those without a plugin), and its properties and metadata.

    ``properties`` are the names of its properties, ``types`` the types of those that are attributes; ``metadata`` are the names of
    its metadata. ``is_real`` unless it is inactive, abstract or only an opinion about a prim without a definition. ``is_bound``
    when it or one above is bound to a material. ``stage`` is what it is composed in, for what only USD can compute.
    """

    path: str
    name: str
    kind: str
    schemas: tuple[str, ...]
    spec: Any
    parent: Prim | None
    scene: UsdLayer
    metadata: tuple[str, ...]
    properties: tuple[str, ...]
    types: dict[str, str]
    is_real: bool
    is_bound: bool
    children: list[Prim] = field(default_factory=list)

    @property
    def composed(self) -> Any:
        """The prim in its stage."""
        return self.scene.stage.GetPrimAtPath(self.path)

    @property
    def display_name(self) -> str:
        """Its display name; empty where it has none."""
        shown = self.spec.GetInfo("displayName") if "displayName" in self.metadata else ""
        return shown if isinstance(shown, str) else ""

    @property
    def is_generated(self) -> bool:
        """Whether it is in a group that the writer makes, and follows from the elements that use it."""
        return self.parent is not None and f"{PREFIX}scope" in self.parent.types

    @property
    def custom_data(self) -> dict[str, Any]:
        """Its custom data."""
        return dict(self.spec.GetInfo("customData")) if "customData" in self.metadata else {}

    def value(self, name: str) -> Any:
        """The value of an attribute that does not change with time; None where there is none."""
        kind = self.types.get(name)
        if kind is None or (name in _TYPES_OF and kind not in _TYPES_OF[name]):
            return None
        return self._sound(name, self.spec.layer.GetAttributeAtPath(f"{self.path}.{name}").default)

    def _sound(self, name: str, value: Any) -> Any:
        """A value that is of its declared type; else None."""
        return value if isinstance(value, _CLASSES.get(self.types[name], object)) and not isinstance(value, Sdf.ValueBlock) else None

    def is_animated(self, name: str) -> bool:
        """Whether an attribute has values for single times."""
        return self.scene.is_animated and name in self.types and self.spec.layer.GetNumTimeSamplesForPath(f"{self.path}.{name}") > 0

    def earliest(self, name: str) -> Any:
        """The first value of an attribute that changes with time; None where it has none."""
        attribute = self.composed.GetAttribute(name)
        return self._sound(name, attribute.Get(Usd.TimeCode.EarliestTime())) if attribute.HasAuthoredValue() else None

    def has_value(self, name: str) -> bool:
        """Whether an attribute has a value, for all times or some."""
        return self.value(name) is not None or self.is_animated(name)

    def targets(self, name: str) -> list[str]:
        """The paths that a relationship leads to."""
        if name in self.types or name not in self.properties:
            return []
        return [str(path) for path in self.spec.layer.GetRelationshipAtPath(f"{self.path}.{name}").targetPathList.GetAppliedItems()]

    def has_api(self, schema: str) -> bool:
        """Whether the schema is applied."""
        return schema in self.schemas

    def with_ancestors(self) -> Iterator[Prim]:
        """The prim and all above it, from below."""
        prim: Prim | None = self
        while prim is not None:
            yield prim
            prim = prim.parent


class UsdLayer(Struct, eq=False):
    """All prims of a layer by path, parents first. ``has_unknown_types``: some attribute has a type that USD cannot read.

    ``stage`` is set when the layer is opened as one.
    """

    prims: dict[str, Prim] = field(default_factory=dict)
    is_animated: bool = False
    has_unknown_types: bool = False
    stage: Any = None

    def real(self) -> list[Prim]:
        """What a stage of the layer consists of."""
        return [prim for prim in self.prims.values() if prim.is_real]

    def close(self) -> None:
        """Cut all cycles, so that memory is freed at once: prims refer to each other and to USD's objects."""
        for prim in self.prims.values():
            prim.parent = None
            prim.children.clear()
        self.prims.clear()
        self.stage = None


def read_layer(layer: Any, most: int) -> UsdLayer | None:
    """Every prim of a layer; None where there are more than ``most``. Not recursive."""
    found = UsdLayer(is_animated=bool(layer.ListAllTimeSamples()))
    names = _Names()
    top = _children(layer.pseudoRoot, layer.pseudoRoot.ListInfoKeys(), names)
    stack: list[tuple[str, Prim | None]] = [(f"/{name}", None) for name in reversed(top)]
    while stack:
        path, parent = stack.pop()
        spec = layer.GetPrimAtPath(path)
        if spec is None or spec.name != path.rpartition("/")[2]:  # a damaged crate may list prims that it does not have
            continue
        prim = found.prims[path] = _read_prim(spec, path, parent, found, names)
        if parent is not None:
            parent.children.append(prim)
        if len(found.prims) > most:
            return None
        stack.extend((f"{path}/{name}", prim) for name in reversed(_children(spec, prim.metadata, names)))
    found.has_unknown_types = not all(names.types.values())
    return found


class _Names(Struct):
    """One copy of each name, and whether USD can read the types that have occurred."""

    known: dict[str, str] = field(default_factory=dict)
    types: dict[str, bool] = field(default_factory=dict)

    def one(self, name: str) -> str:
        return self.known.setdefault(name, name)


def _read_prim(spec: Any, path: str, parent: Prim | None, scene: UsdLayer, names: _Names) -> Prim:
    authored = tuple(map(names.one, spec.ListInfoKeys()))
    schemas = tuple(map(names.one, spec.GetInfo("apiSchemas").GetAppliedItems())) if "apiSchemas" in authored else ()
    layer = spec.layer
    items = {names.one(name): layer.GetObjectAtPath(f"{path}.{name}") for name in spec.GetInfo("properties") or () if name}
    types = {name: _type_of(item, names) for name, item in items.items() if isinstance(item, Sdf.AttributeSpec)}
    properties = tuple(name for name, item in items.items() if item is not None)  # a damaged crate lists some that it does not have
    is_real = spec.specifier == Sdf.SpecifierDef and ("active" not in authored or spec.active) and (parent is None or parent.is_real)
    is_bound = (parent is not None and parent.is_bound) or any(name.startswith(BINDING) for name in properties)
    kind, name = names.one(str(spec.typeName)), path.rpartition("/")[2]
    return Prim(path, name, kind, schemas, spec, parent, scene, authored, properties, types, is_real, is_bound)


def _type_of(attribute: Any, names: _Names) -> str:
    kind = attribute.typeName
    name = names.one(str(kind))
    if name not in names.types:
        names.types[name] = bool(kind.type != Tf.Type.Unknown)
    return name


def _children(spec: Any, authored: Collection[str], names: _Names) -> list[str]:
    """The names of the children, in the order that the prim prescribes."""
    below = [names.one(name) for name in spec.GetInfo("primChildren") or ()]
    if "primOrder" in authored:
        below = list(spec.ApplyNameChildrenOrder(below))
    return below
