"""The elements of a robot as typed views.

A view belongs to a robot, which never changes, or to an editing session, in which its fields are assigned. SI units and radians;
quaternions are (w, x, y, z), tensors (xx, yy, zz, xy, xz, yz); None means unspecified.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import WORLD, Id, has_numbers
from hymeko_x.ir.parts import Dof, Geometry, Limits, Parameters, Rgba, Role
from hymeko_x.ir.values import Pose, Tensor, Vec3
from hymeko_x.robot.element import Element
from hymeko_x.robot.errors import EditError
from hymeko_x.robot.fields import (
    DofField,
    InertialField,
    LimitsField,
    PartField,
    PoseField,
    TensorField,
    between_zero_and_one,
    not_negative,
    ordered,
    with_sizes,
)
from hymeko_x.robot.kinematics import pose_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.robot.draft import Draft
    from hymeko_x.robot.kinematics import Coordinates


# ---- bodies and joints -------------------------------------------------------------------------------------------------------


class BodyElement(Element):
    """A rigid body, or the world."""

    mass = InertialField[float | None](not_negative)
    """Mass in kg; where the file leaves it to its shapes, what the engine of its format computes. None = unspecified."""
    com = InertialField[Vec3](None)
    """Centre of mass in m, in the body's frame; None without an inertial."""
    tensor = TensorField[Tensor | None](None)
    """Inertia tensor in kg m^2 about the centre of mass, in the body's axes."""

    @property
    def parent_joint(self) -> JointElement | None:
        """The joint that leads here, or None for a root."""
        for key, edge in self.draft.at(self.id, "joint"):
            if any(arc.sign < 0 and arc.target == self.id for arc in edge.arcs):
                return JointElement(self.draft, key)
        return None

    @property
    def parent(self) -> BodyElement | None:
        """The body (or the world) to which the parent joint attaches it, or None for a root."""
        joint = self.parent_joint
        return None if joint is None else joint.parent

    @property
    def child_joints(self) -> tuple[JointElement, ...]:
        """The joints from here to other bodies, in order."""
        edges = self.draft.at(self.id, "joint")
        return tuple(
            JointElement(self.draft, key) for key, edge in edges if any(arc.sign > 0 and arc.target == self.id for arc in edge.arcs)
        )

    @property
    def children(self) -> tuple[BodyElement, ...]:
        """The bodies to which these joints lead, in order."""
        return tuple(joint.child for joint in self.child_joints)

    @property
    def shapes(self) -> tuple[ShapeElement, ...]:
        """Its visual and collision shapes, in order."""
        return tuple(ShapeElement(self.draft, key) for key, _ in self.draft.at(self.id, "shape"))

    @property
    def mounted(self) -> tuple[MountedElement, ...]:
        """The frames, cameras, lights and sensors on it, in order."""
        arcs = [arc for _, edge in self.draft.at(self.id, "mount") for arc in edge.arcs if arc.sign < 0]
        return tuple(KINDS[arc.target.kind][1](self.draft, arc.target) for arc in arcs)  # type: ignore[misc]

    def subtree(self) -> Iterator[BodyElement]:
        """The body and all below it, parents first. Not recursive."""
        stack: list[BodyElement] = [self]
        seen: set[Id] = set()
        while stack:
            body = stack.pop()
            if body.id not in seen:
                seen.add(body.id)
                yield body
                stack += reversed(body.children)

    def world_pose(self, q: Coordinates | None = None) -> Pose:
        """Its pose in the world (or its own root) at coordinates by joint, in rad or m; what is left out is at its reference."""
        mechanism = self.draft.mechanism if self.draft.is_locked else self.draft.finished()
        return pose_of(mechanism, self.id, {} if q is None else q)


