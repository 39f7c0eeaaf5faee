"""The words of HyMeKo text that its reader and its writer share: data only."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import formats
from hymeko_x.ir import parts
from hymeko_x.ir.values import X

if TYPE_CHECKING:
    from collections.abc import Mapping


class Word(NamedTuple):
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
    words: tuple[Word, ...]
    open: bool = False


_TYPE = Word("type", "kind", "text")

PARTS: Mapping[str, PartWords] = MappingProxyType(
    {
        "frame": PartWords(parts.Frame, (Word("size", "size", "numbers", "length"),)),
        "material": PartWords(
            parts.Material,
            (
                Word("name", "name", "text"),
                Word("rgba", "rgba", "rgba"),
                Word("specular", "specular", "number"),
                Word("shininess", "shininess", "number"),
                Word("reflectance", "reflectance", "number"),
                Word("emission", "emission", "number"),
                Word("metallic", "metallic", "number"),
                Word("roughness", "roughness", "number"),
            ),
        ),
        "texture": PartWords(parts.Texture, (Word("file", "uri", "text"), Word("name", "name", "text"))),
        "mesh": PartWords(
            parts.Mesh,
            (
                Word("file", "uri", "text"),
                Word("scale", "scale", "vec3"),
                Word("name", "name", "text"),
                Word("vertices", "vertices", "numbers", "length"),
                Word("faces", "faces", "integers"),
                Word("texcoords", "texcoords", "numbers"),
                Word("texfaces", "texfaces", "integers"),
            ),
        ),
        "actuator": PartWords(parts.Actuator, (_TYPE,), open=True),
        "sensor": PartWords(parts.Sensor, (_TYPE, Word("rate", "rate", "number")), open=True),
        "camera": PartWords(parts.Camera, (Word("fovy", "fovy", "number", "angle"), Word("resolution", "resolution", "pixels")), open=True),
        "light": PartWords(parts.Light, (_TYPE, Word("diffuse", "diffuse", "vec3")), open=True),
        "pose": PartWords(parts.PoseSet, (Word("group", "group", "text"), Word("time", "time", "number", "time")), open=True),
        "spring": PartWords(parts.Spring, (Word("stiffness", "stiffness", "number"), Word("rest", "rest", "number"))),
        "damper": PartWords(parts.Damper, (Word("damping", "damping", "number"),)),
        "mass": PartWords(parts.Mass, (Word("mass", "mass", "number", "mass"),)),
        "port": PartWords(parts.Port, (_TYPE, Word("value", "value", "number"))),
        "datum": PartWords(parts.Datum, (), open=True),
        "mount": PartWords(parts.Mount, ()),
        "layer": PartWords(parts.Layer, (Word("use", "use", "text"),)),
        "subset": PartWords(parts.Subset, (Word("faces", "faces", "integers"),)),
        "coupling": PartWords(parts.Coupling, (Word("active", "active", "flag"),)),
        "loop": PartWords(parts.Loop, (_TYPE, Word("active", "active", "flag")), open=True),
        "tendon": PartWords(
            parts.Tendon,
            (
                _TYPE,
                Word("damping", "damping", "number"),
                Word("stiffness", "stiffness", "number"),
                Word("friction", "friction", "number"),
                Word("armature", "armature", "number"),
                Word("width", "width", "number", "length"),
                Word("rgba", "rgba", "rgba"),
            ),
            open=True,
        ),
        "drive": PartWords(parts.Drive, (_TYPE,), open=True),
        "sense": PartWords(parts.Sense, ()),
        "stance": PartWords(parts.Stance, ()),
        "contact": PartWords(parts.Contact, (_TYPE,), open=True),
        "constitutive": PartWords(parts.Constitutive, ()),
        "relation": PartWords(parts.Relation, (), open=True),
    }
)
"""The parts that are said by fields alone; bodies, shapes and joints have readers and writers of their own."""

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
"""Vertices whose block may hold the arcs of the one edge that puts them to use: ``tip : frame { [0 0 1] + arm }``.

For a body that is a joint without freedom: ``hand { [0 0 1] + arm mass 2 }``."""

SHORT_TYPES: Mapping[tuple[str, str], str] = MappingProxyType(
    {
        ("actuator", "motor"): "motor",
        ("actuator", "position"): "servo",
        ("port", "ground"): "ground",
        ("loop", "connect"): "connect",
        ("loop", "weld"): "weld",
        ("contact", "exclude"): "exclude",
        ("contact", "pair"): "pair",
    }
)
"""Types of the standard vocabulary that say an element's kind and its ``type`` in one word."""

