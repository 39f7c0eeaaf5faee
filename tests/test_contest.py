"""The comparison with other programs: the page has what the results have, and no program is left out without a reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from msgspec.structs import replace

from benchmarks.contest.inputs import made
from benchmarks.contest.measure import measured
from benchmarks.contest.rows import CALL, PROCESS, RESULTS, TEXT, Row, as_csv, from_csv
from benchmarks.contest.table import page
from benchmarks.contest.ways import WAYS, Entrant, Way
from hymeko_x import load
from peers import HYMEKO_X, Peer
from peers.session import Session

ROOT = Path(__file__).parents[1]
BLOCK = "<!-- speed: written by `make bench` -->\n\n{}\n\n<!-- end of speed -->"


def test_the_page_has_the_figures_of_the_results() -> None:
    text = (ROOT / "docs/speed.md").read_text("utf-8")
    assert page(text, from_csv(RESULTS.read_text("utf-8"))) == text


def test_every_program_has_a_result_or_a_reason_for_every_robot() -> None:
    rows = from_csv(RESULTS.read_text("utf-8"))
    for way in WAYS:
        robots = {(row.robot, row.kind) for row in rows if row.way == way.name}
        assert ("1,000 links", PROCESS) in robots
        for robot, kind in robots:
            asked = [row.program for row in rows if (row.way, row.robot, row.kind) == (way.name, robot, kind)]
            assert asked == [entrant.name for entrant in way.entrants]
    assert [row for row in rows if (row.seconds is None) != bool(row.reason)] == []


def test_results_are_kept_as_csv() -> None:
    rows = (Row("a to b", "x", "1.0", "Panda", CALL, 0.25), Row("a to b", "y", "", "Panda", PROCESS, reason='it said "no", twice'))
    assert from_csv(as_csv(rows)) == rows


def test_a_table_has_multiples_of_the_first_program_and_notes_for_what_failed() -> None:
    ours = Row("urdf to mjcf", "hymeko-x", "", "Panda", CALL, 0.002)
    rows = [ours, replace(ours, program="slow", version="1.0", seconds=0.5), replace(ours, program="broken", seconds=None, reason="no")]
    rows += [replace(ours, kind=PROCESS, seconds=1.5, megabytes=40.0)]
    rows += [replace(ours, program="slow", version="1.0", kind=PROCESS, seconds=3.0, megabytes=60.0)]
    rows += [Row("hymeko text", "reading", "", "Panda", TEXT, 2.0, 3.0)]
    assert page(BLOCK.format("old"), rows) == BLOCK.format(
        "| urdf to mjcf | Panda | Panda: process | Panda: memory |\n"
        "| --- | --- | --- | --- |\n"
        "| hymeko-x | 2 ms | 1.5 s | 40 MB |\n"
        "| slow 1.0 | 250 x | 2 x | 1.5 x |\n"
        "| broken | none (1) |  |  |\n\n"
        "| hymeko text | Panda |\n"
        "| --- | --- |\n"
        "| reading | 1.50 MB/s |\n\n"
        "1. broken: no"
    )


def test_a_page_without_the_block_is_not_renewed() -> None:
    with pytest.raises(ValueError, match="the page has no block <!-- NAME: written by `make bench` -->"):
        page("text", [])


@pytest.mark.parametrize("format", ["urdf", "mjcf"])
@pytest.mark.parametrize("links", [1, 2, 9, 20])
def test_a_made_robot_has_so_many_links(format: str, links: int, tmp_path: Path) -> None:
    robot = load(made(format, links, tmp_path).path).mechanism
    assert {id.name for id in robot.graph.vertices if id.kind == "body"} == {f"link{i}" for i in range(links)}
    assert {id.name for id in robot.joints if id.name.startswith("joint")} == {f"joint{i}" for i in range(1, links)}


DRIVER = """\
import os, sys, time
sys.path.insert(0, {drivers!r})
from loop import answer_all

def work(job):
    if "die" in job:
        print("out of luck", file=sys.stderr, flush=True)
        os._exit(3)
    if "fail" in job:
        raise ValueError("no such thing")
    print("working", flush=True)
    time.sleep(job.get("sleep", 0))
    return {{"pid": os.getpid()}}

answer_all(work)
"""


@pytest.fixture
def peer(tmp_path: Path) -> Peer:
    """A program in our environment, called after one that is there."""
    driver = tmp_path / "driver.py"
    driver.write_text(DRIVER.format(drivers=str(ROOT / "peers/drivers")))
    return Peer("lxml", (), str(driver))


def test_a_session_keeps_its_process_until_that_dies_or_is_late(peer: Peer) -> None:
    with Session(peer) as session:
        first = session.ask({}, 60.0)
        assert session.ask({}, 60.0)["pid"] == first["pid"]
        assert session.ask({"fail": True}, 60.0) == {"error": "ValueError: no such thing"}
        assert session.ask({"die": True}, 60.0) == {"error": "the process died (exit 3): out of luck"}
        assert session.ask({"sleep": 60}, 0.5) == {"error": "no answer within 0.5 s"}
        assert session.ask({}, 60.0)["pid"] != first["pid"]


def test_a_program_that_is_not_there_says_so() -> None:
    with Session(Peer("nobody", ("nobody==1.0",), "nobody.py")) as session:
        assert session.ask({}, 1.0) == {"error": "it is not installed"}


def test_a_program_that_writes_nothing_or_is_too_slow_is_a_row_that_says_so(peer: Peer, tmp_path: Path) -> None:
    way = Way("urdf", "mjcf", (Entrant(HYMEKO_X), Entrant(Peer("nobody", ("nobody==1.0",), "nobody.py")), Entrant(peer)))
    (row, missing, empty) = measured(way, [made("urdf", 2, tmp_path)], tmp_path, 60.0, lambda _: None)
    assert row.seconds is not None
    assert (row.program, row.robot, row.kind, row.reason) == ("hymeko-x", "2 links", CALL, "")
    assert (missing.program, missing.version, missing.seconds, missing.reason) == ("nobody", "1.0", None, "it is not installed")
    assert (empty.seconds, empty.reason) == (None, "it wrote nothing and did not say why")
