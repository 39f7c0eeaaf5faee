"""What the attributes of MJCF elements mean, and how they are said: the same table for reader and writer.

A :class:`Group` turns the attributes that belong together into one value of the IR and back; ``seen`` is what
MuJoCo makes of them, so that two ways of saying the same can be told from two ways of saying almost the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from hymeko_x.formats.mjcf_classes import TURNS
from hymeko_x.formats.xml import read_numbers
from hymeko_x.ir.parts import (
    Box,
    Capsule,
    Cylinder,
    DofKind,
    Ellipsoid,
    Inertial,
    InertialWritten,
    MeshShape,
    NoShape,
    Plane,
    Sphere,
)
from hymeko_x.ir.values import (
    IDENTITY,
    NO_ROTATION,
    ZERO,
    Pose,
    Written,
    Z,
    compose,
    inverse,
    number_text,
    numbers_text,
    pose,
    rotate_tensor,
    unit,
)
from hymeko_x.ir.written import length_of, pose_as_written

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.parts import Geometry
    from hymeko_x.ir.values import Vec3

DEGREE = math.pi / 180.0
"""MuJoCo multiplies with this number, and so does everybody who wants the same bits."""


class BadAttribute(Exception):
    """An attribute that MuJoCo refuses; the reader knows the place."""

    def __init__(self, attribute: str, expected: str) -> None:
        super().__init__(attribute, expected)
        self.attribute = attribute
        self.expected = expected


@dataclass(frozen=True, slots=True)
class Settings:
    """What <compiler> says about the meaning of numbers and file names."""

    degree: bool = True
    eulerseq: str = "xyz"
    autolimits: bool = True
    inertia_from_geoms: bool = False
    mesh_folder: str = ""
    texture_folder: str = ""
    strip_path: bool = False


@dataclass(frozen=True, slots=True)
class Group:
    """Attributes that make one value.

    ``needs``: attributes of other groups on which their meaning depends. ``exact``: what is written always says the same.
    """

    key: str
    names: tuple[str, ...]
    read: Callable[[Mapping[str, str], Settings], Any]
    write: Callable[[Any, Settings], dict[str, str]]
    seen: Callable[[Mapping[str, str], Settings], Any]
    needs: tuple[str, ...] = ()
    exact: bool = False


# ---- numbers ---------------------------------------------------------------------------------------------------------------


def numbers_of(said: Mapping[str, str], name: str, least: int, most: int) -> tuple[float, ...] | None:
    """The numbers of an attribute, or None when it is not there. Raises: BadAttribute."""
    text = said.get(name)
    if text is None:
        return None
    found = read_numbers(text)
    if found is None or not least <= len(found) <= most:
        count = f"{least}" if least == most else f"{least} to {most}"
        raise BadAttribute(name, f"{count} finite number{'s' if most > 1 else ''}")
    return found


def vector_of(said: Mapping[str, str], name: str, default: Vec3) -> Vec3:
    """Three numbers."""
    found = numbers_of(said, name, 3, 3)
    return default if found is None else (found[0], found[1], found[2])


def radians(degrees: float) -> float:
    """An angle in rad, in MuJoCo's own arithmetic."""
    return degrees * DEGREE


@lru_cache(65536)
def degrees_text(angle: float) -> str:
    """The shortest number of degrees that MuJoCo turns into this angle in rad, bit for bit where there is one."""
    guess = angle / DEGREE
    for digits in range(1, 18):
        near = float(f"{guess:.{digits}g}")
        if near * DEGREE == angle:
            return number_text(near)
    for near in (math.nextafter(guess, math.inf), math.nextafter(guess, -math.inf)):
        if near * DEGREE == angle:
            return number_text(near)
    return number_text(guess)


def angle_text(angle: float, degree: bool) -> str:
    """An angle in rad in the unit of the file."""
    return degrees_text(angle) if degree else number_text(angle)


def plain(said: Mapping[str, str], names: tuple[str, ...]) -> tuple[Any, ...]:
    """Attributes as numbers where they are numbers, else as text: what does not depend on spelling."""
    return tuple([None if (text := said.get(name)) is None else read_numbers(text) or text for name in names])


# ---- orientations -----------------------------------------------------------------------------------------------------------


