"""What the attributes of MJCF geoms, sites, cameras, lights, inertials and assets mean."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.formats.mjcf.classes import TURNS
from hymeko_x.formats.mjcf.codec import (
    POSE,
    POSE_NAMES,
    SITE_POSE,
    AttributeGroup,
    BadAttribute,
    Settings,
    degrees_text,
    numbers_of,
    plain,
    radians,
    read_pose,
    real,
    reals,
    same_pose,
    seen_numbers,
    seen_pose,
    text,
    vector_of,
    write_pose_or_ends,
    write_turn,
    written_turn,
)
from hymeko_x.ir.digits import number_text, numbers_text
from hymeko_x.ir.parts import (
    Box,
    Capsule,
    Cylinder,
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
    apply,
    compose,
    inverse,
    rotate,
    rotate_tensor,
)
from hymeko_x.ir.written import between_ends, length_of, pose_as_written
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import Geometry

# ---- geoms -------------------------------------------------------------------------------------------------------------------

_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3, "plane": 3}
_ALONG = ("capsule", "cylinder", "box", "ellipsoid")
GRID = 0.05
_MARK = 0.005


class GeomPlace(Struct, frozen=True):
    """What a geom is and where: its geometry, its pose, and the distance of a plane's grid lines in m."""

    geometry: Geometry
    pose: Pose
    grid: float | None = None


def _check_ends(attributes: Mapping[str, str], word: str) -> None:
    """Both ends give length and pose, so that a position beside them is refused, as MuJoCo does."""
    if "fromto" not in attributes:
        return
    if word not in _ALONG:
        raise BadAttribute("fromto", "a capsule, cylinder, box or ellipsoid")
    if any(read_numbers(attributes.get("pos", "")) or ()):
        raise BadAttribute("pos", "nothing beside fromto")


def _read_place(attributes: Mapping[str, str], settings: Settings) -> GeomPlace:
    pose = read_pose(attributes, settings)
    word = attributes.get("type", "sphere")
    _check_ends(attributes, word)
    if word == "hfield" and not attributes.get("hfield"):
        raise BadAttribute("hfield", "the name of a height field")
    if word == "mesh" and "mesh" in attributes:
        return GeomPlace(MeshShape(), pose)
    if word not in _SIZES or "mesh" in attributes:
        return GeomPlace(NoShape(), pose)
    size = list(numbers_of(attributes, "size", 1, 3) or ())
    length = None if pose.written is None or pose.written.kind != "fromto" else length_of(pose.written)
    if length is not None:
        size = _sizes_along(word, size, length / 2.0)
    if len(size) < _SIZES[word]:
        raise BadAttribute("size", f"{_SIZES[word]} number{'s' if _SIZES[word] > 1 else ''} for a {word}")
    if any(number <= 0.0 for number in (size[2:3] if word == "plane" else size[: _SIZES[word]])):
        raise BadAttribute("size", "a distance of grid lines that is more than 0" if word == "plane" else "lengths that are more than 0")
    return GeomPlace(_geometry(word, size, length), pose, size[2] if word == "plane" else None)


def _sizes_along(word: str, size: list[float], half: float) -> list[float]:
    """The sizes of a geom between two points: boxes and ellipsoids are square across, whatever else is written."""
    return [*size[:1], half] if word in ("capsule", "cylinder") or not size else [size[0], size[0], half]


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


def _write_place(value: GeomPlace, settings: Settings) -> dict[str, str]:
    word, size = _word_and_size(value)
    attributes = {"type": word} if word else {}
    pose = value.pose
    if pose.written is not None and pose.written.kind == "fromto":
        along = {"capsule": 1, "cylinder": 1, "box": 2, "ellipsoid": 2}.get(word or "")
        if along is not None and _is_between(pose, 2.0 * size[along]) and size[0] == size[along - 1]:
            size = size[:along]
        else:
            pose = Pose(pose.xyz, pose.quat)
    if size:
        attributes["size"] = numbers_text(size)
    return attributes | write_pose_or_ends(pose, settings)


def _word_and_size(value: GeomPlace) -> tuple[str | None, tuple[float, ...]]:
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


def between_its_ends(place: GeomPlace) -> GeomPlace:
    """The geom as two points give it, where its class gives it so, which no position can undo; as it is where points cannot give it."""
    match place.geometry:
        case Capsule(_, found) | Cylinder(_, found) | Box((_, _, found)):
            length = found
        case Ellipsoid((_, _, half)):
            length = 2.0 * half
        case _:
            return place
    return place if _is_between(place.pose, length) else replace(place, pose=between_ends(place.pose, length))


