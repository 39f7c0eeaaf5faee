"""What makes a mechanism legal in xacro, which says what URDF says."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.ir.legalize_xacro import choose_files
from hymeko_x.ir.rules_urdf import RULES as URDF

if TYPE_CHECKING:
    from hymeko_x.ir.legalize import Rule

RULES: tuple[Rule, ...] = (*URDF, choose_files)
