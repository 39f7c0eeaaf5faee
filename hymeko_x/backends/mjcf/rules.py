"""What makes a mechanism legal in MJCF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.rewrite.actuators import choose_actuators, drop_idle_actuators
from hymeko_x.rewrite.base import choose_base, put_world_link_into_world
from hymeko_x.rewrite.couplings import make_couplings_scalar
from hymeko_x.rewrite.inertia import give_moving_bodies_mass, make_tensors_physical
from hymeko_x.rewrite.joints import expand_screws, lower_inner_free_joints, name_dofs, name_dofs_once, split_overfull_joints
from hymeko_x.rewrite.limits import make_limits_intervals
from hymeko_x.rewrite.loops import anchor_closures, close_by_points, open_second_parents
from hymeko_x.rewrite.names import make_names_usable, name_assets_once
from hymeko_x.rewrite.native import drop_stale_keyframes
from hymeko_x.rewrite.shapes import drop_empty_shapes, keep_planes_static, make_sizes_positive, name_shapes_once
from hymeko_x.rewrite.solids import fill_tensors
from hymeko_x.rewrite.subsets import split_subsets
from hymeko_x.rewrite.tendons import drop_odd_tendons, make_tendons_sound, name_wrapped_shapes

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = (
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
    choose_actuators,
    drop_idle_actuators,
    make_names_usable,  # once more, for what the rules have added
)

_FOREIGN = (anchor_closures, name_dofs, give_moving_bodies_mass)
"""What MJCF says in more ways than others, and what MuJoCo finds out itself or the model that a part is made for."""

NATIVE: tuple[Rule, ...] = (*(rule for rule in RULES if rule not in _FOREIGN), name_dofs_once, drop_stale_keyframes)
"""The rules for what came from MJCF: none changes what MuJoCo reads, all hold for what was edited in another format since."""