def _is_between(pose: Pose, length: float) -> bool:
    """Whether a pose is written as two points of this distance."""
    written = pose.written
    return written is not None and written.kind == "fromto" and math.isclose(length_of(written), length, rel_tol=1e-12)


def _seen_place(attributes: Mapping[str, str], settings: Settings) -> Any:
    word = attributes.get("type", "sphere")
    size = [*(read_numbers(attributes.get("size", "")) or ()), 0.0, 0.0, 0.0][:3]
    if "fromto" in attributes:
        size[1:] = (size[0], 0.0) if word in ("box", "ellipsoid") else (0.0, size[2])
    return word, size, seen_pose(attributes, settings)


PLACE = AttributeGroup(
    "place",
    ("type", "size", "fromto", *POSE_NAMES),
    _read_place,
    _write_place,
    _seen_place,
    frozenset(("mesh", "hfield")),
    same=lambda a, b: a == b and a.pose.written == b.pose.written,
)

_GREY = (0.5, 0.5, 0.5, 1.0)
_FRICTION = (1.0, 0.005, 0.0001)
GEOM = (
    PLACE,
    text("mesh"),
    text("material"),
    reals("rgba", 4, 4, _GREY),
    real("mass"),
    real("density"),
    reals("friction", 1, 3, _FRICTION),
)

FITTED_GEOM = tuple(group for group in GEOM if group.key != "mesh")
"""A primitive that MuJoCo fits to a mesh: the name of the mesh is kept as it is."""


def _read_site_size(attributes: Mapping[str, str], settings: Settings) -> tuple[float, ...]:
    word = attributes.get("type", "sphere")
    if (word not in _SIZES and word != "mesh") or word == "plane":
        raise BadAttribute("type", "one of sphere, capsule, ellipsoid, cylinder, box, mesh")
    _check_ends(attributes, word)
    found = numbers_of(attributes, "size", 1, 3) or ()
    needed = 1 if "fromto" in attributes else _SIZES.get(word, 0)
    if any(number <= 0.0 for number in (*found, *[_MARK] * 3)[:needed]):
        raise BadAttribute("size", "lengths that are more than 0")
    return found


SITE = (SITE_POSE, replace(reals("size", 1, 3), read=_read_site_size, needs=frozenset(("type", "fromto"))))


def seen_from(group: AttributeGroup, frame: Pose) -> AttributeGroup:
    """A group of a pose, for an element that stands in a <frame>: its value is seen from the body."""

    def read(attributes: Mapping[str, str], settings: Settings) -> Any:
        return _moved(frame, group.read(attributes, settings))

    def write(value: Any, settings: Settings) -> dict[str, str]:
        return group.write(_moved(inverse(frame), value), settings)

    return replace(group, read=read, write=write)


def _moved(frame: Pose, value: Any) -> Any:
    """A value with a pose, seen from where the frame is."""
    if isinstance(value, GeomPlace):
        return replace(value, pose=compose(frame, value.pose))
    if isinstance(value, Inertial):
        tensor = None if value.tensor is None else rotate_tensor(frame.quat, value.tensor)
        return Inertial(value.mass, apply(frame, value.com), tensor)
    return compose(frame, value)


# ---- elements with parameters ---------------------------------------------------------------------------------------------------


def _degrees(name: str) -> AttributeGroup:
    """An angle that is always in degrees."""

    def read(attributes: Mapping[str, str], settings: Settings) -> float | None:
        found = numbers_of(attributes, name, 1, 1)
        return None if found is None else radians(found[0])

    def write(value: float | None, settings: Settings) -> dict[str, str]:
        return {} if value is None else {name: degrees_text(value)}

    return AttributeGroup(name, (name,), read, write, seen_numbers(name, None))


CAMERA = (POSE, _degrees("fovy"), reals("resolution", 2, 2))


def _read_shine(attributes: Mapping[str, str], settings: Settings) -> Pose:
    xyz = vector_of(attributes, "pos", ZERO)
    raw = vector_of(attributes, "dir", (0.0, 0.0, -1.0))
    try:
        return pose_as_written(xyz, Written("dir", raw)) if "dir" in attributes else Pose(xyz)
    except ZeroDivisionError as error:
        raise BadAttribute("dir", "a direction") from error


