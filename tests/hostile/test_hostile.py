"""Files from strangers: each of them ends with its code, in time, in little memory, and without a trace elsewhere."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.hostile import path_cases, sdf_cases, text_cases, xml_cases
from tests.hostile.case import Case
from tests.hostile.child import Child

CASES = (*xml_cases.CASES, *text_cases.CASES, *path_cases.CASES, *sdf_cases.CASES)
SECRETS = {
    "secret.xml": "<mujocoinclude><option timestep='0.1'/></mujocoinclude>",
    "secret.xacro": "<robot/>",
    "secret.usda": '#usda 1.0\ndef "secret" {}\n',
    "secret.hymeko": "secret : robot {}",
    "secret.urdf": "<robot name='secret'><link name='secret'/></robot>",
    "secret.stl": "solid secret",
}


@pytest.fixture(scope="module")
def child() -> Iterator[Child]:
    child = Child()
    yield child
    child.stop()


def test_there_are_as_many_cases_as_promised() -> None:
    assert len(CASES) >= 80
    assert len({case.name for case in CASES}) == len(CASES)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_what_strangers_send_ends_as_expected(case: Case, child: Child, tmp_path: Path) -> None:
    folder = _laid_out(case, tmp_path)
    before = _tree(tmp_path)
    ending = child.run(list(case.words), str(folder))
    printed = ending.printed.replace(str(tmp_path), "")
    assert ending.code == case.code, printed[-2000:]
    assert "Traceback" not in printed
    assert set(re.findall(r"(?:error|warning)\[(HX\d+)\]", printed)) >= set(case.codes), printed[-2000:]
    assert set(re.findall(r"error\[(HX\d+)\]", printed)) <= set(case.codes), printed[-2000:]
    assert ending.seconds < case.seconds
    assert sorted(_tree(tmp_path) - before) == sorted(f"out/{name}" for name in case.leaves)


def _laid_out(case: Case, place: Path) -> Path:
    """The folder in which the case is run, with its files; beside it secrets, and a folder for what is written."""
    folder = place / "in"
    folder.mkdir()
    (place / "out").mkdir()
    for name, text in SECRETS.items():
        (place / name).write_text(text, encoding="utf-8")
    for name, content in case.files.items():
        data = content() if callable(content) else content
        (folder / name).write_bytes(data.encode("utf-8", "surrogateescape") if isinstance(data, str) else data)
    if case.prepare is not None:
        case.prepare(folder)
    return folder


def _tree(place: Path) -> set[str]:
    return {path.relative_to(place).as_posix() for path in place.rglob("*") if not path.is_dir() or path.is_symlink()}
