"""What a target cannot say, rewritten into what it can: one pure function per feature, in a fixed order per target.

A rule takes a mechanism and returns one that is legal in its respect; it says in the report what it changed, and a
second application changes nothing. Backends receive the result and only print.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from hymeko_x.ir.legalize_actuators import choose_actuators
from hymeko_x.ir.legalize_base import choose_base, put_world_link_into_world
from hymeko_x.ir.legalize_couplings import make_couplings_scalar
from hymeko_x.ir.legalize_inertia import give_moving_bodies_mass, make_tensors_physical
from hymeko_x.ir.legalize_joints import expand_screws, lower_inner_free_joints, name_dofs, split_overfull_joints
from hymeko_x.ir.legalize_limits import make_limits_intervals
from hymeko_x.ir.legalize_loops import anchor_closures, close_by_points, open_second_parents
from hymeko_x.ir.legalize_names import make_names_usable, name_assets_once
from hymeko_x.ir.legalize_native import drop_shapes_of_mujoco, drop_stale_keyframes
from hymeko_x.ir.legalize_shapes import drop_empty_shapes, keep_planes_static, make_sizes_positive, name_shapes_once
from hymeko_x.ir.legalize_solids import fill_tensors
from hymeko_x.ir.legalize_urdf import chain_dofs, hold_or_free_open_bases, join_roots, make_world_a_link
from hymeko_x.ir.legalize_urdf_shapes import approximate_shapes, prefer_own_colours, split_shared_shapes
from hymeko_x.ir.legalize_usd import choose_layout
from hymeko_x.ir.legalize_xacro import choose_files
from hymeko_x.ir.mechanism import ROOT

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism


@dataclass(frozen=True, slots=True)
class Options:
    """What the user chose for the output.

    ``base``: what becomes of an open base (None = the target's own default). ``actuators``: which kind to give every
    driven dof, ``none`` to write none, None to write those that the mechanism has and the target knows. ``layout`` and
    ``nested``: how a stage of USD is laid out (None = as it was, else one file with flat bodies). ``split``: whether the
    macros of xacro go into a file of their own. ``pure``: whether the output carries nothing but what its format says.
    ``beside``: how files of our own that may stand beside the output begin, which is its own name; empty = there is no place.
    """

    base: Literal["fixed", "free"] | None = None
    actuators: Literal["none", "motor", "position", "velocity"] | None = None
    layout: Literal["single", "layered"] | None = None
    nested: bool | None = None
    split: bool = False
    pure: bool = False
    beside: str = ""


Rule = Callable[["Mechanism", Options, "Report"], "Mechanism"]

_USD: tuple[Rule, ...] = (make_names_usable, hold_or_free_open_bases, expand_screws, choose_layout)

_URDF: tuple[Rule, ...] = (
    make_names_usable,
    drop_shapes_of_mujoco,
    fill_tensors,
    expand_screws,
    chain_dofs,
    hold_or_free_open_bases,
    make_world_a_link,
    join_roots,
    split_shared_shapes,
    prefer_own_colours,
    approximate_shapes,
    make_names_usable,  # once more, for what the rules have added
)

RULES: Mapping[str, tuple[Rule, ...]] = MappingProxyType(
    {
        "usd": _USD,
        "usdc": _USD,
        "usdz": _USD,
        "mjcf": (
            make_names_usable,
            name_assets_once,
            open_second_parents,
            close_by_points,
            anchor_closures,
            put_world_link_into_world,
            choose_base,
            expand_screws,
            lower_inner_free_joints,
            name_dofs,
            split_overfull_joints,
            make_limits_intervals,
            make_couplings_scalar,
            fill_tensors,
            make_tensors_physical,
            give_moving_bodies_mass,
            drop_empty_shapes,
            keep_planes_static,
            make_sizes_positive,
            name_shapes_once,
            choose_actuators,
            make_names_usable,  # once more, for what the rules have added
        ),
        "urdf": _URDF,
        "xacro": (*_URDF, choose_files),
    }
)
"""The rules of each target, in order. A target that is not here takes every mechanism as it is."""

NATIVE: tuple[Rule, ...] = (name_shapes_once, drop_stale_keyframes)
"""The rules of MJCF for what came from there."""


def legalize(mechanism: Mechanism, target: str, options: Options, report: Report) -> Mechanism:
    """The mechanism rewritten so that the target's backend can print all of it. Idempotent.

    What came from MJCF, directly, through HyMeKo text or carried by another file, is legal there but for what was edited since.
    """
    rules = NATIVE if target == "mjcf" and mechanism.notation(ROOT, target) is not None else RULES.get(target, ())
    for rule in rules:
        mechanism = rule(mechanism, options, report)
    return mechanism
