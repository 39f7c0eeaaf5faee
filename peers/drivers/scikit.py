"""scikit-robot: a URDF in ``source`` becomes an MJCF in ``out``, or a ``stage`` in ``folder``, which it answers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from loop import answer_all
from skrobot.export.usd import urdf_to_usd
from skrobot.utils.mjcf_converter import urdf_to_mjcf


def convert(job: dict[str, Any]) -> dict[str, Any]:
    """Convert once, as the command line tools do without options: a base that is welded to the world."""
    if "out" in job:
        urdf_to_mjcf(job["source"], job["out"])
        return {}
    source, folder = Path(job["source"]), Path(job["folder"])
    folder.mkdir(parents=True, exist_ok=True)
    stage = folder / f"{source.stem}.usda"
    urdf_to_usd(str(source), str(stage))
    return {"stage": str(stage)}


if __name__ == "__main__":
    answer_all(convert)
