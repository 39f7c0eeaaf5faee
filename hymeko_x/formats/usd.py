"""The words of USD that its reader and its writer share, and how parts of the IR are carried in ``hymeko:`` attributes.

Data and plain values only; nothing here knows the USD libraries. A part is carried as flat pairs of name and value:
``inertial:mass = 1.5``, ``dofs:0:limits:upper = 1.57``; a nested part whose type is not obvious says it under ``is``.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import math
import re
import struct
from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, get_type_hints

from hymeko_x.ir import parts, values
from hymeko_x.ir.mechanism import KINDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

FORMAT = "usd"
PATH = "usd.path"
"""The notation that keeps the path of the prim that an element was read from."""
TYPE = "usd.type"
"""The notation of a joint that keeps the type of its prim where the dofs alone would make it another one."""
REVERSED = "usd.reversed"
"""The notation of a joint whose parent in the tree is its ``body1``."""
EQUALITY = "usd.equality"
"""The notation of a coupling that MuJoCo's schema says alone, without Newton's."""
HELD = "usd.held"
"""The notation of a joint that stands for no prim: its body is fixed because its simulation is switched off."""
POSE = "usd.pose"
"""The notation of a body that keeps where its prim stands (x y z qw qx qy qz) where its joints put it elsewhere."""
GROUND = ("usd.body0", "usd.body1")
"""The notations of a joint that keep the group that stood for the world on either side."""
ROOT_PRIM = "usd.root"
"""The notation of the mechanism that keeps the path of the prim that stands for the robot."""

WITHIN = "xformOp:scale:within"
"""The operation that undoes the scale of the body above."""

PREFIX = "hymeko:"
DIGEST = "hymeko:digest"
SCOPE = "hymeko"
"""The prim below the robot's that holds what USD has no prim for."""
VERSION = 2

AXES: Mapping[str, values.Vec3] = MappingProxyType({"X": values.X, "Y": values.Y, "Z": values.Z})
D6_AXES = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
"""The axes of a generic joint in the order in which they move: what comes first is nearer to the parent."""
LIGHTS: Mapping[str, str] = MappingProxyType({"DistantLight": "directional", "SphereLight": "point", "DomeLight": "image"})
"""The lights of UsdLux that the IR has a word for; a sphere light with a cone is a spot."""
CONE = "ShapingAPI"
DRIVES = ("angular", "linear", *D6_AXES)
"""The instances of a DriveAPI."""

Value = bool | int | float | str | tuple[float, ...] | tuple[int, ...] | tuple[str, ...]

LOCKED = (1.0, -1.0)
"""The bounds by which the writer locks an axis of a generic joint."""


class D6Axis(NamedTuple):
    """One axis of a generic joint: how it moves, and along or about what."""

    kind: parts.DofKind
    axis: values.Vec3


def d6_axis(name: str) -> D6Axis:
    """The meaning of ``transX`` ... ``rotZ``."""
    kind = parts.DofKind.SLIDE if name.startswith("trans") else parts.DofKind.HINGE
    return D6Axis(kind, AXES[name[-1]])


# ---- single precision ----------------------------------------------------------------------------------------------------


def single(value: float) -> float:
    """The shortest decimal that names a single-precision number: 0.1 for the float that is closest to 0.1.

    So that what an author wrote comes back, not its rounding error; the float that it rounds to is the same.
    """
    if not math.isfinite(value) or value == int(value):
        return float(value)
    for digits in (6, 7, 8):
        short = float(f"{value:.{digits}g}")
        if struct.pack("f", short) == struct.pack("f", value):
            return short
    return float(f"{value:.9g}")


# ---- digests ---------------------------------------------------------------------------------------------------------------


def digest(pairs: Iterable[tuple[str, bytes]]) -> str:
    """A short hash of named native values, in whatever order they come."""
    said = b"".join(b"%d:%s%d:%s" % (len(name), name.encode(), len(value), value) for name, value in sorted(pairs))
    return hashlib.sha256(said).hexdigest()[:16]


def value_bytes(value: object) -> bytes:
    """A value of an attribute as bytes: vectors, matrices and arrays by their memory, everything else by its text."""
    if value is None or isinstance(value, str | float | int):
        return repr(value).encode()
    try:
        return memoryview(value).tobytes()  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return repr(value).encode()


# ---- carried texts ---------------------------------------------------------------------------------------------------------


_LONG = 64
_ID = re.compile(r'{"id":("(?:[^"\\]|\\["\\/bfnrt]|\\u[0-9a-f]{4})*")')


