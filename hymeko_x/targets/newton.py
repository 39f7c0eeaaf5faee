"""Newton and Isaac Sim: a stage whose drives have force limits, and that says what it is. docs/targets.md has the sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.usd.assetinfo import describe_stage
from hymeko_x.rewrite.efforts import limit_efforts_by_actuators
from hymeko_x.rewrite.roots import leave_scenery_out

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = (leave_scenery_out, limit_efforts_by_actuators, describe_stage)
