"""Tendons as MjcTendon prims, as MuJoCo's own converters write them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec import Struct, field
from pxr import Gf, Vt

from hymeko_x.backends.usd.sheet import T, point, prim_of, put
from hymeko_x.formats.usd import tendons as table
from hymeko_x.ir.mechanism import numbers_weight
from hymeko_x.ir.parts import Tendon
from hymeko_x.ir.tendons import FIXED, PULLEY, SIDE, wrong_path

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet, WrittenPrim
    from hymeko_x.ir.mechanism import RobotArc


def write_tendons(sheet: UsdSheet) -> None:
    """Each tendon whose path leads through prims; the schema cannot represent one through an axis of a generic joint."""
    for key, tendon, arcs in sheet.mechanism.edges(Tendon):
        path = None if wrong_path(tendon, arcs, sheet.mechanism.graph.edges) else _path(sheet, arcs)
        if path is None:
            continue
        spec = sheet.add_prim(key, "tendons", table.PRIM)
        put(spec, table.KIND, T.Token, tendon.kind)
        _write_path(spec, tendon, path)
        _write_behaviour(spec, tendon)
        for name, value in tendon.parameters:
            _write_parameter(spec, name, value)


# ---- paths -----------------------------------------------------------------------------------------------------------------------


class _Places(Struct):
    """Prims in the order in which they come first, and which of them each step is."""

    prims: dict[Any, int] = field(default_factory=dict)
    indices: list[int] = field(default_factory=list)

    def add(self, prim: Any) -> None:
        self.indices.append(self.prims.setdefault(prim, len(self.prims)))


class _Path(Struct):
    """The steps of a path without its pulleys, each with its coefficient, the site beside it, and the part that it is in."""

    steps: _Places = field(default_factory=_Places)
    sides: _Places = field(default_factory=_Places)
    coefficients: list[float] = field(default_factory=list)
    segments: list[int] = field(default_factory=list)
    divisors: list[float] = field(default_factory=lambda: [1.0])


def _path(sheet: UsdSheet, arcs: tuple[RobotArc, ...]) -> _Path | None:
    """The path as the schema divides it; None where it leads through something that is no prim.

    Nothing is in the first segment of a path that begins with a pulley: MuJoCo and Newton overlook the divisor of the first one.
    """
    path = _Path()
    for arc in arcs:
        if arc.role == PULLEY:
            path.divisors.append(numbers_weight(arc)[0])
            continue
        prim = prim_of(sheet, arc)
        if prim is None:
            return None
        if arc.role == SIDE:
            path.sides.indices.pop()
            path.sides.add(prim)
            continue
        path.steps.add(prim)
        path.sides.indices.append(table.NO_SIDE)
        path.segments.append(len(path.divisors) - 1)
        path.coefficients += numbers_weight(arc)[:1]
    return path


def _write_path(spec: WrittenPrim, tendon: Tendon, path: _Path) -> None:
    point(spec, table.PATH, *path.steps.prims)
    put(spec, table.INDICES, T.IntArray, Vt.IntArray(path.steps.indices))
    if tendon.kind == FIXED:
        put(spec, table.COEFFICIENTS, T.DoubleArray, Vt.DoubleArray(path.coefficients))
        return
    put(spec, table.SEGMENTS, T.IntArray, Vt.IntArray(path.segments))
    put(spec, table.DIVISORS, T.DoubleArray, Vt.DoubleArray(path.divisors))
    if path.sides.prims:
        point(spec, table.SIDES, *path.sides.prims)
        put(spec, table.SIDE_INDICES, T.IntArray, Vt.IntArray(path.sides.indices))


# ---- limits, mechanics, appearance -----------------------------------------------------------------------------------------------


def _write_behaviour(spec: WrittenPrim, tendon: Tendon) -> None:
    """Limits, mechanics and appearance; defaults of the schema are left out."""
    lower, upper = tendon.limits.lower, tendon.limits.upper
    if upper is not None:
        put(spec, table.LIMITED, T.Token, "true")
        for name, bound in zip(table.RANGE, (lower or 0.0, upper), strict=True):
            put(spec, name, T.Double, bound)
    for name, attribute in table.NUMBERS.items():
        value = getattr(tendon, name)
        if value:
            put(spec, attribute, T.Double, value)
    if tendon.width is not None:
        put(spec, table.WIDTH, T.Double, tendon.width)
    if tendon.rgba is not None:
        put(spec, table.COLOUR, T.Color4f, Gf.Vec4f(*tendon.rgba))


def _write_parameter(spec: WrittenPrim, name: str, value: float | str | tuple[float, ...]) -> None:
    """A parameter that the schema has an attribute for."""
    numbers = () if isinstance(value, str) else value if isinstance(value, tuple) else (value,)
    attribute = table.attribute(name)
    default = table.VECTORS.get(name)
    if default is not None and 0 < len(numbers) <= len(default):
        put(spec, attribute, T.DoubleArray, Vt.DoubleArray([*numbers, *default[len(numbers) :]]))
    elif name == table.SPRING and 0 < len(numbers) <= 2:
        put(spec, attribute, T.DoubleArray, Vt.DoubleArray([numbers[0], numbers[-1]]))
    elif name == table.FORCE_RANGE and len(numbers) == 2:
        for end, bound in zip(("min", "max"), numbers, strict=True):
            put(spec, f"{attribute}:{end}", T.Double, bound)
    elif name == table.FORCE_LIMITED and isinstance(value, str):
        put(spec, attribute, T.Token, value)
    elif name == table.MARGIN and len(numbers) == 1:
        put(spec, attribute, T.Double, numbers[0])
    elif name == table.GROUP and len(numbers) == 1 and abs(numbers[0]) < 2**31:
        put(spec, attribute, T.Int, int(numbers[0]))
