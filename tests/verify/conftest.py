"""What the verifier's tests share: files of our own on disk, and verdicts about them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

SUFFIXES = {"urdf": ".urdf", "mjcf": ".xml", "usd": ".usda", "hymeko": ".hymeko"}


@pytest.fixture
def written(tmp_path: Path) -> Callable[[str, str], Path]:
    """Call it with a format and a text to get a file that holds it."""
    count = iter(range(1000))

    def write(format: str, text: str) -> Path:
        path = tmp_path / f"robot{next(count)}{SUFFIXES[format]}"
        path.write_text(text, "utf-8")
        return path

    return write
