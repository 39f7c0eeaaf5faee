"""cyberwave-robot-format: a URDF or MJCF in ``source`` into ``folder``; answers the ``stage``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cyberwave_robot_format.mjcf import MJCFParser
from cyberwave_robot_format.urdf import URDFParser
from cyberwave_robot_format.usd import USDExporter
from loop import answer_all


def convert(job: dict[str, Any]) -> dict[str, Any]:
    """Convert once; ``meshes`` asks for their points in the stage, which it leaves out otherwise."""
    source, folder = Path(job["source"]), Path(job["folder"])
    folder.mkdir(parents=True, exist_ok=True)
    stage = folder / f"{source.stem}.usda"
    parser = URDFParser() if source.suffix == ".urdf" else MJCFParser()
    search = [str(source.parent), *job.get("packages", {}).values()]
    USDExporter(bake_meshes=job.get("meshes", False), mesh_search_paths=search).export(parser.parse(str(source)), stage)
    return {"stage": str(stage)}


if __name__ == "__main__":
    answer_all(convert)
