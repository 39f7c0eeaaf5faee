"""The processes in which readers evaluate a file with limits on time and memory: Python without anything of the user's own."""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec
from pathlib import Path


def python(*words: str) -> list[str]:
    """Python without site packages of its own, which only cost time: the environment has the folders of the libraries."""
    return [sys.executable, "-S", "-P", *words]


def environment_with(*libraries: str) -> dict[str, str]:
    """The folders of the libraries that are installed, and a fixed seed, so that the same file gives the same text."""
    places = [spec.origin for name in libraries if (spec := find_spec(name)) and spec.origin]
    folders = dict.fromkeys(str(Path(place).parents[1]) for place in places)
    kept = {name: os.environ[name] for name in ("SYSTEMROOT", "LD_LIBRARY_PATH") if name in os.environ}
    return {"PYTHONPATH": os.pathsep.join(folders), "PYTHONHASHSEED": "0", **kept}
