"""MJCF in memory, compiled by MuJoCo."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco

if TYPE_CHECKING:
    from collections.abc import Mapping


def load(main: bytes, contents: Mapping[str, bytes]) -> Any:
    """The mjModel of a text with the files to which it refers. Raises: ValueError in MuJoCo's words."""
    return mujoco.MjModel.from_xml_string(main.decode(), dict(contents))
