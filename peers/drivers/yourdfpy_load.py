"""yourdfpy: loads the URDF in ``source`` without meshes and scene graphs."""

from __future__ import annotations

from typing import Any

from loop import answer_all
from yourdfpy import URDF


def load(job: dict[str, Any]) -> None:
    """Load once."""
    URDF.load(job["source"], load_meshes=False, build_scene_graph=False, build_collision_scene_graph=False)


if __name__ == "__main__":
    answer_all(load)
