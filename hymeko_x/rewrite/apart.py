"""Joints that are called apart from links, for programs that look both up in one table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.ir.mechanism import WORLD, Id
from hymeko_x.ir.names import free_name, rename
from hymeko_x.ir.parts import Body, Coupling, Drive, Joint, Sense, Tendon
from hymeko_x.rewrite.references import with_references

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context

_SHOWN = 4


def call_joints_apart(mechanism: Mechanism, context: Context) -> Mechanism:
    """A joint, or one of its dofs, that is called as a link is gets ``_joint`` behind its name."""
    links = _links(mechanism)
    taken = links | {name for view in mechanism.joints.values() for name in (view.id.name, *(dof.name for dof in view.joint.dofs)) if name}
    joints = names_apart(mechanism, taken)
    dofs: dict[Id, dict[str, str]] = {}
    for view in mechanism.joints.values():
        for dof in view.joint.dofs:
            if dof.name in links:
                assert dof.name is not None
                dofs.setdefault(view.id, {})[dof.name] = _new(dof.name, taken)
    changed = {key.name: new.name for key, new in joints.items()} | {old: new for names in dofs.values() for old, new in names.items()}
    if not changed:
        return mechanism
    shown = listed([f"'{old}' is '{new}'" for old, new in changed.items()], _SHOWN)
    message = f"{counted(len(changed), 'joint')} renamed apart from the links of the same name ({context.reason}): {shown}"
    context.report.note(codes.FOR_TARGET, message, element=str(next(iter(joints or dofs))))
    return with_references(rename(_with_dof_names(mechanism, dofs), joints), joints)


def names_apart(mechanism: Mechanism, taken: set[str]) -> dict[Id, Id]:
    """The joints that are called as a link is, with names of their own, which are ``taken`` then."""
    links = _links(mechanism)
    return {key: Id("joint", _new(key.name, taken)) for key in mechanism.joints if key.name in links}


def _links(mechanism: Mechanism) -> set[str]:
    return {key.name for key, _ in mechanism.vertices(Body)} | {WORLD.name}


def _new(name: str, taken: set[str]) -> str:
    new = free_name(f"{name}_joint", taken.__contains__, "_")
    taken.add(new)
    return new


def _with_dof_names(mechanism: Mechanism, dofs: dict[Id, dict[str, str]]) -> Mechanism:
    """The mechanism with these dofs under new names, by joint and old name, also where they are referred to."""
    edges: dict[Id, RobotEdge] = {}
    for key, edge in mechanism.graph.edges.items() if dofs else ():
        data = edge.data
        if isinstance(data, Joint) and key in dofs:
            named = [replace(dof, name=dofs[key].get(dof.name or "", dof.name)) for dof in data.dofs]
            edges[key] = replace(edge, data=Joint(tuple(named)))
        elif isinstance(data, Coupling | Drive | Sense | Tendon) and any(arc.target in dofs for arc in edge.arcs):
            arcs = [replace(arc, role=dofs.get(arc.target, {}).get(arc.role, arc.role)) for arc in edge.arcs]
            edges[key] = replace(edge, arcs=tuple(arcs))
    return mechanism.replace(edges=edges)
