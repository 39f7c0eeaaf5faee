"""scikit-robot: a URDF in ``source`` into ``folder``; answers the ``stage``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from loop import answer_all
from skrobot.export.usd import urdf_to_usd


def convert(job: dict[str, Any]) -> dict[str, Any]:
    """Convert once, as the command line tool does without options: a base that is welded to the world."""
    source, folder = Path(job["source"]), Path(job["folder"])
    folder.mkdir(parents=True, exist_ok=True)
    stage = folder / f"{source.stem}.usda"
    urdf_to_usd(str(source), str(stage))
    return {"stage": str(stage)}


if __name__ == "__main__":
    answer_all(convert)