def written_turn(said: Mapping[str, str], settings: Settings) -> Written | None:
    """The orientation as it is written; angles in rad. None for none, or for no rotation. Raises: BadAttribute."""
    turn = next((name for name in TURNS if name in said), None)
    if turn is None:
        return None
    count = {"quat": 4, "axisangle": 4, "xyaxes": 6}.get(turn, 3)
    numbers = numbers_of(said, turn, count, count)
    assert numbers is not None
    if turn == "euler":
        if settings.degree:
            numbers = tuple([radians(angle) for angle in numbers])
        return Written(f"euler:{settings.eulerseq}", numbers)
    if turn == "axisangle" and settings.degree:
        numbers = (*numbers[:3], radians(numbers[3]))
    return Written(turn, numbers)


def read_pose(said: Mapping[str, str], settings: Settings) -> Pose:
    """``pos`` and an orientation, or ``fromto``. Raises: BadAttribute."""
    if "fromto" in said:
        points = numbers_of(said, "fromto", 6, 6)
        assert points is not None
        written: Written | None = Written("fromto", points)
    else:
        written = written_turn(said, settings)
    xyz = vector_of(said, "pos", ZERO)
    if written is None:
        return Pose(xyz)
    try:
        if written.kind == "quat":
            return pose(xyz, written.numbers)  # type: ignore[arg-type]
        return pose_as_written(xyz, written)
    except ZeroDivisionError as error:
        name = "euler" if written.kind.startswith("euler") else written.kind
        raise BadAttribute(name, "numbers that are a rotation") from error


def write_turn(quat: tuple[float, ...], written: Written | None, settings: Settings) -> dict[str, str]:
    """The orientation as its author wrote it, else as a quaternion; nothing for no rotation."""
    if written is None:
        return {} if quat == NO_ROTATION else {"quat": numbers_text(quat)}
    kind, numbers = written
    if kind == f"euler:{settings.eulerseq}":
        return {"euler": " ".join([angle_text(angle, settings.degree) for angle in numbers])}
    if kind == "axisangle":
        return {"axisangle": f"{numbers_text(numbers[:3])} {angle_text(numbers[3], settings.degree)}"}
    if kind in ("quat", "xyaxes", "zaxis"):
        return {kind: numbers_text(numbers)}
    return {"quat": numbers_text(quat)}


def write_pose(value: Pose, settings: Settings) -> dict[str, str]:
    """``pos`` and the orientation, or ``fromto``."""
    if value.written is not None and value.written.kind == "fromto":
        return {"fromto": numbers_text(value.written.numbers)}
    said = {} if value.xyz == ZERO else {"pos": numbers_text(value.xyz)}
    return said | write_turn(value.quat, value.written, settings)


def same_pose(a: Pose, b: Pose) -> bool:
    """Whether two poses are equal and written alike."""
    return a == b and a.written == b.written


_POSE_NAMES = ("pos", "quat", "euler", "axisangle", "xyaxes", "zaxis")


def _seen_pose(said: Mapping[str, str], settings: Settings) -> Any:
    if "fromto" in said:
        return plain(said, ("fromto",))
    turn = plain(said, TURNS)
    return read_numbers(said.get("pos", "0 0 0")), turn if any(turn) else ((1.0, 0.0, 0.0, 0.0), *[None] * 4)


POSE = Group("pose", _POSE_NAMES, read_pose, write_pose, _seen_pose)
SITE_POSE = Group("pose", (*_POSE_NAMES, "fromto"), read_pose, write_pose, _seen_pose)


def seen_from(group: Group, frame: Pose) -> Group:
    """A group of a pose, for an element that stands in a <frame>: its value is seen from the body."""

    def read(said: Mapping[str, str], settings: Settings) -> Any:
        value = group.read(said, settings)
        return replace(value, pose=compose(frame, value.pose)) if isinstance(value, Place) else compose(frame, value)

    def write(value: Any, settings: Settings) -> dict[str, str]:
        back = inverse(frame)
        inner = replace(value, pose=compose(back, value.pose)) if isinstance(value, Place) else compose(back, value)
        return group.write(inner, settings)

    return replace(group, read=read, write=write)


def same_value(a: Any, b: Any) -> bool:
    """Whether two values are equal, and written alike where it is remembered."""
    if a != b:
        return False
    if isinstance(a, Pose) and isinstance(b, Pose):
        return a.written == b.written
    if isinstance(a, Place) and isinstance(b, Place):
        return a.pose.written == b.pose.written
    if isinstance(a, Inertial) and isinstance(b, Inertial):
        return a.written == b.written and (a.written is None or b.written is None or a.written.frame.written == b.written.frame.written)
    return True


