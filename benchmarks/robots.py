"""Real robots for the benchmarks, from the corpus cache."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from hymeko_x.corpus.cache import cache_root, fetch
from hymeko_x.corpus.catalog import development_files

if TYPE_CHECKING:
    from pathlib import Path


def robots(format: str, names: tuple[str, ...] = ()) -> list[Path]:
    """The development files of a format (all, or those with one of these file names), downloaded if need be."""
    root = cache_root(os.environ)
    files = [file for file in development_files(format) if not names or file.path.rsplit("/", 1)[-1] in names]
    return [fetch(file.package, root) / file.path for file in files]
