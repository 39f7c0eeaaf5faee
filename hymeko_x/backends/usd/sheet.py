"""The open layer of the writer: prims at valid, unique paths, authored through Sdf when all of them are known.

Every call into USD costs more than all that Python does for a property; so prims are plain values until they are authored,
each property once.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field
from pxr import Gf, Sdf, Tf, Vt

from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import FAMILY
from hymeko_x.ir.kinematics import dof_at
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.names import free_name
from hymeko_x.ir.parts import DofKind
from hymeko_x.ir.values import IDENTITY

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc
    from hymeko_x.ir.parts import Dof
    from hymeko_x.ir.values import Pose, Quat, Vec3

T = Sdf.ValueTypeNames

if TYPE_CHECKING:
    Triangles = tuple[NDArray[Any], NDArray[Any]]
    """Points (n, 3) in single precision, and the corners of triangles as rows of them (flat)."""
_UNIFORM = frozenset(
    (
        *("physics:axis", "axis", "purpose", "xformOpOrder", "physics:approximation", "subdivisionScheme", "info:id"),
        *("elementType", "familyName", FAMILY),
    )
)


class WrittenPrim(Struct, eq=False):
    """A prim in the making: its type, metadata, API schemas, attributes (type and value), and the targets of its relationships.

    ``connections`` lead an attribute to that whose value it takes; ``interpolation`` are the attributes with values
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
    interpolation: dict[str, str] = field(default_factory=dict)
    reference: Any = None

    @property
    def name(self) -> str:
        """The last step of the path."""
        return str(self.path.name)


def author(prims: Iterable[WrittenPrim], layer: Any) -> None:
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
            if name in prim.interpolation:
                attribute.SetInfo("interpolation", prim.interpolation[name])
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


_INVALID = re.compile(r"\W")
RESET = "!resetXformStack!"
_GROUPED: Mapping[str, tuple[str, ...]] = MappingProxyType({"joints": ("joint", "loop")})
"""The kinds of elements in a group, which may be in a prim of the author's."""


