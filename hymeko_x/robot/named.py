"""Mappings by name of everything that a robot, or an editing session, has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import WORLD
from hymeko_x.robot import elements as el
from hymeko_x.robot.element import Elements
from hymeko_x.robot.poses import Poses

if TYPE_CHECKING:
    from hymeko_x.robot.draft import Draft


class Named:
    """Mappings by name of all that a draft has: the base of robots and of editing sessions."""

    @property
    def draft(self) -> Draft:
        """The tables behind the mappings."""
        raise NotImplementedError

    @property
    def bodies(self) -> Elements[el.BodyElement]:
        """The bodies (links), without the world."""
        return Elements(self.draft, "body", el.BodyElement)

    @property
    def world(self) -> el.BodyElement:
        """The world, which robots without anything on it do not have."""
        return el.BodyElement(self.draft, WORLD)

    @property
    def joints(self) -> Elements[el.JointElement]:
        """The joints."""
        return Elements(self.draft, "joint", el.JointElement)

    @property
    def shapes(self) -> Elements[el.ShapeElement]:
        """The visual and collision shapes (geoms)."""
        return Elements(self.draft, "shape", el.ShapeElement)

    @property
    def frames(self) -> Elements[el.FrameElement]:
        """The frames (sites)."""
        return Elements(self.draft, "frame", el.FrameElement)

    @property
    def cameras(self) -> Elements[el.CameraElement]:
        """The cameras."""
        return Elements(self.draft, "camera", el.CameraElement)

    @property
    def lights(self) -> Elements[el.LightElement]:
        """The lights."""
        return Elements(self.draft, "light", el.LightElement)

    @property
    def sensors(self) -> Elements[el.SensorElement]:
        """The sensors."""
        return Elements(self.draft, "sensor", el.SensorElement)

    @property
    def actuators(self) -> Elements[el.ActuatorElement]:
        """The actuators."""
        return Elements(self.draft, "actuator", el.ActuatorElement)

    @property
    def tendons(self) -> Elements[el.TendonElement]:
        """The tendons."""
        return Elements(self.draft, "tendon", el.TendonElement)

    @property
    def materials(self) -> Elements[el.MaterialElement]:
        """The materials."""
        return Elements(self.draft, "material", el.MaterialElement)

    @property
    def meshes(self) -> Elements[el.MeshElement]:
        """The meshes."""
        return Elements(self.draft, "mesh", el.MeshElement)

    @property
    def textures(self) -> Elements[el.TextureElement]:
        """The textures."""
        return Elements(self.draft, "texture", el.TextureElement)

    @property
    def poses(self) -> Poses:
        """The named configurations: group states, poses of HyMeKo, and keyframes of MJCF that have a name, of which ``values`` are read."""
        return Poses(self.draft, "pose", el.PoseSetElement)

    @property
    def couplings(self) -> Elements[el.RelationElement]:
        """The joints that follow others (mimics, gears)."""
        return Elements(self.draft, "coupling", el.RelationElement)

    @property
    def loops(self) -> Elements[el.RelationElement]:
        """The closures of the tree (equality constraints)."""
        return Elements(self.draft, "loop", el.RelationElement)

    @property
    def contacts(self) -> Elements[el.RelationElement]:
        """The pairs that collide or do not."""
        return Elements(self.draft, "contact", el.RelationElement)
