"""The engine-neutral robot that every reference reader returns and every check compares.

A forest of bodies under the world, each with the joint above it, in SI units and radians. Matrices are 4x4 homogeneous.
The pose of a body in its parent is

    T(q) = P * prod_i( Tr(a_i) M_i(q_i - ref_i) Tr(-a_i) )

with P the joint's ``placement`` and a_i the ``anchor`` of dof i; axes and anchors are in the frame of the child body, as it
is when all dofs are at their refs. A coordinate vector q holds one number per hinge, slide and screw, a quaternion
(w, x, y, z) per ball, a position and a quaternion per free dof (both counted from the placement).
"""

from __future__ import annotations

from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace
from numpy.typing import NDArray

from hymeko_x.formats import FORMATS, Format
from hymeko_x.verify.features import Feature

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

K = TypeVar("K")
Array = NDArray[np.float64]
Index = NDArray[np.intp]

WORLD = 0
"""The index of the world in every model's bodies."""

INF = float("inf")


class Kind(Enum):
    """How one degree of freedom moves."""

    HINGE = "hinge"
    SLIDE = "slide"
    SCREW = "screw"
    BALL = "ball"
    FREE = "free"

    @property
    def width(self) -> int:
        """The number of coordinates."""
        return _WIDTHS[self]

    @property
    def scalar(self) -> bool:
        """Whether its coordinate is one number."""
        return self.width == 1


_WIDTHS = {Kind.HINGE: 1, Kind.SLIDE: 1, Kind.SCREW: 1, Kind.BALL: 4, Kind.FREE: 7}


class Dof(Struct, frozen=True, eq=False):
    """One degree of freedom. ``axis`` is unit, in the body's frame; bounds are infinite where there are none.

    ``effort`` is (lowest, highest) in N or Nm, ``driven`` the largest force that the actuators can exert together. Damping in
    Nms/rad or Ns/m, ``pitch`` of a screw in m/rad; ``nonlinear`` holds the higher coefficients of damping and stiffness where an engine
    has them.
    """

    kind: Kind
    axis: Array
    anchor: Array = field(default_factory=lambda: np.zeros(3))
    ref: float = 0.0
    name: str | None = None
    lower: float = -INF
    upper: float = INF
    velocity: float = INF
    effort: tuple[float, float] = (-INF, INF)
    driven: float = INF
    damping: float = 0.0
    friction: float = 0.0
    armature: float = 0.0
    stiffness: float = 0.0
    spring_ref: float = 0.0
    pitch: float = 0.0
    nonlinear: tuple[float, ...] = ()


class Joint(Struct, frozen=True, eq=False):
    """The joint between a body and its parent. No dofs = fixed; ``open`` marks a root without a joint to the world (URDF's)."""

    name: str | None = None
    placement: Array = field(default_factory=lambda: np.eye(4))
    dofs: tuple[Dof, ...] = ()
    open: bool = False


def between_frames(name: str | None, parent_pose: Array, dofs: tuple[Dof, ...], child_pose: Array) -> Joint:
    """The joint T = ``parent_pose`` * motion * ``child_pose``^-1, whose dofs are given in the joint's own frame.

    C M C^-1 turns about, or slides along, C's image of the axis, through C's image of the anchor.
    """
    turn, shift = child_pose[:3, :3], child_pose[:3, 3]
    moved = tuple(replace(dof, axis=turn @ dof.axis, anchor=turn @ dof.anchor + shift) for dof in dofs)
    back = np.eye(4)
    back[:3, :3], back[:3, 3] = turn.T, -(turn.T @ shift)
    return Joint(name, parent_pose @ back, moved)


class Role(Enum):
    """The purpose of a shape. ``BOTH`` collides and is drawn."""

    VISUAL = "visual"
    COLLISION = "collision"
    BOTH = "both"


class Surface(Struct, frozen=True, eq=False):
    """The triangles of a mesh in its own frame after scaling: ``vertices`` (n, 3) in m and ``faces`` (m, 3).

    ``polygons``: whether its file has larger faces, which each reader splits in its own way. ``other``: the same file with these split as
    MuJoCo splits them, (points, triangles).
    """

    vertices: Array
    faces: Index
    polygons: bool = False
    other: tuple[Array, Index] | None = None


class MeshFile(Struct, frozen=True):
    """A mesh file that is read only when it is compared: ``path`` is None when it was not found."""

    uri: str
    path: Path | None
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)


