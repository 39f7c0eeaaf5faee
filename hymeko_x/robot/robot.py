"""The robot of the public API: an immutable mechanism with its elements by name, its kinematics, and its hand-over to engines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x import formats, pipeline
from hymeko_x.ir.parts import Body
from hymeko_x.ir.tensor import from_tensor, to_tensor
from hymeko_x.ir.values import IDENTITY
from hymeko_x.joining import with_names
from hymeko_x.robot import memory, text
from hymeko_x.robot.composing import attach, detach, split, subtree
from hymeko_x.robot.data import RobotData
from hymeko_x.robot.editing import Editing
from hymeko_x.robot.kinematics import all_poses
from hymeko_x.robot.merging import merge_fixed
from hymeko_x.robot.mirroring import mirror, swapped
from hymeko_x.robot.scaling import scale
from hymeko_x.robot.varying import vary

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.parts import EdgePart, Joint, VertexPart
    from hymeko_x.ir.tensor import Tensor
    from hymeko_x.ir.values import Pose, Vec3
    from hymeko_x.robot.element import Element
    from hymeko_x.robot.kinematics import Coordinates


class Robot(RobotData):
    """A robot, which never changes: every change gives a new one.

    ``mechanism`` is what it is made of, ``files`` finds its meshes and images; by default they are looked for beside the file
    that the mechanism was read from.
    """

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Robot) and self.mechanism == other.mechanism

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return text.one_line(self.mechanism)

    def __str__(self) -> str:
        return text.tree(self.mechanism)

    def _repr_html_(self) -> str:
        """A picture and the tree, for notebooks; the tree alone where nothing can be drawn."""
        draw: Callable[[Robot], str] = formats.loaded("hymeko_x.draw.notebook:html")  # drawing is a layer that uses this one
        return draw(self)

    # ---- numbers ---------------------------------------------------------------------------------------------------------

    @property
    def mass(self) -> float:
        """The sum of the masses of all bodies in kg; bodies without one count 0."""
        return sum(body.inertial.mass or 0.0 for _, body in self.completed.vertices(Body) if body.inertial is not None)

    @property
    def dofs(self) -> int:
        """The number of degrees of freedom of all joints, 3 of a ball and 6 of a free joint; couplings and loops are not subtracted."""
        return text.freedoms(self.mechanism)

    def fk(self, q: Coordinates | None = None) -> dict[str, Pose]:
        """The pose of every body in the world (or in the root of its tree), by name, at coordinates by joint in rad or m.

        ``q`` has a number by joint name, a quaternion (w, x, y, z) for a ball, a position and a quaternion for a free joint, or it is
        the sequence of all coordinates in the order of the joints. Joints left out are at their references; followers follow.

        Raises: KeyError for a joint that is not there, EditError for a wrong number of coordinates, and for what is no finite number.
        """
        return {key.name: pose for key, pose in all_poses(self.mechanism, {} if q is None else q).items() if key.kind == "body"}

    # ---- changing --------------------------------------------------------------------------------------------------------

    def edit(self) -> Editing[Robot]:
        """A session of changes: ``with robot.edit() as e: e.bodies["wrist"].mass = 0.5``; the changed robot is ``e.robot``."""
        return Editing(self)

    def attach(
        self,
        part: Robot,
        at: str | Element = "world",
        *,
        prefix: str = "",
        joint: str | Joint | None = None,
        pose: Pose | Vec3 = IDENTITY,
    ) -> Robot:
        """This robot with another one on a body or frame of it; the names of the other one get the prefix.

        The world of the part is where ``pose`` is in the frame ``at``. What is fixed or free in its world is fixed to the body, or moves
        by ``joint``: a type such as ``"hinge"``, or a Joint with its dofs; what is free stays free in the world. Settings of the whole
        (gravity, time step) are those of this robot; classes are written out, files, materials, tendons, keyframes and extras of both
        come along.

        Raises: EditError when names clash or a joint is given for several roots; KeyError when there is no such body or frame.
        """
        return attach(self, part, at, prefix=prefix, joint=joint, pose=pose)

    def detach(self, name: str) -> tuple[Robot, Robot]:
        """The robot without a part, and the part: all with this prefix, or a body with all below it, which is then an open root.

        The slash at the end of a prefix may be left out. What was attached with a prefix gets back its names and its world. Relations
        between the two are in neither.

        Raises: KeyError when no body has this prefix, and none this name.
        """
        return detach(self, name)

    def subtree(self, body: str) -> Robot:
        """A body with all below it as a robot of its own; the body is its open root. Raises: KeyError when there is no such body."""
        return subtree(self, body)

    def split(self) -> tuple[Robot, ...]:
        """A scene as its robots: one for each body that stands or floats in the world, with all below it, called like that body.

        Names stay; what is on the world itself, and relations between the robots, are in none.
        """
        return split(self)

    def merge_fixed_joints(self, *, keep: Iterable[str] = ()) -> Robot:
        """Every body that a fixed joint attaches to another body becomes a part of that one; inertials are added. What is fixed to the
        world stays a body, and so do the bodies to ``keep``.

        Raises: KeyError for a body to keep that is not there.
        """
        return self.changed(merge_fixed(pipeline.inlined(self.completed, self.files), keep))

    def scaled(self, factor: float) -> Robot:
        """Another size: lengths times the factor, masses times its cube, times as they are; every typed number by its dimension.

        So do margins, gaps and widths of MJCF. Parameters of actuators and sensors, other extras, and what is left to the defaults of an
        engine stay as they are. Raises: EditError unless the factor is positive.
        """
        return self.changed(scale(self.inlined, float(factor)))

    def mirrored(self, *, names: tuple[str, str] | None = None) -> Robot:
        """The mirror image on the plane y = 0: the same coordinates give mirrored poses. ``names`` are two words, such as left and
        right, each of which becomes the other one in every name.

        Shapes that are no meshes are symmetric; meshes get a negative scale; the picture of a camera is mirrored left to right.
        Extras stay as they are. Raises: ValueError for names that are not two words.
        """
        image = mirror(self.mechanism if names is None else self.inlined)
        return self.changed(image if names is None else with_names(image, swapped(names), is_part=False))

    def randomized(self, seed: int, **spreads: float) -> Robot:
        """A variant: each number times a factor drawn evenly from 1 - spread to 1 + spread. The same seed gives the same robot.

        Spreads: ``mass`` (with the tensor), ``damping``, ``friction`` (of joints), ``stiffness``, ``armature``, ``contact_friction``.

        Raises: EditError for an unknown name, and for a spread outside of 0 to 1.
        """
        return self.changed(vary(self.completed if spreads.get("mass") else self.mechanism, seed, spreads))

    # ---- in memory -------------------------------------------------------------------------------------------------------

    def to_mujoco(self) -> Any:
        """The robot as a compiled ``mujoco.MjModel``. Raises: Refusal HX302 in MuJoCo's words."""
        return memory.hand_over(self.mechanism, self.files, "mujoco")

    def to_pinocchio(self) -> Any:
        """The robot as a ``pinocchio.Model``. Raises: Refusal HX302 in Pinocchio's words."""
        return memory.hand_over(self.mechanism, self.files, "pinocchio")

    def to_usd(self) -> Any:
        """The robot as a ``pxr.Usd.Stage`` in memory, in m and kg with z up. Raises: Refusal when it cannot be written."""
        return memory.hand_over(self.mechanism, self.files, "pxr")

    def to_networkx(self) -> Any:
        """The hypergraph as a bipartite ``networkx.MultiDiGraph``: a node per vertex and per edge, an arrow per arc."""
        return memory.as_networkx(self.mechanism)

    def to_tensor(self) -> Tensor[Id, VertexPart, EdgePart]:
        """The arcs of the hypergraph with their weights as one sparse tensor, (elements, edges, places, components)."""
        return to_tensor(self.mechanism.graph)

    def with_tensor(self, tensor: Tensor[Id, VertexPart, EdgePart]) -> Robot:
        """The robot with the graph of a tensor: the arcs and weights that its array has now."""
        return self.changed(replace(self.mechanism, graph=from_tensor(tensor)))
