"""The rules that make a mechanism legal in MJCF, and which of them a mechanism needs that came from there."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.mjcf.steady import integrate_implicitly
from hymeko_x.diagnostics import Origin
from hymeko_x.formats.mjcf.keyframes import with_poses
from hymeko_x.formats.mjcf.lengths import has_soft_bodies, without_misfits
from hymeko_x.formats.mjcf.notations import attribute
from hymeko_x.formats.mjcf.words import AT_SITES, NAME, compiler_has
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Body
from hymeko_x.rewrite.actuators import drop_foreign_actuators, drop_idle_actuators
from hymeko_x.rewrite.couplings import drop_odd_tendons, make_couplings_scalar, make_tendons_sound, name_wrapped_shapes
from hymeko_x.rewrite.differentials import drive_by_differentials
from hymeko_x.rewrite.fragments import mount_sensors_of_fragments
from hymeko_x.rewrite.inertia import fill_tensors, give_moving_bodies_mass, make_tensors_physical, welded_to
from hymeko_x.rewrite.joints import (
    expand_screws,
    lower_inner_free_joints,
    make_limits_intervals,
    name_dofs,
    name_dofs_in_use,
    name_dofs_once,
    split_overfull_joints,
)
from hymeko_x.rewrite.loops import anchor_closures, close_by_points, close_in_pairs, open_second_parents
from hymeko_x.rewrite.names import make_names_usable, name_assets_once
from hymeko_x.rewrite.roots import put_world_link_into_world, report_open_bases
from hymeko_x.rewrite.sensors import measure_at_frames
from hymeko_x.rewrite.shapes import drop_empty_shapes, keep_planes_static, make_sizes_positive, name_shapes_once
from hymeko_x.rewrite.subsets import split_subsets
from hymeko_x.rewrite.transmissions import drive_by_transmissions

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.rewrite.context import Context, Rule


def write_poses_as_keyframes(mechanism: Mechanism, _context: Context) -> Mechanism:
    """Named poses are keyframes."""
    return with_poses(mechanism)


def _measure_at_sites(mechanism: Mechanism, context: Context) -> Mechanism:
    """Sensors that are on bodies measure at sites, where MuJoCo has such sensors."""
    return measure_at_frames(mechanism, context, AT_SITES)


def _drive_by_transmissions(mechanism: Mechanism, context: Context) -> Mechanism:
    """Transmissions are actuators; as many are servos, the integrator is one that keeps them calm."""
    driven = drive_by_differentials(drive_by_transmissions(mechanism, context), context)
    return driven if driven is mechanism else integrate_implicitly(driven, replace(context, reason="transmissions"))


RULES: tuple[Rule, ...] = (
    mount_sensors_of_fragments,
    _measure_at_sites,
    make_names_usable,
    name_assets_once,
    open_second_parents,
    close_in_pairs,
    close_by_points,
    anchor_closures,
    put_world_link_into_world,
    report_open_bases,
    expand_screws,
    lower_inner_free_joints,
    name_dofs,
    split_overfull_joints,
    make_limits_intervals,
    make_couplings_scalar,
    drop_odd_tendons,
    make_tendons_sound,
    split_subsets,
    fill_tensors,
    make_tensors_physical,
    give_moving_bodies_mass,
    drop_empty_shapes,
    keep_planes_static,
    make_sizes_positive,
    name_shapes_once,
    name_wrapped_shapes,
    _drive_by_transmissions,
    drop_foreign_actuators,
    drop_idle_actuators,
    write_poses_as_keyframes,
    make_names_usable,  # once more, for what the rules have added
)


# ---- what came from MJCF -----------------------------------------------------------------------------------------------------


def _make_tensors_physical(mechanism: Mechanism, context: Context) -> Mechanism:
    """Inertias as they are where <compiler> makes MuJoCo repair those that it would refuse otherwise."""
    return mechanism if compiler_has(mechanism, ("balanceinertia", "boundinertia")) else make_tensors_physical(mechanism, context)


def _give_bare_bodies_mass(mechanism: Mechanism, context: Context) -> Mechanism:
    """The least mass for moving bodies with nothing that weighs, as an edited file may add them: MuJoCo refuses these."""

    def is_bare(body: Id) -> bool:
        has_inertial = mechanism.vertex(body, Body).inertial is not None
        return not (has_inertial or mechanism.shapes.get(body) or mechanism.extras.get(body))

    return give_moving_bodies_mass(mechanism, context, lambda key: all(map(is_bare, welded_to(mechanism, key))))


def _drop_empty_shapes(mechanism: Mechanism, context: Context) -> Mechanism:
    """MuJoCo has geometries of its own: a height field, a distance function, a primitive fitted to a mesh."""

    def has_own_geometry(shape: Id) -> bool:
        kept = any(extra.format == NAME for extra in mechanism.extras.get(shape, ()))
        return kept or mechanism.notation(shape, attribute("type")) is not None

    return drop_empty_shapes(mechanism, context, has_own_geometry)


_FROM_GEOMS = 'inertiafromgeom="true"'


def _let_inertials_count(mechanism: Mechanism, context: Context) -> Mechanism:
    """Where <compiler> makes MuJoCo pass over inertials and a body has one, only bodies without one get theirs from geoms."""
    own = mechanism.extras.get(ROOT, ())
    compilers = [extra for extra in own if extra.format == NAME and extra.text.startswith("<compiler") and _FROM_GEOMS in extra.text]
    if not compilers or all(body.inertial is None for _, body in mechanism.vertices(Body)):
        return mechanism
    message = 'inertiafromgeom becomes "auto": bodies that have an inertial keep it, all others get theirs from geoms as before'
    context.report.note(codes.REWRITTEN, message, mechanism.origin(ROOT))
    extras = {
        key: tuple([extra for extra in found if not (key.kind == "body" and _is_inertial(extra))])
        for key, found in mechanism.extras.items()
    }
    extras[ROOT] = tuple([_counting(extra) if extra in compilers else extra for extra in own])
    return replace(mechanism, extras=extras)


def _counting(compiler: Extra) -> Extra:
    return replace(compiler, text=compiler.text.replace(_FROM_GEOMS, 'inertiafromgeom="auto"'))


def _is_inertial(extra: Extra) -> bool:
    """Whether an extra is an <inertial> that MuJoCo passed over."""
    return extra.format == NAME and not extra.path and extra.text.startswith("<inertial")


def _drop_stale_keyframes(mechanism: Mechanism, context: Context) -> Mechanism:
    """Keyframes are kept verbatim, and fit as long as no joint or actuator is added or removed; MuJoCo refuses others."""
    kept, stale = without_misfits(mechanism)
    file = mechanism.source.file
    origin = mechanism.origin(ROOT) or (Origin(file) if file else None)
    for reason, names in stale.items():
        which = f"keyframe {names[0]} has" if len(names) == 1 else f"{len(names)} keyframes ({', '.join(names[:2])}, ...) have"
        left = "it is" if len(names) == 1 else "they are"
        context.report.warn(codes.NOT_REPRESENTED, f"{which} {reason}; {left} left out", origin)
    return kept


def _write_poses_as_keyframes(mechanism: Mechanism, _context: Context) -> Mechanism:
    """Named poses are keyframes, where joints count all coordinates."""
    return mechanism if has_soft_bodies(mechanism) else with_poses(mechanism)


ACTUATED: tuple[Rule, ...] = (integrate_implicitly,)
"""The rules for actuators that the user asks for."""

_REPLACED: Mapping[Rule, Rule | None] = MappingProxyType(
    {
        anchor_closures: None,
        name_dofs: None,
        give_moving_bodies_mass: _give_bare_bodies_mass,
        make_tensors_physical: _make_tensors_physical,
        drop_empty_shapes: _drop_empty_shapes,
        write_poses_as_keyframes: None,
    }
)
"""Rules that a robot from MJCF does without, since MJCF has more than one form of it or MuJoCo finds it out, and those that do less."""

NATIVE: tuple[Rule, ...] = (
    *(rule for common in RULES if (rule := _REPLACED.get(common, common)) is not None),
    name_dofs_in_use,
    name_dofs_once,
    _let_inertials_count,
    _drop_stale_keyframes,
    _write_poses_as_keyframes,  # behind the rule that reports those that do not fit
)
"""The rules for what came from MJCF: none changes what MuJoCo reads, all hold for what was edited in another format since."""
