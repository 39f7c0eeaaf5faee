"""A layer in the making: prims at valid, unique paths, attributes with their types, all authored through Sdf."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pxr import Gf, Sdf, Vt

from hymeko_x.backends.usd.prims import Prim, T
from hymeko_x.formats import usd as words

if TYPE_CHECKING:
    from hymeko_x.backends.usd.surfaces import Surface
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.values import Pose, Quat, Vec3

_INVALID = re.compile(r"\W")
RESET = "!resetXformStack!"


@dataclass(slots=True)
class Sheet:
    """The layer, and where each element's prim is: ``homes`` by id, ``dofs`` the prim of each dof of a joint.

    ``placed`` are the prims that stand for elements, ``groups`` those that hold them. ``skins`` is the shape of each body whose
    own prim is its geometry, ``scales`` the scale of such a prim.
    """

    mechanism: Mechanism
    layer: Any
    root: Any
    homes: dict[Id, Any] = field(default_factory=dict)
    dofs: dict[tuple[Id, int], tuple[Any, str]] = field(default_factory=dict)
    placed: set[Any] = field(default_factory=set)
    groups: set[Any] = field(default_factory=set)
    prims: dict[Any, Prim] = field(default_factory=dict)
    skins: dict[Id, Id] = field(default_factory=dict)
    scales: dict[Id, Vec3] = field(default_factory=dict)
    surfaces: dict[Id, Surface | None] = field(default_factory=dict)

    # ---- prims -----------------------------------------------------------------------------------------------------------

    def free_path(self, parent: Any, name: str) -> Any:
        """An unused path below a prim for something of this name."""
        valid = valid_name(name)
        path, number = parent.AppendChild(valid), 1
        while path in self.prims:
            number += 1
            path = parent.AppendChild(f"{valid}_{number}")
        return path

    def define(self, path: Any, kind: str, name: str = "") -> Prim:
        """A new prim of this type; prims above it that are not there yet become Xforms. ``name`` is what people call it."""
        if path.GetParentPath() not in self.prims:
            for above in path.GetPrefixes()[:-1]:
                self.prims.setdefault(above, Prim(above))
        prim = self.prims.setdefault(path, Prim(path))
        prim.kind = kind
        if name and name != path.name:
            prim.info["displayName"] = name
        return prim

    def is_made(self, path: Any) -> bool:
        """Whether a prim is there for an element or a group of ours, not only because something is below it."""
        return path in self.placed or path in self.groups

    def noted_path(self, key: Id) -> Any | None:
        """The path of the prim that an element was read from, where nothing else stands there yet."""
        noted = self.mechanism.notation(key, words.PATH)
        if noted is None or not Sdf.Path.IsValidPathString(noted):
            return None
        path = Sdf.Path(noted)
        is_free = path not in self.prims or not self.is_made(path)
        return path if path.IsAbsoluteRootOrPrimPath() and is_free else None

    def place(self, key: Id, parent: Any, kind: str, name: str | None = None, *, below: bool = False) -> Prim:
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
        return self.put_prim(key, path, kind, own)

    def put_prim(self, key: Id, path: Any, kind: str, name: str | None = None) -> Prim:
        """A new prim at this path for an element."""
        prim = self.define(path, kind, name or key.name)
        self.homes[key] = path
        self.placed.add(path)
        return prim

    def move(self, prim: Prim, pose: Pose, scale: Vec3 | None = None, *, on: Id) -> None:
        """Put a prim at a pose in a body's rigid frame, whatever scale the body's prim has."""
        transform(prim, pose, scale, within=self.scales.get(on))

    def shrunk(self, body: Id, point: Vec3) -> Vec3:
        """A point of a body in m, in the scaled space of its prim."""
        scale = self.scales.get(body)
        return point if scale is None else (point[0] / scale[0], point[1] / scale[1], point[2] / scale[2])

    def scope(self, name: str) -> Any:
        """The path of one of our own groups below the robot's prim."""
        path = self.root.AppendChild(name)
        if path not in self.prims:
            self.define(path, "Scope")
            self.groups.add(path)
        return path


def valid_name(name: str) -> str:
    """The name as a prim name: letters of any script, digits and underscores."""
    valid = _INVALID.sub("_", name) or "_"
    valid = valid if Sdf.Path.IsValidIdentifier(valid) else f"_{valid}"
    return valid if Sdf.Path.IsValidIdentifier(valid) else "_" + re.sub(r"[^A-Za-z0-9_]", "_", valid)


# ---- properties ------------------------------------------------------------------------------------------------------------------


def put(prim: Prim, name: str, kind: Any, value: Any) -> None:
    """An attribute of this type; without a value it is there to be connected to."""
    prim.attributes[name] = kind, value


def connect(prim: Prim, name: str, kind: Any, source: Prim, output: str) -> None:
    """An attribute that takes the value of another prim's."""
    put(prim, name, kind, None)
    prim.connections[name] = source.path.AppendProperty(output)


def point(prim: Prim, name: str, *targets: Any) -> None:
    """A relationship with these targets, after those that it has."""
    prim.targets.setdefault(name, []).extend(targets)


def apply(prim: Prim, *schemas: str) -> None:
    """Apply API schemas, known to a plugin or not."""
    prim.schemas.extend(schema for schema in schemas if schema not in prim.schemas)


def transform(prim: Prim, pose: Pose, scale: Vec3 | None = None, *, reset: bool = False, within: Vec3 | None = None) -> None:
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