def is_long(value: tuple[object, ...]) -> bool:
    """Whether a tuple of numbers is an array of its own rather than part of a text."""
    return len(value) > _LONG and not isinstance(value[0], str)


def text_of(pairs: Mapping[str, Value]) -> str:
    """Flat pairs as one line of JSON in ASCII, which says every double and every letter exactly."""
    return json.dumps(pairs, separators=(",", ":"))


def pairs_of(text: str) -> dict[str, Value]:
    """The pairs that :func:`text_of` was given. Raises: ValueError."""
    found = json.loads(text)
    if not isinstance(found, dict):
        raise ValueError("no pairs of names and values")
    return {name: tuple(value) if isinstance(value, list) else value for name, value in found.items()}


def id_in(text: object) -> str | None:
    """The id that such a text begins with; None where it does not."""
    found = _ID.match(text) if isinstance(text, str) else None
    return str(json.loads(found.group(1))) if found else None


# ---- parts as flat values ----------------------------------------------------------------------------------------------------

_TYPES: Mapping[str, type] = MappingProxyType(
    {
        kind.__name__: kind
        for module in (parts, values)
        for kind in vars(module).values()
        if isinstance(kind, type) and (dataclasses.is_dataclass(kind) or kind is values.Written)
    }
)
_PARTS = frozenset(_TYPES.values())
PART_OF: Mapping[str, type] = MappingProxyType({kind: part for part, kind in KINDS.items()})
"""The part of each kind of element."""


def flat(part: object) -> dict[str, Value]:
    """A part as flat pairs; values that its fields have anyway are left out. Reads back with :func:`part_of`."""
    found: dict[str, Value] = {}
    _flatten(part, "", found)
    return found


def _flatten(part: Any, prefix: str, found: dict[str, Value]) -> None:
    kind_of_part: type = type(part)
    for name, default in _fields(kind_of_part):
        value = getattr(part, name)
        if value is default:
            continue
        key = f"{prefix}{name}"
        kind = type(value)
        if name == "parameters":
            if value:
                found[key] = json.dumps(value, ensure_ascii=False)
        elif kind in _PARTS:
            if kind is not type(default):
                found[f"{key}:is"] = kind.__name__
            _flatten(value, f"{key}:", found)
        elif kind is tuple and value and type(value[0]) in _PARTS:
            found[f"{key}:count"] = len(value)
            for number, item in enumerate(value):
                found[f"{key}:{number}:is"] = type(item).__name__
                _flatten(item, f"{key}:{number}:", found)
        elif value != default or value != value:
            found[key] = value.value if isinstance(value, Enum) else value


def part_of(kind: type, pairs: Mapping[str, Value]) -> Any:
    """The part of this type that :func:`flat` wrote.

    Raises: ValueError, TypeError or KeyError for pairs that are no such part.
    """
    return _build(kind, _nested(pairs))


def _nested(pairs: Mapping[str, Value]) -> dict[str, Any]:
    tree: dict[str, Any] = {}
    for key, value in pairs.items():
        *way, last = key.split(":")
        node = tree
        for step in way:
            node = node.setdefault(step, {})
            if not isinstance(node, dict):
                raise ValueError(f"'{key}' is inside of a plain value")
        node[last] = value
    return tree


def _build(kind: type, tree: Mapping[str, Any]) -> Any:
    hints = _hints(kind)
    arguments: dict[str, Any] = {}
    for name, default in _fields(kind):
        if name not in tree:
            continue
        said = tree[name]
        hint = hints.get(name)
        if name == "parameters":
            arguments[name] = tuple((key, tuple(value) if isinstance(value, list) else value) for key, value in json.loads(said))
        elif isinstance(said, dict):
            arguments[name] = _build_several(said) if "count" in said else _build(_TYPES.get(said.get("is", ""), type(default)), said)
        elif isinstance(hint, type) and issubclass(hint, Enum):
            arguments[name] = hint(said)
        else:
            arguments[name] = said
    return kind(**arguments)


def _build_several(tree: Mapping[str, Any]) -> tuple[Any, ...]:
    return tuple(_build(_TYPES[tree[str(number)]["is"]], tree[str(number)]) for number in range(tree["count"]))


@functools.cache
def _fields(kind: type) -> tuple[tuple[str, object], ...]:
    """The fields of a part with their defaults; a required field has the default ``MISSING``."""
    if kind is values.Written:
        return ("kind", dataclasses.MISSING), ("numbers", dataclasses.MISSING)
    return tuple((field.name, field.default) for field in dataclasses.fields(kind))


@functools.cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind, {**vars(parts), **vars(values)})
