"""The rules that make a mechanism legal in SDF."""

from __future__ import annotations

import math
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.sdf.gazebo import obey_gazebo_fragments
from hymeko_x.backends.sdf.loops import close_loops_by_joints
from hymeko_x.backends.sdf.names import make_names_unique_in_models, make_names_unique_on_links
from hymeko_x.backends.sdf.scopes import put_bodies_into_models
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.sensors import IMAGE, LEAST_FOV
from hymeko_x.ir.kinematics import displacement
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, joint_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Body, Camera, Dof, DofKind, Frame, Joint, Light, Material, Mount, Shape
from hymeko_x.ir.values import ZERO, Pose, compose
from hymeko_x.rewrite.chains import chain_dofs
from hymeko_x.rewrite.couplings import drop_inactive_couplings, make_couplings_scalar
from hymeko_x.rewrite.efforts import limit_efforts_by_actuators
from hymeko_x.rewrite.inertia import fill_tensors, give_every_body_mass, make_tensors_physical
from hymeko_x.rewrite.joints import lower_inner_free_joints
from hymeko_x.rewrite.loops import close_in_pairs
from hymeko_x.rewrite.names import make_names_usable
from hymeko_x.rewrite.roots import put_world_link_into_world
from hymeko_x.rewrite.shapes import drop_engine_shapes, drop_unused_assets, make_sizes_positive, prefer_own_colours, split_shared_shapes
from hymeko_x.rewrite.subsets import part_meshes_by_looks

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.mechanism import JointView, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context, Rule


def unless_from_sdf(rule: Rule) -> Rule:
    """The rule for mechanisms of other formats: what an SDF file has, SDF can represent."""

    def applied(mechanism: Mechanism, context: Context) -> Mechanism:
        return mechanism if notations.is_from_sdf(mechanism) else rule(mechanism, context)

    applied.__doc__ = rule.__doc__
    return applied


# ---- joints ------------------------------------------------------------------------------------------------------------------


def move_anchors_into_frames(mechanism: Mechanism, _context: Context) -> Mechanism:
    """The only dof of a joint turns about the origin of the joint's frame: P Tr(a) M(-ref) and C Tr(a) are the frames then."""
    edges: dict[Id, RobotEdge] = {}
    for key, view in mechanism.joints.items():
        dofs = view.joint.dofs
        if len(dofs) != 1 or dofs[0].kind is DofKind.FREE or not (any(dofs[0].anchor) or dofs[0].ref):
            continue
        dof, at = dofs[0], Pose(dofs[0].anchor)
        single = replace(dof, anchor=ZERO, ref=0.0)
        parent = compose(compose(view.parent_pose, at), displacement(single, -dof.ref))
        edges[key] = joint_edge(Joint((single,)), view.parent, view.child, parent, compose(view.child_pose, at))
    return mechanism.replace(edges=edges)


def chain_joints(mechanism: Mechanism, context: Context) -> Mechanism:
    """A joint with dofs that no SDF joint has becomes a chain of joints with one dof each."""
    if notations.is_from_sdf(mechanism):
        return chain_dofs(mechanism, context, [view for view in mechanism.joints.values() if words.default_type(view.joint) is None])
    chained = [view for view in mechanism.joints.values() if not _is_joint(view)]
    return chain_dofs(mechanism, context, chained, keeps_balls=True, poses_children=True)


def _is_joint(view: JointView) -> bool:
    dofs = view.joint.dofs
    if len(dofs) == 1 and dofs[0].kind is DofKind.FREE:
        return view.parent == WORLD
    if any(any(dof.anchor) or dof.ref for dof in dofs):
        return False
    if len(dofs) == 2 and any(dof != Dof(dof.kind, dof.axis, damping=dofs[0].damping) for dof in dofs):
        return False  # Drake has neither limits nor springs of universal joints, and one damping for both axes
    return words.default_type(view.joint) not in (None, "revolute2")