# ---- plain groups ------------------------------------------------------------------------------------------------------------


def real(name: str, default: float | None = None) -> Group:
    """One number."""

    def read(said: Mapping[str, str], settings: Settings) -> float | None:
        found = numbers_of(said, name, 1, 1)
        return default if found is None else found[0]

    def write(value: float | None, settings: Settings) -> dict[str, str]:
        return {} if value is None else {name: number_text(value)}

    return Group(name, (name,), read, write, _seen(name, default), exact=True)


def first_real(name: str, default: float) -> Group:
    """One number, of which some formats want more (coefficients of a polynomial); only the first one is typed."""

    def read(said: Mapping[str, str], settings: Settings) -> float:
        found = numbers_of(said, name, 1, 3)
        return default if found is None else found[0]

    def write(value: float, settings: Settings) -> dict[str, str]:
        return {name: number_text(value)}

    return Group(name, (name,), read, write, _seen(name, default))


def reals(name: str, least: int, most: int) -> Group:
    """Some numbers; empty when there are none."""

    def read(said: Mapping[str, str], settings: Settings) -> tuple[float, ...]:
        return numbers_of(said, name, least, most) or ()

    def write(value: tuple[float, ...], settings: Settings) -> dict[str, str]:
        return {name: numbers_text(value)} if value else {}

    return Group(name, (name,), read, write, _seen(name, None), exact=True)


def text(name: str) -> Group:
    """A text, such as a reference."""
    return Group(
        name,
        (name,),
        lambda said, settings: said.get(name),
        lambda value, settings: {} if value is None else {name: value},
        lambda said, settings: said.get(name),
        exact=True,
    )


def _seen(name: str, default: float | None) -> Callable[[Mapping[str, str], Settings], Any]:
    def seen(said: Mapping[str, str], settings: Settings) -> Any:
        found = said.get(name)
        return ((default,) if default is not None else None) if found is None else read_numbers(found)

    return seen


# ---- joints ------------------------------------------------------------------------------------------------------------------

DOF_KINDS = {"hinge": DofKind.HINGE, "slide": DofKind.SLIDE, "ball": DofKind.BALL, "free": DofKind.FREE}
_DOF_WORDS = {kind: word for word, kind in DOF_KINDS.items()}
_TURNING = (None, "hinge", "ball")


def _read_kind(said: Mapping[str, str], settings: Settings) -> DofKind:
    word = said.get("type", "hinge")
    if word not in DOF_KINDS:
        raise BadAttribute("type", f"one of {', '.join(DOF_KINDS)}")
    return DOF_KINDS[word]


def _read_axis(said: Mapping[str, str], settings: Settings) -> tuple[Vec3, Written | None]:
    if said.get("type") in ("ball", "free"):
        return Z, None
    raw = vector_of(said, "axis", Z)
    try:
        axis = unit(raw)
    except ZeroDivisionError as error:
        raise BadAttribute("axis", "a direction") from error
    return axis, None if axis == raw else Written("axis", raw)


def _write_axis(value: tuple[Vec3, Written | None], settings: Settings) -> dict[str, str]:
    axis, written = value
    return {"axis": numbers_text(written.numbers if written and written.kind == "axis" else axis)}


def _motion(name: str) -> Group:
    """A coordinate of a joint: an angle in the unit of the file, or a length."""

    def in_degrees(said: Mapping[str, str], settings: Settings) -> bool:
        return settings.degree and said.get("type") in _TURNING

    def read(said: Mapping[str, str], settings: Settings) -> float:
        found = numbers_of(said, name, 1, 1)
        if found is None:
            return 0.0
        return radians(found[0]) if in_degrees(said, settings) else found[0]

    def write(value: tuple[float, DofKind], settings: Settings) -> dict[str, str]:
        coordinate, kind = value
        return {name: angle_text(coordinate, settings.degree and kind is not DofKind.SLIDE)}

    return Group(name, (name,), lambda said, s: (read(said, s), _read_kind(said, s)), write, _seen(name, 0.0), ("type",))


Span = tuple[float, float] | None