class Shape(Struct, frozen=True, eq=False):
    """A geometry on a body: ``pose`` in the body frame; ``size`` in m.

    Sizes: box full lengths (3), sphere radius, cylinder and capsule radius and length along z (without caps), ellipsoid
    half axes (3), plane none. A mesh has a ``mesh``: its triangles, or the file that holds them.
    """

    kind: str
    role: Role
    pose: Array
    size: tuple[float, ...] = ()
    name: str | None = None
    mesh: Surface | MeshFile | None = None


class Body(Struct, frozen=True, eq=False):
    """A rigid body: mass in kg, centre of mass in m and tensor about it in kg m^2, both in body axes.

    ``parent`` is the index of the body at the other end of ``joint``. ``inertia_is_known`` is False where the file has no
    inertia and each engine computes another one; ``tensor_is_known`` is False where it has a mass and no tensor.
    """

    name: str | None
    parent: int
    joint: Joint
    mass: float = 0.0
    com: Array = field(default_factory=lambda: np.zeros(3))
    tensor: Array = field(default_factory=lambda: np.zeros((3, 3)))
    shapes: tuple[Shape, ...] = ()
    inertia_is_known: bool = True
    tensor_is_known: bool = True


class Coupling(Struct, frozen=True):
    """A scalar dof that follows: q = constant + sum over leaders of c1 q + c2 q^2 + ... in absolute coordinates.

    ``follower`` and the leaders are indices into the model's dofs.
    """

    follower: int
    constant: float = 0.0
    leaders: tuple[tuple[int, tuple[float, ...]], ...] = ()
    name: str | None = None

    @property
    def straight(self) -> bool:
        """Whether it is a constant plus a multiple of at most one leader."""
        return len(self.leaders) < 2 and not any(any(coefficients[1:]) for _, coefficients in self.leaders)


class Loop(Struct, frozen=True, eq=False):
    """A closure: frame ``pose_a`` on body a meets ``pose_b`` on body b.

    ``kind``: ``connect`` (origins coincide), ``weld`` (frames coincide), ``hinge`` (origins and z axes), ``slide``
    (frames up to a motion along z), ``cylinder`` (z lines), ``other`` (as weld; ``words`` name the free motions).
    """

    kind: str
    body_a: int
    pose_a: Array
    body_b: int
    pose_b: Array
    name: str | None = None
    words: str = ""


Point = tuple[float, float, float]

JOINT, SITE, SIDE, SPHERE, CYLINDER, PULLEY = "joint", "site", "side", "sphere", "cylinder", "pulley"
"""The kinds of steps. A side is a point beside the shape before it; the cable passes the shape on that side."""


def point_of(numbers: Array) -> Point:
    """Three numbers of an array, in m or without unit, as they are."""
    x, y, z = (float(number) for number in numbers)
    return x, y, z


class Step(Struct, frozen=True):
    """One step of a path. ``on``: the dof of a joint, the body of everything else but a pulley, as indices into the model.

    ``number``: the coefficient of a joint, the divisor of a pulley, the radius of a shape in m. ``point`` is where a site is,
    or the centre of a shape, in m in the body's frame; ``axis`` is the direction of a cylinder there, as a unit vector.
    """

    kind: str
    on: int = -1
    number: float = 0.0
    point: Point | None = None
    axis: Point | None = None


class SpringRange(Struct, frozen=True):
    """The lengths ``between`` which a tendon exerts no force; None: an engine computes them from the pose at rest.

    ``at_rest``: whether they are the length in that pose.
    """

    between: tuple[float, float] | None = None
    at_rest: bool = True


RELAXED = SpringRange()


class Tendon(Struct, frozen=True):
    """A cable through points and around shapes, or a weighted sum of joint coordinates.

    ``mechanics``: stiffness, damping, friction, armature. ``limits`` are its least and greatest length, ``force`` the least and
    greatest force of all actuators on it; None = unlimited. ``spring`` matters where it is stiff. ``curves`` holds the higher
    coefficients of stiffness and damping: empty where all are zero, None where the format or its reader does not represent them.
    """

    name: str | None
    path: tuple[Step, ...]
    mechanics: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    limits: tuple[float, float] | None = None
    force: tuple[float, float] | None = None
    spring: SpringRange = RELAXED
    curves: tuple[float, ...] | None = None


class Record(Struct, frozen=True):
    """Words and numbers that are compared one by one: an actuator with its target, a sensor, or a coupling of tendons.

    A reader that only knows that there is one leaves both empty. ``kind`` is that of a sensor in the reader's words.
    """

    name: str | None
    words: tuple[str, ...]
    numbers: tuple[float, ...]
    kind: str = ""