def remove_refused_numbers(mechanism: Mechanism, context: Context) -> Mechanism:
    """A dof without the numbers that libsdformat or Drake refuse: limits that are crossed, negative damping, negative stiffness."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.joints.values():
        dofs = view.joint.dofs
        for what, accepted in _REFUSED.items():
            before, dofs = dofs, tuple([accepted(dof) for dof in dofs])
            if dofs == before:
                continue
            edges[view.id] = replace(mechanism.graph.edges[view.id], data=replace(view.joint, dofs=dofs))
            message = f"{view.id}: {what}, which programs that read SDF refuse; the joint is written without"
            context.report.warn(codes.REWRITTEN, message, mechanism.origin(view.id), element=str(view.id))
    return mechanism.replace(edges=edges)


def _uncrossed(dof: Dof) -> Dof:
    lower, upper = dof.limits.lower, dof.limits.upper
    crossed = lower is not None and upper is not None and lower > upper
    return replace(dof, limits=replace(dof.limits, lower=None, upper=None)) if crossed else dof


_REFUSED: Mapping[str, Callable[[Dof], Dof]] = MappingProxyType(
    {
        "the lower position limit is above the upper one": _uncrossed,
        "the damping is negative": lambda dof: replace(dof, damping=0.0) if dof.damping < 0.0 else dof,
        "the stiffness is negative": lambda dof: replace(dof, stiffness=0.0) if dof.stiffness < 0.0 else dof,
    }
)
"""The numbers that are refused, and the dof without them."""


def widen_cameras(mechanism: Mechanism, context: Context) -> Mechanism:
    """A camera whose image is narrower than 0.1 rad, for which libsdformat refuses the file, is as wide as that."""
    vertices: dict[Id, Camera] = {}
    for key, camera in mechanism.vertices(Camera):
        width, height = camera.resolution or (IMAGE[0].default, IMAGE[1].default)
        least = 2.0 * math.atan(math.tan(LEAST_FOV / 2.0) * height / width) if width > 0 else 0.0
        if camera.fovy is None or camera.fovy >= least:
            continue
        vertices[key] = replace(camera, fovy=least)
        message = f"{key} has a vertical field of view of {camera.fovy:.6g} rad, SDF has no image below 0.1 rad; {least:.6g} is written"
        context.report.warn(codes.REWRITTEN, message, mechanism.origin(key), element=str(key))
    return mechanism.replace(vertices=vertices)


def limit_colours(mechanism: Mechanism, _context: Context) -> Mechanism:
    """The components of colours lie between 0 and 1: libsdformat refuses the file for any other."""
    edges: dict[Id, RobotEdge] = {}
    for key, shape, _ in mechanism.edges(Shape):
        if (rgba := _limited(shape.rgba)) != shape.rgba:
            edges[key] = replace(mechanism.graph.edges[key], data=replace(shape, rgba=rgba))
    vertices: dict[Id, Light | Material] = {}
    for key, material in mechanism.vertices(Material):
        if (rgba := _limited(material.rgba)) != material.rgba:
            vertices[key] = replace(material, rgba=rgba)
    for key, light in mechanism.vertices(Light):
        if (diffuse := _limited(light.diffuse)) != light.diffuse:
            vertices[key] = replace(light, diffuse=diffuse)
    return mechanism.replace(vertices=vertices, edges=edges)


def _limited(colour: tuple[float, ...] | None) -> tuple[float, ...] | None:
    return None if colour is None else tuple([min(max(component, 0.0), 1.0) for component in colour])


def weigh_bodies(mechanism: Mechanism, context: Context) -> Mechanism:
    """Every body has a mass; in a mechanism from SDF one without inertial is new, unless the author lets collisions give it."""
    if not notations.is_from_sdf(mechanism):
        return give_every_body_mass(mechanism, context)
    given = {key for key, found in mechanism.extras.items() if any(extra.text.startswith("<inertial") for extra in found)}
    weighed = {key for key, body in mechanism.vertices(Body) if body.inertial is not None}
    return give_every_body_mass(mechanism, context, without=given | weighed)


# ---- the world ---------------------------------------------------------------------------------------------------------------


def put_world_geometry_on_a_link(mechanism: Mechanism, context: Context) -> Mechanism:
    """What is on the world goes on a link that is fixed to it: only links have shapes and sensors. Lights stay."""
    in_world = mechanism.notation(ROOT, notations.WORLD) is not None
    moved: dict[Id, RobotEdge] = {}
    for key, edge in mechanism.graph.edges.items():
        if isinstance(edge.data, Shape | Mount) and any(arc.target == WORLD and arc.sign > 0 for arc in edge.arcs):
            mounted = next((mechanism.graph.vertices.get(arc.target) for arc in edge.arcs if arc.sign < 0), None)
            if not isinstance(mounted, Light) and not ((in_world or notations.is_from_sdf(mechanism)) and isinstance(mounted, Frame)):
                moved[key] = edge
    if not moved:
        return mechanism
    names = names_in_use(mechanism)
    link = names.take("body", words.WORLD_LINK)
    message = f"what is on the world is written on {link}, which is fixed to it"
    context.report.note(codes.REWRITTEN, message, element=str(link))
    edges = {key: _on(edge, link) for key, edge in moved.items()}
    edges[names.take("joint", f"{link.name}_to_world")] = joint_edge(Joint(), WORLD, link)
    return mechanism.replace(vertices={link: Body()}, edges=edges)


def _on(edge: RobotEdge, link: Id) -> RobotEdge:
    return replace(edge, arcs=tuple([replace(arc, target=link) if arc.target == WORLD and arc.sign > 0 else arc for arc in edge.arcs]))


RULES: tuple[Rule, ...] = (
    make_names_usable,
    unless_from_sdf(drop_engine_shapes),
    unless_from_sdf(put_world_link_into_world),
    unless_from_sdf(fill_tensors),
    unless_from_sdf(make_tensors_physical),
    unless_from_sdf(lower_inner_free_joints),
    unless_from_sdf(limit_efforts_by_actuators),
    unless_from_sdf(remove_refused_numbers),
    move_anchors_into_frames,
    chain_joints,
    close_in_pairs,
    unless_from_sdf(close_loops_by_joints),
    drop_inactive_couplings,
    make_couplings_scalar,
    unless_from_sdf(widen_cameras),
    unless_from_sdf(limit_colours),
    put_world_geometry_on_a_link,
    weigh_bodies,
    prefer_own_colours,
    partial(split_shared_shapes, ending="_collision"),
    unless_from_sdf(obey_gazebo_fragments),
    part_meshes_by_looks,
    unless_from_sdf(make_sizes_positive),
    put_bodies_into_models,
    make_names_unique_in_models,
    make_names_unique_on_links,
    drop_unused_assets,
    make_names_usable,  # once more, for what the rules have added
)