class JointElement(Element):
    """A joint with its dofs, from the parent to the child: T_parent_child(q) = pose * motion(q) * inverse(child_pose).

    Fields of a dof are those of the only one; see ``dofs`` for joints with several.
    """

    dofs = PartField[tuple[Dof, ...]](None)
    """The degrees of freedom in order; none = fixed."""
    axis = DofField[Vec3](None)
    """Unit vector in the joint's frame; any vector with a direction can be assigned."""
    limits = LimitsField(ordered)
    """Bounds in rad or m, rad/s or m/s, Nm or N; a pair (lower, upper) can be assigned."""
    damping = DofField[float](not_negative)
    """In Nms/rad or Ns/m."""
    friction = DofField[float](not_negative)
    """Dry friction in Nm or N."""
    stiffness = DofField[float](not_negative)
    """Of a spring about ``spring_ref``, in Nm/rad or N/m."""
    spring_ref = DofField[float](None)
    """The coordinate in rad or m at which the spring is at rest."""
    armature = DofField[float](not_negative)
    """Rotor inertia in kg m^2 or kg."""
    ref = DofField[float](None)
    """The coordinate in rad or m at which the child is where the poses put it."""
    pose = PoseField(1)
    """The joint's frame in the parent; a position in m can be assigned."""
    child_pose = PoseField(-1)
    """The joint's frame in the child; a position in m can be assigned."""

    @property
    def type(self) -> str:
        """``fixed``, ``hinge``, ``slide``, ``screw``, ``ball``, ``free``; of several dofs all of them with ``+`` between."""
        return "+".join(dof.kind.value for dof in self.dofs) or "fixed"

    @property
    def parent(self) -> BodyElement:
        """The body (or the world) from which it leads. Raises: EditError where the source gives none."""
        return self._end(1)

    @property
    def child(self) -> BodyElement:
        """The body to which it leads. Raises: EditError where the source gives none."""
        return self._end(-1)

    def _end(self, sign: int) -> BodyElement:
        arc = self.arc(self.id, sign)
        if arc is None:
            raise EditError(f"{self.id} has no {'parent' if sign > 0 else 'child'}")
        return BodyElement(self.draft, arc.target)


# ---- what is on bodies -------------------------------------------------------------------------------------------------------


class ShapeElement(Element):
    """A geometry on a body, to be seen, for contact, or for both."""

    geometry = PartField[Geometry](with_sizes)
    """Box, Sphere, Cylinder, ... with sizes in m."""
    role = PartField[Role](None)
    """VISUAL, COLLISION or BOTH."""
    rgba = PartField[Rgba | None](between_zero_and_one)
    """Red, green, blue and opacity from 0 to 1, instead of the material's; None = the material's."""
    friction = PartField[tuple[float, ...]](None)
    """Coefficients: sliding, torsional, rolling."""
    pose = PoseField(1)
    """Its frame in the body; a position in m can be assigned."""

    @property
    def body(self) -> BodyElement:
        """The body that it is on."""
        arc = self.arc(self.id, 1)
        if arc is None:
            raise EditError(f"{self.id} is on no body")
        return BodyElement(self.draft, arc.target)

    @property
    def material(self) -> MaterialElement | None:
        """Its material, or None."""
        found = self._role("material")
        return None if found is None else MaterialElement(self.draft, found)

    @property
    def mesh(self) -> MeshElement | None:
        """The mesh of a MeshShape, or None."""
        found = self._role("mesh")
        return None if found is None else MeshElement(self.draft, found)

    def _role(self, role: str) -> Id | None:
        return next((arc.target for arc in self.draft.edges[self.id].arcs if arc.role == role), None)


class MountedElement(Element):
    """What sits on a body in a pose of its own."""

    pose = PoseField(1)
    """Its frame in the body; a position in m can be assigned. Raises: EditError where it is on none."""

    @property
    def posed(self) -> Id:
        """The edge that puts it on its body. Raises: EditError where it is on none."""
        for key, _ in self.draft.at(self.id, "mount"):
            return key
        raise EditError(f"{self.id} is on no body")

    @property
    def body(self) -> BodyElement:
        """The body (or the world) that it is on. Raises: EditError where it is on none."""
        arc = self.arc(self.posed, 1)
        return BodyElement(self.draft, WORLD if arc is None else arc.target)

    def world_pose(self, q: Coordinates | None = None) -> Pose:
        """Its pose in the world (or the body's own root) at coordinates by joint, in rad or m."""
        return self.body.world_pose(q) @ self.pose


class FrameElement(MountedElement):
    """A named pose on a body: a site of MJCF, a frame of SDF."""


class CameraElement(MountedElement):
    """A camera that looks along its own -z, y up."""

    fovy = PartField[float | None](lambda value: None if value is None or 0 < value < 3.1416 else "is an angle in rad between 0 and pi")
    """Vertical field of view in rad."""
    resolution = PartField[tuple[int, int] | None](None)
    """Width and height in pixels."""


class LightElement(MountedElement):
    """A light that shines along its own -z."""

    kind = PartField[str](None)
    """spot, directional, point, image."""
    diffuse = PartField[Vec3 | None](None)
    """Red, green and blue from 0 to 1."""


