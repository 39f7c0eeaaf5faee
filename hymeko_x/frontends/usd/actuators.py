"""MjcActuator prims as actuators: the general ones of MJCF, a motor where nothing but its ranges and gear is said."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd import actuators as table
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Actuator, Drive

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.frontends.usd.relations import Driven
    from hymeko_x.ir.mechanism import RobotArc

_GENERAL = ("gaintype", "gainprm", "biastype", "biasprm", "dyntype", "dynprm")
_KINDS = ("frame", "body", "tendon")


def read_actuator(prim: Prim, ends: dict[str, Driven], draft: Draft) -> None:
    """The actuator of a prim with the edge to its targets; one without a target that we know stays an extra."""
    arcs = [arc for role, name in _relationships(prim) for arc in _arcs(prim, role, name, ends, draft)]
    if not arcs:
        said = f"actuator '{prim.path}' acts on nothing that is known; it is kept as written"
        draft.report.warn(codes.UNDEFINED_REFERENCE, said, draft.origin, element=prim.path)
        return
    parameters = _parameters(prim, draft)
    is_plain = arcs[0].target.kind != "body" and not any(name in _GENERAL for name, _ in parameters)
    kind = "motor" if is_plain else "general"  # MJCF has no motor on a body
    key = draft.own(prim, "actuator")
    draft.vertices[key] = Actuator(kind, tuple(parameters))
    draft.note(key, words.TYPE, table.PRIM)
    gear = draft.get(prim, "mjc:gear")
    weight = _trimmed(tuple(map(float, gear))) if gear is not None else None
    first: RobotArc = Arc(arcs[0].target, -1, weight, arcs[0].role)
    is_in_parent = prim.value("mjc:jointInParent") is True
    draft.take(prim, "@type", *(name for _, name in _relationships(prim)), *(["mjc:jointInParent"] if is_in_parent else []))
    drive = Drive("jointinparent" if is_in_parent else "")
    draft.edges[draft.own(prim, "drive", key.name)] = Edge(drive, (Arc(key, 1), first, *arcs[1:]))


def _relationships(prim: Prim) -> list[tuple[str, str]]:
    """The relationships that name something, with the role of it. A target beside a slider is the crank."""
    named = [name for name in (table.TARGET, table.SLIDER, table.REFERENCE) if prim.targets(name)]
    roles = {table.TARGET: "crank" if table.SLIDER in named else "", table.SLIDER: "slider", table.REFERENCE: "reference"}
    return [(roles[name], name) for name in named]


def _arcs(prim: Prim, role: str, name: str, ends: dict[str, Driven], draft: Draft) -> list[RobotArc]:
    path = prim.targets(name)[0]
    end = ends.get(path)
    if end is not None:
        return [Arc(end.joint, -1, None, end.dof)]
    found = next((key for key in draft.elements.get(path, ()) if key.kind in _KINDS), None)
    return [Arc(found, -1, None, role)] if found is not None else []


# ---- parameters ------------------------------------------------------------------------------------------------------------------


def _parameters(prim: Prim, draft: Draft) -> list[tuple[str, float | str | tuple[float, ...]]]:
    """What the prim says beside its targets, under the names of MJCF; what is the schema's default says nothing."""
    found: list[tuple[str, float | str | tuple[float, ...]]] = []
    for name, attribute in table.TOKENS.items():
        value = draft.get(prim, f"mjc:{attribute}")
        if isinstance(value, str) and value not in ("auto", table.DEFAULTS.get(name)):
            found.append((name, value))
        elif value is not None:
            _leave(prim, f"mjc:{attribute}", draft)
    for name, attribute in table.VECTORS.items():
        value = draft.get(prim, f"mjc:{attribute}")
        if value is not None:
            found.append((name, _trimmed(tuple(map(float, value)))))
    for name, attribute in table.RANGES.items():
        if any(prim.has_value(f"mjc:{attribute}:{end}") for end in ("min", "max")):
            low, high = (float(draft.get(prim, f"mjc:{attribute}:{end}") or 0.0) for end in ("min", "max"))
            found.append((name, (low, high)))
    for name, attribute in (*table.NUMBERS.items(), *table.INTEGERS.items()):
        value = draft.get(prim, f"mjc:{attribute}")
        if isinstance(value, int | float):
            found.append((name, float(value)))
    return found


def _leave(prim: Prim, name: str, draft: Draft) -> None:
    """A property that was looked at stays an extra."""
    draft.taken.get(prim.path, set()).discard(name)


def _trimmed(values: tuple[float, ...]) -> tuple[float, ...]:
    """Numbers without the zeros at the end, at least one."""
    count = max((place for place, value in enumerate(values, start=1) if value), default=1)
    return values[:count]