class UsdSheet(Struct):
    """The open layer. ``paths`` are the paths of the prims of elements by id, ``dofs`` the prim and axis of each dof of a joint.

    ``element_paths`` are the paths of prims that represent elements, ``group_paths`` of those that contain them, ``groups``
    by their names. ``body_shapes`` is the shape of each body whose own prim is its geometry, ``body_scales`` the scale of such a prim.
    ``is_nested``: whether each body is inside of its parent.
    """

    mechanism: Mechanism
    layer: Any
    root: Any
    is_nested: bool = False
    paths: dict[Id, Any] = field(default_factory=dict)
    dofs: dict[tuple[Id, int], tuple[Any, str]] = field(default_factory=dict)
    element_paths: set[Any] = field(default_factory=set)
    group_paths: set[Any] = field(default_factory=set)
    groups: dict[str, Any] = field(default_factory=dict)
    prims: dict[Any, WrittenPrim] = field(default_factory=dict)
    body_shapes: dict[Id, Id] = field(default_factory=dict)
    body_scales: dict[Id, Vec3] = field(default_factory=dict)
    triangles: dict[Id, Triangles | None] = field(default_factory=dict)

    @property
    def is_neutral(self) -> bool:
        """Whether the stage follows REP 158, with every value in its neutral form."""
        return self.mechanism.notation(ROOT, words.PROFILE) == words.REP_158

    # ---- prims -----------------------------------------------------------------------------------------------------------

    def free_path(self, parent: Any, name: str) -> Any:
        """An unused path below a prim for something of this name."""
        return parent.AppendChild(free_name(valid_name(name), lambda free: parent.AppendChild(free) in self.prims, "_"))

    def define(self, path: Any, kind: str, name: str = "") -> WrittenPrim:
        """A new prim of this type; missing ancestors become Xforms. ``name`` is the display name."""
        if path.GetParentPath() not in self.prims:
            for above in path.GetPrefixes()[:-1]:
                self.prims.setdefault(above, WrittenPrim(above))
        prim = self.prims.setdefault(path, WrittenPrim(path))
        prim.kind = kind
        if name and name != path.name:
            prim.info["displayName"] = name
        return prim

    def is_made(self, path: Any) -> bool:
        """Whether a prim represents an element or is a group of the writer's, and not only an ancestor of one."""
        return path in self.element_paths or path in self.group_paths

    def noted_path(self, key: Id) -> Any | None:
        """The path of the prim that an element was read from, where it is free."""
        noted = self.mechanism.notation(key, words.PATH)
        if noted is None or len(noted) != 1 or not Sdf.Path.IsValidPathString(noted[0]):
            return None
        path = Sdf.Path(noted[0])
        is_free = path not in self.prims or not self.is_made(path)
        return path if path.IsAbsoluteRootOrPrimPath() and is_free else None

    def add_prim(self, key: Id, parent: Any, kind: str, name: str | None = None, *, below: bool = False) -> WrittenPrim:
        """A new prim for an element: at its old path if it has one (for ``below`` only under the parent), else below the parent.

        ``parent`` is a path, or the name of one of our own groups, which is there only when something is in it.
        """
        noted = self.noted_path(key)
        if noted is not None and below and not (noted != parent and noted.HasPrefix(parent)):
            noted = None
        path = noted or self.free_path(self.scope(parent) if isinstance(parent, str) else parent, name or key.name)
        own = name or key.name
        if noted is not None and own.partition("#")[0] == noted.name:  # the second prim of that name
            own = noted.name
        return self.add_prim_at(key, path, kind, own)

    def add_prim_at(self, key: Id, path: Any, kind: str, name: str | None = None) -> WrittenPrim:
        """A new prim at this path for an element."""
        prim = self.define(path, kind, name or key.name)
        self.paths[key] = path
        self.element_paths.add(path)
        return prim

    def set_pose(self, prim: WrittenPrim, pose: Pose, scale: Vec3 | None = None, *, on: Id) -> None:
        """Put a prim at a pose in a body's rigid frame, whatever scale the body's prim has; one in that frame has no ops."""
        within = self.body_scales.get(on)
        if pose != IDENTITY or scale is not None or within is not None:
            transform(prim, pose, scale, within=within)

    def in_prim_space(self, body: Id, point: Vec3) -> Vec3:
        """A point of a body in m, in the scaled space of its prim."""
        scale = self.body_scales.get(body)
        return point if scale is None else (point[0] / scale[0], point[1] / scale[1], point[2] / scale[2])

    def scope(self, name: str) -> Any:
        """The path of a group: the author's, where all of its elements are in one, else the writer's below the robot's prim."""
        if name not in self.groups:
            self.groups[name] = self.authors_group(*_GROUPED.get(name, ())) or self._own_group(name)
        return self.groups[name]

    def _own_group(self, name: str) -> Any:
        path = self.root.AppendChild(name)
        if path not in self.prims:
            self.define(path, "Scope")
            self.group_paths.add(path)
        return path

    def authors_group(self, *kinds: str) -> Any | None:
        """The robot's prim, or one below, in which its author has all elements of these kinds; None where there is none but elements."""
        if not kinds or self.mechanism.notation(ROOT, words.ROOT_PRIM) is None:
            return None
        graph = self.mechanism.graph
        noted = {key: self.mechanism.notation(key, words.PATH) or () for key in (*graph.vertices, *graph.edges)}
        taken = {text for texts in noted.values() for text in texts}
        above = {text.rpartition("/")[0] for key, texts in noted.items() if key.kind in kinds for text in texts}
        group = above.pop() if len(above) == 1 else ""
        is_inside = f"{group}/".startswith(f"{self.root}/") and Sdf.Path.IsValidPathString(group)
        return Sdf.Path(group) if is_inside and group not in taken else None


