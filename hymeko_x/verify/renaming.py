"""Names of one author in the spelling of another: patterns with at most one ``*``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


def is_renaming(pattern: str, new: str) -> bool:
    """Whether a pattern has a name to begin with and one ``*`` at most, which the new name may repeat."""
    return bool(pattern) and pattern.count("*") <= 1 and new.count("*") <= pattern.count("*")


def renamed(name: str, rename: Mapping[str, str]) -> str:
    """A name after the first pattern that fits it; a ``*`` in the new name is what the pattern's ``*`` stands for."""
    for pattern, new in rename.items():
        before, star, behind = pattern.partition("*")
        found = re.fullmatch(re.escape(before) + ("(.*)" if star else "") + re.escape(behind), name, re.DOTALL)
        if found:
            return new.replace("*", found[1]) if star else new
    return name