def _is_limited(said: Mapping[str, str], settings: Settings, span: str, flag: str) -> bool:
    found = numbers_of(said, span, 2, 2)
    word = said.get(flag, "auto")
    if word not in ("true", "false", "auto"):
        raise BadAttribute(flag, "true, false or auto")
    ordered = found is not None and found[0] < found[1]
    if word == "true" and not ordered and said.get("type") not in ("ball", "free"):
        raise BadAttribute(span, f"a lower and a greater number, since {flag} is true")
    return ordered and (word == "true" or (word == "auto" and settings.autolimits))


def span(name: str, flag: str, *, angular: bool = False) -> Group:
    """An interval with its flag; None where it does not hold."""

    def read(said: Mapping[str, str], settings: Settings) -> tuple[Span, DofKind]:
        kind = _read_kind(said, settings) if angular else DofKind.SLIDE
        if not _is_limited(said, settings, name, flag):
            return None, kind
        low, high = numbers_of(said, name, 2, 2) or (0.0, 0.0)
        if angular and settings.degree and kind is not DofKind.SLIDE:
            return (radians(low), radians(high)), kind
        return (low, high), kind

    def write(value: tuple[Span, DofKind], settings: Settings) -> dict[str, str]:
        found, kind = value
        if found is None:
            return {flag: "false"}
        degree = angular and settings.degree and kind is not DofKind.SLIDE
        said = {name: f"{angle_text(found[0], degree)} {angle_text(found[1], degree)}"}
        return said if settings.autolimits else {flag: "true", **said}

    def seen(said: Mapping[str, str], settings: Settings) -> Any:
        found, word = read_numbers(said.get(name, "0 0")) or (0.0, 0.0), said.get(flag, "auto")
        return found, word == "true" or (word == "auto" and settings.autolimits and found[0] < found[-1])

    return Group(name, (name, flag), read, write, seen, ("type",) if angular else ())


KIND = Group(
    "type", ("type",), _read_kind, lambda value, settings: {"type": _DOF_WORDS[value]}, lambda said, settings: said.get("type", "hinge")
)
AXIS = Group("axis", ("axis",), _read_axis, _write_axis, lambda said, settings: read_numbers(said.get("axis", "0 0 1")), ("type",))
ANCHOR = Group(
    "pos",
    ("pos",),
    lambda said, settings: vector_of(said, "pos", ZERO),
    lambda value, settings: {"pos": numbers_text(value)},
    lambda said, settings: read_numbers(said.get("pos", "0 0 0")),
)
REF = _motion("ref")
SPRING_REF = _motion("springref")

JOINT = (
    KIND,
    AXIS,
    ANCHOR,
    span("range", "limited", angular=True),
    REF,
    SPRING_REF,
    first_real("stiffness", 0.0),
    first_real("damping", 0.0),
    real("frictionloss", 0.0),
    real("armature", 0.0),
    span("actuatorfrcrange", "actuatorfrclimited"),
)


# ---- geoms -------------------------------------------------------------------------------------------------------------------

_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3, "plane": 3}
GRID = 0.05


@dataclass(frozen=True, slots=True)
class Place:
    """What a geom is and where: its geometry, its pose, and the distance of a plane's grid lines in m."""

    geometry: Geometry
    pose: Pose
    grid: float | None = None


def _read_place(said: Mapping[str, str], settings: Settings) -> Place:
    pose = read_pose(said, settings)
    word = said.get("type", "sphere")
    if word == "mesh" and "mesh" in said:
        return Place(MeshShape(), pose)
    if word not in _SIZES or "mesh" in said:
        return Place(NoShape(), pose)
    size = list(numbers_of(said, "size", 1, 3) or ())
    length = None if pose.written is None or pose.written.kind != "fromto" else length_of(pose.written)
    if length is not None and word not in ("capsule", "cylinder", "box", "ellipsoid"):
        raise BadAttribute("fromto", "a capsule, cylinder, box or ellipsoid")
    if length is not None:
        size = _sizes_along(word, size, length / 2.0)
    if len(size) < _SIZES[word]:
        raise BadAttribute("size", f"{_SIZES[word]} number{'s' if _SIZES[word] > 1 else ''} for a {word}")
    return Place(_geometry(word, size, length), pose, size[2] if word == "plane" else None)


def _sizes_along(word: str, size: list[float], half: float) -> list[float]:
    if word in ("capsule", "cylinder"):
        return [*size[:1], half]
    return [*size[:1], size[1] if len(size) > 1 else size[0], half] if size else []


