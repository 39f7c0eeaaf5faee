"""The words of HyMeKo text that its reader and its writer share: fields, types, names and units."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import formats
from hymeko_x.ir import lumped, parts
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.notations import word
from hymeko_x.ir.values import X

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import RobotArc, RobotEdge


class FieldWord(NamedTuple):
    """A field of the language: its word, the part's attribute, the form of its value, and its dimension for units.

    Forms: number, text, flag, numbers (any count), vec3, rgba (three numbers or four), integers (any count), pixels (two).
    """

    word: str
    attribute: str
    form: str
    dimension: str = ""


class PartWords(NamedTuple):
    """A part and its words, in the order in which they are printed. ``open``: other fields are its parameters."""

    part: type
    words: tuple[FieldWord, ...]
    open: bool = False


def _number(word: str, dimension: str = "") -> FieldWord:
    return FieldWord(word, word, "number", dimension)


def _numbers(words: str) -> tuple[FieldWord, ...]:
    return tuple(map(_number, words.split()))


def _forces(words: str) -> tuple[FieldWord, ...]:
    """Numbers whose dimension has the name of the word (:mod:`hymeko_x.formats.hymeko.units`)."""
    return tuple(_number(word, word) for word in words.split())


def _motions(words: str) -> tuple[FieldWord, ...]:
    """Numbers along a dof: dimension ``motion`` is an angle for dofs that turn and a length for dofs that slide."""
    return tuple(_number(word, "motion") for word in words.split())


_TYPE = FieldWord("type", "kind", "text")
_NAME = FieldWord("name", "name", "text")
_FILE = FieldWord("file", "uri", "text")
_RGBA = FieldWord("rgba", "rgba", "rgba")
_SCALE = FieldWord("scale", "scale", "vec3")
_ACTIVE = FieldWord("active", "active", "flag")
_FACES = FieldWord("faces", "faces", "integers")
_MASS = _number("mass", "mass")
_LAW = FieldWord("law", "law", "text")
_DOMAIN = FieldWord("domain", "domain", "text")
_POINTS = (FieldWord("vertices", "vertices", "numbers", "length"), _FACES)
_TEXTURING = (FieldWord("texcoords", "texcoords", "numbers"), FieldWord("texfaces", "texfaces", "integers"))
_SHADING = (FieldWord("normals", "normals", "numbers"), FieldWord("normalfaces", "normalfaces", "integers"))
_SURFACE = _numbers("specular shininess reflectance emission metallic roughness")

PARTS: Mapping[str, PartWords] = MappingProxyType(
    {
        "frame": PartWords(parts.Frame, (FieldWord("size", "size", "numbers", "length"),)),
        "material": PartWords(parts.Material, (_NAME, _RGBA, *_SURFACE)),
        "texture": PartWords(parts.Texture, (_FILE, _NAME)),
        "mesh": PartWords(parts.Mesh, (_FILE, _SCALE, _NAME, *_POINTS, *_TEXTURING, *_SHADING)),
        "actuator": PartWords(parts.Actuator, (_TYPE,), open=True),
        "sensor": PartWords(parts.Sensor, (_TYPE, _number("rate")), open=True),
        "camera": PartWords(parts.Camera, (_number("fovy", "angle"), FieldWord("resolution", "resolution", "pixels")), open=True),
        "light": PartWords(parts.Light, (_TYPE, FieldWord("diffuse", "diffuse", "vec3")), open=True),
        "pose": PartWords(parts.PoseSet, (FieldWord("group", "group", "text"), _number("time", "time")), open=True),
        "spring": PartWords(lumped.Spring, (*_numbers("stiffness rest"), _LAW, _DOMAIN)),
        "damper": PartWords(lumped.Damper, (*_numbers("damping"), _LAW, _DOMAIN)),
        "mass": PartWords(lumped.Mass, (_MASS, _DOMAIN)),
        "port": PartWords(lumped.Port, (_TYPE, _number("value"), _DOMAIN), open=True),
        "datum": PartWords(parts.Datum, (), open=True),
        "mount": PartWords(parts.Mount, ()),
        "layer": PartWords(parts.Layer, (FieldWord("use", "use", "text"),)),
        "subset": PartWords(parts.Subset, (_FACES,)),
        "coupling": PartWords(parts.Coupling, (_ACTIVE,)),
        "loop": PartWords(parts.Loop, (_TYPE, _ACTIVE), open=True),
        "tendon": PartWords(
            parts.Tendon, (_TYPE, *_forces("damping stiffness friction armature"), _number("width", "length"), _RGBA), open=True
        ),
        "drive": PartWords(parts.Drive, (_TYPE,), open=True),
        "sense": PartWords(parts.Sense, ()),
        "stance": PartWords(parts.Stance, ()),
        "contact": PartWords(parts.Contact, (_TYPE,), open=True),
        "constitutive": PartWords(lumped.Constitutive, ()),
        "relation": PartWords(parts.Relation, (), open=True),
        "nest": PartWords(parts.Nest, ()),
    }
)
"""The parts that fields alone represent; bodies, shapes and joints have readers and writers of their own."""

ATTACHED: Mapping[str, str] = MappingProxyType(
    {
        "frame": "mount",
        "camera": "mount",
        "light": "mount",
        "actuator": "drive",
        "sensor": "sense",
        "pose": "stance",
        "material": "layer",
        "body": "joint",
    }
)
"""Vertices whose block may hold the arcs of the one edge that attaches them: ``tip : frame { [0 0 1] + arm }``.

