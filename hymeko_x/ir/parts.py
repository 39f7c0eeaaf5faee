"""The parts that vertices and edges of a mechanism carry: frozen values.

A property is not a connection: no part names another element; all connections are arcs. Which arcs an edge has,
with which sign, weight and role, stands in the docstring of its part. So parts are in no cycle, and Python's collector of
cycles need not look at them (``gc=False``).
"""

from __future__ import annotations

from enum import Enum

from msgspec import Struct

from hymeko_x.ir.fields import Data as Data
from hymeko_x.ir.fields import DataValue as DataValue
from hymeko_x.ir.fields import Noted
from hymeko_x.ir.fields import Parameters as Parameters
from hymeko_x.ir.geometry import Box as Box
from hymeko_x.ir.geometry import Capsule as Capsule
from hymeko_x.ir.geometry import Cylinder as Cylinder
from hymeko_x.ir.geometry import Ellipsoid as Ellipsoid
from hymeko_x.ir.geometry import Geometry as Geometry  # noqa: TC001 - for those who import it from here
from hymeko_x.ir.geometry import MeshShape as MeshShape
from hymeko_x.ir.geometry import NoShape as NoShape
from hymeko_x.ir.geometry import Plane as Plane
from hymeko_x.ir.geometry import Sphere as Sphere
from hymeko_x.ir.lumped import Constitutive, Damper, Mass, Port, Spring
from hymeko_x.ir.values import ZERO, Pose, Tensor, Vec3, Written, X

Rgba = tuple[float, float, float, float]


# ---- vertices: bodies ----------------------------------------------------------------------------------------------------


class Inertial(Noted, frozen=True, gc=False):
    """Mass in kg, centre of mass in m in the body frame, inertia tensor in kg m^2 about it in body axes. None = unspecified.

    ``written`` remembers the turned axes (``Pose.written`` style rotation) and the tensor as given in them.
    """

    mass: float | None = None
    com: Vec3 = ZERO
    tensor: Tensor | None = None
    written: InertialWritten | None = None


class InertialWritten(Struct, frozen=True, gc=False, forbid_unknown_fields=True):
    """An inertia tensor as its author gave it: in the axes of ``frame`` (a pose at the centre of mass)."""

    frame: Pose
    tensor: Tensor


class Body(Struct, frozen=True, gc=False):
    """A rigid body. ``inertial`` None means that its mass is unspecified."""

    inertial: Inertial | None = None


class World(Struct, frozen=True, gc=False):
    """The inertial frame. Exactly one vertex, ``WORLD``, carries it; its shapes are the world's geometry."""


class Frame(Struct, frozen=True, gc=False):
    """A named pose on a body (an MJCF site, an SDF frame): a :class:`Mount` places it. ``size`` in m is for display."""

    size: tuple[float, ...] = ()


# ---- vertices: appearance and assets --------------------------------------------------------------------------------------------


class Material(Struct, frozen=True, gc=False):
    """A surface. ``name`` is what the author called it (ids are unique, names need not be); None colours are unspecified."""

    name: str | None = None
    rgba: Rgba | None = None
    specular: float | None = None
    shininess: float | None = None
    reflectance: float | None = None
    emission: float | None = None
    metallic: float | None = None
    roughness: float | None = None


class Texture(Struct, frozen=True, gc=False):
    """An image, by uri as the source wrote it; a :class:`Layer` puts it on a material."""

    uri: str | None = None
    name: str | None = None


class Mesh(Struct, frozen=True, gc=False):
    """A triangle mesh: a file by uri as the source wrote it, or inline data; ``scale`` applies to its points.

    ``vertices`` and ``faces`` are flat (3 numbers each); ``name`` is set where the format names its meshes. ``texcoords`` are
    places in an image (flat, 2 numbers each, from its lower left corner), ``texfaces`` the rows of them at the corners of ``faces``.
    ``normals`` are unit vectors (flat, 3 numbers each), ``normalfaces`` the rows of them at these corners.
    """

    uri: str | None = None
    scale: Vec3 = (1.0, 1.0, 1.0)
    name: str | None = None
    vertices: tuple[float, ...] = ()
    faces: tuple[int, ...] = ()
    texcoords: tuple[float, ...] = ()
    texfaces: tuple[int, ...] = ()
    normals: tuple[float, ...] = ()
    normalfaces: tuple[int, ...] = ()

    def without_points(self) -> Mesh:
        """The mesh without anything that a file of it would have."""
        return Mesh(self.uri, self.scale, self.name)


