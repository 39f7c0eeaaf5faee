"""MjcTendon prims: the tendons of a stage by MuJoCo's schema, which no parser of UsdPhysics reads.

Source: MjcPhysics (MuJoCo's USD schemas), mujoco-usd-converter, Newton's importer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec import Struct
from msgspec.structs import replace
from pxr import Sdf

from hymeko_x.verify.model import CYLINDER, JOINT, PULLEY, RELAXED, SIDE, SITE, SPHERE, Kind, Role, SpringRange, Step, Tendon, point_of
from hymeko_x.verify.readers.usd.joints import dof_names
from hymeko_x.verify.readers.usd.scene import number_of, owner, targets_of, value_of
from hymeko_x.verify.readers.usd.shapes import shape_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.readers.usd.joints import JointEdge
    from hymeko_x.verify.readers.usd.scene import MeasuredStage

_TYPE, _SITE_API = "MjcTendon", "MjcSiteAPI"
_ROUND = {"sphere": SPHERE, "cylinder": CYLINDER}


class _BadPath(Exception):
    """A path that cannot be followed, with the reason."""


class _Targets(Struct, frozen=True, eq=False):
    """The targets of paths: each joint's dof by the joint's path, and the bodies by theirs; "" is the world."""

    scene: MeasuredStage
    dofs: Mapping[str, int]
    kinds: Mapping[str, Kind]
    bodies: Mapping[str, int]


def tendon_paths(prims: Sequence[Any]) -> list[str]:
    """The paths of the tendons among all prims of a stage, in its order."""
    return [str(prim.GetPath()) for prim in prims if prim.GetTypeName() == _TYPE]


def read_tendons(
    scene: MeasuredStage,
    model: KinematicModel,
    names: Mapping[str, str],
    tree: Mapping[str, JointEdge],
    numbers: Mapping[str, int],
    *,
    automatic: bool,
) -> KinematicModel:
    """The model with its tendons, and a note for each whose path leads nowhere.

    ``names`` are those of the tendons and ``numbers`` those of the bodies, both by path; ``automatic``: whether a range alone is a limit.
    """
    dofs = dof_names(model)
    edges = [edge for first in tree.values() for edge in (first, *first.more) if edge.name in dofs]
    joint_dofs = {edge.path: dofs[edge.name] for edge in edges}
    known = _Targets(scene, joint_dofs, {path: model.dofs[dof].kind for path, dof in joint_dofs.items()}, numbers)
    found: list[Tendon] = []
    notes: list[str] = []
    for path, name in names.items():
        try:
            found.append(_tendon(known, scene.stage.GetPrimAtPath(path), name, automatic=automatic))
        except _BadPath as error:
            notes.append(f"tendon '{name}' is left out: its path {error}")
    return replace(model, tendons=tuple(found), notes=(*model.notes, *notes))


def limits_are_automatic(prims: Sequence[Any]) -> bool:
    """Whether a range alone is a limit, which is the default of a scene."""
    return not any(value_of(prim, "mjc:compiler:autoLimits") is False for prim in prims)


def _tendon(known: _Targets, prim: Any, name: str, *, automatic: bool) -> Tendon:
    """One tendon in SI units. Raises: _BadPath."""
    metres, kilograms = known.scene.metres, known.scene.kilograms
    newtons = metres * kilograms
    fixed = value_of(prim, "mjc:type") == "fixed"
    stiffness = number_of(prim, "mjc:stiffness", 0.0) * kilograms
    return Tendon(
        name,
        tuple(_sum(known, prim) if fixed else _cable(known, prim)),
        (
            stiffness,
            number_of(prim, "mjc:damping", 0.0) * kilograms,
            number_of(prim, "mjc:frictionloss", 0.0) * newtons,
            number_of(prim, "mjc:armature", 0.0) * kilograms,
        ),
        _bounds(prim, "mjc:range", "mjc:limited", metres, automatic=automatic),
        _bounds(prim, "mjc:actuatorfrcrange", "mjc:actuatorfrclimited", newtons, automatic=automatic),
        _spring(prim, metres) if stiffness else RELAXED,
    )


def _bounds(prim: Any, name: str, limited: str, unit: float, *, automatic: bool) -> tuple[float, float] | None:
    low, high = (number_of(prim, f"{name}:{end}", 0.0) for end in ("min", "max"))
    word = value_of(prim, limited) or "auto"
    holds = word == "true" or (word == "auto" and automatic and low < high)
    return (low * unit, high * unit) if holds else None


def _spring(prim: Any, metres: float) -> SpringRange:
    """Its lengths; -1 is the one at rest."""
    lengths = _numbers(prim, "mjc:springlength")
    if len(lengths) != 2 or lengths[0] == -1.0:
        return RELAXED
    return SpringRange((lengths[0] * metres, lengths[1] * metres), at_rest=False)


# ---- paths -----------------------------------------------------------------------------------------------------------


def _sum(known: _Targets, prim: Any) -> Iterator[Step]:
    """The joints of a fixed tendon. A coefficient is a length for an angle, or for a length."""
    targets = _targets(prim, "mjc:path", "mjc:path:indices")
    coefficients = _numbers(prim, "mjc:path:coef") or [1.0] * len(targets)
    if len(coefficients) != len(targets):
        raise _BadPath(f"has {len(targets)} joints and {len(coefficients)} coefficients")
    for target, coefficient in zip(targets, coefficients, strict=True):
        if target not in known.dofs:
            raise _BadPath(f"leads to {target}, which is no joint that one coordinate moves")
        turns = known.kinds[target] is Kind.HINGE
        yield Step(JOINT, known.dofs[target], coefficient * (known.scene.metres if turns else 1.0))


def _cable(known: _Targets, prim: Any) -> Iterator[Step]:
    """The sites and shapes of a cable; where a segment begins, there is a pulley, before the first one if it has a divisor."""
    targets = _targets(prim, "mjc:path", "mjc:path:indices")
    segments = _integers(prim, "mjc:path:segments") or [0] * len(targets)
    divisors = _numbers(prim, "mjc:path:divisors") or [1.0]
    sides = _sides(prim, len(targets))
    if len(segments) != len(targets) or any(not 0 <= segment < len(divisors) for segment in segments):
        raise _BadPath(f"has {len(targets)} steps, {len(segments)} segments, and {len(divisors)} divisors")
    if divisors[0] != 1.0:
        yield Step(PULLEY, number=divisors[0])
    last = 0
    for target, segment, side in zip(targets, segments, sides, strict=True):
        if segment != last:
            yield Step(PULLEY, number=divisors[segment])
        last = segment
        yield _target(known, target)
        if side:
            yield _site(known, known.scene.stage.GetPrimAtPath(side), SIDE)


def _sides(prim: Any, count: int) -> list[str]:
    """For each step the site beside it, or ""."""
    found = targets_of(prim, "mjc:sideSites")
    order = _integers(prim, "mjc:sideSites:indices") or [-1] * count
    if len(order) != count or any(index >= len(found) for index in order):
        raise _BadPath(f"has {count} steps, {len(found)} sites beside them, and {len(order)} indices of these")
    return [found[index] if index >= 0 else "" for index in order]


def _targets(prim: Any, name: str, indices: str) -> list[str]:
    found = targets_of(prim, name)
    order = _integers(prim, indices) or range(len(found))
    if any(not 0 <= index < len(found) for index in order):
        raise _BadPath(f"has {len(found)} targets and other indices")
    return [found[index] for index in order]


def _target(known: _Targets, path: str) -> Step:
    """A site, or a ball or cylinder around which a cable goes."""
    prim = known.scene.stage.GetPrimAtPath(Sdf.Path(path))
    if not prim:
        raise _BadPath(f"leads to {path}, where nothing is")
    if _SITE_API in prim.GetPrimTypeInfo().GetAppliedAPISchemas():
        return _site(known, prim, SITE)
    on = owner(prim, known.bodies)
    shape = shape_of(known.scene, prim, on, Role.VISUAL)
    if shape is None or shape.kind not in _ROUND:
        return _site(known, prim, SITE)
    axis = point_of(shape.pose[:3, 2]) if shape.kind == "cylinder" else None
    return Step(_ROUND[shape.kind], known.bodies[on], shape.size[0], point_of(shape.pose[:3, 3]), axis)


def _site(known: _Targets, prim: Any, kind: str) -> Step:
    if not prim:
        raise _BadPath("has a site beside it that is not there")
    on = owner(prim, known.bodies)
    return Step(kind, known.bodies[on], point=point_of(known.scene.relative(on, prim)[0][:3, 3]))


# ---- values ----------------------------------------------------------------------------------------------------------


def _numbers(prim: Any, name: str) -> list[float]:
    attribute = prim.GetAttribute(name)
    array = attribute and attribute.GetTypeName() in (Sdf.ValueTypeNames.DoubleArray, Sdf.ValueTypeNames.FloatArray)
    return [float(number) for number in attribute.Get() or ()] if array else []


def _integers(prim: Any, name: str) -> list[int]:
    attribute = prim.GetAttribute(name)
    return list(attribute.Get() or ()) if attribute and attribute.GetTypeName() == Sdf.ValueTypeNames.IntArray else []
