"""Names that SDF accepts: elements beside each other have different ones, and ``::``, ``__`` and ``world`` have a meaning.

Source: libsdformat, Element::HasUniqueChildNames, which passes over plugins alone.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.sdf.nesting import nesting_of
from hymeko_x.diagnostics import listed
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.ir.mechanism import WORLD, Id
from hymeko_x.ir.names import free_name, names_in_use, rename
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Camera, DofKind, Light, Sense, Sensor
from hymeko_x.xml.text import unescaped

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from hymeko_x.ir.mechanism import Mechanism, RobotEdge, ShapeView
    from hymeko_x.ir.parts import Role
    from hymeko_x.rewrite.context import Context

_NAMED = re.compile(r"<(?!plugin\b)[^\s/>]+\b[^>]*?\sname=([\"'])(.*?)\1")
_MEANING = "names are unique in a {}, and '::', '__' and 'world' have a meaning"


def _free_of_marks(name: str, kind: str) -> str:
    """The name without ``::``; the kind stands before one that is reserved."""
    name = name.replace(words.SCOPE, "_")
    is_reserved = (name.startswith("__") and name.endswith("__")) or name == words.WORLD_FRAME
    return f"{kind}_{name.strip('_')}" if is_reserved else name


# ---- models ------------------------------------------------------------------------------------------------------------------


def make_names_unique_in_models(mechanism: Mechanism, context: Context) -> Mechanism:
    """Links, frames and joints of a model have different names; ``::`` only stands between a model and what is in it."""
    renamed: dict[Id, Id] = {}
    nesting = nesting_of(mechanism)
    taken = {scope.removesuffix(words.SCOPE) for scope in nesting.models}
    unwritten = _unwritten(mechanism) | {*nesting.models.values()}
    is_from_sdf = notations.is_from_sdf(mechanism)
    order = ("body", "joint", "loop", "frame")
    named = [key for key in (*mechanism.graph.vertices, *mechanism.graph.edges) if key.kind in order]
    for key in sorted(named, key=lambda key: order.index(key.kind)):
        if key in unwritten or (is_from_sdf and mechanism.notation(key, notations.SHARED)):
            continue
        scope = nesting.scope_of(key)
        wanted = key.name if is_from_sdf else scope + _free_of_marks(key.name.removeprefix(scope), key.kind)
        name = free_name(wanted if wanted not in taken else f"{wanted}_{key.kind}", taken.__contains__, "_")
        taken.add(name)
        if name != key.name:
            renamed[key] = Id(key.kind, name)
            message = f"{key} is written as '{name}': {_MEANING.format('model')}"
            context.report.note(codes.RENAMED, message, mechanism.origin(key), element=str(renamed[key]))
    return rename(mechanism, renamed)


def _unwritten(mechanism: Mechanism) -> frozenset[Id]:
    """The joints to the world that stay without a name in the file: those of bases that float, or of a robot in which nothing moves."""
    views = mechanism.joints.values()
    nameless = [view for view in views if view.parent == WORLD and mechanism.notation(view.id, UNNAMED) is not None]
    free = [view.id for view in views if view.parent == WORLD and [dof.kind for dof in view.joint.dofs] == [DofKind.FREE]]
    stands = not any(view.joint.dofs for view in views) and all(view in nameless for view in views if view.parent == WORLD)
    implied = [view.id for view in views if mechanism.notation(view.id, notations.IMPLIED)]
    return frozenset([*free, *implied, *(view.id for view in nameless if stands)])


# ---- links -------------------------------------------------------------------------------------------------------------------


def make_names_unique_on_links(mechanism: Mechanism, context: Context) -> Mechanism:
    """Visuals, collisions, sensors and lights of a link have different names; of two that share one, the later one gets its kind behind it.

    Sensors come first, because programs know them by name; then come visuals, and collisions.
    """
    renamed = _renamed_mounts(mechanism)
    mechanism = rename(mechanism, renamed)
    mounted = _mounted(mechanism)
    edges: dict[Id, RobotEdge] = {}
    names: list[str] = []
    for body, views in mechanism.shapes.items():
        beside = (*_names_beside(mechanism, body), *(words.split_scope(key.name)[1] for key in mounted.get(body, ())))
        if not beside and all(view.shape.name is None for view in views):
            continue
        for view, name in _renamed_shapes(views, dict.fromkeys(beside, ""), mechanism):
            edges[view.id] = replace(mechanism.graph.edges[view.id], data=replace(view.shape, name=name))
            names.append(f"'{name}'")
    for old, new in renamed.items():
        message = f"{old} is written as '{new.name}': {_MEANING.format('link')}"
        context.report.note(codes.RENAMED, message, mechanism.origin(new), element=str(new))
    if not edges:
        return mechanism
    context.report.note(codes.RENAMED, f"{len(names)} shapes get another name: {_MEANING.format('link')}: {listed(names, 5)}")
    return mechanism.replace(edges=edges)


def _renamed_mounts(mechanism: Mechanism) -> dict[Id, Id]:
    """The new ids of sensors, cameras and lights whose names something on the same link or joint has, or that SDF refuses."""
    renamed: dict[Id, Id] = {}
    names = names_in_use(mechanism)
    is_from_sdf = notations.is_from_sdf(mechanism)
    for holder, elements in _mounted(mechanism).items():
        scope = words.split_scope(holder.name)[0]
        taken = _names_beside(mechanism, holder)
        for key in elements:
            inside = scope if key.name.startswith(scope) else ""
            own = key.name.removeprefix(inside)
            wanted = own if is_from_sdf else _free_of_marks(own, key.kind)
            if wanted in taken and not mechanism.notation(key, notations.SHARED):
                wanted = free_name(f"{wanted}_{key.kind}", taken.__contains__, "_")
            if wanted != own:
                renamed[key] = names.take(key.kind, inside + wanted, "_")
                wanted = renamed[key].name.removeprefix(inside)
            taken.add(wanted)
    return renamed


def _mounted(mechanism: Mechanism) -> dict[Id, list[Id]]:
    """The sensors, cameras and lights on each link, each joint and the world."""
    found: dict[Id, list[Id]] = {}
    for body, views in mechanism.mounts.items():
        elements = [view.mounted for view in views if _is_written(mechanism, view.mounted)]
        if elements:
            found[body] = elements
    for _, _, arcs in mechanism.edges(Sense):
        ends = [arc.target for arc in arcs if arc.sign > 0 and arc.target.kind in ("joint", "loop")]
        for arc in arcs:
            if ends and arc.sign < 0 and _is_written(mechanism, arc.target):
                found.setdefault(ends[0], []).append(arc.target)
    return found


def _is_written(mechanism: Mechanism, key: Id) -> bool:
    part = mechanism.graph.vertices.get(key)
    return isinstance(part, Camera | Light) or (isinstance(part, Sensor) and part.kind in words.SENSORS)


def _names_beside(mechanism: Mechanism, key: Id) -> set[str]:
    """The names of the elements that a link or joint holds as they were written; beside a light of the world stands the model."""
    texts = [extra.text for extra in mechanism.extras.get(key, ()) if extra.format == words.FORMAT and not extra.path]
    found = [match for match in map(_NAMED.match, texts) if match is not None]
    return {*(unescaped(match[2]) for match in found), *((mechanism.name,) if key == WORLD else ())}


def _renamed_shapes(views: Iterable[ShapeView], taken: dict[str, str], mechanism: Mechanism) -> Iterator[tuple[ShapeView, str]]:
    """The shapes of a link that get another name. ``taken`` has the names on the link, with the tags of shapes; it grows.

    Shapes without a name get theirs from their place, after all others.
    """
    is_from_sdf = notations.is_from_sdf(mechanism)
    by_tag = [(tag, number, view) for tag, role in words.ROLES.items() for number, view in enumerate(_of(views, role), 1)]
    for tag, _, view in by_tag:
        own = view.shape.name
        if own is None:
            continue
        wanted = own if is_from_sdf else _free_of_marks(own or tag, tag)
        is_kept = mechanism.notation(view.id, notations.SHARED)
        behind = "" if taken.get(wanted, tag) == tag or wanted.endswith(f"_{tag}") else f"_{tag}"
        name = wanted if is_kept else free_name(wanted + behind, taken.__contains__, "_")
        taken[name] = tag
        if name != own:
            yield view, name
    for tag, number, view in by_tag:
        usual = words.shape_name(tag, number)
        if view.shape.name is None:
            name = usual if usual not in taken or mechanism.notation(view.id, notations.SHARED) else free_name(tag, taken.__contains__, "_")
            taken[name] = tag
            if name != usual:
                yield view, name


def _of(views: Iterable[ShapeView], role: Role) -> list[ShapeView]:
    return [view for view in views if view.shape.role is role]
