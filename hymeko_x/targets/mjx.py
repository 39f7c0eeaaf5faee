"""MJX: what MuJoCo takes and its re-implementation in JAX does not. docs/targets.md lists the restrictions with their source."""

from __future__ import annotations

from collections import Counter
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.formats.mjcf.settings import settings, with_settings
from hymeko_x.targets import mujoco
from hymeko_x.targets.engine import compiled

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Context, Rule

_INSTEAD: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "integrator": MappingProxyType({"implicit": "implicitfast", "discrete": "implicitfast"}),
        "solver": MappingProxyType({"PGS": "Newton"}),
    }
)
"""Words of <option> that MJX does not have, and those that come nearest."""
_UNKNOWN: Mapping[str, tuple[str, frozenset[str]]] = MappingProxyType(
    {
        "actuator_dyntype": ("mjtDyn", frozenset(("NONE", "INTEGRATOR", "FILTER", "FILTEREXACT", "MUSCLE"))),
        "actuator_gaintype": ("mjtGain", frozenset(("FIXED", "AFFINE", "MUSCLE"))),
        "actuator_biastype": ("mjtBias", frozenset(("NONE", "AFFINE", "MUSCLE"))),
        "actuator_trntype": ("mjtTrn", frozenset(("JOINT", "JOINTINPARENT", "TENDON", "SITE"))),
        "eq_type": ("mjtEq", frozenset(("CONNECT", "WELD", "JOINT", "TENDON"))),
        "wrap_type": ("mjtWrap", frozenset(("JOINT", "PULLEY", "SITE", "SPHERE", "CYLINDER"))),
    }
)
"""The fields of mjModel of which MJX has some values only, with their enumerations and these values."""
_NO_CONTACT = frozenset(
    frozenset(pair.split())
    for pair in ("ELLIPSOID BOX", "ELLIPSOID MESH", "CYLINDER BOX", "CYLINDER MESH", "HFIELD ELLIPSOID", "HFIELD CYLINDER")
)
"""The pairs of shapes for which MJX has no contacts."""
_SHOWN = 3


def replace_options(mechanism: Mechanism, context: Context) -> Mechanism:
    """The integrator and the solver, where MJX has none of that name, become the nearest that it has."""
    own = settings(mechanism, "option")
    new = {name: words[own[name]] for name, words in _INSTEAD.items() if own.get(name) in words}
    for name, word in new.items():
        context.report.note(codes.FOR_TARGET, f"{context.reason}: {name} '{own[name]}' becomes '{word}'", element="mechanism")
    return with_settings(mechanism, "option", new) if new else mechanism


def report_what_is_missing(mechanism: Mechanism, context: Context) -> Mechanism:
    """Warn of what MJX refuses to load. Nothing is changed."""
    try:
        model = compiled(context.write(mechanism), context.files)
    except ValueError:  # a rule before this one has reported it
        return mechanism
    for message in (*_unknown_values(model), *_pairs_without_contacts(model)):
        context.report.warn(codes.NOT_REPRESENTED, f"{context.reason}: {message}", element="mechanism")
    return mechanism


def _unknown_values(model: Any) -> Iterator[str]:
    import mujoco as engine

    for field, (enumeration, known) in _UNKNOWN.items():
        kind = getattr(engine, enumeration)
        words = {kind(int(value)).name.removeprefix(f"mj{enumeration[3:].upper()}_") for value in getattr(model, field)}
        for word in sorted(words - known):
            yield f"MJX has no {word} among the values of {field}"


def _pairs_without_contacts(model: Any) -> Iterator[str]:
    """The kinds of pairs that may collide and for which MJX has no function, each once, with examples."""
    import mujoco as engine

    kinds = [engine.mjtGeom(int(kind)).name.removeprefix("mjGEOM_") for kind in model.geom_type]
    found: Counter[frozenset[str]] = Counter()
    examples: dict[frozenset[str], list[str]] = {}
    for a, b in _may_collide(model):
        pair = frozenset((kinds[a], kinds[b]))
        if pair in _NO_CONTACT:
            found[pair] += 1
            names = " and ".join(f"'{model.body(int(model.geom_bodyid[geom])).name}'" for geom in (a, b))
            examples.setdefault(pair, []).append(names)
    for pair, count in found.items():
        listed = "; ".join(examples[pair][:_SHOWN])
        yield f"MJX refuses contacts of {' and '.join(sorted(pair)).lower()}, and {count} pairs of shapes may touch: bodies {listed}"


def _may_collide(model: Any) -> Iterator[tuple[int, int]]:
    """The pairs of geoms that MuJoCo's filters let collide.

    Source: MuJoCo's documentation, Computation, Collision detection, Selection.
    """
    excluded = {int(signature) for signature in model.exclude_signature}
    solid = [geom for geom in range(model.ngeom) if model.geom_contype[geom] or model.geom_conaffinity[geom]]
    weld, parent = model.body_weldid, model.body_parentid
    for place, a in enumerate(solid):
        for b in solid[place + 1 :]:
            first, second = sorted((int(model.geom_bodyid[a]), int(model.geom_bodyid[b])))
            is_met = model.geom_contype[a] & model.geom_conaffinity[b] or model.geom_contype[b] & model.geom_conaffinity[a]
            if not is_met or weld[first] == weld[second] or (first << 16) + second in excluded:
                continue
            above, below = int(weld[parent[weld[first]]]), int(weld[parent[weld[second]]])
            if (weld[first] == below or weld[second] == above) and weld[first] != 0 and weld[second] != 0:
                continue
            yield a, b


RULES: tuple[Rule, ...] = (replace_options, *mujoco.RULES, report_what_is_missing)
