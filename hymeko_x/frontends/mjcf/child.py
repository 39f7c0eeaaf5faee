"""`python child.py SECONDS BYTES`: a model from standard input, expanded, to standard output.

Models that copy or attach themselves end this process, and nothing else. It runs as a file, since its package takes 0.1 s to load.
In: one line of JSON with the sizes of the model's text, its sub-models and its files, then all of them in that order.
Out: the expanded text, and exit code 0; or MuJoCo's message, and exit code 3.
"""

from __future__ import annotations

import json
import os
import sys
import warnings
from typing import Any


def main() -> int:
    """Expand one model within the limits that are given."""
    _limit(int(sys.argv[1]), int(sys.argv[2]))
    job = json.loads(sys.stdin.buffer.readline())
    text = sys.stdin.buffer.read(job["text"]).decode()
    models, assets = ({name: sys.stdin.buffer.read(size) for name, size in job[kind].items()} for kind in ("models", "assets"))
    answer = os.dup(1)
    os.dup2(2, 1)  # MuJoCo prints its warnings
    code, output = _expanded(text, models, assets, job["compile"])
    with open(answer, "wb") as out:
        out.write(output.encode("utf-8", "replace"))
    return code


def _expanded(text: str, models: dict[str, bytes], assets: dict[str, bytes], compiled: bool) -> tuple[int, str]:
    """The model as MuJoCo writes it, with every value as its author wrote it.

    MuJoCo's warnings are not about the expansion; they come again when the result is compiled.
    """
    warnings.simplefilter("ignore")
    import mujoco

    try:
        spec: Any = mujoco.MjSpec.from_string(text, include=models, assets=assets)
        spec.compiler.savecompiled = False
        spec.compiler.savecanonical = False
        if compiled:
            spec.compile()
        return 0, spec.to_xml()
    except (ValueError, RuntimeError, MemoryError, mujoco.FatalError) as error:
        return 3, str(error).strip()


def _limit(seconds: int, size: int) -> None:
    """Bounded time and memory, and no trace of a crash. Where the system has no such limits, the parent's clock remains."""
    try:
        import resource
    except ImportError:
        return
    for kind, bound in ((resource.RLIMIT_CPU, seconds), (resource.RLIMIT_DATA, size), (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (bound if hard == resource.RLIM_INFINITY else min(bound, hard), hard))


if __name__ == "__main__":
    sys.exit(main())
