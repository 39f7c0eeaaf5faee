"""The type checker knows the public interface: it accepts thirty right lines and refuses each of thirty wrong ones."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from tests.robot.typed import HEAD, RIGHT, WRONG

ROOT = Path(__file__).parents[2]


def errors(text: str, folder: Path) -> dict[int, str]:
    """What mypy --strict says, by line."""
    path = folder / "lines.py"
    path.write_text(text)
    words = ["--strict", "--no-error-summary", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(ROOT / ".mypy_cache")]
    run = subprocess.run([sys.executable, "-m", "mypy", *words, str(path)], capture_output=True, text=True, cwd=ROOT, check=False)
    assert run.returncode in (0, 1), run.stderr
    return {int(found[1]): found[2] for found in re.finditer(r"lines\.py:(\d+): error: (.*)", run.stdout)}


def test_right_lines_are_accepted_and_each_wrong_one_is_refused(tmp_path: Path) -> None:
    right, wrong = RIGHT.strip().splitlines(), WRONG.strip().splitlines()
    assert min(len(right), len(wrong)) >= 30
    first = len((HEAD + RIGHT).splitlines())
    found = errors(f"{HEAD}{RIGHT}{WRONG.lstrip()}", tmp_path)
    assert {number: words for number, words in found.items() if number <= first} == {}
    assert [line for number, line in enumerate(wrong, first + 1) if number not in found] == []
