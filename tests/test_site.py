"""The site of the docs: built with warnings as errors, complete, and without anything from elsewhere."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import hymeko_x
from hymeko_x.codes import CODES

ROOT = Path(__file__).parents[1]


@pytest.mark.full
def test_the_site_is_built_without_a_warning_and_loads_nothing_from_elsewhere(tmp_path: Path) -> None:
    pytest.importorskip("material")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    pages = {path.relative_to(tmp_path).as_posix(): path.read_text("utf-8") for path in tmp_path.rglob("*.html")}
    assert [name for name, text in pages.items() if re.search(r'(?:src|rel="stylesheet" href)="https?:', text)] == []
    assert [name for name, text in pages.items() if "<p>```" in text] == []
    diagnostics = pages["diagnostics/index.html"]
    assert [code for code in CODES if f"{code}: " not in diagnostics] == []
    assert [name for name in hymeko_x.__all__ if f'id="hymeko_x.{name}"' not in pages["api/index.html"]] == []
    assert (tmp_path / "search/search_index.json").stat().st_size > 100_000
    sections = {one["location"]: one for one in json.loads((tmp_path / "search/search_index.json").read_text("utf-8"))["docs"]}
    assert sections["questions/"]["boost"] > 1.0 > sections["api/"]["boost"]  # what users ask comes before names that contain the word


def undocumented(path: Path) -> list[str]:
    """The public classes, functions and methods of a module that have no docstring, and the module itself."""
    text = path.read_text("utf-8")
    tree = ast.parse(text)
    nodes: list[tuple[str, ast.Module | ast.ClassDef]] = [("", tree)]
    found = [str(path)] if text and ast.get_docstring(tree) is None else []
    for prefix, node in nodes:
        for child in node.body:
            if not isinstance(child, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) or child.name.startswith("_"):
                continue
            if isinstance(child, ast.ClassDef):
                nodes.append((f"{child.name}.", child))
            elif any(ast.unparse(mark).endswith(("overload", ".setter")) for mark in child.decorator_list):
                continue
            if ast.get_docstring(child) is None:
                found.append(f"{path}:{child.lineno} {prefix}{child.name}")
    return found


def test_everything_public_in_the_code_has_a_docstring() -> None:
    assert [line for path in sorted((ROOT / "hymeko_x").rglob("*.py")) for line in undocumented(path)] == []


def test_every_public_name_has_a_docstring() -> None:
    assert [name for name in hymeko_x.__all__ if not name.startswith("_") and not getattr(hymeko_x, name).__doc__] == []
