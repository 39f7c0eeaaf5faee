"""The large scale of the code: short files, short functions, one name for one class, and no circle of imports among files."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

import networkx

ROOT = Path(__file__).parents[1]
MODULES = {
    path.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".").removesuffix(".__init__"): path
    for path in sorted((ROOT / "hymeko_x").rglob("*.py"))
}
LONGEST_FILE = 400
LONGEST_FUNCTION = 40
OF_OTHERS = ("hymeko_x.verify.model", "hymeko_x.formats.json.document")
"""Classes under the names of the parts that they mirror: the robot as an engine has it, and what the JSON schema calls by these names."""


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


def test_no_file_is_long() -> None:
    lengths = {name: len(path.read_text("utf-8").splitlines()) for name, path in MODULES.items()}
    assert {name: length for name, length in lengths.items() if length > LONGEST_FILE} == {}


def test_no_function_is_long() -> None:
    long = {}
    for name, path in MODULES.items():
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                length = (node.end_lineno or node.lineno) - node.lineno + 1
                if length > LONGEST_FUNCTION:
                    long[f"{name}.{node.name}"] = length
    assert long == {}


def test_a_class_has_its_name_alone() -> None:
    """A name stands for one concept, wherever it is read. Private classes are known in their file alone."""
    homes: dict[str, list[str]] = {}
    for name, path in MODULES.items():
        if name not in OF_OTHERS:
            for node in tree(path).body:
                if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    homes.setdefault(node.name, []).append(name)
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}


def test_no_files_import_each_other_in_a_circle() -> None:
    """At whatever level, for types too: of two files in a circle neither can be understood without the other."""
    arrows = [(name, imported) for name, path in MODULES.items() for imported in imported_modules(path)]
    circles = [sorted(circle) for circle in networkx.strongly_connected_components(networkx.DiGraph(arrows)) if len(circle) > 1]
    assert circles == []


def imported_modules(path: Path) -> set[str]:
    """The project's own modules that a file imports."""
    found = set()
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ImportFrom):
            places = [(f"{node.module}.{alias.name}", str(node.module)) for alias in node.names]
            found |= {inner if inner in MODULES else outer for inner, outer in places}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return found & MODULES.keys()
