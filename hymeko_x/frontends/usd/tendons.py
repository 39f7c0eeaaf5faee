"""MjcTendon prims as tendons: cables through sites, around shapes and over pulleys, and combinations of joints."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats.mjcf.words import TENDON_PARAMETERS
from hymeko_x.formats.usd import tendons as table
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import UNLIMITED, DofKind, Joint, Limits, Tendon
from hymeko_x.ir.tendons import FIXED, PULLEY, SIDE, SPATIAL, WRAP, wrong_path

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.joints import DofRef
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import Rgba

_STEPS = ("frame", "shape")
_NO_TENDON = Id("tendon", "")
_OF_KIND = MappingProxyType(
    {True: (table.COEFFICIENTS,), False: (table.SEGMENTS, table.DIVISORS, table.SIDES, table.SIDE_INDICES)},
)
"""The attributes for the path of a fixed tendon, and of another one."""
_TYPES: Mapping[str, type] = MappingProxyType({table.MARGIN: float, table.GROUP: int, table.FORCE_LIMITED: str})
"""What the parameters are that are not several numbers."""


class _BadPath(Exception):
    """A path that cannot be followed; the text is the reason."""


def read_tendons(prims: list[Prim], ends: dict[str, DofRef], builder: UsdBuilder) -> None:
    """The tendons of these prims; one with a broken path is reported and stays an extra."""
    found = [prim for prim in prims if prim.kind == table.PRIM]
    automatic = _limits_are_automatic(prims) if found else True
    for prim in found:
        try:
            _read_tendon(prim, ends, builder, automatic=automatic)
        except _BadPath as error:
            builder.warn(prim, codes.UNDEFINED_REFERENCE, f"the path of tendon '{prim.path}' {error}; it is kept as written")


def _limits_are_automatic(prims: list[Prim]) -> bool:
    """Whether a range alone is a limit, which a scene can switch off."""
    return not any(prim.value("mjc:compiler:autoLimits") is False for prim in prims)


def _read_tendon(prim: Prim, ends: dict[str, DofRef], builder: UsdBuilder, *, automatic: bool) -> None:
    """Raises: _BadPath."""
    kind = prim.value(table.KIND) or SPATIAL
    path = _joints(prim, ends, builder) if kind == FIXED else _cable(prim, ends, builder)
    wrong = wrong_path(Tendon(kind), path, builder.edges)
    if wrong is not None:
        raise _BadPath(wrong)
    key = builder.new_id(prim, "tendon")
    builder.mark_read(prim, "@type", table.KIND, table.PATH, table.INDICES, *_OF_KIND[kind == FIXED])
    arcs: tuple[RobotArc, ...] = tuple(Arc(key, 0, arc.weight, PULLEY) if arc.role == PULLEY else arc for arc in path)
    builder.edges[key] = Edge(_tendon(prim, kind, _limits(prim, builder, automatic=automatic), builder), arcs)


# ---- paths -----------------------------------------------------------------------------------------------------------------------


def _joints(prim: Prim, ends: dict[str, DofRef], builder: UsdBuilder) -> list[RobotArc]:
    """The joints of a fixed tendon with their coefficients, 1 by default."""
    steps = _steps(prim, ends, builder)
    coefficients = _numbers(prim, table.COEFFICIENTS) or [1.0] * len(steps)
    if len(coefficients) != len(steps):
        raise _BadPath(f"has {len(steps)} joints and {len(coefficients)} coefficients")
    found: list[RobotArc] = []
    for (target, role), value in zip(steps, coefficients, strict=True):
        found.append(Arc(target, 1, (value * _unit(target, role, builder),), role))
    return found


def _unit(joint: Id, role: str, builder: UsdBuilder) -> float:
    """What a coefficient of 1 is: a length for an angle, or for a length."""
    edge = builder.edges.get(joint)
    dofs = edge.data.dofs if edge is not None and isinstance(edge.data, Joint) else ()
    turns = any(dof.kind is DofKind.HINGE for dof in dofs if not role or dof.name == role)
    return builder.scene.metres if turns else 1.0


def _cable(prim: Prim, ends: dict[str, DofRef], builder: UsdBuilder) -> list[RobotArc]:
    """The sites, shapes and pulleys of a cable; the site beside a shape comes after it."""
    steps = _steps(prim, ends, builder)
    segments, divisors = _indices(prim, table.SEGMENTS, len(steps)), _numbers(prim, table.DIVISORS)
    sides, beside = prim.targets(table.SIDES), _indices(prim, table.SIDE_INDICES, len(steps))
    arcs, last = _pulley(divisors, 0) if divisors and divisors[0] != 1.0 else [], 0
    for place, (target, role) in enumerate(steps):
        segment = segments[place] if segments else 0
        if segment < last:
            raise _BadPath("goes back to an earlier segment")
        arcs += _pulley(divisors, segment) if segment > last else []
        last = segment
        arcs.append(Arc(target, 0, None, WRAP if target.kind == "shape" else role))
        if target.kind == "shape" and beside and beside[place] != table.NO_SIDE:
            arcs.append(Arc(_site(sides, beside[place], builder), 0, None, SIDE))
    return arcs


def _pulley(divisors: list[float], segment: int) -> list[RobotArc]:
    """The pulley before a segment; its tendon has no id yet."""
    if segment >= len(divisors):
        raise _BadPath(f"has no divisor for segment {segment}")
    return [Arc(_NO_TENDON, 0, (divisors[segment],), PULLEY)]


def _site(sides: list[str], index: int, builder: UsdBuilder) -> Id:
    if not 0 <= index < len(sides):
        raise _BadPath(f"has no site {index} beside it")
    found = next((key for key in builder.elements.get(sides[index], ()) if key.kind == "frame"), None)
    if found is None:
        raise _BadPath(f"has '{sides[index]}' beside it, which is no site")
    return found


def _steps(prim: Prim, ends: dict[str, DofRef], builder: UsdBuilder) -> list[tuple[Id, str]]:
    """What the path leads through, in order, each with the dof that is meant where it is a joint."""
    known = [_element(path, ends, builder) for path in prim.targets(table.PATH)]
    order = _indices(prim, table.INDICES) or range(len(known))
    wrong = next((index for index in order if not 0 <= index < len(known)), None)
    if wrong is not None:
        raise _BadPath(f"has {len(known)} targets and the index {wrong}")
    return [known[index] for index in order]


def _element(path: str, ends: dict[str, DofRef], builder: UsdBuilder) -> tuple[Id, str]:
    end = ends.get(path)
    if end is not None:
        return end.joint, end.dof
    found = next((key for key in builder.elements.get(path, ()) if key.kind in _STEPS), None)
    if found is None:
        raise _BadPath(f"leads to '{path}', which is neither a site nor a shape nor a joint")
    return found, ""


def _indices(prim: Prim, name: str, count: int | None = None) -> list[int]:
    """Whole numbers; empty by default. ``count`` is how many there have to be."""
    found = [int(value) for value in _numbers(prim, name)]
    if found and count is not None and len(found) != count:
        raise _BadPath(f"has {count} steps and {len(found)} {name}")
    return found


def _numbers(prim: Prim, name: str) -> list[float]:
    """The numbers of an attribute; empty by default. Raises: _BadPath."""
    found = _items(prim, name)
    if not all(map(math.isfinite, found)):
        raise _BadPath(f"has {name} that are not finite")
    return found


def _items(prim: Prim, name: str) -> list[float]:
    """The items of an array of numbers; nothing where the attribute is none."""
    return list(prim.value(name) or ()) if prim.types.get(name) in ("int[]", "float[]", "double[]") else []


# ---- limits, mechanics, appearance -----------------------------------------------------------------------------------------------


def _limits(prim: Prim, builder: UsdBuilder, *, automatic: bool) -> Limits:
    """The shortest and the greatest length where they hold; a range that does not stays an extra."""
    word = prim.value(table.LIMITED)
    low, high = (value if isinstance(value, float) else 0.0 for value in map(prim.value, table.RANGE))
    if not low < high or not (word == "true" or (word in (None, "auto") and automatic)):
        return UNLIMITED
    builder.mark_read(prim, *table.RANGE, *([table.LIMITED] if word == "true" else []))
    return Limits(low * builder.scene.metres, high * builder.scene.metres)


def _tendon(prim: Prim, kind: str, limits: Limits, builder: UsdBuilder) -> Tendon:
    """The tendon in m, N and kg."""
    scene = builder.scene
    units = {"friction": scene.kilograms * scene.metres}
    authored = {name: builder.number(prim, path, 0.0) * units.get(name, scene.kilograms) for name, path in table.NUMBERS.items()}
    width = builder.get(prim, table.WIDTH) if isinstance(prim.value(table.WIDTH), float) else None
    return Tendon(
        kind,
        limits,
        authored["damping"],
        authored["stiffness"],
        authored["friction"],
        authored["armature"],
        None if width is None else width * scene.metres,
        _colour(prim, builder),
        tuple(_parameters(prim, builder)),
    )


def _colour(prim: Prim, builder: UsdBuilder) -> Rgba | None:
    if prim.types.get(table.COLOUR) != "color4f" or prim.value(table.COLOUR) is None:
        return None
    red, green, blue, alpha = builder.get(prim, table.COLOUR)
    return red, green, blue, alpha


def _parameters(prim: Prim, builder: UsdBuilder) -> Iterator[tuple[str, float | str | tuple[float, ...]]]:
    """The other attributes of the prim, under the names of MJCF and in their order there."""
    for name in TENDON_PARAMETERS:
        value = _parameter(prim, name, builder)
        if value is not None:
            yield name, value


def _parameter(prim: Prim, name: str, builder: UsdBuilder) -> float | str | tuple[float, ...] | None:
    attribute, scene = table.attribute(name), builder.scene
    if name == table.FORCE_RANGE:
        names = [f"{attribute}:{end}" for end in ("min", "max")]
        if not all(isinstance(prim.value(name), float) for name in names):
            return None
        low, high = (builder.get(prim, name) * scene.kilograms * scene.metres for name in names)
        return low, high
    if name in table.VECTORS or name == table.SPRING:
        return _vector(prim, name, _items(prim, attribute), builder)
    value = prim.value(attribute)
    if not isinstance(value, _TYPES.get(name, ())) or value == "auto":
        return None
    value = builder.get(prim, attribute)
    return value * scene.metres if name == table.MARGIN else value if isinstance(value, str) else float(value)


def _vector(prim: Prim, name: str, authored: list[float], builder: UsdBuilder) -> float | tuple[float, ...] | None:
    """Several numbers without those at the end that count anyway; any other number of them stays an extra."""
    default = table.VECTORS.get(name)
    if len(authored) != (2 if default is None else len(default)):
        return None
    builder.mark_read(prim, table.attribute(name))
    if default is None:
        low, high = (value if value < 0.0 else value * builder.scene.metres for value in authored)
        return low if low == high else (low, high)
    count = max((place for place, pair in enumerate(zip(authored, default, strict=True), 1) if pair[0] != pair[1]), default=1)
    return authored[0] if count == 1 else tuple(authored[:count])
