"""Gazebo Sim: a model whose joints can be commanded. docs/targets.md has the sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.sdf.plugins import control_joints
from hymeko_x.rewrite.efforts import limit_efforts_by_actuators
from hymeko_x.rewrite.roots import leave_scenery_out

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = (leave_scenery_out, limit_efforts_by_actuators, control_joints)
