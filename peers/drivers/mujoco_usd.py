"""mujoco-usd-converter: an MJCF in ``source`` into ``folder``; answers the ``stage``."""

from __future__ import annotations

import shutil
from typing import Any

import mujoco_usd_converter
from loop import answer_all


def convert(job: dict[str, Any]) -> dict[str, Any]:
    """Convert once, into an empty folder."""
    shutil.rmtree(job["folder"], ignore_errors=True)
    converter = mujoco_usd_converter.Converter(layer_structure=job.get("layers", True))
    return {"stage": converter.convert(job["source"], job["folder"]).path}


if __name__ == "__main__":
    answer_all(convert)
