"""URDF in memory, as Pinocchio reads it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pinocchio

if TYPE_CHECKING:
    from collections.abc import Mapping


def load(main: bytes, contents: Mapping[str, bytes]) -> Any:
    """The model of a text; Pinocchio's models have no meshes. Raises: ValueError in Pinocchio's words."""
    return pinocchio.buildModelFromXML(main.decode())
