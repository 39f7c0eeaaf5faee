"""mjcf-urdf-simple-converter: an MJCF in ``source`` becomes a URDF in ``out``."""

from __future__ import annotations

from typing import Any

import mjcf_urdf_simple_converter
from loop import answer_all


def convert(job: dict[str, Any]) -> None:
    """Convert once."""
    mjcf_urdf_simple_converter.convert(job["source"], job["out"])


if __name__ == "__main__":
    answer_all(convert)
