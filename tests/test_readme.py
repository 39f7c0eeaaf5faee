"""The sessions in the README and in the docs are what really happens. `python tests/test_readme.py` writes the present output into them."""

from __future__ import annotations

import doctest
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from hymeko_x.corpus import catalog
from tests.turns import cases

if TYPE_CHECKING:
    from tests.conftest import RealRobots

README = Path(__file__).parents[1] / "README.md"
PAGES = (
    README,
    *(
        README.parent / "docs" / f"{name}.md"
        for name in ("agree", "command-line", "comparison", "dh", "dynamics", "errors", "lossless", "report", "tour", "update", "verify")
    ),
    *sorted((README.parent / "docs/tasks").glob("*.md")),
)
BLOCK = re.compile(r"```(\w+)(?: (\S+))?\n(.*?)```\n", re.DOTALL)


def shell(command: str, folder: Path) -> str:
    """What a user sees who types the command."""
    python = shlex.quote(sys.executable)
    program = f'hymeko-x() {{ {python} -m hymeko_x "$@"; }}\npython() {{ {python} "$@"; }}\n{command}'
    environment = {**os.environ, "PYTHONPATH": str(README.parent), "COLUMNS": "120"}
    run = subprocess.run(
        ["bash", "-c", program], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment, check=False
    )
    return run.stdout


def session(text: str, folder: Path) -> str:
    """The page with every command's output as it is now; the files that it shows are put into the folder."""

    def rerun(block: re.Match[str]) -> str:
        language, name, content = block.groups()
        if name:
            (folder / name).write_text(content)
        if language != "console":
            return block[0]
        commands = [line for line in content.splitlines() if line.startswith("$ ")]
        printed = "".join(f"{command}\n{shell(command[2:], folder)}" for command in commands)
        return f"```console\n{printed}```\n"

    return BLOCK.sub(rerun, text)


LONG = ("dynamics.md",)
"""Pages whose commands take half a minute: they have their turn in `make test-full`."""


@pytest.mark.parametrize("page", cases({page.name: page for page in PAGES}, LONG))
def test_the_session_in_a_page_is_what_really_happens(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = page.read_text("utf-8")
    assert session(text, tmp_path) == text
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for language, name, content in BLOCK.findall(text):
        if language == "python" and not name:  # those with a name are run by a command
            exec(compile(content, page.name, "exec"), names)


@pytest.mark.corpus
def test_the_quadruped_in_four_formats_is_what_the_example_prints(real_robot: RealRobots) -> None:
    real_robot(next(file for file in catalog.development_files("urdf") if file.path.endswith("assets/quadruped.urdf")))
    page = README.parent / "docs" / "side-by-side.md"
    printed = shell(f"{shlex.quote(sys.executable)} examples/side_by_side.py", README.parent)
    assert printed == page.read_text()


def test_the_python_in_the_readme_is_what_really_happens(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = list(BLOCK.finditer(README.read_text("utf-8")))
    for block in blocks:
        if block[2]:
            (tmp_path / block[2]).write_text(block[3])
    monkeypatch.chdir(tmp_path)
    code = "".join(block[3] for block in blocks if block[1] == "pycon")
    test = doctest.DocTestParser().get_doctest(code, {}, "README.md", str(README), 0)
    printed: list[str] = []
    assert test.examples
    assert doctest.DocTestRunner().run(test, out=printed.append).failed == 0, "".join(printed)


if __name__ == "__main__":
    import tempfile

    for page in PAGES:
        with tempfile.TemporaryDirectory() as folder:
            page.write_text(session(page.read_text("utf-8"), Path(folder)), "utf-8")
