"""The loop around a language model: every fault is found by the check that is for it, and repaired; each step is a record."""

from __future__ import annotations

import json
import random
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import formats
from hymeko_x.cli import exits, main
from hymeko_x.generate.faults import NUMBERS, STRUCTURE, _with_fault
from hymeko_x.generate.loop import Task, file_in, generate, judged
from hymeko_x.generate.models import Faulty
from hymeko_x.generate.prompts import first_prompt

SCARA = Path(__file__).parents[2] / "corpus/listings/scara_robot.hymeko"


def task(format: str = "urdf", prompt: str = "card") -> Task:
    return Task(SCARA.read_text("utf-8"), SCARA, hx.load(SCARA).mechanism, formats.by_name(format), prompt)


def right(format: str = "urdf") -> str:
    return hx.dumps(hx.load(SCARA), format)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("format", ["urdf", "mjcf"])
def test_the_right_answer_passes_everything(format: str) -> None:
    for answer in (right(format), f"Sure!\n```xml\n{right(format)}```\nDone."):
        step = judged(task(format), answer, 1)
        assert (step.is_complete, step.has_counts, step.is_same, step.faults) == (True, True, True, ())


@pytest.mark.parametrize("fault", [*STRUCTURE[1:], *NUMBERS])
@pytest.mark.unread("HX045", "HX314", "HX317", "HX318")
def test_the_verifier_finds_every_fault(fault: str) -> None:
    robot = _with_fault(hx.load(SCARA).mechanism, fault, random.Random(1))
    assert robot != hx.load(SCARA).mechanism
    step = judged(task(), hx.dumps(robot, "urdf", lenient=True), 1)
    assert step.faults
    assert not step.is_same
    assert step.has_counts == ("link" not in fault)
    assert step.is_complete == (fault in NUMBERS or fault == "no link")


@pytest.mark.unread("HX005", "HX010")
def test_a_file_that_breaks_off_fails_everything() -> None:
    step = judged(task(), right()[:900], 1)
    assert (step.is_complete, step.is_same) == (False, False)
    assert judged(task(), "I cannot do that.", 1).faults[0].startswith("<text>")


def test_a_model_is_told_what_is_wrong_until_it_is_right() -> None:
    answers = iter([right().replace('mass value="2"', 'mass value="3"'), right()])
    seen: list[list[dict[str, str]]] = []

    def model(messages: list[dict[str, str]]) -> str:
        seen.append([*messages])
        return next(answers)

    steps = generate(task(), model, 5)
    assert [step.is_same for step in steps] == [False, True]
    assert [message["role"] for message in seen[1]] == ["user", "assistant", "user"]
    assert "expected 2, found 3 kg" in seen[1][2]["content"]


def test_it_ends_after_so_many_tries() -> None:
    assert len(generate(task(), lambda messages: "no", 3)) == 3


def test_the_prompts_are_those_of_the_paper_and_a_better_one() -> None:
    published = first_prompt("paper", formats.by_name("urdf"), "TEXT", 3, 2)
    assert published.startswith("You are an expert in robotics. Convert the following HyMeKo robot description into a valid URDF file.")
    assert published.endswith("Only output the URDF XML, nothing else:\nTEXT")
    ours = first_prompt("card", formats.by_name("mjcf"), "TEXT", 3, 2)
    assert "3 links and 2 joints" in ours
    assert ours.endswith("\n\nTEXT")


def test_the_first_fence_is_the_file() -> None:
    assert file_in("a\n```xml\n<robot/>\n```\nb") == "<robot/>\n"
    assert file_in("<robot/>") == "<robot/>\n"


@pytest.mark.unread("HX045")
def test_faults_come_at_the_rate_of_the_paper() -> None:
    model = Faulty(hx.load(SCARA).mechanism, formats.by_name("urdf"), 0.18, random.Random(3))
    expected = right()
    faulty = sum(file_in(model([])) != expected for _ in range(200))
    assert 0.18 * 200 < faulty < 0.45 * 200  # 1 - 0.82 * 0.82 = 0.33 with those of numbers


# ---- the verb --------------------------------------------------------------------------------------------------------------------


@pytest.mark.unread("HX005", "HX010")
def test_a_run_of_faults_prints_the_table_and_logs_each_step(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["generate", str(SCARA), "--to", "urdf", "--with", "faults:1", "--runs", "8", "--log", "log.jsonl", "--result", "out.urdf"]
    assert main(words) == exits.DONE
    first = capsys.readouterr().out
    assert first.splitlines()[-1].split() == ["the", "same", "robot", "after", "repair", "8", "100.0%"]
    steps = [json.loads(line) for line in Path("log.jsonl").read_text().splitlines()]
    assert {step["run"] for step in steps} == {*range(1, 9)}
    assert [step for step in steps if not step["is_same"] and not step["faults"]] == []
    assert f"8 runs, {len(steps)} answers" in first
    assert main(["verify", str(SCARA), "out.urdf"]) == exits.DONE
    capsys.readouterr()
    assert main(words) == exits.DONE
    assert capsys.readouterr().out == first


def test_recorded_answers_are_replayed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("answers").mkdir()
    Path("answers/1.txt").write_text("no")
    assert main(["generate", str(SCARA), "--to", "urdf", "--with", "replay:answers", "--tries", "1"]) == exits.DIFFERENT
    assert main(["generate", str(SCARA), "--to", "urdf", "--with", "replay:answers"]) == exits.FAILED
    assert "'answers' has no answer number 2" in capsys.readouterr().err
    Path("answers/2.txt").write_text(right())
    assert main(["generate", str(SCARA), "--to", "urdf", "--with", "replay:answers"]) == exits.DONE


@pytest.fixture
def chat() -> Iterator[tuple[str, list[dict[str, object]]]]:
    """A chat on this machine that gives the right answer, and what it was asked."""
    asked: list[dict[str, object]] = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            asked.append({"headers": dict(self.headers), **json.loads(self.rfile.read(int(self.headers["Content-Length"])))})
            body = {"choices": [{"message": {"content": right()}}]} if self.path == "/v1/chat/completions" else {"error": "no"}
            self.send_response(200)
            self.end_headers()
            self.wfile.write(json.dumps(body).encode())

        def log_message(self, format: str, *words: object) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}", asked
    server.shutdown()
    thread.join()
    server.server_close()


def test_an_endpoint_is_asked(
    chat: tuple[str, list[dict[str, object]]], folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    url, asked = chat
    monkeypatch.setenv("SOME_KEY", "k")
    words = ["generate", str(SCARA), "--to", "urdf", "--prompt", "paper", "--model", "m"]
    assert main([*words, "--with", f"{url}/v1/chat/completions", "--key-from", "SOME_KEY"]) == exits.DONE
    (request,) = asked
    assert request["model"] == "m"
    assert request["headers"]["Authorization"] == "Bearer k"  # type: ignore[index]
    assert request["messages"][0]["content"].endswith(SCARA.read_text("utf-8"))  # type: ignore[index]
    assert main([*words, "--with", f"{url}/other"]) == exits.FAILED
    assert "gave no answer" in capsys.readouterr().err
    assert main([*words, "--with", "gpt"]) == exits.USAGE
