"""Dofs and poses of a mechanism's tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hymeko_x.ir.parts import Joint


def dof_number(joint: Joint, role: str) -> int | None:
    """Which dof of the joint an arc's role means: by name, else by number, else the only one. None when there is none."""
    for number, dof in enumerate(joint.dofs):
        if role and dof.name == role:
            return number
    if role.isascii() and role.isdigit() and int(role) < len(joint.dofs):
        return int(role)
    return 0 if not role and len(joint.dofs) == 1 else None
