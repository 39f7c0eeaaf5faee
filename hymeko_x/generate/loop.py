"""The loop: ask, mend, check, verify, report the faults, ask again. Each step is a record."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.api import loads
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.formats import OWN
from hymeko_x.generate.prompts import feedback, first_prompt
from hymeko_x.generate.repair import Repair, repair
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.source import NO_FILES
from hymeko_x.validation import Profile, validate
from hymeko_x.verify import verify

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.formats import Format
    from hymeko_x.generate.models import LanguageModel, Messages
    from hymeko_x.ir.mechanism import Mechanism

_FENCE = re.compile(r"```[\w-]*\n(.*?)```", re.DOTALL)
_SAMPLES = 20


class Task(Struct, frozen=True):
    """A robot to be written in a format: its text, the file and the mechanism that answers are compared with."""

    text: str
    path: Path
    robot: Mechanism
    format: Format
    prompt: str = "card"

    @property
    def counts(self) -> tuple[int, int]:
        """How many links and joints there should be."""
        return counts_of(self.robot)


def counts_of(robot: Mechanism) -> tuple[int, int]:
    """The numbers of links, and of joints between them: what holds a base in the world is no joint in every format."""
    return sum(1 for _ in robot.vertices(parts.Body)), sum(view.parent != WORLD for view in robot.joints.values())


class JudgedAnswer(Struct, frozen=True):
    """One answer: whether it passed the paper's checks, has the right numbers of elements, and is the same robot; and its faults.

    ``text`` is the file in it after its ``repairs``, of which each was an error that needed no model.
    """

    attempt: int
    is_complete: bool
    has_counts: bool
    is_same: bool
    faults: tuple[str, ...]
    answer: str
    text: str
    repairs: tuple[str, ...] = ()


def generate(task: Task, model: LanguageModel, tries: int) -> list[JudgedAnswer]:
    """The answers until one is the same robot, at most so many. Raises: Refusal when the model gives none."""
    prompt = first_prompt(task.prompt, task.format, task.text, *task.counts)
    messages: Messages = [{"role": "user", "content": prompt}]
    steps: list[JudgedAnswer] = []
    while len(steps) < tries and not (steps and steps[-1].is_same):
        answer = model(messages)
        step = judged(task, answer, len(steps) + 1)
        steps.append(step)
        messages += [{"role": "assistant", "content": answer}, {"role": "user", "content": feedback([*step.repairs, *step.faults])}]
    return steps


def file_in(answer: str) -> str:
    """The file in an answer: what stands in its first fence, or all of it."""
    found = _FENCE.search(answer)
    return (found[1] if found else answer).strip() + "\n"


def judged(task: Task, answer: str, attempt: int) -> JudgedAnswer:
    """An answer with its faults. What cannot be read fails everything, and what fails one check is still asked the next."""
    mended = repair(file_in(answer)) if task.format is OWN else Repair(file_in(answer))
    text = mended.text
    try:
        robot = loads(text, task.format.name).mechanism
    except Refusal as refusal:
        return JudgedAnswer(attempt, False, False, False, tuple(str(one) for one in refusal.diagnostics), answer, text, mended.changes)
    report = Report()
    validate(robot, NO_FILES, report, [Profile.COMPLETE])
    complete = [str(one) for one in report.errors()]
    numbers = zip(("links", "joints"), counts_of(robot), task.counts, strict=True)
    counts = [f"there are {found} {word}, expected {expected}" for word, found, expected in numbers if found != expected]
    different = list(_differences(task, text))
    return JudgedAnswer(attempt, not complete, not counts, not different, (*complete, *counts, *different), answer, text, mended.changes)


def _differences(task: Task, text: str) -> Iterator[str]:
    """What the verifier finds: where the answer is another robot than the source."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"answer{task.format.suffixes[0]}"
        path.write_text(text, "utf-8")
        verdict = verify(task.path, path, samples=_SAMPLES)
    if verdict.reason:
        yield f"it cannot be compared: {verdict.reason}".replace(folder, "")
    for check in verdict.failed:
        values = f": expected {check.values[0]}, found {check.values[1]} {check.unit}" if check.values else ""
        yield f"{check.quantity} of {check.at}{values}"