class SensorElement(MountedElement):
    """A sensor; one that measures a joint or a tendon is on no body."""

    kind = PartField[str](None)
    """imu, force, jointpos, ..."""
    rate = PartField[float | None](not_negative)
    """Updates per second in Hz."""
    parameters = PartField[Parameters](None)
    """Everything else by name, in the units of its format."""

    @property
    def measures(self) -> tuple[Element, ...]:
        """The elements that it measures."""
        arcs = [arc for _, edge in self.draft.at(self.id, "sense") for arc in edge.arcs if arc.target != self.id]
        return tuple(view_of(self.draft, arc.target) for arc in arcs)


class ActuatorElement(Element):
    """A motor, a servo, a transmission."""

    kind = PartField[str](None)
    """motor, position, velocity, transmission, muscle, ..."""
    parameters = PartField[Parameters](None)
    """Gains and ranges by name, in the units of its format."""

    @property
    def drives(self) -> tuple[Element, ...]:
        """The joints, tendons, frames or bodies that it drives."""
        arcs = [arc for _, edge in self.draft.at(self.id, "drive") for arc in edge.arcs if arc.target != self.id]
        return tuple(view_of(self.draft, arc.target) for arc in arcs)


# ---- appearance and files -----------------------------------------------------------------------------------------------------


class MaterialElement(Element):
    """A surface; its numbers are from 0 to 1, None = unspecified."""

    rgba = PartField[Rgba | None](between_zero_and_one)
    """Red, green, blue and opacity."""
    specular = PartField[float | None](not_negative)
    """Strength of highlights."""
    shininess = PartField[float | None](not_negative)
    """How small highlights are."""
    metallic = PartField[float | None](not_negative)
    """0 for plastic, 1 for metal."""
    roughness = PartField[float | None](not_negative)
    """0 for a mirror, 1 for chalk."""


class MeshElement(Element):
    """A triangle mesh in a file or in the mechanism."""

    uri = PartField[str | None](None)
    """The file as the source names it; None = its points are in the mechanism."""
    scale = PartField[Vec3](None)
    """Factors on its points."""


class TextureElement(Element):
    """An image."""

    uri = PartField[str | None](None)
    """The file as the source names it."""


# ---- relations ----------------------------------------------------------------------------------------------------------------


class PoseSetElement(Element):
    """A named configuration: a keyframe or a group state."""

    time = PartField[float | None](None)
    """In s."""

    @property
    def values(self) -> dict[str, tuple[float, ...]]:
        """The coordinates by joint, in rad or m; quaternions as (w, x, y, z)."""
        arcs = [arc for _, edge in self.draft.at(self.id, "stance") for arc in edge.arcs if arc.target.kind == "joint"]
        return {arc.target.name: arc.weight for arc in arcs if has_numbers(arc.weight)}


class TendonElement(Element):
    """A cable, or a linear combination of joints."""

    damping = PartField[float](not_negative)
    """In Ns/m, or in the units of the joints."""
    stiffness = PartField[float](not_negative)
    """In N/m, or in the units of the joints."""
    limits = PartField[Limits](ordered)
    """Bounds of its length in m, or of the combination."""


class RelationElement(Element):
    """A coupling, loop or contact: the elements that it relates."""

    @property
    def elements(self) -> tuple[Element, ...]:
        """The related elements, in order."""
        return tuple(view_of(self.draft, arc.target) for arc in self.draft.edges[self.id].arcs)


KINDS: Mapping[str, tuple[str, type[Element]]] = {
    "body": ("bodies", BodyElement),
    "joint": ("joints", JointElement),
    "shape": ("shapes", ShapeElement),
    "frame": ("frames", FrameElement),
    "camera": ("cameras", CameraElement),
    "light": ("lights", LightElement),
    "sensor": ("sensors", SensorElement),
    "actuator": ("actuators", ActuatorElement),
    "tendon": ("tendons", TendonElement),
    "material": ("materials", MaterialElement),
    "mesh": ("meshes", MeshElement),
    "texture": ("textures", TextureElement),
    "pose": ("poses", PoseSetElement),
    "coupling": ("couplings", RelationElement),
    "loop": ("loops", RelationElement),
    "contact": ("contacts", RelationElement),
}
"""By kind, the name of its mapping and the class of its views."""


def view_of(draft: Draft, key: Id) -> Element:
    """The view of an element."""
    if key == WORLD:
        return BodyElement(draft, key)
    return KINDS[key.kind][1](draft, key) if key.kind in KINDS else Element(draft, key)
