"""Editing sessions: fields are assigned, elements added, removed and renamed; the result is a new robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD, Id, joint_edge, mount_edge, shape_edge
from hymeko_x.ir.parts import (
    Actuator,
    Body,
    Camera,
    Dof,
    DofKind,
    Drive,
    Frame,
    Inertial,
    Joint,
    Light,
    Material,
    Mesh,
    MeshShape,
    PoseSet,
    Role,
    Sense,
    Sensor,
    Shape,
    Stance,
)
from hymeko_x.ir.values import IDENTITY, ZERO, Z, compose
from hymeko_x.robot import elements as el
from hymeko_x.robot.data import RobotData
from hymeko_x.robot.draft import Draft
from hymeko_x.robot.element import Element
from hymeko_x.robot.errors import EditError, unknown_name
from hymeko_x.robot.kinematics import width_of
from hymeko_x.robot.named import Named
from hymeko_x.robot.poses import StateElement
from hymeko_x.robot.values import as_pose, plain_value

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import TracebackType

    from hymeko_x.ir.geometry import Geometry
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import EdgePart, Limits, Rgba, VertexPart
    from hymeko_x.ir.values import Pose, Tensor, Vec3

    Bounds = Limits | tuple[float | None, float | None]

E_ = TypeVar("E_", bound=Element)
R = TypeVar("R", bound=RobotData)


class Editing(Named, Generic[R]):
    """An editing session: ``with robot.edit() as e:`` and then ``e.robot``, the new robot. The old one stays as it is.

    Elements are found as in a robot, and their fields assigned. Each change is checked at its line, and one that cannot be is an
    EditError with the name of the element; it changes nothing. ``on`` and ``to`` are names of bodies or frames, ``"world"``, or
    elements; ``at`` is a Pose there or a position in m.
    """

    def __init__(self, robot: R) -> None:
        self._robot = robot
        self._draft = Draft(robot.mechanism, lambda: robot.completed, is_locked=False)
        self.name = robot.name

    @property
    def draft(self) -> Draft:
        """The tables that are changed."""
        return self._draft

    def __enter__(self) -> Editing[R]:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if error is None:
            self._draft.is_locked = True

    @property
    def robot(self) -> R:
        """The robot with all changes so far."""
        return self._robot.changed(self._draft.finished(self.name, lambda: self._robot.inlined))

    # ---- bodies and joints -----------------------------------------------------------------------------------------------

    def add_body(
        self,
        name: str,
        *,
        on: str | Element | None = None,
        at: Pose | Vec3 = IDENTITY,
        joint: str = "fixed",
        axis: Vec3 = Z,
        limits: Bounds | None = None,
        mass: float | None = None,
        com: Vec3 = ZERO,
        tensor: Tensor | None = None,
        joint_name: str | None = None,
    ) -> el.BodyElement:
        """A new body, and the joint of this type (fixed, hinge, slide, ball, free) that attaches it; without ``on`` it is an open root.

        ``mass`` in kg, ``com`` in m, ``tensor`` in kg m^2 about it; ``axis`` and ``limits`` (rad or m) as of a joint.
        """
        key = self._draft.new_id("body", name)
        frame = None if on is None else self._place(on, at)
        self._draft.add_vertex(key, Body())
        body = el.BodyElement(self._draft, key)
        try:
            if mass is not None:
                self._draft.set_part(key, Body(Inertial(0.0)))
                body.mass, body.com, body.tensor = mass, com, tensor
            if frame is not None:
                self._join(joint_name or f"{name}_joint", frame, key, joint, axis, limits)
        except EditError:
            self._draft.remove([key])
            raise
        return body

    def add_joint(
        self,
        name: str,
        *,
        parent: str | Element,
        child: str | Element,
        at: Pose | Vec3 = IDENTITY,
        type: str = "fixed",
        axis: Vec3 = Z,
        limits: Bounds | None = None,
    ) -> el.JointElement:
        """A joint from a body or frame to a body without a parent joint."""
        below = self._body(child)
        if below.parent_joint is not None:
            raise EditError(f"{below.id} has the parent {below.parent_joint.id} already; remove it first, or add a loop")
        frame = self._place(parent, at)
        if frame[0] in {body.id for body in below.subtree()}:
            raise EditError(f"{below.id} cannot be below {frame[0]}, which is below it")
        return self._join(name, frame, below.id, type, axis, limits)

    def _join(self, name: str, frame: tuple[Id, Pose], child: Id, type: str, axis: Vec3, limits: Bounds | None) -> el.JointElement:
        key = self._draft.new_id("joint", name)
        self._draft.set_edge(key, joint_edge(Joint(dofs_of(key, type)), frame[0], child, frame[1]))
        joint = el.JointElement(self._draft, key)
        try:
            if joint.type in _WITH_AXIS:
                joint.axis = axis
            if limits is not None:
                joint.limits = limits
        except EditError:
            self._draft.remove([key])
            raise
        return joint

    # ---- on bodies -------------------------------------------------------------------------------------------------------

    def add_shape(
        self,
        name: str,
        geometry: Geometry | str,
        *,
        on: str | Element,
        at: Pose | Vec3 = IDENTITY,
        role: Role = Role.BOTH,
        rgba: Rgba | None = None,
        material: str | None = None,
    ) -> el.ShapeElement:
        """A shape: a geometry with sizes in m, or the name of a mesh."""
        self._draft.check_shape_name(name)
        body, pose = self._place(on, at)
        key = self._draft.free_id("shape", f"{body.name}/{role.value}")
        mesh = self.meshes[geometry].id if isinstance(geometry, str) else None
        surface = None if material is None else self.materials[material].id
        part = Shape(MeshShape() if isinstance(geometry, str) else geometry, role, name)
        self._draft.set_edge(key, shape_edge(part, body, pose, mesh, surface))
        return self._with(el.ShapeElement(self._draft, key), geometry=part.geometry, rgba=rgba)

    def add_frame(self, name: str, *, on: str | Element, at: Pose | Vec3 = IDENTITY) -> el.FrameElement:
        """A frame (site)."""
        return el.FrameElement(self._draft, self._mount("frame", name, Frame(), on, at))

    def add_camera(
        self,
        name: str,
        *,
        on: str | Element,
        at: Pose | Vec3 = IDENTITY,
        fovy: float | None = None,
        resolution: tuple[int, int] | None = None,
    ) -> el.CameraElement:
        """A camera that looks along its own -z, y up; ``fovy`` is its vertical field of view in rad."""
        camera = el.CameraElement(self._draft, self._mount("camera", name, Camera(), on, at))
        return self._with(camera, fovy=fovy, resolution=resolution)

    def add_light(
        self, name: str, *, on: str | Element = "world", at: Pose | Vec3 = IDENTITY, kind: str = "spot", diffuse: Vec3 | None = None
    ) -> el.LightElement:
        """A light that shines along its own -z."""
        light = el.LightElement(self._draft, self._mount("light", name, Light(), on, at))
        return self._with(light, kind=kind, diffuse=diffuse)

    # ---- what drives and measures ------------------------------------------------------------------------------------------

    def add_actuator(
        self, name: str, *, joint: str | Element, kind: str = "motor", gear: float = 1.0, **parameters: float | tuple[float, ...]
    ) -> el.ActuatorElement:
        """An actuator of a joint: motor, position, velocity, ...; parameters (kp, kv, ctrlrange, ...) in the units of its format."""
        key = self._draft.new_id("actuator", name)
        target = self._named("joint", joint)
        self._draft.add_vertex(key, Actuator(kind))
        actuator = self._with(el.ActuatorElement(self._draft, key), parameters=tuple(parameters.items()) or None)
        self._edge("drive", name, Drive(), (Arc(key, 1), Arc(target.id, -1, None if gear == 1.0 else (float(gear),))))
        return actuator

    def add_sensor(
        self, name: str, kind: str, *, of: Element | None = None, on: str | Element | None = None, at: Pose | Vec3 = IDENTITY
    ) -> el.SensorElement:
        """A sensor ``of`` an element (a joint, a frame), or ``on`` a body."""
        if (of is None) == (on is None):
            raise EditError(f"sensor '{name}' measures either something (of=) or where it is (on=)")
        if on is not None:
            return el.SensorElement(self._draft, self._mount("sensor", name, Sensor(kind), on, at))
        key = self._draft.new_id("sensor", name)
        assert of is not None
        target = self._own(of)
        self._draft.add_vertex(key, Sensor(kind))
        self._edge("sense", name, Sense(), (Arc(target.id, 1), Arc(key, -1)))
        return el.SensorElement(self._draft, key)

    def add_pose(self, name: str, values: Mapping[str, float | Sequence[float]]) -> el.PoseSetElement:
        """A named configuration: the coordinates of joints in rad or m, of a ball the quaternion (w, x, y, z)."""
        key = self._draft.new_id("pose", name)
        if name in self.poses:
            raise EditError(f"there is a {key} already")
        arcs: list[RobotArc] = [Arc(key, 1)]
        for joint, value in values.items():
            view = self.joints[joint]
            numbers = plain_value(value)
            numbers = numbers if isinstance(numbers, tuple) else (numbers,)
            if len(numbers) != width_of(view.dofs):
                raise EditError(f"pose '{name}': {view.id} has {width_of(view.dofs)} coordinates, found {value!r}")
            arcs.append(Arc(view.id, 0, numbers))
        self._draft.add_vertex(key, PoseSet())
        self._edge("stance", name, Stance(), tuple(arcs))
        return el.PoseSetElement(self._draft, key)

    # ---- appearance ------------------------------------------------------------------------------------------------------

    def add_material(self, name: str, *, rgba: Rgba | None = None) -> el.MaterialElement:
        """A material; colours from 0 to 1."""
        key = self._draft.new_id("material", name)
        self._draft.add_vertex(key, Material(name))
        return self._with(el.MaterialElement(self._draft, key), rgba=rgba)

    def add_mesh(self, name: str, uri: str, *, scale: Vec3 = (1.0, 1.0, 1.0)) -> el.MeshElement:
        """A mesh in a file, which is looked for as those of the robot are."""
        key = self._draft.new_id("mesh", name)
        self._draft.add_vertex(key, Mesh(uri, name=name))
        return self._with(el.MeshElement(self._draft, key), scale=scale)

    # ---- any element -----------------------------------------------------------------------------------------------------

    def remove(self, element: str | Element) -> None:
        """Remove an element, and what cannot be without it; of a body the joint to it, all bodies below it and what is on them."""
        found = self._any(element)
        if isinstance(found, el.BodyElement):
            self._draft.remove([body.id for body in found.subtree()])
        elif isinstance(found, StateElement):
            self._draft.call_state(found.name, None)
        else:
            self._draft.remove([found.id])

    def rename(self, element: str | Element, name: str) -> None:
        """Give an element another name, wherever it occurs."""
        found = self._any(element)
        if not isinstance(found, StateElement):
            self._draft.rename(found.id, name)
        elif name not in self.poses:
            self._draft.call_state(found.name, name)
        elif name != found.name:
            raise EditError(f"there is a {Id('pose', name)} already")

    # ---- finding ---------------------------------------------------------------------------------------------------------

    def _any(self, element: str | Element) -> Element:
        """The element, or the only one of a name."""
        if isinstance(element, Element):
            return self._own(element)
        found = [key for kind in el.KINDS if (key := self._draft.find(kind, element)) is not None]
        found = [key for key in found if not self._draft.is_unnamed(key)] or found
        if len(found) > 1:
            ways = " or ".join(f"e.{el.KINDS[key.kind][0]}[{element!r}]" for key in found)
            raise EditError(f"'{element}' is the name of {' and of '.join(str(key) for key in found)}; give {ways}")
        if not found and element in self.poses:
            return self.poses[element]
        if not found:
            names = dict.fromkeys(key.name for kind in el.KINDS for key in self._draft.ids(kind))
            raise unknown_name("element", element, names)
        return el.view_of(self._draft, found[0])

    def _own(self, element: Element) -> Element:
        """The element of this session: one of the robot that is edited stands for it."""
        if isinstance(element, StateElement) and element.name in self.poses:
            return self.poses[element.name]
        if element.id not in self._draft:
            raise EditError(f"{element.id} is not in robot '{self.name}'")
        return el.view_of(self._draft, element.id)

    def _named(self, kind: str, element: str | Element) -> Element:
        if isinstance(element, Element):
            return self._own(element)
        key = self._draft.find(kind, element)
        if key is None:
            raise unknown_name(kind, element, (other.name for other in self._draft.ids(kind)))
        return el.view_of(self._draft, key)

    def _body(self, element: str | Element) -> el.BodyElement:
        found = self._named("body", element)
        if not isinstance(found, el.BodyElement):
            raise EditError(f"{found.id} is no body")
        return found

    def _place(self, on: str | Element, at: Pose | Vec3) -> tuple[Id, Pose]:
        return place(self._draft, self._own(on) if isinstance(on, Element) else on, at)

    # ---- adding ----------------------------------------------------------------------------------------------------------

    def _mount(self, kind: str, name: str, part: VertexPart, on: str | Element, at: Pose | Vec3) -> Id:
        key = self._draft.new_id(kind, name)
        body, pose = self._place(on, at)
        self._draft.add_vertex(key, part)
        self._draft.set_edge(self._draft.free_id("mount", name), mount_edge(body, key, pose))
        return key

    def _edge(self, kind: str, name: str, part: EdgePart, arcs: tuple[RobotArc, ...]) -> None:
        self._draft.set_edge(self._draft.free_id(kind, name), Edge(part, arcs))

    def _with(self, element: E_, **values: object) -> E_:
        """A new element with these fields; it is not added where one of them cannot be."""
        try:
            for name, value in values.items():
                if value is not None:
                    setattr(element, name, value)
        except EditError:
            self._draft.remove([element.id])
            raise
        return element


_WITH_AXIS = frozenset({"hinge", "slide", "screw"})


def dofs_of(key: Id, type: str) -> tuple[Dof, ...]:
    """The dofs of a joint of this type. Raises: EditError for an unknown type."""
    known = {"fixed": (), **{kind.value: (Dof(kind),) for kind in DofKind}}
    if type not in known:
        raise EditError(f"{key}: there is no type '{type}'; known: {', '.join(known)}")
    return known[type]


def place(draft: Draft, on: str | Element, at: Pose | Vec3) -> tuple[Id, Pose]:
    """The body and the pose on it that a name of a body or frame, ``"world"``, or an element means, with ``at`` in it."""
    if isinstance(on, str):
        found = [key for kind in ("frame", "body") if (key := draft.find(kind, on)) is not None]
        if len(found) > 1:
            raise EditError(f"'{on}' is the name of {found[0]} and of {found[1]}; give one of these elements")
        if not found and on != WORLD.name:
            raise unknown_name("body or frame", on, [key.name for kind in ("frame", "body") for key in draft.ids(kind)])
        on = el.view_of(draft, found[0] if found else draft.need_world())
    pose = as_pose(on.id, at)
    if isinstance(on, el.BodyElement):
        return on.id, pose
    if isinstance(on, el.MountedElement | el.ShapeElement):
        return on.body.id, compose(on.pose, pose)
    raise EditError(f"nothing can be on {on.id}; give a body or a frame")
