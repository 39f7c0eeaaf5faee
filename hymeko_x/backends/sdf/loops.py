"""Closures of loops as joints: SDF has no other word for them, and takes the first joint that leads to a link for that of the tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.ir.mechanism import WORLD, Id, joint_edge, pose_weight
from hymeko_x.ir.names import names_in_use, rename
from hymeko_x.ir.parts import Body, Dof, DofKind, Joint, Loop
from hymeko_x.ir.values import IDENTITY, Pose, compose

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import JointView, Mechanism, RobotArc, RobotEdge
    from hymeko_x.rewrite.context import Context


class _End(NamedTuple):
    """One end of a closure: the body, and the pose of the closure's frame in it."""

    body: Id
    pose: Pose


def close_loops_by_joints(mechanism: Mechanism, context: Context) -> Mechanism:
    """Each closure becomes one that SDF can write as a joint: from one link to another one that a joint of the tree holds.

    One that holds a free base is that base's joint. Between links that a joint joins already it starts at a link of its own, because
    Drake takes one joint between two links. A closure that is no joint of SDF is left out.
    """
    closures = [*mechanism.edges(Loop)]
    if not closures:
        return mechanism
    closer = _Closer(mechanism, context)
    for key, loop, arcs in closures:
        closer.close(key, loop, arcs)
    return closer.result()


class _Closer:
    """The closures of a mechanism, one after the other."""

    def __init__(self, mechanism: Mechanism, context: Context) -> None:
        self._mechanism = mechanism
        self._context = context
        self._places = {view.mounted: _End(view.body, view.pose) for views in mechanism.mounts.values() for view in views}
        self._names = names_in_use(mechanism)
        self._roots: dict[Id, Id] = {WORLD: WORLD}
        for body in mechanism.depth_first():
            above = mechanism.parent_joint.get(body)
            self._roots[body] = body if above is None or _is_free(above) else self._roots[above.parent]
        views = (view for view in mechanism.joints.values() if not _is_free(view))
        self._joined = {frozenset((view.parent, view.child)) for view in views}
        self._vertices: dict[Id, Body] = {}
        self._edges: dict[Id, RobotEdge] = {}
        self._gone: list[Id] = []
        self._renamed: dict[Id, Id] = {}

    def result(self) -> Mechanism:
        """The mechanism with what was found."""
        if not (self._edges or self._gone):
            return self._mechanism
        graph = self._mechanism.graph.replace(vertices=self._vertices, edges=self._edges, without=self._gone)
        notations = {key: value for key, value in self._mechanism.notations.items() if key not in self._renamed}
        return rename(replace(self._mechanism, graph=graph, notations=notations), self._renamed)

    def close(self, key: Id, loop: Loop, arcs: tuple[RobotArc, ...]) -> None:
        """Rewrite one closure."""
        if not loop.active:
            self._leave_out(key, "is not active")
            return
        if len(arcs) != 2 or loop.kind not in ("connect", "weld", "joint") or words.default_type(Joint(loop.dofs)) is None:
            self._leave_out(key, "is no joint of SDF")
            return
        first, second = (self._end(arc) for arc in arcs)
        roots = self._root(first.body), self._root(second.body)
        if first.body == second.body:
            self._leave_out(key, "joins a link to itself")
        elif roots[0] == roots[1] or not self._hold(key, loop, first, second, roots):
            self._write(key, arcs, first, second)

    def _end(self, arc: RobotArc) -> _End:
        """The end on a body; a frame stands for the body that it is on."""
        on = self._places.get(arc.target)
        return _End(arc.target, pose_weight(arc)) if on is None else _End(on.body, compose(on.pose, pose_weight(arc)))

    def _root(self, body: Id) -> Id:
        """The body at the root of the tree that a body is in by now."""
        root = self._roots[body]
        while self._roots[root] != root:
            root = self._roots[root]
        return root

    def _leave_out(self, key: Id, why: str) -> None:
        self._context.report.warn(codes.NOT_REPRESENTED, f"{key} {why}; it is left out", self._mechanism.origin(key), element=str(key))
        self._gone.append(key)

    def _hold(self, key: Id, loop: Loop, first: _End, second: _End, roots: tuple[Id, Id]) -> bool:
        """Whether the closure holds a free base, and now is the joint above it."""
        if second.body == roots[1] != WORLD:
            above, base = first, second
        elif first.body == roots[0] != WORLD:
            above, base = second, first
        else:
            return False
        self._roots[base.body] = self._root(above.body)
        self._joined.add(frozenset((above.body, base.body)))
        self._gone.append(key)
        free = self._mechanism.parent_joint.get(base.body)
        joint = self._names.take("joint", key.name)
        if free is not None:
            self._renamed[free.id] = joint
        self._edges[joint if free is None else free.id] = joint_edge(Joint(_dofs(loop)), above.body, base.body, above.pose, base.pose)
        message = f"{key} holds {base.body}, which has no other joint; it is written as its joint"
        self._context.report.note(codes.REWRITTEN, message, self._mechanism.origin(key), element=str(key))
        return True

    def _write(self, key: Id, arcs: tuple[RobotArc, ...], first: _End, second: _End) -> None:
        """The closure with an end that a joint of the tree holds as its second one."""
        swapped = second.body in (WORLD, self._root(second.body))
        ends = [second, first] if swapped else [first, second]
        joined = frozenset((first.body, second.body))
        if joined in self._joined:
            ends[0] = self._anchor(key, ends[0])
        self._joined.add(joined)
        order = arcs[::-1] if swapped else arcs
        new = tuple([replace(arc, target=end.body, weight=_weight(end.pose)) for arc, end in zip(order, ends, strict=True)])
        if new != arcs:
            self._edges[key] = replace(self._mechanism.graph.edges[key], arcs=new)

    def _anchor(self, key: Id, end: _End) -> _End:
        """A link of its own for the end of a closure, fixed to the link where that is."""
        anchor = self._names.take("body", f"{key.name}{words.ANCHOR}")
        self._vertices[anchor] = Body()
        self._edges[self._names.take("joint", f"{anchor.name}_joint")] = joint_edge(Joint(), end.body, anchor, end.pose)
        message = f"{key} joins two links that a joint joins already; it starts at a link of its own, {anchor}"
        self._context.report.note(codes.REWRITTEN, message, self._mechanism.origin(key), element=str(key))
        return _End(anchor, IDENTITY)


def _is_free(view: JointView) -> bool:
    return view.parent == WORLD and len(view.joint.dofs) == 1 and view.joint.dofs[0].kind is DofKind.FREE


def _weight(pose: Pose) -> Pose | None:
    return None if pose == IDENTITY else pose


def _dofs(loop: Loop) -> tuple[Dof, ...]:
    return loop.dofs or ((Dof(DofKind.BALL),) if loop.kind == "connect" else ())
