"""urdf-usd-converter: a URDF in ``source`` into ``folder``, with ROS ``packages``; answers the ``stage``."""

from __future__ import annotations

import shutil
from typing import Any

import urdf_usd_converter
from loop import answer_all


def convert(job: dict[str, Any]) -> dict[str, Any]:
    """Convert once, into an empty folder."""
    shutil.rmtree(job["folder"], ignore_errors=True)
    packages = [{"name": name, "path": path} for name, path in job.get("packages", {}).items()]
    converter = urdf_usd_converter.Converter(layer_structure=job.get("layers", True), ros_packages=packages)
    return {"stage": converter.convert(job["source"], job["folder"]).path}


if __name__ == "__main__":
    answer_all(convert)
