"""The words of SRDF, MoveIt's file of what a URDF robot is used for, which its reader and its writer share.

Source: srdfdom's model.cpp. What the IR has no parts for (groups, virtual joints, passive joints, end effectors) are extras of the whole.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

SUFFIX = ".srdf"
PATH = "srdf"
"""The path of the extras that are elements of an SRDF file."""
REASON = "reason"
"""The parameter of an exclusion that says why its links never touch."""
ADJACENT, USER = "Adjacent", "User"
"""Reasons of MoveIt's setup assistant: a joint connects the links; a person knows it."""
ALL = "all"
"""The group of every joint that moves by itself, which a robot without groups gets: a pose needs a group."""
ORDER = ("group", "group_state", "end_effector", "virtual_joint", "passive_joint", "disable_collisions")
"""Elements in the order in which MoveIt's setup assistant writes them; others come last."""
REFERENCES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "link": {"name": "body"},
        "joint": {"name": "joint"},
        "passive_joint": {"name": "joint"},
        "chain": {"base_link": "body", "tip_link": "body"},
        "virtual_joint": {"child_link": "body"},
        "end_effector": {"parent_link": "body"},
        "disable_collisions": {"link1": "body", "link2": "body"},
    }
)
"""By tag, the attributes that name elements of the URDF, with the kind of these."""
