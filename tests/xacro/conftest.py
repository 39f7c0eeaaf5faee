"""A folder for the files of one test."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.xacro.samples import Folder


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    """An empty folder."""
    return Folder(tmp_path)
