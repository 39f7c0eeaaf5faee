"""Which cases of a test run with `make test`, and which with `make test-full` only."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import pytest


def cases(values: Mapping[str, object], later: Collection[str]) -> list[Any]:
    """A case of a parametrized test for each value, called by its name; those of ``later`` are `full`."""
    return [pytest.param(value, id=name, marks=[pytest.mark.full] if name in later else []) for name, value in values.items()]
