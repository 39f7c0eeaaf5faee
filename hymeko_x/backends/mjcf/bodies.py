"""<worldbody>: the tree of bodies with their inertials, joints, geoms, sites, cameras and lights."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.geoms import write_geom
from hymeko_x.backends.mjcf.text import Attributes, Text, number, numbers, pose_attributes
from hymeko_x.formats.mjcf import DOFS, LIGHTS
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body, Camera, DofKind, Frame, Light
from hymeko_x.ir.values import IDENTITY, ZERO, apply, compose, inverse, rotate, unit

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.names import Printed
    from hymeko_x.ir.mechanism import Id, JointView, Mechanism
    from hymeko_x.ir.parts import Dof, Inertial
    from hymeko_x.ir.values import Pose, Vec3

_DOWN: Vec3 = (0.0, 0.0, -1.0)


def write_worldbody(text: Text, mechanism: Mechanism, names: Printed) -> None:
    """The world's own geoms, then every tree, depth first and without recursion."""
    text.section("worldbody")
    _write_content(text, mechanism, WORLD, names)
    stack: list[Id | None] = list(reversed(mechanism.roots))
    while stack:
        body = stack.pop()
        if body is None:
            text.close()
            continue
        write_body(text, mechanism, body, names)
        stack.append(None)
        stack.extend(joint.child for joint in reversed(mechanism.children.get(body, ())))
    text.close()


def write_body(text: Text, mechanism: Mechanism, key: Id, names: Printed) -> None:
    """Opens a body and writes all of it but the bodies inside it.

    The body frame at the reference configuration is P C^-1 in the parent; axes and anchors are seen in that frame.
    """
    view = mechanism.parent_joint.get(key)
    pose = IDENTITY if view is None else compose(view.parent_pose, inverse(view.child_pose))
    text.open("body", {"name": names.of(key), **pose_attributes(pose)})
    inertial = mechanism.vertex(key, Body).inertial
    if inertial is not None:
        text.leaf("inertial", _inertial_attributes(inertial))
    for dof in view.joint.dofs if view else ():
        write_joint(text, view, dof)  # type: ignore[arg-type]
    _write_content(text, mechanism, key, names)


def write_joint(text: Text, view: JointView, dof: Dof) -> None:
    """One dof of the joint above a body."""
    name = dof.name or view.id.name
    behaviour = _behaviour_attributes(dof)
    if dof.kind is DofKind.FREE:
        if any(value is not None for value in behaviour.values()):
            text.later("joint", {"name": name, "type": "free", **behaviour}, name)
        else:
            text.leaf("freejoint", {"name": name})
        return
    anchor = apply(view.child_pose, dof.anchor)
    turns = dof.kind is not DofKind.SLIDE
    attributes: Attributes = {
        "name": name,
        "type": None if dof.kind is DofKind.HINGE else DOFS[dof.kind],
        "axis": None if dof.kind is DofKind.BALL else numbers(*unit(rotate(view.child_pose.quat, dof.axis))),
        "pos": None if anchor == ZERO or not turns else numbers(*anchor),
        "range": _range(dof),
        **behaviour,
    }
    text.later("joint", attributes, name)


def _range(dof: Dof) -> str | None:
    lower, upper = dof.limits.lower, dof.limits.upper
    if upper is None:
        return None
    return numbers(0.0 if lower is None else lower, upper)


def _behaviour_attributes(dof: Dof) -> Attributes:
    effort = dof.limits.effort
    return {
        "ref": number(dof.ref, 0.0),
        "springref": number(dof.spring_ref, 0.0),
        "stiffness": number(dof.stiffness, 0.0),
        "damping": number(dof.damping, 0.0),
        "frictionloss": number(dof.friction, 0.0),
        "armature": number(dof.armature, 0.0),
        "actuatorfrcrange": None if effort is None else numbers(-effort, effort),
    }


def _inertial_attributes(inertial: Inertial) -> Attributes:
    """Mass, centre of mass, and the tensor about it in body axes: three numbers where the products are zero, else six."""
    tensor = inertial.tensor or (0.0,) * 6
    diagonal = not any(tensor[3:])
    return {
        "pos": numbers(*inertial.com),
        "mass": numbers(inertial.mass or 0.0),
        "diaginertia": numbers(*tensor[:3]) if diagonal else None,
        "fullinertia": None if diagonal else numbers(*tensor),
    }


def _write_content(text: Text, mechanism: Mechanism, body: Id, names: Printed) -> None:
    """The geoms, sites, cameras and lights of a body or of the world."""
    for shape in mechanism.shapes.get(body, ()):
        write_geom(text, shape, names)
    for _, key, _, pose in mechanism.mounts.get(body, ()):
        match mechanism.graph.vertices.get(key):
            case Frame(size=size):
                text.leaf("site", {"name": names.of(key), **pose_attributes(pose), "size": numbers(*size) if size else None})
            case Camera() as camera:
                text.leaf("camera", {"name": names.of(key), **pose_attributes(pose), **_camera_attributes(camera)})
            case Light() as light:
                text.leaf("light", {"name": names.of(key), **_light_attributes(light, pose)})
            case _:
                continue


def _camera_attributes(camera: Camera) -> Attributes:
    """MJCF counts ``fovy`` in degrees, whatever the compiler's angle is."""
    return {
        "fovy": number(None if camera.fovy is None else math.degrees(camera.fovy)),
        "resolution": None if camera.resolution is None else "{} {}".format(*camera.resolution),
    }


def _light_attributes(light: Light, pose: Pose) -> Attributes:
    """A light has a direction instead of an orientation."""
    direction = rotate(pose.quat, _DOWN)
    return {
        "type": light.kind if light.kind in LIGHTS[1:] else None,
        "pos": None if pose.xyz == ZERO else numbers(*pose.xyz),
        "dir": None if direction == _DOWN else numbers(*direction),
        "diffuse": None if light.diffuse is None else numbers(*light.diffuse),
    }
