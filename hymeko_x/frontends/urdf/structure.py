"""Whether links and joints are a tree; no links, two parents, several roots and cycles are reported. Changes nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import listed
from hymeko_x.ir.parts import Body, Joint

if TYPE_CHECKING:
    from hymeko_x.frontends.urdf.builder import UrdfBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.xml.tree import XmlNode


def check_structure(root: XmlNode, builder: UrdfBuilder, *, is_whole: bool) -> None:
    """Report everything that keeps the links and joints from being one tree. Linear, not recursive.

    ``is_whole``: nothing is kept for the file, which may be all of a system without links.
    """
    bodies = [key for key, part in builder.vertices.items() if isinstance(part, Body)]
    if not bodies and is_whole:
        builder.report.error(codes.MISSING_PART, "the robot has no links; the result has no bodies", root.origin)
        return
    parents: dict[Id, list[Id]] = {}
    children: dict[Id, list[Id]] = {}
    for joint, parent, child in _joints(builder):
        parents.setdefault(child, []).append(joint)
        children.setdefault(parent, []).append(child)
    _check_parents(parents, builder)
    roots = [body for body in bodies if body not in parents]
    _check_roots(root, roots, builder)
    _check_reach(bodies, roots, children, builder)


def _joints(builder: UrdfBuilder) -> list[tuple[Id, Id, Id]]:
    return [(key, edge.arcs[0].target, edge.arcs[1].target) for key, edge in builder.edges.items() if isinstance(edge.data, Joint)]


def _check_parents(parents: dict[Id, list[Id]], builder: UrdfBuilder) -> None:
    for child, joints in parents.items():
        if len(joints) < 2:
            continue
        names = ", ".join(f"'{joint.name}'" for joint in joints)
        builder.report.error(
            codes.TWO_PARENTS,
            f"link '{child.name}' is the child of {len(joints)} joints ({names}); all are kept, the first one gives its place in the tree",
            builder.origins[joints[1]],
            element=str(child),
            hint="urdfdom lets the last one win, MuJoCo refuses the file",
        )


def _check_roots(root: XmlNode, roots: list[Id], builder: UrdfBuilder) -> None:
    if len(roots) < 2:
        return
    names = listed([f"'{body.name}'" for body in roots], 5)
    builder.report.warn(
        codes.SEVERAL_ROOTS,
        f"{len(roots)} links have no parent joint ({names}); each is kept as the root of a tree of its own",
        root.origin,
        hint="urdfdom refuses such a file",
    )


def _check_reach(bodies: list[Id], roots: list[Id], children: dict[Id, list[Id]], builder: UrdfBuilder) -> None:
    """Bodies that no root leads to form cycles."""
    reached = set(roots)
    stack = list(roots)
    while stack:
        fresh = [child for child in children.get(stack.pop(), ()) if child not in reached]
        reached.update(fresh)
        stack.extend(fresh)
    lost = [body for body in bodies if body not in reached]
    if not lost:
        return
    builder.report.error(
        codes.CYCLE,
        f"no root leads to link '{lost[0].name}'"
        + (f" and {len(lost) - 1} more" if len(lost) > 1 else "")
        + ": their joints form a cycle, which is kept",
        builder.origins[lost[0]],
        element=str(lost[0]),
    )