def _geometry(word: str, size: list[float], length: float | None) -> Geometry:
    match word:
        case "sphere":
            return Sphere(size[0])
        case "capsule":
            return Capsule(size[0], size[1] * 2.0 if length is None else length)
        case "cylinder":
            return Cylinder(size[0], size[1] * 2.0 if length is None else length)
        case "box":
            return Box((size[0] * 2.0, size[1] * 2.0, size[2] * 2.0))
        case "ellipsoid":
            return Ellipsoid((size[0], size[1], size[2]))
        case _:
            return Plane((size[0], size[1]))


def _write_place(value: Place, settings: Settings) -> dict[str, str]:
    word, size = _word_and_size(value)
    said = {"type": word} if word else {}
    pose = value.pose
    if pose.written is not None and pose.written.kind == "fromto":
        along = {"capsule": 1, "cylinder": 1, "box": 2, "ellipsoid": 2}.get(word or "")
        if along is not None and size[along] == length_of(pose.written) / 2.0:
            size = size[:along]
        else:
            pose = Pose(pose.xyz, pose.quat)
    if size:
        said["size"] = numbers_text(size)
    return said | write_pose(pose, settings)


def _word_and_size(value: Place) -> tuple[str | None, tuple[float, ...]]:
    match value.geometry:
        case Sphere(radius):
            return "sphere", (radius,)
        case Capsule(radius, length):
            return "capsule", (radius, length / 2.0)
        case Cylinder(radius, length):
            return "cylinder", (radius, length / 2.0)
        case Box((x, y, z)):
            return "box", (x / 2.0, y / 2.0, z / 2.0)
        case Ellipsoid(radii):
            return "ellipsoid", radii
        case Plane((x, y)):
            return "plane", (x, y, GRID if value.grid is None else value.grid)
        case MeshShape():
            return "mesh", ()
        case _:
            return None, ()


def _seen_place(said: Mapping[str, str], settings: Settings) -> Any:
    word = said.get("type", "sphere")
    size = [*(read_numbers(said.get("size", "")) or ()), 0.0, 0.0, 0.0][:3]
    if "fromto" in said:
        size[1 if word in ("capsule", "cylinder") else 2] = 0.0
        size[1] = size[1] or (size[0] if word in ("box", "ellipsoid") else 0.0)
    return word, size, _seen_pose(said, settings)


PLACE = Group("place", ("type", "size", "fromto", *_POSE_NAMES), _read_place, _write_place, _seen_place, ("mesh",))

GEOM = (PLACE, text("mesh"), text("material"), reals("rgba", 4, 4), real("mass"), real("density"), reals("friction", 1, 3))

FITTED_GEOM = tuple(group for group in GEOM if group.key != "mesh")
"""A primitive that MuJoCo fits to a mesh: the mesh's name says what to fit, and stays as it is."""

SITE = (SITE_POSE, reals("size", 1, 3))

# ---- things with parameters ---------------------------------------------------------------------------------------------------


def _degrees(name: str) -> Group:
    """An angle that is always in degrees."""

    def read(said: Mapping[str, str], settings: Settings) -> float | None:
        found = numbers_of(said, name, 1, 1)
        return None if found is None else radians(found[0])

    def write(value: float | None, settings: Settings) -> dict[str, str]:
        return {} if value is None else {name: degrees_text(value)}

    return Group(name, (name,), read, write, _seen(name, None))


CAMERA = (POSE, _degrees("fovy"), reals("resolution", 2, 2))


def _read_shine(said: Mapping[str, str], settings: Settings) -> Pose:
    xyz = vector_of(said, "pos", ZERO)
    raw = vector_of(said, "dir", (0.0, 0.0, -1.0))
    try:
        return pose_as_written(xyz, Written("dir", raw)) if "dir" in said else Pose(xyz)
    except ZeroDivisionError as error:
        raise BadAttribute("dir", "a direction") from error


def _write_shine(value: Pose, settings: Settings) -> dict[str, str]:
    from hymeko_x.ir.values import rotate

    said = {} if value.xyz == ZERO else {"pos": numbers_text(value.xyz)}
    if value.written is not None and value.written.kind == "dir":
        said["dir"] = numbers_text(value.written.numbers)
    elif value.quat != NO_ROTATION:
        said["dir"] = numbers_text(rotate(value.quat, (0.0, 0.0, -1.0)))
    return said


SHINE = Group("pose", ("pos", "dir"), _read_shine, _write_shine, lambda said, settings: plain(said, ("pos", "dir")))


