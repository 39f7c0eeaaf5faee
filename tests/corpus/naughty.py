"""What takes the place of the work on one file: steps that do what native libraries do on bad days."""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from msgspec.structs import asdict

from hymeko_x.corpus.cases import Case
from hymeko_x.corpus.plan import Plan, set_limits
from hymeko_x.corpus.rows import Cost, Leg, RobotRow
from hymeko_x.corpus.work import NOTES


def misbehave(case: Case, plan: Plan, folder: str, scratch: str, steps: Sequence[str]) -> None:
    """Every step works, but the one that the file's name says, as `STEP=DEED.urdf`."""
    set_limits(plan.limits)
    where, _, deed = case.path.removesuffix(".urdf").partition("=")
    for step in steps:
        if step == where:
            DEEDS[deed](folder)
        found = found_at(case, step)
        line = {"step": step, "found": found, "cost": asdict(Cost(case.key, step, 0.0, 0.0, 0.0))}
        with (Path(scratch) / NOTES).open("a") as notes:
            notes.write(json.dumps(line) + "\n")


def note_modules(case: Case, plan: Plan, folder: str, scratch: str, steps: Sequence[str]) -> None:
    """Which modules a process has before it does anything."""
    (Path(scratch) / "modules").write_text(" ".join(sys.modules))


def found_at(case: Case, step: str) -> dict[str, object]:
    if step == "read":
        return asdict(RobotRow(case.key, case.package, case.format))
    if step == "engine":
        return {"engine": "done", "engine_reason": ""}
    return asdict(Leg(case.key, case.format, step.partition(":")[2], verdict="same"))


def fail(folder: str) -> None:
    raise KeyError("a bug of ours")


def die_once(folder: str) -> None:
    """As when somebody kills the worker."""
    grave = Path(folder) / "grave"
    if not grave.exists():
        grave.touch()
        os.kill(os.getpid(), signal.SIGKILL)


DEEDS = {
    "abort": lambda folder: os.abort(),
    "segfault": lambda folder: os.kill(os.getpid(), signal.SIGSEGV),
    "exit": lambda folder: os._exit(3),
    "hang": lambda folder: time.sleep(1000),
    "fail": fail,
    "eat": lambda folder: bytearray(4 * 2**30),
    "killed": lambda folder: os.kill(os.getpid(), signal.SIGKILL),
    "killed_once": die_once,
}
