"""What a geom is for, by its attributes: MJCF has no attribute of its own for it."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.ir.parts import Role

if TYPE_CHECKING:
    from collections.abc import Mapping

SHOWN = 3
"""The viewers of MuJoCo show the groups below this number."""
ATTRIBUTES: Mapping[Role, Mapping[str, str]] = MappingProxyType(
    {Role.VISUAL: {"contype": "0", "conaffinity": "0", "group": "2"}, Role.COLLISION: {"group": "3"}, Role.BOTH: {}}
)
"""The attributes of a geom by what it is for, where others have their default values."""
_DEFAULTS = MappingProxyType({"contype": "1", "conaffinity": "1", "group": "0"})


def role_of(given: Mapping[str, str]) -> Role:
    """For the eye alone when it can touch nothing; for contact alone when it is in a group that is not shown."""
    touches, affects, group = [_number(given.get(name, default)) for name, default in _DEFAULTS.items()]
    if not touches and not affects:
        return Role.VISUAL
    return Role.COLLISION if group >= SHOWN else Role.BOTH


def role_attributes(role: Role, given: Mapping[str, str]) -> dict[str, str]:
    """The attributes that make a geom, which has or inherits those that are given, one for this; none where it is one already."""
    if role_of(given) is role:
        return {}
    wanted = {**_DEFAULTS, **ATTRIBUTES[role]}
    return {name: text for name, text in wanted.items() if _number(given.get(name, _DEFAULTS[name])) != int(text)}


def _number(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        return 0
