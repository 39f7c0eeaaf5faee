"""What the user asks of the robot itself: what holds its bases, and what drives its dofs. From then on it is the robot's own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import counted
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import WORLD, Id, joint_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Actuator, Coupling, Dof, DofKind, Drive, Joint
from hymeko_x.ir.values import Z
from hymeko_x.rewrite.actuators import MUJOCO_KINDS, with_sensors, without_actuators
from hymeko_x.rewrite.collisions import make_collisions_convex
from hymeko_x.rewrite.context import Context
from hymeko_x.rewrite.densities import WATER, give_inertials
from hymeko_x.rewrite.joints import full_name, legal_dof
from hymeko_x.rewrite.roots import stands_for_world, with_world
from hymeko_x.rewrite.rotors import give_light_dofs_rotors
from hymeko_x.rewrite.servos import SAG, loads, parameters_of
from hymeko_x.rewrite.sites import make_frames_links
from hymeko_x.source import NO_FILES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import JointView, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Options
    from hymeko_x.rewrite.servos import Load
    from hymeko_x.source import Files


def choose(mechanism: Mechanism, options: Options, report: Report, *, files: Files = NO_FILES) -> Mechanism:
    """The robot as the options ask for it; ``files`` has its meshes. Idempotent."""
    if options.density is not None or options.inertia_from is not None:
        density = WATER if options.density is None else options.density
        mechanism = give_inertials(mechanism, density, options.inertia_from, Context(report, files, f"--density {density:g}"))
    if options.collision is not None:
        mechanism = make_collisions_convex(mechanism, options.collision, Context(report, files, f"--collision {options.collision}"))
    if options.base is not None:
        mechanism = _with_bases(mechanism, is_free=options.base == "free", report=report)
    if options.actuators == "position":
        mechanism = give_light_dofs_rotors(mechanism, Context(report, reason="--actuators position"))
    if options.actuators is not None:
        mechanism = with_actuators(mechanism, options.actuators, report)
    if options.sites:
        mechanism = make_frames_links(mechanism, report, "--sites" if options.target is None else f"--for {options.target}")
    return mechanism


# ---- bases -------------------------------------------------------------------------------------------------------------------


def _with_bases(mechanism: Mechanism, *, is_free: bool, report: Report) -> Mechanism:
    """Each open base gets a fixed or a free joint to the world."""
    worlds = {WORLD, *[root for root in mechanism.roots if stands_for_world(root, mechanism)]}
    open_bases = [root for root in mechanism.roots if root not in worlds and root not in mechanism.parent_joint]
    if not open_bases:
        _report_bases(mechanism, worlds, is_free, report)
        return mechanism
    names = names_in_use(mechanism)
    joint, suffix = (Joint((Dof(DofKind.FREE, Z),)), "free") if is_free else (Joint(), "base")
    edges = {names.take("joint", f"{root.name}_{suffix}"): joint_edge(joint, WORLD, root) for root in open_bases}
    mechanism = with_world(mechanism)
    mechanism = mechanism.replace(edges=edges)
    return mechanism if is_free else mechanism.with_note(edges, UNNAMED, True)


def _report_bases(mechanism: Mechanism, worlds: set[Id], is_free: bool, report: Report) -> None:
    """Report the joints because of which bases are not as the user asks."""
    hint = "remove that joint or the link 'world' to let the robot float" if is_free else "remove that joint to let the robot be fixed"
    for joint in (joint for world in worlds for joint in mechanism.children.get(world, ())):
        kinds = [dof.kind for dof in joint.joint.dofs]
        if kinds != ([] if is_free else [DofKind.FREE]):
            continue
        what = f"does not float: {joint.id} fixes it to the world" if is_free else f"is not fixed: {joint.id} lets it float"
        report.warn(codes.REWRITTEN, f"{joint.child} {what}", mechanism.origin(joint.id), element=str(joint.child), hint=hint)


# ---- actuators ---------------------------------------------------------------------------------------------------------------

_DRIVEN = frozenset({DofKind.HINGE, DofKind.SLIDE, DofKind.SCREW})


def with_actuators(mechanism: Mechanism, kind: str, report: Report) -> Mechanism:
    """One actuator of a kind for every driven dof instead of those that a simulation would have; only ``none`` leaves no transmissions."""
    present = {key: actuator for key, actuator in mechanism.vertices(Actuator) if kind == "none" or actuator.kind in MUJOCO_KINDS}
    bare = without_actuators(mechanism, list(present))
    names = names_in_use(bare)
    vertices: dict[Id, Actuator] = {}
    edges: dict[Id, RobotEdge] = {}
    carried = loads(bare) if kind == "position" else {}
    for view, number, dof in _driven_dofs(bare) if kind != "none" else ():
        name = full_name(view, number)
        key = names.take("actuator", f"{name}_{kind}" if Id("actuator", name) in bare.graph.vertices else name)
        vertices[key] = Actuator(kind, parameters_of(kind, dof, carried.get((view.id, number))))
        role = "" if len(view.joint.dofs) == 1 else dof.name or str(number)
        edges[names.take("drive", key.name)] = Edge(Drive(), (Arc(key, 1), Arc(view.id, -1, None, role)))
    if present == vertices:
        return mechanism
    _report_gains(bare, carried, report)
    if present:
        what = "left out" if kind == "none" else f"replaced by one {kind} per driven dof"
        report.note(
            codes.REWRITTEN, f"{counted(len(present), 'actuator')} of the source {what}, as asked", element=str(next(iter(present)))
        )
    return with_sensors(bare.replace(vertices=vertices, edges=edges), mechanism, report)


def _report_gains(mechanism: Mechanism, carried: Mapping[tuple[Id, int], Load], report: Report) -> None:
    """Report where gains are from, and the dofs that cannot hold the robot: their servos give in."""
    if any(load.inertia > 0.0 for load in carried.values()):
        message = f"--actuators position: gains follow from the masses that each joint moves at home, and sag by {SAG:g} rad or m at most"
        report.note(codes.FOR_TARGET, message, hint="docs/targets.md has the formula")
    for view, number, dof in _driven_dofs(mechanism) if carried else ():
        load, effort = carried[view.id, number], dof.limits.effort
        if effort and load.weight > effort:
            message = f"{view.id} carries {load.weight:.3g} at home, more than its effort limit of {effort:.3g}: it cannot hold the robot"
            report.warn(codes.REWRITTEN, message, mechanism.origin(view.id), element=str(view.id))


def _driven_dofs(mechanism: Mechanism) -> Iterator[tuple[JointView, int, Dof]]:
    """Every hinge, slide and screw that follows no other dof, with its number, on the joints that hold bodies."""
    followers = set()
    for _, _, arcs in mechanism.edges(Coupling):
        for arc in arcs:
            if arc.sign > 0 and arc.target in mechanism.joints:
                followers.add((arc.target, dof_number(mechanism.joints[arc.target].joint, arc.role)))
    for view in mechanism.joints.values():
        if mechanism.parent_joint[view.child] != view:
            continue
        for number, dof in enumerate(view.joint.dofs):
            if dof.kind in _DRIVEN and (view.id, number) not in followers:
                yield view, number, legal_dof(dof, [])
