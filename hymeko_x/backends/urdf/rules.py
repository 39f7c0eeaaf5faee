"""The rules that make a mechanism legal in URDF, and in xacro."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.urdf.gazebo import write_gazebo_fragments
from hymeko_x.backends.urdf.srdf import as_virtual_joint
from hymeko_x.diagnostics import Report
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf.notations import CAPSULE, STYLE, TYPE, VIRTUAL, Style
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Capsule, Dof, DofKind, Ellipsoid, Plane
from hymeko_x.ir.values import IDENTITY, plane_axes
from hymeko_x.rewrite.chains import chain_dofs
from hymeko_x.rewrite.couplings import drop_inactive_couplings
from hymeko_x.rewrite.efforts import limit_efforts_by_actuators
from hymeko_x.rewrite.inertia import fill_tensors
from hymeko_x.rewrite.joints import expand_screws
from hymeko_x.rewrite.names import make_names_usable
from hymeko_x.rewrite.roots import floating_joint, join_roots, make_world_a_link
from hymeko_x.rewrite.shapes import approximate_shapes, drop_engine_shapes, drop_unused_assets, prefer_own_colours, split_shared_shapes
from hymeko_x.rewrite.subsets import part_meshes_by_looks

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import JointView, Mechanism
    from hymeko_x.rewrite.context import Context, Rule


def chain_joints(mechanism: Mechanism, context: Context) -> Mechanism:
    """A joint that is no URDF joint becomes a chain of joints with one dof each."""
    return chain_dofs(mechanism, context, [view for view in mechanism.joints.values() if not _is_joint(view, mechanism)])


def with_joints_of_urdf(mechanism: Mechanism, context: Context) -> Mechanism:
    """The mechanism with the joints, and their names, that it has in URDF, for what refers to them; nothing is reported."""
    silent = replace(context, report=Report())
    for rule in RULES[: RULES.index(chain_joints) + 1]:
        mechanism = rule(mechanism, silent)
    return mechanism


def _is_joint(view: JointView, mechanism: Mechanism) -> bool:
    """Whether URDF can represent the joint as it is."""
    dofs = view.joint.dofs
    if view.child_pose != IDENTITY or any(any(dof.anchor) or dof.ref for dof in dofs):
        return False
    kinds = tuple(dof.kind for dof in dofs)
    if kinds == (DofKind.BALL,):  # only where a URDF file had one (``spherical``)
        return mechanism.notation(view.id, TYPE) is not None
    if kinds == (DofKind.SLIDE, DofKind.SLIDE, DofKind.HINGE):
        plain = all(dof == Dof(dof.kind, dof.axis) for dof in dofs)  # a planar joint has one name, and no limits or damping
        return plain and tuple(dof.axis for dof in dofs[:2]) == plane_axes(dofs[2].axis)
    return not dofs or (len(dofs) == 1 and kinds[0] in (DofKind.HINGE, DofKind.SLIDE, DofKind.FREE))


def approximate_primitives(mechanism: Mechanism, context: Context) -> Mechanism:
    """Ellipsoids, planes, and capsules, unless the URDF file that the mechanism came from has <capsule>, are approximated."""
    keeps_capsules = CAPSULE in (mechanism.notation(ROOT, STYLE) or Style()).habits
    return approximate_shapes(mechanism, context, (Ellipsoid, Plane) if keeps_capsules else (Ellipsoid, Plane, Capsule))


def report_missing_limits(mechanism: Mechanism, context: Context) -> Mechanism:
    """Limits that URDF requires and the robot does not have are reported: a number that stands for none is written."""
    bounded = [view for view in mechanism.joints.values() if len(view.joint.dofs) == 1 and _is_bounded(view, mechanism)]
    missing = {name: [view.id for view in bounded if getattr(view.joint.dofs[0].limits, name) is None] for name in ("effort", "velocity")}
    listed = " and ".join(f"{name} of {len(found)} joint{'s'[: len(found) > 1]}" for name, found in missing.items() if found)
    if listed:
        message = f"URDF requires limits that are not given: {listed}; {words.NO_LIMIT_TEXT} is written, which is read as none"
        context.report.note(codes.REWRITTEN, message, element=str(next(found[0] for found in missing.values() if found)))
    return mechanism


def _is_bounded(view: JointView, mechanism: Mechanism) -> bool:
    word = words.JOINT_TYPES.get(mechanism.notation(view.id, TYPE) or words.default_type(view.joint) or "")
    return word is not None and word.bounded


def leave_virtual_joint_out(mechanism: Mechanism, _context: Context) -> Mechanism:
    """The joint that stands in the SRDF is none of the URDF, whose base is open then."""
    held = floating_joint(mechanism)
    return mechanism if held is None or mechanism.notation(held.id, VIRTUAL) is None else as_virtual_joint(mechanism, held)


RULES: tuple[Rule, ...] = (
    make_names_usable,
    leave_virtual_joint_out,
    drop_engine_shapes,
    drop_inactive_couplings,
    fill_tensors,
    expand_screws,
    limit_efforts_by_actuators,
    chain_joints,
    make_world_a_link,
    join_roots,
    prefer_own_colours,
    approximate_primitives,
    split_shared_shapes,
    part_meshes_by_looks,
    report_missing_limits,
    drop_unused_assets,
    make_names_usable,  # once more, for what the rules have added
    write_gazebo_fragments,
)
