"""MuJoCo's own parser, compiler and writer: a URDF in ``source`` becomes an MJCF in ``out``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
from loop import answer_all


def convert(job: dict[str, Any]) -> None:
    """Convert once."""
    spec = mujoco.MjSpec.from_file(job["source"])
    spec.compile()
    Path(job["out"]).write_text(spec.to_xml(), "utf-8")


if __name__ == "__main__":
    answer_all(convert)