MESH_POINTS = ("vertices", "faces", "texcoords", "texfaces", "normals", "normalfaces")
"""The fields of a mesh that a file of it would have."""

# ---- vertices: elements on bodies -----------------------------------------------------------------------------------------


class Actuator(Struct, frozen=True, gc=False):
    """What drives: ``kind`` (motor, position, velocity, transmission, muscle, ...) and its parameters in order."""

    kind: str = "motor"
    parameters: Parameters = ()


class Sensor(Struct, frozen=True, gc=False):
    """What measures: ``kind`` (imu, force, jointpos, ...), update ``rate`` in Hz, and its parameters in order."""

    kind: str
    rate: float | None = None
    parameters: Parameters = ()


class Camera(Struct, frozen=True, gc=False):
    """A camera looking along its own -z, y up. ``fovy`` is the vertical field of view in rad."""

    fovy: float | None = None
    resolution: tuple[int, int] | None = None
    parameters: Parameters = ()


class Light(Struct, frozen=True, gc=False):
    """A light shining along its own -z. ``kind``: spot, directional, point, image."""

    kind: str = "spot"
    diffuse: Vec3 | None = None
    parameters: Parameters = ()


class PoseSet(Struct, frozen=True, gc=False):
    """A named configuration (keyframe, group state): a :class:`Stance` edge has the value of each joint. ``time`` in s."""

    group: str | None = None
    time: float | None = None
    parameters: Parameters = ()


# ---- vertices and edges of plain hypergraphs -----------------------------------------------------------------------------------


class Datum(Struct, frozen=True, gc=False):
    """A vertex that only carries data: data of a hypergraph that no robot part represents."""

    parameters: Data = ()


# ---- edges: shapes and mounts --------------------------------------------------------------------------------------------------


class Role(Enum):
    """What a shape is for."""

    VISUAL = "visual"
    COLLISION = "collision"
    BOTH = "both"


class Shape(Struct, frozen=True, gc=False):
    """A geometry on a body. Arcs: ``+ body`` weight Pose (shape frame in the body); ``~ mesh``; ``~ material`` (roles so named).

    ``name`` as its author gave it, not necessarily unique; ``rgba`` overrides the material; ``mass`` in kg and
    ``density`` in kg/m^3 count where the body's inertial comes from its shapes; ``friction`` is sliding, torsional, rolling.
    """

    geometry: Geometry
    role: Role
    name: str | None = None
    rgba: Rgba | None = None
    mass: float | None = None
    density: float | None = None
    friction: tuple[float, ...] = ()


class Mount(Struct, frozen=True, gc=False):
    """Where a frame, camera, light or sensor sits. Arcs: ``+ body`` weight Pose (its frame in the body), ``- element``."""


class Layer(Struct, frozen=True, gc=False):
    """A texture on a material. Arcs: ``+ texture``, ``- material``. ``use``: rgb, normal, occlusion, roughness, metallic, ..."""

    use: str = "rgb"


class Subset(Struct, frozen=True, gc=False):
    """Triangles of a shape's mesh that show another material than the rest of it. Arcs: ``+ shape``, ``- material``.

    ``faces`` are the numbers of the triangles in the mesh, ascending.
    """

    faces: tuple[int, ...] = ()


# ---- edges: kinematics -----------------------------------------------------------------------------------------------------------


class DofKind(Enum):
    """How one degree of freedom moves; ball has three and free six coordinates' worth of velocity."""

    HINGE = "hinge"
    SLIDE = "slide"
    SCREW = "screw"
    BALL = "ball"
    FREE = "free"


class Limits(Struct, frozen=True, gc=False, forbid_unknown_fields=True):
    """Bounds of one dof in rad or m and s, N or Nm; None = unlimited."""

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    acceleration: float | None = None
    jerk: float | None = None


UNLIMITED = Limits()


class Safety(Struct, frozen=True, gc=False, forbid_unknown_fields=True):
    """A soft-limit controller (URDF <safety_controller>): soft bounds in rad or m, gains in 1/s and Nms/rad or Ns/m."""

    k_velocity: float
    k_position: float = 0.0
    soft_lower: float = 0.0
    soft_upper: float = 0.0


class Calibration(Struct, frozen=True, gc=False, forbid_unknown_fields=True):
    """Reference positions for homing (URDF <calibration>), in rad or m."""

    rising: float | None = None
    falling: float | None = None
    reference: float | None = None