def parsed_layer(text: str) -> Any | None:
    """A layer of this text; None where that is not USD."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    try:
        return layer if layer.ImportFromString(text) else None
    except Tf.ErrorException:
        return None


def valid_name(name: str) -> str:
    """The name as a prim name: letters of any script, digits and underscores."""
    valid = _INVALID.sub("_", name) or "_"
    valid = valid if Sdf.Path.IsValidIdentifier(valid) else f"_{valid}"
    return valid if Sdf.Path.IsValidIdentifier(valid) else "_" + re.sub(r"[^A-Za-z0-9_]", "_", valid)


# ---- properties ------------------------------------------------------------------------------------------------------------------


def put(prim: WrittenPrim, name: str, kind: Any, value: Any) -> None:
    """An attribute of this type; without a value it is there to be connected to."""
    prim.attributes[name] = kind, value


def connect(prim: WrittenPrim, name: str, kind: Any, source: WrittenPrim, output: str) -> None:
    """An attribute that takes the value of another prim's."""
    put(prim, name, kind, None)
    prim.connections[name] = source.path.AppendProperty(output)


def point(prim: WrittenPrim, name: str, *targets: Any) -> None:
    """A relationship with these targets, after those that it has."""
    prim.targets.setdefault(name, []).extend(targets)


def apply(prim: WrittenPrim, *schemas: str) -> None:
    """Apply API schemas, with or without a plugin."""
    prim.schemas.extend(schema for schema in schemas if schema not in prim.schemas)


def transform(prim: WrittenPrim, pose: Pose, scale: Vec3 | None = None, *, reset: bool = False, within: Vec3 | None = None) -> None:
    """Author a pose in m (and a scale) as translate, orient and scale ops in double precision.

    ``within`` is the scale of the prim above, which is undone.
    """
    order = [RESET] if reset else []
    if within is not None:
        put(prim, words.WITHIN, T.Double3, Gf.Vec3d(*(1.0 / value for value in within)))
        order.append(words.WITHIN)
    put(prim, "xformOp:translate", T.Double3, Gf.Vec3d(*pose.xyz))
    put(prim, "xformOp:orient", T.Quatd, quatd(pose.quat))
    order += ["xformOp:translate", "xformOp:orient"]
    if scale is not None:
        put(prim, "xformOp:scale", T.Double3, Gf.Vec3d(*scale))
        order.append("xformOp:scale")
    put(prim, "xformOpOrder", T.TokenArray, Vt.TokenArray(order))


def quatd(quat: Quat) -> Any:
    """A quaternion in double precision."""
    return Gf.Quatd(quat[0], Gf.Vec3d(*quat[1:]))


def quatf(quat: Quat) -> Any:
    """A quaternion in single precision."""
    return Gf.Quatf(quat[0], Gf.Vec3f(*quat[1:]))


# ---- prims of joints and their dofs --------------------------------------------------------------------------------------------------


def dof_of(sheet: UsdSheet, arc: RobotArc) -> tuple[Any, str, Dof] | None:
    """The prim of the dof that an arc means, its axis where that is a generic joint, and the dof itself (hinge or slide)."""
    found = dof_at(sheet.mechanism.graph.edges, arc)
    if found is None or found[1].kind not in (DofKind.HINGE, DofKind.SLIDE):
        return None
    place = sheet.dofs.get((arc.target, found[0]))
    return None if place is None else (sheet.prims[place[0]], place[1], found[1])


def prim_of(sheet: UsdSheet, arc: RobotArc) -> Any | None:
    """The path of the prim of an arc's target: of one dof where a joint has several; None where that is an axis of a generic joint."""
    if arc.target.kind != "joint":
        return sheet.paths.get(arc.target)
    found = dof_of(sheet, arc)
    return found[0].path if found is not None and not found[1] else None
