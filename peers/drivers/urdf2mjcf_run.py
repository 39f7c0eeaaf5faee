"""urdf2mjcf: a URDF in ``source`` becomes an MJCF in ``out``."""

from __future__ import annotations

from typing import Any

from loop import answer_all
from urdf2mjcf.convert import convert_urdf_to_mjcf


def convert(job: dict[str, Any]) -> None:
    """Convert once."""
    convert_urdf_to_mjcf(job["source"], job["out"])


if __name__ == "__main__":
    answer_all(convert)
