"""Mesh files of the real robots that are in the cache, in an order that is always the same and mixes them."""

from __future__ import annotations

import hashlib
import os
from typing import TYPE_CHECKING

import pytest

from hymeko_x.corpus.cache import cache_root

if TYPE_CHECKING:
    from pathlib import Path

_MOST_BYTES = 2_000_000


def cached_meshes(suffixes: tuple[str, ...], count: int) -> list[Path]:
    """So many files of these types; skips the test where the cache has none."""
    folder = cache_root(os.environ) / "corpus"
    found = [path for path in folder.rglob("*") if path.suffix.lower() in suffixes and 0 < path.stat().st_size < _MOST_BYTES]
    if not found:
        pytest.skip("the cache has no robots: hymeko-x corpus fetch")
    return sorted(found, key=lambda path: hashlib.sha256(str(path.relative_to(folder)).encode()).digest())[:count]
