"""The notations of exclusions that come from collision groups."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from hymeko_x.ir.notations import word

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import Id


# ---- collision groups ------------------------------------------------------------------------------------------------------------

GROUP = "PhysicsCollisionGroup"
GROUPED = word("usd.grouped")
"""The notation of an exclusion from collision groups: ``groups`` where it is theirs alone, ``both`` where a filtered pair has it, too."""
BY_GROUPS, BY_BOTH = "groups", "both"
GROUPS = word("usd.groups")
"""The notation of the mechanism with the digest of the exclusions that its collision groups mean."""


def pairs_digest(pairs: Iterable[tuple[Id, Id]]) -> str:
    """A fingerprint of pairs of bodies, in whatever order."""
    lines = sorted("\n".join(sorted(map(str, pair))) for pair in pairs)
    return hashlib.sha256("\n\n".join(lines).encode()).hexdigest()[:16]
