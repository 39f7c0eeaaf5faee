"""Pinocchio, with ``mimic=True``. docs/targets.md has the sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.rewrite.apart import call_joints_apart
from hymeko_x.rewrite.mimics import put_leaders_first
from hymeko_x.rewrite.roots import leave_scenery_out

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = (leave_scenery_out, call_joints_apart, put_leaders_first)
