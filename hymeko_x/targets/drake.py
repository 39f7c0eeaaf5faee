"""Drake. docs/targets.md has the sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.rewrite.roots import leave_scenery_out, open_floating_base

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = (leave_scenery_out, open_floating_base)
