"""Convex collision shapes instead of concave meshes, which engines fill, refuse or collide slowly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.formats import native_format
from hymeko_x.ir.mechanism import shape_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Body, Mesh, MeshShape, Role
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge, ShapeView
    from hymeko_x.ir.names import Names
    from hymeko_x.meshes.convex import Convex
    from hymeko_x.rewrite.context import Context

Kind = Literal["hull", "decompose"]
_SHOWN = 4


class _New(NamedTuple):
    """What replaces a mesh: the ids of its convex parts, and their volume together as a multiple of the mesh's hull."""

    parts: tuple[Id, ...]
    share: float


def make_collisions_convex(mechanism: Mechanism, kind: Kind, context: Context) -> Mechanism:
    """Every concave mesh that collides is replaced by its convex hull, or by convex parts; what is seen stays. Idempotent.

    A shape that is both seen and touched becomes two. Bodies whose engine computes their masses from these shapes stay as they are.
    """
    names = names_in_use(mechanism)
    meshes: dict[Id, Mesh] = {}
    found: dict[Id, _New | None] = {}
    edges: dict[Id, RobotEdge] = {}
    gone: list[Id] = []
    for view in _colliding(mechanism):
        assert view.mesh is not None
        if view.mesh not in found:
            found[view.mesh] = _convex(mechanism.vertex(view.mesh, Mesh), view.mesh, kind, names, meshes, context)
        new = found[view.mesh]
        if new is None:
            continue
        edges |= _shapes(view, new.parts, names)
        if view.shape.role is Role.BOTH:
            edges[view.id] = replace(mechanism.graph.edges[view.id], data=replace(view.shape, role=Role.VISUAL))
        else:
            gone.append(view.id)
    if not edges:
        context.report.note(codes.FOR_TARGET, f"{context.reason}: no concave mesh collides; nothing is changed", element="mechanism")
        return mechanism
    _report({key: new for key, new in found.items() if new is not None}, kind, context)
    added = [key for key in edges if key not in mechanism.graph.edges]
    return mechanism.replace(vertices=meshes, edges=edges, without=gone).with_note(added, UNNAMED, True)


def _colliding(mechanism: Mechanism) -> list[ShapeView]:
    """The shapes that collide with a mesh, on bodies whose masses are known."""
    is_computed = native_format(mechanism) is not None
    return [
        view
        for view in mechanism.every_shape()
        if isinstance(view.shape.geometry, MeshShape) and view.mesh is not None and view.shape.role is not Role.VISUAL
        if not (is_computed and isinstance(body := mechanism.graph.vertices.get(view.body), Body) and body.inertial is None)
    ]


def _convex(mesh: Mesh, key: Id, kind: Kind, names: Names, meshes: dict[Id, Mesh], context: Context) -> _New | None:
    """The convex parts of a mesh, which are added to ``meshes``; None where it is convex, flat or not there."""
    from hymeko_x.meshes.convex import hull_of, is_convex, parts_of
    from hymeko_x.meshes.reader import triangles_of

    part = triangles_of(mesh, context.files)
    if part is None or is_convex(part):
        return None
    hull = hull_of(part, mesh.scale)
    if hull is None:
        return None
    solids: list[Convex] = [hull] if kind == "hull" else parts_of(part, mesh.scale)
    stem = mesh.name or file_stem(mesh.uri or "") or key.name
    ids = []
    for number, solid in enumerate(solids, 1):
        name = f"{stem}_hull" if kind == "hull" else f"{stem}_part_{number}"
        taken = names.take("mesh", name)
        meshes[taken] = Mesh(name=taken.name, vertices=solid.vertices, faces=solid.faces)
        ids.append(taken)
    return _New(tuple(ids), sum(solid.volume for solid in solids) / hull.volume)


def _shapes(view: ShapeView, parts: tuple[Id, ...], names: Names) -> dict[Id, RobotEdge]:
    """A shape for each part, where the replaced one was."""
    shape = replace(view.shape, role=Role.COLLISION, rgba=None, mass=None, density=None)
    return {names.take("shape", part.name): shape_edge(replace(shape, name=None), view.body, view.pose, part) for part in parts}


def _report(found: dict[Id, _New], kind: Kind, context: Context) -> None:
    meshes = counted(len(found), "concave collision mesh", "concave collision meshes")
    if kind == "hull":
        shown = listed([_named(key) for key in found], _SHOWN)
        text = f"{meshes} replaced by convex hulls: {shown}"
    else:
        shown = listed([f"{_named(key)} {len(new.parts)} ({new.share:.0%} of its hull)" for key, new in found.items()], _SHOWN)
        text = f"{meshes} replaced by {sum(len(new.parts) for new in found.values())} convex parts: {shown}"
    context.report.note(codes.FOR_TARGET, f"{context.reason}: {text}", element=str(next(iter(found))))


def _named(mesh: Id) -> str:
    return f"'{mesh.name.partition('#')[0]}'"
