"""How a robot looks as text: one line, and a tree of at most 40 lines."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism

MOST_LINES = 40
_FREEDOMS = {"ball": 3, "free": 6}


def one_line(mechanism: Mechanism) -> str:
    """``<Robot 'panda': 12 bodies, 11 joints (9 dofs), from panda.urdf>``."""
    bodies = sum(1 for _ in mechanism.vertices(Body))
    source = f", from {posixpath.basename(mechanism.source.file)}" if mechanism.source.file else ""
    return f"<Robot '{mechanism.name}': {bodies} bodies, {len(mechanism.joints)} joints ({freedoms(mechanism)} dofs){source}>"


def freedoms(mechanism: Mechanism) -> int:
    """The number of degrees of freedom of all joints, 3 of a ball and 6 of a free joint."""
    return sum(_FREEDOMS.get(dof.kind.value, 1) for view in mechanism.joints.values() for dof in view.joint.dofs)


def tree(mechanism: Mechanism) -> str:
    """The first line, then the bodies by depth with the joints that lead to them; what does not fit is counted."""
    lines = [one_line(mechanism)[1:-1]]
    depth: dict[Id, int] = {WORLD: 0}
    if mechanism.children.get(WORLD):
        lines.append("world")
    bodies = list(mechanism.depth_first())
    shown = bodies if len(lines) + len(bodies) <= MOST_LINES else bodies[: MOST_LINES - len(lines) - 1]
    for body in shown:
        above = mechanism.parent_joint.get(body)
        depth[body] = 0 if above is None else depth.get(above.parent, 0) + 1
        joint = "" if above is None else f"  ({above.id.name}: {_type(mechanism, body)})"
        lines.append(f"{'  ' * min(depth[body], 20)}{body.name}{joint}")
    if len(shown) < len(bodies):
        lines.append(f"... and {len(bodies) - len(shown)} more bodies")
    return "\n".join(lines)


def _type(mechanism: Mechanism, body: Id) -> str:
    return "+".join(dof.kind.value for dof in mechanism.parent_joint[body].joint.dofs) or "fixed"
