"""iDynTree: reads the URDF in ``source`` and exports it to ``out``."""

from __future__ import annotations

from typing import Any

import idyntree.swig as idyntree
from loop import answer_all


def convert(job: dict[str, Any]) -> None:
    """Convert once. Raises: ValueError when iDynTree reports a failure; it prints the reason to stderr."""
    loader = idyntree.ModelLoader()
    if not loader.loadModelFromFile(job["source"]):
        raise ValueError("iDynTree does not load it")
    exporter = idyntree.ModelExporter()
    exporter.init(loader.model(), loader.sensors(), idyntree.ModelExporterOptions())
    if not exporter.exportModelToFile(job["out"], "urdf"):
        raise ValueError("iDynTree does not export it")


if __name__ == "__main__":
    answer_all(convert)
