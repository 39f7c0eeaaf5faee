"""What all drivers do: one job per line in, one answer per line out, with the processor time that the work took.

Jobs that stand on the command line are done instead of those from stdin, for the time and memory of a whole process, which
fails with the first of them that does.
"""

from __future__ import annotations

import gc
import json
import sys
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


def answer_all(work: Callable[[dict[str, Any]], dict[str, Any] | None]) -> None:
    """Answer every job. ``repeat`` in a job runs it so often; ``seconds`` is the least processor time."""
    for line in sys.argv[1:] or sys.stdin:
        if line.strip():
            job = json.loads(line)
            answer = _answer(work, job)
            print("> " + json.dumps(answer), flush=True)
            if "error" in answer and sys.argv[1:]:
                sys.exit(answer["error"])


def _answer(work: Callable[[dict[str, Any]], dict[str, Any] | None], job: dict[str, Any]) -> dict[str, Any]:
    best = float("inf")
    answer: dict[str, Any] = {}
    for _ in range(job.get("repeat", 1)):
        gc.collect()
        start = time.process_time()
        try:
            answer = work(job) or {}
        except Exception as error:  # noqa: BLE001 - a foreign program may fail in any way
            return {"error": f"{type(error).__name__}: {str(error)[:300]}"}
        best = min(best, time.process_time() - start)
    return {**answer, "seconds": best}