For a body that is a joint without freedom: ``hand { [0 0 1] + arm mass 2 }``."""

LUMPED_UNITS: Mapping[str, tuple[str, str, str]] = MappingProxyType(
    {"spring": ("stiffness", "N/m", "Nm/rad"), "damper": ("damping", "N*s/m", "Nm*s/rad"), "mass": ("mass", "kg", "kg*m^2")}
)
"""The field of a lumped element whose unit tells its domain, and its units in translation and in rotation."""

SHORT_TYPES: Mapping[tuple[str, str], str] = MappingProxyType(
    {
        ("actuator", "motor"): "motor",
        ("actuator", "position"): "servo",
        ("port", "ground"): "ground",
        ("port", "effort"): "force",
        ("port", "position"): "motion",
        ("port", "pid"): "pid",
        ("port", "feedback"): "feedback",
        ("loop", "connect"): "connect",
        ("loop", "weld"): "weld",
        ("contact", "exclude"): "exclude",
        ("contact", "pair"): "pair",
    }
)
"""Types of the standard vocabulary that stand for an element's kind and its ``type``."""

ROOT_NAME = word("hymeko.root")
"""The notation of the mechanism that keeps the name of the root where it is not that of the mechanism."""
CHILD_CLASS = "childclass"
"""The field of a body that names the default class of MJCF for everything in it; a notation."""

NAMED_AFTER_ID = frozenset({"material"})
"""Parts whose ``name`` is that of the element unless another name or ``unnamed`` is given."""

ALIASES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "spring": MappingProxyType({"spring_constant": "stiffness", "k": "stiffness"}),
        "damper": MappingProxyType({"damping_const": "damping", "c": "damping"}),
        "mesh": MappingProxyType({"url": "file", "uri": "file"}),
        "material": MappingProxyType({"color": "rgba", "rgb": "rgba"}),
    }
)
"""Other words for fields, from the published examples; read, never printed."""

LIMIT_WORDS = (*_motions("lower upper velocity"), *_forces("effort"), *_motions("acceleration jerk"))
"""Bounds of a dof."""

DOF_WORDS = (
    *_forces("damping friction stiffness"),
    _number("spring_ref", "motion"),
    *_forces("armature"),
    _number("ref", "motion"),
    FieldWord("anchor", "anchor", "vec3", "length"),
    _number("pitch", "length"),
    FieldWord("dof_name", "name", "text"),
)
SAFETY_WORDS = (*_numbers("k_velocity k_position"), *_motions("soft_lower soft_upper"))
CALIBRATION_WORDS = _motions("rising falling reference")

SHAPE_WORDS = (_NAME, _RGBA, _MASS, *_forces("density"), FieldWord("friction", "friction", "numbers"))

SHAPE_ROLES: Mapping[parts.Role, str] = MappingProxyType(
    {parts.Role.VISUAL: "visual", parts.Role.COLLISION: "collision", parts.Role.BOTH: "shape"}
)
"""The word of a shape; one without a given id is named after its body and this word."""

SOLIDS: Mapping[str, type[parts.Geometry]] = MappingProxyType(
    {
        "box": parts.Box,
        "sphere": parts.Sphere,
        "ellipsoid": parts.Ellipsoid,
        "cylinder": parts.Cylinder,
        "capsule": parts.Capsule,
        "plane": parts.Plane,
    }
)
"""The geometries that one field represents; those with radius and length have both in it."""

MOVES: Mapping[str, tuple[parts.DofKind, ...]] = MappingProxyType(
    {
        "none": (),
        "hinge": (parts.DofKind.HINGE,),
        "slide": (parts.DofKind.SLIDE,),
        "screw": (parts.DofKind.SCREW,),
        "ball": (parts.DofKind.BALL,),
        "free": (parts.DofKind.FREE,),
    }
)
"""The dofs of a joint type, by its preset ``moves``; those of ``several`` are read from blocks."""

JOINT_TYPES: Mapping[tuple[parts.DofKind, ...], str] = MappingProxyType(
    {
        (): "fixed",
        (parts.DofKind.HINGE,): "",
        (parts.DofKind.SLIDE,): "prismatic",
        (parts.DofKind.SCREW,): "screw",
        (parts.DofKind.BALL,): "ball",
        (parts.DofKind.FREE,): "floating",
    }
)
"""The type that a joint with these dofs is printed with; a joint without a type turns about its axis."""

