"""Filtered pairs of bodies, and physics materials for the friction of colliders."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.backends.usd.sheet import T, apply, point, put
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd.contacts import BY_GROUPS, GROUPED
from hymeko_x.ir.parts import Contact, Role

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet, WrittenPrim

_BINDING = "material:binding:physics"


def write_contacts(sheet: UsdSheet) -> None:
    """Pairs of bodies that do not collide, on the first of them; each prim carries one of its pairs. Collision groups contain others."""
    first: set[Any] = set()
    for key, contact, arcs in sheet.mechanism.edges(Contact):
        paths = [sheet.paths.get(arc.target) for arc in arcs if arc.target.kind == "body"]
        if contact.kind != "exclude" or sheet.mechanism.notation(key, GROUPED) == BY_GROUPS:
            continue
        if len(paths) != 2 or None in paths:
            continue
        spec = sheet.prims[paths[0]]
        apply(spec, "PhysicsFilteredPairsAPI")
        point(spec, "physics:filteredPairs", paths[1])
        if spec.path not in first:
            first.add(spec.path)
            sheet.paths[key] = spec.path


def write_frictions(sheet: UsdSheet) -> None:
    """One physics material for all colliders of one friction; those that had a material of their own keep that."""
    users: dict[tuple[float, ...], list[WrittenPrim]] = {}
    for view in sheet.mechanism.every_shape():
        extras = sheet.mechanism.extras.get(view.id, ())
        is_bound = any(extra.format == words.FORMAT and _BINDING in extra.text for extra in extras)
        if view.shape.friction and view.shape.role is not Role.VISUAL and not is_bound and view.id in sheet.paths:
            users.setdefault(view.shape.friction, []).append(sheet.prims[sheet.paths[view.id]])
    for friction, specs in users.items():
        material = _write_material(sheet, friction, "friction" if len(users) == 1 else f"friction_{friction[0]:g}")
        for spec in specs:
            apply(spec, "MaterialBindingAPI")
            point(spec, _BINDING, material)


def _write_material(sheet: UsdSheet, friction: tuple[float, ...], name: str) -> Any:
    """Sliding friction for UsdPhysics, torsional and rolling friction for MuJoCo and Newton."""
    scope = sheet.scope("frictions")
    put(sheet.prims[scope], f"{words.PREFIX}scope", T.Bool, True)
    sheet.group_paths.discard(scope)
    spec = sheet.define(sheet.free_path(scope, name), "Material")
    apply(spec, "PhysicsMaterialAPI")
    put(spec, "physics:staticFriction", T.Float, friction[0])
    put(spec, "physics:dynamicFriction", T.Float, friction[0])
    if sheet.is_neutral:
        put(spec, "physics:restitution", T.Float, 0.0)
    for value, mjc, newton in zip(friction[1:3], ("torsional", "rolling"), ("torsional", "rolling"), strict=False):
        apply(spec, "MjcMaterialAPI", "NewtonMaterialAPI")
        put(spec, f"mjc:{mjc}friction", T.Double, value)
        put(spec, f"newton:{newton}Friction", T.Float, value)
    return spec.path
