"""A layer in the making: prims at valid, unique paths, attributes with their types, all authored through Sdf."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pxr import Gf, Sdf, Vt

from hymeko_x.formats import usd as words

if TYPE_CHECKING:
    from hymeko_x.formats.usd import Value
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.values import Pose, Quat, Vec3

_INVALID = re.compile(r"\W")
RESET = "!resetXformStack!"


@dataclass(slots=True)
class Sheet:
    """The layer, and where each element's prim is: ``homes`` by id, ``dofs`` the prim of each dof of a joint.

    ``carried`` holds by prim the elements that it carries, by their kinds; ``made`` what we added to a prim that no element
    says, which the reader overlooks; ``restored`` what extras say about it. ``skins`` is the shape of each body whose own prim
    is its geometry, ``scales`` the scale of such a prim.
    """

    mechanism: Mechanism
    layer: Any
    root: Any
    homes: dict[Id, Any] = field(default_factory=dict)
    dofs: dict[tuple[Id, int], tuple[Any, str]] = field(default_factory=dict)
    carried: dict[Any, dict[str, Id]] = field(default_factory=dict)
    made: dict[Any, list[str]] = field(default_factory=dict)
    restored: dict[Any, set[str]] = field(default_factory=dict)
    skins: dict[Id, Id] = field(default_factory=dict)
    scales: dict[Id, Vec3] = field(default_factory=dict)

    # ---- prims -----------------------------------------------------------------------------------------------------------

    def free_path(self, parent: Any, name: str) -> Any:
        """An unused path below a prim for something of this name."""
        valid = valid_name(name)
        path, number = parent.AppendChild(valid), 1
        while self.layer.GetPrimAtPath(path):
            number += 1
            path = parent.AppendChild(f"{valid}_{number}")
        return path

    def define(self, path: Any, kind: str, name: str = "") -> Any:
        """A new prim of this type; prims above it that are not there yet become Xforms. ``name`` is what people call it."""
        spec = Sdf.CreatePrimInLayer(self.layer, path)
        above = spec.nameParent
        while above and above.path != Sdf.Path.absoluteRootPath and above.specifier == Sdf.SpecifierOver:
            above.specifier = Sdf.SpecifierDef
            above.typeName = above.typeName or "Xform"
            above = above.nameParent
        spec.specifier = Sdf.SpecifierDef
        if kind:
            spec.typeName = kind
        if name and name != spec.name:
            spec.SetInfo("displayName", name)
        return spec

    def noted_path(self, key: Id) -> Any | None:
        """The path of the prim that an element was read from, where nothing else stands there yet."""
        noted = self.mechanism.notation(key, words.PATH)
        if noted is None or not Sdf.Path.IsValidPathString(noted):
            return None
        path = Sdf.Path(noted)
        spec = self.layer.GetPrimAtPath(path)
        is_free = not spec or ((spec.specifier == Sdf.SpecifierOver or path not in self.made) and path not in self.carried)
        return path if path.IsAbsoluteRootOrPrimPath() and is_free else None

    def place(self, key: Id, parent: Any, kind: str, name: str | None = None, *, below: bool = False) -> Any:
        """A new prim for an element: at its old path if it has one (for ``below`` only under the parent), else below the parent.

        ``parent`` is a path, or the name of one of our own groups, which is there only when something is in it.
        """
        noted = self.noted_path(key)
        if noted is not None and below and not (noted != parent and noted.HasPrefix(parent)):
            noted = None
        path = noted or self.free_path(self.scope(parent) if isinstance(parent, str) else parent, name or key.name)
        return self.put_prim(key, path, kind, name)

    def put_prim(self, key: Id, path: Any, kind: str, name: str | None = None) -> Any:
        """A new prim at this path for an element."""
        spec = self.define(path, kind, name or key.name)
        self.homes[key] = path
        self.made.setdefault(path, []).extend(["displayName"] if spec.HasInfo("displayName") else [])
        self.carried.setdefault(path, {})[key.kind] = key
        return spec

    def move(self, spec: Any, pose: Pose, scale: Vec3 | None = None, *, on: Id) -> None:
        """Put a prim at a pose in a body's rigid frame, whatever scale the body's prim has."""
        transform(spec, pose, scale, within=self.scales.get(on))

    def shrunk(self, body: Id, point: Vec3) -> Vec3:
        """A point of a body in m, in the scaled space of its prim."""
        scale = self.scales.get(body)
        return point if scale is None else (point[0] / scale[0], point[1] / scale[1], point[2] / scale[2])

    def scope(self, name: str) -> Any:
        """The path of one of our own groups below the robot's prim."""
        path = self.root.AppendChild(name)
        if not self.layer.GetPrimAtPath(path):
            self.define(path, "Scope")
            self.made[path] = ["@spec"]
        return path