class KinematicModel(Struct, frozen=True, eq=False, dict=True):
    """One robot as one engine sees it. ``bodies[0]`` is the world; a parent always comes before its children.

    ``precision`` is the relative accuracy of its numbers (double or float32); ``is_independent`` is False when the reader is
    this project's own; ``notes`` are findings of the reader that the verdict repeats. ``features`` are those that format and
    reader represent, except those in ``unrepresented`` for dofs of one kind; ``unread`` are those that only the reader lacks.
    ``sensor_kinds`` are those that the format has, None for all.
    """

    name: str
    format: str
    engine: str
    bodies: tuple[Body, ...]
    couplings: tuple[Coupling, ...] = ()
    loops: tuple[Loop, ...] = ()
    actuators: tuple[Record, ...] = ()
    sensors: tuple[Record, ...] = ()
    tendons: tuple[Tendon, ...] = ()
    tied_tendons: tuple[Record, ...] = ()
    features: frozenset[Feature] = frozenset(Feature)
    unrepresented: frozenset[tuple[Feature, Kind]] = frozenset()
    unread: frozenset[Feature] = frozenset()
    sensor_kinds: frozenset[str] | None = None
    precision: float = 1e-15
    is_independent: bool = True
    notes: tuple[str, ...] = ()

    def represents(self, feature: Feature, kind: Kind) -> bool:
        """Whether the format and its reader represent this of a dof of this kind."""
        return feature in self.features and (feature, kind) not in self.unrepresented

    @cached_property
    def row(self) -> Format:
        """Its format's row in the table; for a mechanism in memory a row without particulars."""
        return next((row for row in FORMATS if row.name == self.format), Format(self.format, "", (), None, None))

    @cached_property
    def dofs(self) -> tuple[Dof, ...]:
        """Every dof of every joint, in body order."""
        return tuple(dof for body in self.bodies for dof in body.joint.dofs)

    @cached_property
    def first_dof(self) -> tuple[int, ...]:
        """For each body the index of its joint's first dof."""
        counts = [len(body.joint.dofs) for body in self.bodies]
        return tuple(int(n) for n in np.concatenate(([0], np.cumsum(counts)[:-1])))

    @cached_property
    def body_of_dof(self) -> tuple[int, ...]:
        """For each dof the child body of its joint."""
        return tuple(index for index, body in enumerate(self.bodies) for _ in body.joint.dofs)

    @cached_property
    def columns(self) -> tuple[int, ...]:
        """For each dof its first column in a coordinate vector."""
        widths = [dof.kind.width for dof in self.dofs]
        return tuple(int(n) for n in np.concatenate(([0], np.cumsum(widths)[:-1]))) if widths else ()

    @cached_property
    def width(self) -> int:
        """The length of a coordinate vector."""
        return sum(dof.kind.width for dof in self.dofs)

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """For each body its children, in order."""
        children: list[list[int]] = [[] for _ in self.bodies]
        for index, body in enumerate(self.bodies[1:], start=1):
            children[body.parent].append(index)
        return tuple(tuple(indices) for indices in children)

    @cached_property
    def index(self) -> Mapping[str, int]:
        """The body of each name; of two bodies with one name the first."""
        found: dict[str, int] = {}
        for index, body in enumerate(self.bodies):
            if body.name is not None:
                found.setdefault(body.name, index)
        return found

    def body_label(self, index: int) -> str:
        """``body 'forearm'``, or the number of a body without a name."""
        name = self.bodies[index].name
        return f"body '{name}'" if name is not None else f"the unnamed body {index}"

    def dof_label(self, index: int) -> str:
        """``joint 'elbow'``, or the child body of a joint without a name."""
        body = self.body_of_dof[index]
        name = self.dofs[index].name or self.bodies[body].joint.name
        return f"joint '{name}'" if name is not None else f"the joint above {self.body_label(body)}"


def world_body(name: str = "world", shapes: tuple[Shape, ...] = ()) -> Body:
    """The world as a body, the first of a model's bodies."""
    return Body(name, -1, Joint(), shapes=shapes)


def parents_first(roots: Iterable[K], children: Mapping[K, Sequence[K]]) -> list[K]:
    """The nodes of a forest in depth-first order, children in their own order."""
    order: list[K] = []
    stack = list(roots)[::-1]
    while stack:
        node = stack.pop()
        order.append(node)
        stack.extend(reversed(children.get(node, ())))
    return order
