"""Batch runs: what is in the tables, and that killing anything at any time changes none of it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import polars as pl
import pytest

from hymeko_x.corpus.store import Store, load
from tests.corpus.folder import TOO_LARGE, fill

ROOT = Path(__file__).parents[2]
PAIRS = "urdf:hymeko,urdf:mjcf,mjcf:urdf,hymeko:urdf"


def command(*words: str) -> list[str]:
    return [sys.executable, "-m", "hymeko_x", "corpus", *words]


def corpus(*words: str, code: int = 0) -> subprocess.CompletedProcess[str]:
    run = subprocess.run(command(*words), capture_output=True, text=True, cwd=ROOT, check=False)
    assert run.returncode == code, run.stderr
    return run


def facts(results: Path) -> tuple[bytes, bytes]:
    return (results / "robots.parquet").read_bytes(), (results / "legs.parquet").read_bytes()


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = fill(tmp_path_factory.mktemp("in") / "toys")
    (folder / "large.xml").write_text(TOO_LARGE)
    return folder


@pytest.fixture(scope="module")
def undisturbed(robots: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    results = tmp_path_factory.mktemp("out") / "undisturbed"
    corpus("run", "--from", str(robots), "--pairs", PAIRS, "--verify", "--jobs", "1", "-o", str(results))
    return results


def test_every_file_and_every_pair_has_its_row(undisturbed: Path) -> None:
    tables = load(Store(str(undisturbed)))
    robots = {row["key"]: (row["status"], row["engine"]) for row in tables.robots.iter_rows(named=True)}
    assert robots == {
        **{f"toys/arm{count}.urdf": ("done", "done") for count in range(1, 6)},
        "toys/broken.urdf": ("refused", ""),
        "toys/large.xml": ("done", "refused"),
        "toys/one.hymeko": ("done", "done"),
        "toys/pendulum.xml": ("done", "done"),
    }
    legs = {(row["key"][5:], row["target"]): (row["status"], row["verdict"]) for row in tables.legs.iter_rows(named=True)}
    assert legs == {
        **{(f"arm{count}.urdf", "hymeko"): ("done", "same") for count in range(1, 6)},
        **{(f"arm{count}.urdf", "mjcf"): ("done", "same as far as mjcf can say") for count in range(1, 6)},
        **{("broken.urdf", target): ("unread", "") for target in ("hymeko", "mjcf")},
        ("large.xml", "urdf"): ("done", "not comparable"),
        ("one.hymeko", "urdf"): ("done", "same"),
        ("pendulum.xml", "urdf"): ("done", "same"),
    }


def test_facts_name_no_place_of_this_machine(undisturbed: Path, robots: Path) -> None:
    parts = "".join(path.read_text() for path in undisturbed.rglob("parts/*/*.json"))
    assert parts.count('"key"') > 9
    assert str(robots) not in parts
    assert "hymeko-x-" not in parts


@pytest.mark.full
def test_a_killed_runner_goes_on_where_it_was(robots: Path, undisturbed: Path, tmp_path: Path) -> None:
    results = tmp_path / "killed"
    words = command("run", "--from", str(robots), "--pairs", PAIRS, "--verify", "--jobs", "2", "-o", str(results))
    for wanted in (2, 5):
        with subprocess.Popen([*words, "--resume"], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as runner:
            while len(list(results.glob("parts/*/*.json"))) < wanted and runner.poll() is None:
                time.sleep(0.02)
            runner.send_signal(signal.SIGKILL)
        assert runner.returncode == -signal.SIGKILL
    assert not (results / "legs.parquet").exists()
    corpus("stats", str(results), "-o", str(tmp_path / "so_far"))
    before = {path: path.stat().st_mtime_ns for path in results.glob("parts/*/*.json")}
    assert 5 <= len(before) < 9
    corpus(*words[4:], "--resume")
    assert {path: path.stat().st_mtime_ns for path in before} == before, "a file was done twice"
    assert facts(results) == facts(undisturbed)


@pytest.mark.full
@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
def test_killed_workers_change_nothing(robots: Path, undisturbed: Path, tmp_path: Path) -> None:
    results = tmp_path / "workers"
    words = command("run", "--from", str(robots), "--pairs", PAIRS, "--verify", "--jobs", "1", "-o", str(results))
    killed: set[int] = set()
    with subprocess.Popen(words, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as runner:
        while runner.poll() is None and len(killed) < 3:
            for worker in set(workers_of(runner.pid)) - killed:
                with suppress(ProcessLookupError):  # it was faster
                    os.kill(worker, signal.SIGKILL)
                    killed.add(worker)
            time.sleep(0.005)  # a file may take less than a tenth of a second
    assert runner.returncode == 0
    assert killed
    assert facts(results) == facts(undisturbed)


def workers_of(pid: int) -> list[int]:
    """The grandchildren of a process: its fork server's children."""
    children = {int(stat.parent.name): parent_of(stat) for stat in Path("/proc").glob("[0-9]*/stat")}
    return [child for child, parent in children.items() if children.get(parent) == pid]


def parent_of(stat: Path) -> int:
    try:
        return int(stat.read_text().rpartition(")")[2].split()[1])
    except OSError:
        return 0


def test_results_are_not_mixed_up(robots: Path, undisturbed: Path) -> None:
    again = corpus("run", "--from", str(robots), "--pairs", PAIRS, "--verify", "-o", str(undisturbed), code=1)
    assert "there are results already" in again.stderr
    assert "--resume continues them" in again.stderr
    other = corpus("run", "--from", str(robots), "--pairs", "urdf:usd", "--verify", "--resume", "-o", str(undisturbed), code=1)
    assert "the results there are of a run with other pairs" in other.stderr


@pytest.mark.full
def test_the_same_results_give_the_same_report(undisturbed: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        corpus("stats", str(undisturbed), "-o", str(tmp_path / name))
    a, b = ({path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("a", "b"))
    assert sorted(a) == sorted(b)
    assert [name for name in a if a[name] != b[name]] == []
    assert {"report.md", "costs.md", "pairs.csv", "shortness.parquet", "lengths.svg", "sizes.png"} <= set(a)
    assert "Of 13 conversions of accepted files 13 give the same robot (100.0 %)." not in a["report.md"].decode()
    assert "Of 12 conversions of accepted files 12 give the same robot (100.0 %)." in a["report.md"].decode()


def test_every_part_is_a_document_of_its_own(undisturbed: Path) -> None:
    parts = [json.loads(path.read_bytes()) for path in undisturbed.glob("parts/*/*.json")]
    assert len(parts) == 9
    assert {cost["step"] for part in parts for cost in part["costs"]} == {
        *("read", "engine", "convert:hymeko", "convert:mjcf", "convert:urdf", "verify:hymeko", "verify:mjcf", "verify:urdf")
    }
    assert pl.read_parquet(undisturbed / "costs.parquet").filter(pl.col("megabytes") <= 0).is_empty()


def test_wrong_words_are_reported_in_one_line(tmp_path: Path) -> None:
    assert "expected pairs such as urdf:mjcf, found 'urdf'" in corpus("run", "--pairs", "urdf", code=2).stderr
    assert "there is no folder" in corpus("run", "--from", str(tmp_path / "nowhere"), code=1).stderr
    assert "there is no robot to read" in corpus("run", "--from", str(tmp_path), code=2).stderr
    assert "there is no 'robots.parquet' in the results" in corpus("stats", str(tmp_path), code=1).stderr
