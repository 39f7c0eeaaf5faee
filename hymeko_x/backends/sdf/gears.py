"""The couplings that are gearboxes of SDF: those that came from one, as long as the joints between its links still are what it relates."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.gearboxes import Hinge, turn_of
from hymeko_x.formats.sdf.notations import WrittenPose
from hymeko_x.formats.sdf.values import VECTOR, BadText, read_pose
from hymeko_x.ir.mechanism import ROOT, WORLD, numbers_weight
from hymeko_x.ir.parts import Coupling, DofKind
from hymeko_x.ir.values import IDENTITY, Pose, compose, rotate, unit

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.sdf.frames import ZeroPoses
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc
    from hymeko_x.ir.values import Vec3


class Gear(NamedTuple):
    """A gearbox: the child frame that its own frame is usually given in, its pose there, and its ratio."""

    child: Id
    pose: Pose
    ratio: float


def gears(mechanism: Mechanism, places: ZeroPoses) -> dict[Id, Gear]:
    """The gearbox of each coupling that is one."""
    own = [(key, arcs) for key, _, arcs in mechanism.edges(Coupling) if mechanism.notation(key, notations.GEARBOX) is not None]
    hinges = _hinges(mechanism, places) if own else {}
    found = ((key, _gear(key, arcs, mechanism, places, hinges)) for key, arcs in own)
    return {key: gear for key, gear in found if gear is not None}


def _hinges(mechanism: Mechanism, places: ZeroPoses) -> dict[frozenset[Id], Hinge]:
    views = (view for view in mechanism.joints.values() if [dof.kind for dof in view.joint.dofs] == [DofKind.HINGE])
    return {
        frozenset((view.parent, view.child)): Hinge(
            view.id, view.parent, rotate(places.in_world.get(view.id, IDENTITY).quat, view.joint.dofs[0].axis)
        )
        for view in views
    }


def _gear(
    key: Id, arcs: tuple[RobotArc, ...], mechanism: Mechanism, places: ZeroPoses, hinges: Mapping[frozenset[Id], Hinge]
) -> Gear | None:
    """The gearbox of a coupling; None where its links or axes are not those of the coupled joints any more."""
    scope = words.split_scope(key.name)[0]
    parent, child, *reference = [places.find(scope, name) for name in mechanism.notation(key, notations.GEARBOX) or ("", "")]
    base = reference[0] if reference else WORLD
    if parent is None or child is None or base is None or len(arcs) != 2:
        return None
    pose = _pose(key, child, scope, mechanism, places)
    turns = []
    for tag, end in zip(words.AXES, (parent, child), strict=True):
        axis = _axis(key, tag, child, pose, scope, mechanism, places)
        turns.append(None if axis is None else turn_of(places.body_of(end), places.body_of(base), axis, hinges))
    leader, follower = turns
    constant, factor = (*numbers_weight(arcs[1]), 0.0, 0.0)[:2]
    if leader is None or follower is None or constant or (follower.joint, leader.joint) != (arcs[0].target, arcs[1].target):
        return None
    return Gear(child, pose, -factor * leader.sign * follower.sign + 0.0)


def _pose(key: Id, child: Id, scope: str, mechanism: Mechanism, places: ZeroPoses) -> Pose:
    """The pose of the gearbox in the frame that it names as its child."""
    written = mechanism.notation(key, notations.POSE) or WrittenPose()
    base = places.find(scope, written.relative_to) if written.relative_to else None
    try:
        pose = read_pose(written)
    except BadText:
        return IDENTITY
    return pose if base is None else compose(places.relative(base, child), pose)


def _axis(key: Id, tag: str, child: Id, pose: Pose, scope: str, mechanism: Mechanism, places: ZeroPoses) -> Vec3 | None:
    """An axis in the world at the zero configuration, from what its author wrote."""
    texts = mechanism.notation(key, notations.WRITTEN) or {}
    try:
        direction = unit(VECTOR.read(texts.get(f"{tag}/xyz", "")))
    except (BadText, ZeroDivisionError):
        return None
    frame = _frame(texts, tag, scope, mechanism, places)
    at = compose(places.in_world.get(child, IDENTITY), pose) if frame is None else places.in_world.get(frame, IDENTITY)
    return rotate(at.quat, direction)


def _frame(texts: Mapping[str, str], tag: str, scope: str, mechanism: Mechanism, places: ZeroPoses) -> Id | None:
    """The frame in which an axis is given; None for that of the gearbox."""
    expressed = texts.get(f"{tag}/xyz/@expressed_in")
    if expressed:
        return places.find(scope, expressed)
    version = mechanism.notation(ROOT, notations.VERSION) or words.DEFAULT_VERSION
    usual = "1" if words.minor(version) < words.VERSION_OF_JOINT_AXES else "0"
    uses_model = texts.get(f"{tag}/use_parent_model_frame", usual).lower() in ("true", "1")
    return places.model_frame(scope) if uses_model else None
