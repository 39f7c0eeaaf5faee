"""Whatever one step does to its process, it is one row, and the other steps have their own."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
from pathlib import Path

import pytest

from hymeko_x.corpus.cases import Case
from hymeko_x.corpus.plan import Plan, ProcessLimits
from hymeko_x.corpus.rows import Leg, Outcome
from hymeko_x.corpus.supervise import Processes, preloaded, supervise
from tests.corpus.naughty import misbehave

PLAN = Plan((("urdf", "hymeko"), ("urdf", "mjcf")), limits=ProcessLimits(seconds=5.0, bytes=3 * 2**30))


def outcome(tmp_path: Path, name: str) -> Outcome:
    return supervise(Case("p", str(tmp_path), f"{name}.urdf", "urdf"), PLAN, str(tmp_path), Processes(), misbehave)


def rows(outcome: Outcome) -> list[tuple[str, str, str, str]]:
    return [(leg.target, leg.status, leg.reason, leg.verdict) for leg in outcome.legs]


def test_a_file_that_does_no_harm_has_all_its_rows(tmp_path: Path) -> None:
    found = outcome(tmp_path, "good")
    assert rows(found) == [("hymeko", "done", "", "same"), ("mjcf", "done", "", "same")]
    assert [cost.step for cost in found.costs] == ["read", "engine", "convert:hymeko", "verify:hymeko", "convert:mjcf", "verify:mjcf"]


@pytest.mark.parametrize(
    ("deed", "status", "reason"),
    [
        ("abort", "crashed", "killed by SIGABRT"),
        ("segfault", "crashed", "killed by SIGSEGV"),
        ("exit", "crashed", "exit code 3"),
        ("fail", "failed", "KeyError: 'a bug of ours'"),
        ("eat", "out of memory", "more than 3072 MiB"),
        ("hang", "timed out", "more than 5 s"),
        ("killed", "out of memory", "killed by SIGKILL"),
    ],
)
def test_a_conversion_that_ends_its_process_costs_itself_only(tmp_path: Path, deed: str, status: str, reason: str) -> None:
    found = outcome(tmp_path, f"convert:hymeko={deed}")
    assert rows(found) == [("hymeko", status, reason, ""), ("mjcf", "done", "", "same")]
    assert (found.robot.status, found.robot.engine) == ("done", "done")


def test_a_reader_that_crashes_leaves_every_conversion_unread(tmp_path: Path) -> None:
    found = outcome(tmp_path, "read=abort")
    assert (found.robot.status, found.robot.reason) == ("crashed", "killed by SIGABRT")
    assert rows(found) == [("hymeko", "unread", "killed by SIGABRT", ""), ("mjcf", "unread", "killed by SIGABRT", "")]


def test_a_verifier_that_crashes_says_nothing_about_the_conversion(tmp_path: Path) -> None:
    leg = outcome(tmp_path, "verify:hymeko=abort").legs[0]
    assert leg == Leg("p/verify:hymeko=abort.urdf", "urdf", "hymeko", verdict="not comparable", verdict_reason=leg.verdict_reason)
    assert leg.verdict_reason == "the verifier crashed: killed by SIGABRT"


def test_an_engine_that_crashes_is_asked_once(tmp_path: Path) -> None:
    found = outcome(tmp_path, "engine=abort")
    assert (found.robot.status, found.robot.engine, found.robot.engine_reason) == ("done", "crashed", "killed by SIGABRT")
    assert [leg.status for leg in found.legs] == ["done", "done"]


def test_a_worker_that_somebody_kills_does_its_file_again(tmp_path: Path) -> None:
    found = outcome(tmp_path, "convert:mjcf=killed_once")
    assert (tmp_path / "grave").exists()
    assert rows(found) == [("hymeko", "done", "", "same"), ("mjcf", "done", "", "same")]


@pytest.mark.skipif("forkserver" not in multiprocessing.get_all_start_methods(), reason="processes cannot be forked from a server here")
def test_a_process_begins_with_the_heavy_libraries_loaded(tmp_path: Path) -> None:
    """In a program of its own: one server forks for a whole program, and another test's may be there already."""
    program = f"""
from pathlib import Path
from tests.corpus.naughty import note_modules
from tests.corpus.test_supervise import PLAN, Case, Processes
if __name__ == "__main__":
    folder = {str(tmp_path)!r}
    Processes().run(note_modules, Case("p", folder, "any.urdf", "urdf"), PLAN, "", folder, ())
"""
    (tmp_path / "program.py").write_text(program)
    root = str(Path(__file__).parents[2])
    subprocess.run([sys.executable, tmp_path / "program.py"], check=True, env={**os.environ, "PYTHONPATH": root})
    at_hand = set((tmp_path / "modules").read_text().split())
    assert {"mujoco", "numpy", "pinocchio", "pxr", "trimesh", *preloaded()} - at_hand == set()
