"""`hymeko-x generate`: a language model converts a robot, checked and verified, until it is the same robot."""

from __future__ import annotations

import json
import os
import random
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec.structs import asdict

from hymeko_x import disk, formats
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.parser import count
from hymeko_x.diagnostics import Report
from hymeko_x.generate.prompts import PROMPTS

if TYPE_CHECKING:
    import argparse

    from hymeko_x.generate.loop import JudgedAnswer, Task
    from hymeko_x.generate.models import LanguageModel

_ONE_JOINT = 2
"""Up to so many bodies the paper's rate is that of the robot with one joint."""


def generate_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `generate`."""
    parser.add_argument("input", metavar="FILE", help="the robot to convert")
    parser.add_argument("--to", required=True, metavar="FORMAT", help="the format of the answers")
    models = "the model: the URL of a chat, replay:DIR (recorded answers) or faults:SEED (a stand-in with the paper's rates)"
    parser.add_argument("--with", dest="model", required=True, metavar="MODEL", help=models)
    parser.add_argument("--model", dest="name", default="default", metavar="NAME", help="the model's name at the URL")
    parser.add_argument("--key-from", metavar="VARIABLE", help="the environment variable with the key for the URL")
    parser.add_argument("--prompt", choices=PROMPTS, default="card", help="as in the paper, or with the language on one page (default)")
    parser.add_argument("--tries", type=count, default=5, metavar="N", help="answers per run, the first and its repairs (default 5)")
    parser.add_argument("--runs", type=count, default=1, metavar="N", help="so many runs, for the table (default 1)")
    parser.add_argument("--log", metavar="FILE", help="each step as a line of JSON")
    parser.add_argument("--result", metavar="OUT", help="the last run's file, if it is the same robot")


def run_generate(chosen: argparse.Namespace) -> int:
    """Print the table; exit 4 when a run does not end with the same robot."""
    from hymeko_x.generate.loop import generate

    disk.check_outputs(chosen.log, chosen.result, makes_folders=True)
    task = _task(chosen)
    model = _model(chosen, task)
    lines: list[str] = []
    runs: list[list[JudgedAnswer]] = []
    for number in range(1, chosen.runs + 1):
        steps = generate(task, model, chosen.tries)
        lines += (json.dumps({"run": number, **asdict(step)}) for step in steps)
        runs.append(steps)
    if chosen.log:
        disk.write_files({chosen.log: "".join(f"{line}\n" for line in lines).encode()})
    print("\n".join(table(runs)))
    last = runs[-1][-1]
    if chosen.result and last.is_same:
        disk.write_files({chosen.result: last.text.encode()})
    for fault in last.faults:
        print(f"  {fault}", file=sys.stderr)
    return exits.DONE if all(steps[-1].is_same for steps in runs) else exits.DIFFERENT


def table(runs: list[list[JudgedAnswer]]) -> list[str]:
    """How many first answers pass each test as they are, and how many runs end with the same robot."""
    first = [steps[0] for steps in runs if not steps[0].repairs]
    rows = (
        ("valid by the paper's checks", sum(step.is_complete for step in first)),
        ("with the numbers of links and joints", sum(step.is_complete and step.has_counts for step in first)),
        ("the same robot by the verifier", sum(step.is_same for step in first)),
        ("the same robot after repair", sum(steps[-1].is_same for steps in runs)),
    )
    lines = (f"  {name:<38} {number:>5} {number / len(runs):>6.1%}" for name, number in rows)
    return [f"{len(runs)} runs, {sum(map(len, runs))} answers", *lines]


def _task(chosen: argparse.Namespace) -> Task:
    from hymeko_x import pipeline
    from hymeko_x.api import dumps
    from hymeko_x.generate.loop import Task

    source = disk.open_source(chosen.input)
    format = formats.of_input(source.name, source.data)
    robot = pipeline.read(source, format, Report())
    text = source.data.decode() if format is formats.OWN else dumps(robot, formats.OWN.name)
    return Task(text, Path(chosen.input), robot, formats.by_name(chosen.to), chosen.prompt)


def _model(chosen: argparse.Namespace, task: Task) -> LanguageModel:
    from hymeko_x.generate.models import Endpoint, Faulty, Replay

    kind, _, word = chosen.model.partition(":")
    if kind == "replay":
        return Replay(Path(word))
    if kind == "faults":
        if not word.isdigit() or task.format.error_rates is None:
            raise UsageError(f"'{chosen.model}': expected faults:SEED, and a format of which the paper reports a rate")
        small = task.counts[0] <= _ONE_JOINT
        return Faulty(task.robot, task.format, task.format.error_rates[0 if small else 1], random.Random(int(word)))
    if kind not in ("http", "https"):
        raise UsageError(f"--with '{chosen.model}': expected a URL, replay:DIR or faults:SEED")
    return Endpoint(chosen.model, chosen.name, os.environ.get(chosen.key_from, "") if chosen.key_from else "")
