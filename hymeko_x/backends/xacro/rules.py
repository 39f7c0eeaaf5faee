"""What makes a mechanism legal in xacro, which says what URDF says."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.urdf.rules import RULES as URDF

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = URDF