class Dof(Noted, frozen=True, gc=False):
    """One degree of freedom of a joint, given in the joint frame.

    ``axis`` is unit (its notation in ``written``), ``anchor`` in m the point that a rotation keeps in place, ``ref`` the
    coordinate at which the child is where the arcs put it. Damping in Nms/rad or Ns/m, ``friction`` in Nm or N,
    ``stiffness`` in Nm/rad or N/m about ``spring_ref``, ``armature`` in kg m^2 or kg, ``pitch`` of a screw in m/rad.
    ``name`` where its format gives it another name than the joint.
    """

    kind: DofKind = DofKind.HINGE
    axis: Vec3 = X
    limits: Limits = UNLIMITED
    damping: float = 0.0
    friction: float = 0.0
    stiffness: float = 0.0
    spring_ref: float = 0.0
    armature: float = 0.0
    ref: float = 0.0
    anchor: Vec3 = ZERO
    pitch: float = 0.0
    safety: Safety | None = None
    calibration: Calibration | None = None
    name: str | None = None
    written: Written | None = None


class Joint(Struct, frozen=True, gc=False):
    """A connection in the tree with ordered dofs; none = fixed.

    Arcs: ``+ parent`` weight Pose P (joint frame in the parent), ``- child`` weight Pose C (joint frame in the child), so that
    T_parent_child(q) = P * prod_i( Tr(a_i) M_i(q_i - ref_i) Tr(-a_i) ) * C^-1.
    """

    dofs: tuple[Dof, ...] = ()


class Coupling(Struct, frozen=True, gc=False):
    """A joint or tendon that follows others. Arcs: ``+ follower`` weight (1,), ``- leader`` weight (c0, c1, ...).

    q_follower = sum over leaders of c0 + c1 q + c2 q^2 + ...; a dof of a joint with several is named by the arc's role.
    """

    active: bool = True


class Loop(Struct, frozen=True, gc=False):
    """A closure of the tree. Arcs: ``~`` two or more bodies or frames, weight Pose (the closure's frame in each).

    ``kind``: connect (points coincide), weld (frames coincide), or joint: the dofs that stay free are ``dofs``.
    """

    kind: str = "connect"
    dofs: tuple[Dof, ...] = ()
    active: bool = True
    parameters: Parameters = ()


class Tendon(Struct, frozen=True, gc=False):
    """A cable or a linear combination. ``kind`` fixed: arcs ``+ joint`` weight (coefficient,).

    ``kind`` spatial: arcs in path order, ``~ frame`` (site), ``~ shape`` of role ``wrap`` with an optional arc of role
    ``side`` after it; a pulley is an arc of role ``pulley`` to the tendon itself with weight (divisor,). Lengths in m.
    """

    kind: str = "spatial"
    limits: Limits = UNLIMITED
    damping: float = 0.0
    stiffness: float = 0.0
    friction: float = 0.0
    armature: float = 0.0
    width: float | None = None
    rgba: Rgba | None = None
    parameters: Parameters = ()


class Drive(Struct, frozen=True, gc=False):
    """Who drives what. Arcs: ``+ actuator``, ``- joint | tendon | frame | body`` weight gear numbers."""

    kind: str = ""
    parameters: Parameters = ()


class Sense(Struct, frozen=True, gc=False):
    """Who measures what. Arcs: ``+ body | frame | joint | ...``, ``- sensor``; a reference is an arc of role ``reference``."""


class Stance(Struct, frozen=True, gc=False):
    """The values of a named configuration. Arcs: ``+ pose set``, ``~ joint`` weight its coordinates in rad or m."""


class Contact(Struct, frozen=True, gc=False):
    """``kind`` pair (these shapes collide) or exclude (these bodies do not). Arcs: ``~`` the two shapes or bodies."""

    kind: str = "exclude"
    parameters: Parameters = ()


class Relation(Struct, frozen=True, gc=False):
    """An edge of a plain hypergraph that means nothing in particular. The weights of its arcs are lists of any shape."""

    parameters: Data = ()


class Nest(Struct, frozen=True, gc=False):
    """What stands inside a vertex or an edge of a plain hypergraph. Arcs: ``+`` the outer element, ``-`` the inner ones in order."""


VertexPart = (
    Body | World | Frame | Material | Texture | Mesh | Actuator | Sensor | Camera | Light | PoseSet | Spring | Damper | Mass | Port | Datum
)
EdgePart = (
    Shape | Mount | Layer | Subset | Joint | Coupling | Loop | Tendon | Drive | Sense | Stance | Contact | Constitutive | Relation | Nest
)
Weight = Pose | tuple[DataValue, ...]