def _write_shine(value: Pose, settings: Settings) -> dict[str, str]:

    attributes = {} if value.xyz == ZERO else {"pos": numbers_text(value.xyz)}
    if value.written is not None and value.written.kind == "dir":
        attributes["dir"] = numbers_text(value.written.numbers)
    elif value.quat != NO_ROTATION:
        attributes["dir"] = numbers_text(rotate(value.quat, (0.0, 0.0, -1.0)))
    return attributes


SHINE = AttributeGroup(
    "pose", ("pos", "dir"), _read_shine, _write_shine, lambda attributes, settings: plain(attributes, ("pos", "dir")), same=same_pose
)


def _read_light_kind(attributes: Mapping[str, str], settings: Settings) -> str:
    return attributes.get("type") or ("directional" if attributes.get("directional") == "true" else "spot")


LIGHT_KIND = AttributeGroup(
    "kind",
    ("type", "directional"),
    _read_light_kind,
    lambda value, settings: {"type": value},
    lambda attributes, settings: _read_light_kind(attributes, settings),
)
LIGHT = (SHINE, LIGHT_KIND, reals("diffuse", 3, 3))

# ---- inertials -----------------------------------------------------------------------------------------------------------------


def _read_inertial(attributes: Mapping[str, str], settings: Settings) -> Inertial:
    if "pos" not in attributes or "mass" not in attributes:
        raise BadAttribute("mass" if "pos" in attributes else "pos", "a value: <inertial> needs pos and mass")
    mass = numbers_of(attributes, "mass", 1, 1) or (0.0,)
    com = vector_of(attributes, "pos", ZERO)
    full = numbers_of(attributes, "fullinertia", 6, 6)
    diagonal = numbers_of(attributes, "diaginertia", 3, 3)
    turn = written_turn(attributes, settings)
    if full is not None:
        if turn is not None or diagonal is not None:
            raise BadAttribute("fullinertia", "no orientation and no diaginertia beside it")
        return Inertial(mass[0], com, full)  # type: ignore[arg-type]
    if diagonal is None:
        return Inertial(mass[0], com)
    tensor = (*diagonal, 0.0, 0.0, 0.0)
    if turn is None:
        return Inertial(mass[0], com, tensor)  # type: ignore[arg-type]
    frame = read_pose({name: attributes[name] for name in TURNS if name in attributes}, settings)
    if frame == IDENTITY and frame.written is None:
        return Inertial(mass[0], com, tensor)  # type: ignore[arg-type]
    return Inertial(mass[0], com, rotate_tensor(frame.quat, tensor), InertialWritten(frame, tensor))  # type: ignore[arg-type]


def _write_inertial(value: Inertial, settings: Settings) -> dict[str, str]:
    attributes = {"pos": numbers_text(value.com), "mass": number_text(value.mass or 0.0)}
    if value.tensor is None:
        return attributes
    if value.written is not None:
        frame, own = value.written.frame, value.written.tensor
        if not any(own[3:]) and value.tensor == rotate_tensor(frame.quat, own):
            return {**attributes, **write_turn(frame.quat, frame.written, settings), "diaginertia": numbers_text(own[:3])}
    if not any(value.tensor[3:]):
        return {**attributes, "diaginertia": numbers_text(value.tensor[:3])}
    return {**attributes, "fullinertia": numbers_text(value.tensor)}


def _same_inertial(a: Inertial, b: Inertial) -> bool:
    if a != b or a.written != b.written:
        return False
    return a.written is None or b.written is None or a.written.frame.written == b.written.frame.written


_INERTIAL_NAMES = ("pos", "mass", "diaginertia", "fullinertia", *TURNS)
INERTIAL = AttributeGroup(
    "inertial",
    _INERTIAL_NAMES,
    _read_inertial,
    _write_inertial,
    lambda attributes, settings: (plain(attributes, ("mass", "diaginertia", "fullinertia")), seen_pose(attributes, settings)),
    same=_same_inertial,
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

SCALE = AttributeGroup(
    "scale",
    ("scale",),
    lambda attributes, settings: vector_of(attributes, "scale", (1.0, 1.0, 1.0)),
    lambda value, settings: {"scale": numbers_text(value)},
    lambda attributes, settings: read_numbers(attributes.get("scale", "1 1 1")),
)

MESH = (
    SCALE,
    reals("vertex", 0, 10**9),
    reals("face", 0, 10**9),
)