def valid_name(name: str) -> str:
    """The name as a prim name: letters of any script, digits and underscores."""
    valid = _INVALID.sub("_", name) or "_"
    valid = valid if Sdf.Path.IsValidIdentifier(valid) else f"_{valid}"
    return valid if Sdf.Path.IsValidIdentifier(valid) else "_" + re.sub(r"[^A-Za-z0-9_]", "_", valid)


# ---- properties ------------------------------------------------------------------------------------------------------------------

T = Sdf.ValueTypeNames
_UNIFORM = frozenset(("physics:axis", "axis", "purpose", "xformOpOrder", "physics:approximation", "subdivisionScheme", "info:id"))


def put(spec: Any, name: str, kind: Any, value: Any) -> None:
    """Author an attribute of this type."""
    attribute = spec.attributes.get(name)
    if attribute is None:
        is_uniform = name in _UNIFORM or name.startswith("mjc:")
        attribute = Sdf.AttributeSpec(spec, name, kind, Sdf.VariabilityUniform if is_uniform else Sdf.VariabilityVarying)
    attribute.default = value


def point(spec: Any, name: str, *targets: Any) -> None:
    """Author a relationship."""
    relationship = spec.relationships.get(name) or Sdf.RelationshipSpec(spec, name, False)
    for target in targets:
        relationship.targetPathList.explicitItems.append(target)


def apply(spec: Any, *schemas: str) -> None:
    """Apply API schemas, known to a plugin or not."""
    present = list(spec.GetInfo("apiSchemas").GetAppliedItems()) if spec.HasInfo("apiSchemas") else []
    wanted = [*present, *(schema for schema in schemas if schema not in present)]
    spec.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=wanted))


def transform(spec: Any, pose: Pose, scale: Vec3 | None = None, *, reset: bool = False, within: Vec3 | None = None) -> None:
    """Author a pose in m (and a scale) as translate, orient and scale ops in double precision.

    ``within`` is the scale of the prim above, which is undone.
    """
    order = [RESET] if reset else []
    if within is not None:
        put(spec, words.WITHIN, T.Double3, Gf.Vec3d(*(1.0 / value for value in within)))
        order.append(words.WITHIN)
    put(spec, "xformOp:translate", T.Double3, Gf.Vec3d(*pose.xyz))
    put(spec, "xformOp:orient", T.Quatd, quatd(pose.quat))
    order += ["xformOp:translate", "xformOp:orient"]
    if scale is not None:
        put(spec, "xformOp:scale", T.Double3, Gf.Vec3d(*scale))
        order.append("xformOp:scale")
    put(spec, "xformOpOrder", T.TokenArray, Vt.TokenArray(order))


def quatd(quat: Quat) -> Any:
    """A quaternion in double precision."""
    return Gf.Quatd(quat[0], Gf.Vec3d(*quat[1:]))


def quatf(quat: Quat) -> Any:
    """A quaternion in single precision."""
    return Gf.Quatf(quat[0], Gf.Vec3f(*quat[1:]))


def put_value(spec: Any, name: str, value: Value) -> None:
    """Author one of our own attributes with the type that keeps its value exactly."""
    if isinstance(value, bool):
        put(spec, name, T.Bool, value)
    elif isinstance(value, int):
        put(spec, name, T.Int64, value)
    elif isinstance(value, float):
        put(spec, name, T.Double, value)
    elif isinstance(value, str):
        put(spec, name, T.String, words.text_without_nul(value))
    elif value and all(isinstance(item, str) for item in value):
        put(spec, name, T.StringArray, Vt.StringArray([words.text_without_nul(str(item)) for item in value]))
    elif value and all(type(item) is int for item in value):
        put(spec, name, T.Int64Array, Vt.Int64Array(list(value)))
    else:
        put(spec, name, T.DoubleArray, Vt.DoubleArray([float(item) for item in value]))
