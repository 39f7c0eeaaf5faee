"""hymeko-x itself, from this repository: loads ``source``, and writes ``out`` when there is one; ``measure`` is what `convert` does."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from loop import answer_all

sys.path.insert(0, str(Path(__file__).parents[2]))

import hymeko_x as hx
from hymeko_x import disk, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options


def work(job: dict[str, Any]) -> None:
    """Load, or convert with ledger and residue (``measure``), or read and write alone."""
    if "out" not in job:
        hx.load(job["source"])
    elif job.get("measure", False):
        hx.convert(job["source"], job["out"], keep="beside")
    else:
        _write(job["source"], job["out"])


def _write(source: str, out: str) -> None:
    files = DiskFiles(Path(source).parent)
    place = pipeline.OutputPlace(str(Path(out).parent))
    package = pipeline.write(hx.load(source).mechanism, formats.of_output(out), Options(), files, Report(), place)
    disk.write_package(package, out, files)


if __name__ == "__main__":
    answer_all(work)