def _read_light_kind(said: Mapping[str, str], settings: Settings) -> str:
    return said.get("type") or ("directional" if said.get("directional") == "true" else "spot")


LIGHT_KIND = Group(
    "kind",
    ("type", "directional"),
    _read_light_kind,
    lambda value, settings: {"type": value},
    lambda said, settings: _read_light_kind(said, settings),
)
LIGHT = (SHINE, LIGHT_KIND, reals("diffuse", 3, 3))

# ---- inertials -----------------------------------------------------------------------------------------------------------------


def _read_inertial(said: Mapping[str, str], settings: Settings) -> Inertial:
    if "pos" not in said or "mass" not in said:
        raise BadAttribute("mass" if "pos" in said else "pos", "a value: <inertial> needs pos and mass")
    mass = numbers_of(said, "mass", 1, 1) or (0.0,)
    com = vector_of(said, "pos", ZERO)
    full = numbers_of(said, "fullinertia", 6, 6)
    diagonal = numbers_of(said, "diaginertia", 3, 3)
    turn = written_turn(said, settings)
    if full is not None:
        if turn is not None or diagonal is not None:
            raise BadAttribute("fullinertia", "no orientation and no diaginertia beside it")
        return Inertial(mass[0], com, full)  # type: ignore[arg-type]
    if diagonal is None:
        return Inertial(mass[0], com)
    tensor = (*diagonal, 0.0, 0.0, 0.0)
    frame = read_pose({name: said[name] for name in TURNS if name in said}, settings)
    if frame == IDENTITY and frame.written is None:
        return Inertial(mass[0], com, tensor)  # type: ignore[arg-type]
    return Inertial(mass[0], com, rotate_tensor(frame.quat, tensor), InertialWritten(frame, tensor))  # type: ignore[arg-type]


def _write_inertial(value: Inertial, settings: Settings) -> dict[str, str]:
    said = {"pos": numbers_text(value.com), "mass": number_text(value.mass or 0.0)}
    if value.tensor is None:
        return said
    if value.written is not None and value.tensor == rotate_tensor(value.written.frame.quat, value.written.tensor):
        turn = write_turn(value.written.frame.quat, value.written.frame.written, settings)
        return {**said, **turn, "diaginertia": numbers_text(value.written.tensor[:3])}
    if not any(value.tensor[3:]):
        return {**said, "diaginertia": numbers_text(value.tensor[:3])}
    return {**said, "fullinertia": numbers_text(value.tensor)}


_INERTIAL_NAMES = ("pos", "mass", "diaginertia", "fullinertia", *TURNS)
INERTIAL = Group(
    "inertial",
    _INERTIAL_NAMES,
    _read_inertial,
    _write_inertial,
    lambda said, settings: (plain(said, ("mass", "diaginertia", "fullinertia")), _seen_pose(said, settings)),
)

MATERIAL = (
    reals("rgba", 4, 4),
    real("specular"),
    real("shininess"),
    real("reflectance"),
    real("emission"),
    real("metallic"),
    real("roughness"),
    text("texture"),
)

SCALE = Group(
    "scale",
    ("scale",),
    lambda said, settings: vector_of(said, "scale", (1.0, 1.0, 1.0)),
    lambda value, settings: {"scale": numbers_text(value)},
    lambda said, settings: read_numbers(said.get("scale", "1 1 1")),
)

MESH = (
    SCALE,
    reals("vertex", 0, 10**9),
    reals("face", 0, 10**9),
)

TENDON = (
    span("range", "limited"),
    first_real("stiffness", 0.0),
    first_real("damping", 0.0),
    real("frictionloss", 0.0),
    real("armature", 0.0),
    real("width"),
    reals("rgba", 4, 4),
)

# ---- free parameters ----------------------------------------------------------------------------------------------------------

_NAMES_ONLY = frozenset(
    {"plugin", "instance", "target", "objname", "refname", "key", "value", "file", "texture", "model", "prefix", "input"}
)


def parameter_value(name: str, said: str) -> float | str | tuple[float, ...]:
    """An attribute as a number, numbers or text; text wherever numbers would not say the same."""
    found = None if name in _NAMES_ONLY else read_numbers(said)
    if not found:
        return said
    return found[0] if len(found) == 1 else found


def parameter_text(value: float | str | tuple[float, ...]) -> str:
    """A parameter as an attribute's text."""
    if isinstance(value, str):
        return value
    return numbers_text(value) if isinstance(value, tuple) else number_text(value)