ROLE_MOVES: Mapping[str, str] = MappingProxyType(
    dict.fromkeys(("REV", "ROT", "CONT"), "hinge")
    | dict.fromkeys(("PRI", "PRISM", "LIN", "TRANS"), "slide")
    | dict.fromkeys(("FIX", "FIXED"), "none")
)
"""Roles on the child's arc that name the joint's type, as in the published listings."""

AXES: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {
        **dict.fromkeys(("X", "AXIS_X"), (1.0, 0.0, 0.0)),
        **dict.fromkeys(("Y", "AXIS_Y"), (0.0, 1.0, 0.0)),
        **dict.fromkeys(("Z", "AXIS_Z"), (0.0, 0.0, 1.0)),
        "AXIS_M_X": (-1.0, 0.0, 0.0),
        "AXIS_M_Y": (0.0, -1.0, 0.0),
        "AXIS_M_Z": (0.0, 0.0, -1.0),
    }
)
"""The standard directions."""

_NO_AXIS = frozenset({parts.DofKind.BALL, parts.DofKind.FREE})


def default_axis(kind: parts.DofKind) -> tuple[float, float, float]:
    """The axis of a dof that names none: z, and x, as in every format, where an axis has no meaning."""
    return X if kind in _NO_AXIS else (0.0, 0.0, 1.0)


POSED_EDGES = frozenset({"joint", "shape", "mount", "loop"})
"""Edges whose arcs are weighted with poses; the others carry plain numbers."""

TARGETS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "joint": ("body", "world"),
        "shape": ("body", "world", "mesh", "material"),
        "mount": ("body", "world", "frame", "camera", "light", "sensor"),
        "layer": ("texture", "material"),
        "subset": ("shape", "material"),
        "coupling": ("joint", "tendon", "mass"),
        "loop": ("body", "frame", "world"),
        "tendon": ("frame", "joint", "shape", "tendon"),
        "drive": ("actuator", "joint", "tendon", "frame", "body"),
        "sense": ("sensor", "body", "frame", "joint", "tendon", "actuator", "shape", "camera", "world", "mass", "constitutive"),
        "stance": ("pose", "joint"),
        "contact": ("shape", "body", "world"),
        "constitutive": ("body", "spring", "damper", "mass", "port", "world"),
        "relation": (),
        "nest": ("datum", "relation"),
    }
)
"""The kinds that a reference in an edge may mean, the likeliest first; empty = any kind."""

FOREIGN = formats.FOREIGN
SETTINGS = FOREIGN | {"extra", "written", "files", "scope"}
"""Fields in the root that are about the whole."""

DOF_TYPES: Mapping[parts.DofKind, str] = MappingProxyType(
    {kind: "floating" if moves == "free" else moves for moves, kinds in MOVES.items() for kind in kinds}
)
"""The type that one of several dofs is printed with."""

TURNING = frozenset({parts.DofKind.HINGE, parts.DofKind.BALL, parts.DofKind.SCREW})
"""The dofs whose coordinates are angles."""

DOF_BLOCKS = SETTINGS | {"dof", "safety", "calibration"}
"""Names of blocks in a joint that are no names of dofs."""

RESERVED = SETTINGS | {"units", "world", "style"}
"""Names that must be quoted to be names of elements; the printer quotes the words of the grammar by itself."""

# ---- edges in the block of a vertex --------------------------------------------------------------------------------------

TEXTURE = "texture"
"""The field of a material that names its texture."""


def attached_key(vertex: Id) -> Id | None:
    """The edge whose arcs may stand in the block of a vertex: it has the vertex's name."""
    kind = ATTACHED.get(vertex.kind)
    return None if kind is None else Id(kind, vertex.name)


def attached_edge(vertex: Id, arcs: tuple[RobotArc, ...]) -> RobotEdge:
    """The edge that attaches a vertex with these arcs in its block: its mount, drive, sense, stance, layer or fixed joint.

    The vertex itself comes after the arcs, for an actuator and a stance before them.
    """
    match vertex.kind:
        case "actuator":
            return Edge(parts.Drive(), (Arc(vertex, 1), *arcs))
        case "pose":
            return Edge(parts.Stance(), (Arc(vertex, 1), *arcs))
        case "sensor":
            return Edge(parts.Sense(), (*arcs, Arc(vertex, -1)))
        case "material":
            return Edge(parts.Layer(), (*arcs, Arc(vertex, -1)))
        case "body":
            return Edge(parts.Joint(()), (*arcs, Arc(vertex, -1)))
        case _:
            return Edge(parts.Mount(), (*arcs, Arc(vertex, -1)))
