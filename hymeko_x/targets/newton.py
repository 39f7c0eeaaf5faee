"""Newton and Isaac Sim: a stage that follows REP 158, and whose drives have force limits. docs/targets.md has the sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.usd.assetinfo import describe_stage, follow_rep_158
from hymeko_x.rewrite.densities import weigh_colliders
from hymeko_x.rewrite.dummies import make_dummies_frames, put_world_links_into_world
from hymeko_x.rewrite.efforts import limit_efforts_by_actuators
from hymeko_x.rewrite.frictions import give_colliders_friction
from hymeko_x.rewrite.inertia import give_every_body_mass
from hymeko_x.rewrite.roots import leave_scenery_out

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = (
    leave_scenery_out,
    put_world_links_into_world,
    make_dummies_frames,
    weigh_colliders,
    give_every_body_mass,
    give_colliders_friction,
    limit_efforts_by_actuators,
    describe_stage,
    follow_rep_158,
)