CHILD_CLASS = "childclass"
"""The field of a body that names the default class of MJCF for everything in it; a notation."""

NAMED_AFTER_ID = frozenset({"material"})
"""Parts whose ``name`` is that of the element unless something else is said: another name, or ``unnamed``."""

ALIASES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "spring": MappingProxyType({"spring_constant": "stiffness", "k": "stiffness"}),
        "damper": MappingProxyType({"damping_const": "damping", "c": "damping"}),
        "mesh": MappingProxyType({"url": "file", "uri": "file"}),
        "material": MappingProxyType({"color": "rgba", "rgb": "rgba"}),
    }
)
"""Other words for fields, from the published examples; read, never printed."""

LIMIT_WORDS = (
    Word("lower", "lower", "number", "motion"),
    Word("upper", "upper", "number", "motion"),
    Word("velocity", "velocity", "number", "motion"),
    Word("effort", "effort", "number"),
    Word("acceleration", "acceleration", "number", "motion"),
    Word("jerk", "jerk", "number", "motion"),
)
"""Bounds of a dof; dimension ``motion`` is an angle for what turns and a length for what slides."""

DOF_WORDS = (
    Word("damping", "damping", "number"),
    Word("friction", "friction", "number"),
    Word("stiffness", "stiffness", "number"),
    Word("spring_ref", "spring_ref", "number", "motion"),
    Word("armature", "armature", "number"),
    Word("ref", "ref", "number", "motion"),
    Word("anchor", "anchor", "vec3", "length"),
    Word("pitch", "pitch", "number", "length"),
    Word("dof_name", "name", "text"),
)

SAFETY_WORDS = (
    Word("k_velocity", "k_velocity", "number"),
    Word("k_position", "k_position", "number"),
    Word("soft_lower", "soft_lower", "number", "motion"),
    Word("soft_upper", "soft_upper", "number", "motion"),
)
CALIBRATION_WORDS = (
    Word("rising", "rising", "number", "motion"),
    Word("falling", "falling", "number", "motion"),
    Word("reference", "reference", "number", "motion"),
)

SHAPE_WORDS = (
    Word("name", "name", "text"),
    Word("rgba", "rgba", "rgba"),
    Word("mass", "mass", "number", "mass"),
    Word("density", "density", "number"),
    Word("friction", "friction", "numbers"),
)

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
"""What the preset ``moves`` of a joint type means; ``several`` reads the dofs from blocks."""

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
    {
        "REV": "hinge",
        "ROT": "hinge",
        "CONT": "hinge",
        "PRI": "slide",
        "PRISM": "slide",
        "LIN": "slide",
        "TRANS": "slide",
        "FIX": "none",
        "FIXED": "none",
    }
)
"""Roles on the child's arc that tell the joint's type, as in the published listings."""

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
    """The axis of a dof that names none: z, and what every format says where no axis has a meaning."""
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
        "coupling": ("joint", "tendon"),
        "loop": ("body", "frame", "world"),
        "tendon": ("frame", "joint", "shape", "tendon"),
        "drive": ("actuator", "joint", "tendon", "frame", "body"),
        "sense": ("sensor", "body", "frame", "joint", "tendon", "actuator", "shape", "camera", "world"),
        "stance": ("pose", "joint"),
        "contact": ("shape", "body", "world"),
        "constitutive": ("body", "spring", "damper", "mass", "port"),
        "relation": (),
    }
)
"""The kinds that a reference in an edge may mean, the likeliest first; empty = any kind."""

FOREIGN = frozenset({*(format.family for format in formats.FORMATS), "srdf"})
"""Fields of these names hold what a format said verbatim."""

SETTINGS = FOREIGN | {"extra", "written", "files", "scope"}
"""Fields that stand in the root and say something about the whole."""

DOF_TYPES: Mapping[parts.DofKind, str] = MappingProxyType(
    {
        parts.DofKind.HINGE: "hinge",
        parts.DofKind.SLIDE: "slide",
        parts.DofKind.SCREW: "screw",
        parts.DofKind.BALL: "ball",
        parts.DofKind.FREE: "floating",
    }
)
"""The type that one of several dofs is printed with."""

DOF_BLOCKS = SETTINGS | {"dof", "safety", "calibration"}
"""Names of blocks in a joint that are no names of dofs."""

RESERVED = SETTINGS | {"units", "world", "style"}
"""Names that must be quoted to be names of elements; the printer quotes the words of the grammar by itself."""
