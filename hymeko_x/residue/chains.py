"""Joints of several dofs that the image has as chains of joints: folded where nothing else is on the bodies between them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import joint_edge
from hymeko_x.ir.parts import Body, Joint
from hymeko_x.ir.values import IDENTITY, apply, compose, inverse, rotate

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import Dof, VertexPart
    from hymeko_x.ir.values import Pose
    from hymeko_x.residue import Change, Fold, Residue, WholeElement

MOTION = frozenset({"kind", "axis", "anchor", "pitch", "ref"})
"""Fields of a dof that are given in the frame of its joint."""


def fold_chains(mechanism: Mechanism, folds: Iterable[Fold]) -> Mechanism:
    """Chains of joints as one joint of several dofs, where the bodies between them carry nothing."""
    edges: dict[Id, RobotEdge] = {}
    gone: set[Id] = set()
    for fold in folds:
        views = [mechanism.joints.get(key) for key in fold.chain]
        chain = [view for view in views if view is not None]
        if len(chain) < len(views) or not _is_bare_chain(mechanism, fold, chain):
            continue
        gone.update((*fold.chain, *fold.between))
        edges[fold.joint] = folded(chain)
    if not edges:
        return mechanism
    kept = {key: edge for key, edge in mechanism.graph.edges.items() if key not in gone}
    vertices = {key: part for key, part in mechanism.graph.vertices.items() if key not in gone}
    graph = replace(mechanism.graph, vertices=vertices, edges={**kept, **edges})
    layout = tuple(key for key in mechanism.layout if key not in gone)
    return replace(mechanism, graph=graph, layout=layout)


def _is_bare_chain(mechanism: Mechanism, fold: Fold, chain: list[JointView]) -> bool:
    """Whether the joints follow each other and nothing else is on the bodies between them."""
    inner = [view.child for view in chain[:-1]]
    if inner != list(fold.between) or any(below.parent != above.child for above, below in pairwise(chain)):
        return False
    own = set(fold.chain)
    hanging = (found.edge for body in inner for found in mechanism.graph.incidence.get(body, ()))
    return own.issuperset(hanging) and all(_has_no_weight(mechanism.vertex(body, Body)) for body in inner)


def _has_no_weight(body: Body) -> bool:
    """Whether a body is only there to part two joints: what a format demands for a massless one is next to nothing."""
    return body.inertial is None or (body.inertial.mass or 0.0) < 1e-6


def folded(chain: list[JointView]) -> RobotEdge:
    """The edge of one joint with the dofs of all, in the frame of the first."""
    dofs: list[Dof] = []
    here: Pose = IDENTITY  # the frame of the current joint in that of the first, at the reference configuration
    for number, view in enumerate(chain):
        dofs += [_seen_from(dof, here) for dof in view.joint.dofs]
        if number + 1 < len(chain):
            here = compose(here, compose(inverse(view.child_pose), chain[number + 1].parent_pose))
    return joint_edge(
        Joint(tuple(dofs)), chain[0].parent, chain[-1].child, chain[0].parent_pose, compose(chain[-1].child_pose, inverse(here))
    )


def _seen_from(dof: Dof, frame: Pose) -> Dof:
    if frame == IDENTITY:
        return dof
    return replace(dof, axis=rotate(frame.quat, dof.axis), anchor=apply(frame, dof.anchor), written=None)


# ---- chains that stay ------------------------------------------------------------------------------------------------------


def with_open_chains(residue: Residue, image: Mechanism, report: Report) -> Residue:
    """The residue, in which what is kept for the dofs of joints that stay chains, and for what refers to them, is for the joints of these.

    What a dof moves along is as it is in the chain.
    """
    joints = image.joints
    folds = [fold for fold in residue.alignment.folds if fold.joint not in joints and all(key in joints for key in fold.chain)]
    if not folds:
        return residue
    for fold in folds:
        message = f"{fold.joint} stays a chain of joints, since a body between them was edited"
        report.note(codes.RESIDUE_SUPERSEDED, message, element=str(fold.joint))
    dofs: dict[Id, list[tuple[Id, int]]] = {
        fold.joint: [(key, place) for key in fold.chain for place in range(len(joints[key].joint.dofs))] for fold in folds
    }
    names = {joint: {joints[key].joint.dofs[place].name or key.name: key for key, place in row} for joint, row in dofs.items()}
    changes = [found for change in residue.changes if (found := _of_chain(change, dofs)) is not None]
    additions = [element._replace(part=_at_chain(element, names)) for element in residue.additions]
    return replace(residue, changes=tuple(changes), additions=tuple(additions))


def _of_chain(change: Change, dofs: Mapping[Id, list[tuple[Id, int]]]) -> Change | None:
    """A change of a dof as one of the dof in the chain, where ``dofs`` are by joint and place; None for what only the one joint has."""
    row = dofs.get(change.element)
    if row is None:
        return change
    match change.path:
        case ("data", "dofs", int(number), str(name), *rest) if number < len(row) and name not in MOTION:
            joint, place = row[number]
            return change._replace(element=joint, path=("data", "dofs", place, name, *rest))
    return None


def _at_chain(element: WholeElement, names: Mapping[Id, Mapping[str, Id]]) -> VertexPart | RobotEdge:
    """The part of an element, whose arcs to a dof of a joint lead to the joint of that dof in the chain."""
    edge = element.part
    if not isinstance(edge, Edge) or not any(arc.target in names for arc in edge.arcs):
        return edge
    return replace(edge, arcs=tuple([_arc_to_chain(arc, names.get(arc.target, {})) for arc in edge.arcs]))


def _arc_to_chain(arc: RobotArc, joints: Mapping[str, Id]) -> RobotArc:
    joint = joints.get(arc.role)
    return arc if joint is None else replace(arc, target=joint, role="")
