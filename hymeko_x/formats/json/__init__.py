"""The JSON form of a mechanism: what the reader and the writer share. docs/json.md describes it, ``hymeko-x schema`` prints its schema."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

VERSION = 1
"""Raised when a key changes its meaning or goes away; new keys may come without."""

MARK = "hymeko-x"
"""The key of the root that has the version: by it the form is recognised."""

ENDLESS = "number"
"""The only key of an object that stands for a number that JSON does not have."""
NUMBERS: Mapping[str, float] = MappingProxyType({"inf": float("inf"), "-inf": float("-inf"), "nan": float("nan")})
"""The values of that key."""
