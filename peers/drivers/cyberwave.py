"""cyberwave-robot-format: a URDF or MJCF in ``source`` becomes ``out``, or a ``stage`` in ``folder``, which it answers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cyberwave_robot_format.mjcf import MJCFExporter, MJCFParser
from cyberwave_robot_format.urdf import URDFExporter, URDFParser
from cyberwave_robot_format.usd import USDExporter
from loop import answer_all


def convert(job: dict[str, Any]) -> dict[str, Any]:
    """Convert once; ``meshes`` asks for their points in the stage, which it leaves out otherwise."""
    source = Path(job["source"])
    robot = (URDFParser() if source.suffix == ".urdf" else MJCFParser()).parse(str(source))
    if "out" in job:
        exporter = URDFExporter() if job["out"].endswith(".urdf") else MJCFExporter()
        exporter.export(robot, job["out"])
        return {}
    folder = Path(job["folder"])
    folder.mkdir(parents=True, exist_ok=True)
    stage = folder / f"{source.stem}.usda"
    search = [str(source.parent), *job.get("packages", {}).values()]
    USDExporter(bake_meshes=job.get("meshes", False), mesh_search_paths=search).export(robot, stage)
    return {"stage": str(stage)}


if __name__ == "__main__":
    answer_all(convert)
