"""Type checkers know the public interface: they accept thirty right lines and refuse each of thirty wrong ones."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from shutil import which
from typing import TYPE_CHECKING

import pytest

from tests.robot.typed import HEAD, RIGHT, WRONG

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).parents[2]


def errors(text: str, folder: Path) -> dict[int, str]:
    """What mypy --strict says, by line."""
    path = folder / "lines.py"
    path.write_text(text)
    words = ["--strict", "--no-error-summary", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(ROOT / ".mypy_cache")]
    run = subprocess.run([sys.executable, "-m", "mypy", *words, str(path)], capture_output=True, text=True, cwd=ROOT, check=False)
    assert run.returncode in (0, 1), run.stderr
    return {int(found[1]): found[2] for found in re.finditer(r"lines\.py:(\d+): error: (.*)", run.stdout)}


def errors_of_pyright(text: str, folder: Path) -> dict[int, str]:
    """What pyright finds in strict mode, by line."""
    (folder / "lines.py").write_text(text)
    settings = {"include": ["lines.py"], "extraPaths": [str(ROOT)], "typeCheckingMode": "strict"}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings))
    words = ["pyright", "-p", str(folder), "--pythonpath", sys.executable, "--outputjson"]
    run = subprocess.run(words, capture_output=True, text=True, check=False)
    found = json.loads(run.stdout)["generalDiagnostics"]
    return {item["range"]["start"]["line"] + 1: item["message"] for item in found if item["severity"] == "error"}


CHECKERS = [
    pytest.param(errors, id="mypy"),
    pytest.param(errors_of_pyright, id="pyright", marks=pytest.mark.skipif(not which("pyright"), reason="pip install 'pyright[nodejs]'")),
]


@pytest.mark.parametrize("check", CHECKERS)
def test_right_lines_are_accepted_and_each_wrong_one_is_refused(check: Callable[[str, Path], dict[int, str]], tmp_path: Path) -> None:
    right, wrong = RIGHT.strip().splitlines(), WRONG.strip().splitlines()
    assert min(len(right), len(wrong)) >= 30
    first = len((HEAD + RIGHT).splitlines())
    found = check(f"{HEAD}{RIGHT}{WRONG.lstrip()}", tmp_path)
    assert {number: words for number, words in found.items() if number <= first} == {}
    assert [line for number, line in enumerate(wrong, first + 1) if number not in found] == []
