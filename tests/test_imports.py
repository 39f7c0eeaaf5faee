"""Who may import whom: layers point one way, and heavy libraries stay where they belong."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from hymeko_x import formats

ROOT = Path(__file__).parents[1]
LAYERS = (
    ("collector", "memory", "child_process", "diagnostics", "codes", "severities", "version"),
    ("ir",),
    ("source", "outline"),
    ("xml", "meshes", "networks"),
    ("formats",),
    ("rewrite", "compare", "language", "factor", "extras", "states"),
    ("residue", "assets", "reporting", "joining"),
    ("frontends", "backends"),
    ("targets",),
    ("pipeline", "importing", "disk", "verify", "validation", "corpus"),
    ("agree", "delivery", "edits", "robot", "dynamics"),
    ("api",),
    ("draw", "server", "mcp", "generate"),
    ("cli", "testing"),
    ("__main__",),
)
"""A module may import from its own part of the program and from the layers before its own; within a layer see BESIDE."""

BESIDE = {
    ("codes", "diagnostics"),
    ("severities", "codes"),
    ("severities", "diagnostics"),
    ("compare", "rewrite"),
    ("corpus", "verify"),
    ("corpus", "pipeline"),
    ("corpus", "disk"),
    ("importing", "pipeline"),
    ("verify", "importing"),
    ("delivery", "edits"),
    ("residue", "assets"),
}
"""Imports within a layer that are meant to be: (who, whom)."""

HOMES = {
    "pxr": ("frontends/usd", "backends/usd", "verify/"),
    "mujoco": ("frontends/mjcf", "targets/", "verify/", "draw/"),
    "pinocchio": ("verify/",),
    "trimesh": ("meshes/", "verify/"),
    "collada": ("meshes/",),
    "lark": ("language/",),
    "xacro": ("frontends/xacro",),
    "rich": ("cli/",),
    "fsspec": ("corpus/",),
    "matplotlib": ("corpus/", "dynamics/"),
    "pebble": ("corpus/",),
    "polars": ("corpus/", "dynamics/"),
    "sympy": ("dynamics/",),
    "casadi": ("dynamics/",),
    "ray": ("corpus/",),
    "hypothesis": ("testing/",),
    "pygls": ("server/",),
    "mcp": ("mcp/",),
    "anyio": ("mcp/",),
    "resvg_py": ("draw/graph/raster.py",),
    "viser": ("draw/view/", "cli/view.py"),
}
"""Heavy libraries and the only places that may import them."""

MODULES = sorted(path for path in (ROOT / "hymeko_x").rglob("*.py"))


def imports(path: Path) -> Iterator[str]:
    """The full names of all modules that a file imports, at whatever level of nesting."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names = (f"{node.module}.{alias.name}" for alias in node.names) if node.module == "hymeko_x" else (str(node.module),)
            yield from names


def part(module: str) -> str:
    """The part of the program that a module belongs to: `ir` of `hymeko_x.ir.graph`."""
    return module.split(".")[1]


def layer(name: str) -> int:
    return next(number for number, names in enumerate(LAYERS) if name in names)


def is_allowed(who: str, whom: str) -> bool:
    if who == whom or layer(whom) < layer(who):
        return True
    return (who, whom) in BESIDE


def named(path: Path) -> str:
    return path.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".").removesuffix(".__init__")


def test_imports_point_one_way() -> None:
    wrong = [
        f"{named(path)} imports {module}"
        for path in MODULES
        if path.parent != ROOT / "hymeko_x" or path.stem != "__init__"
        for module in imports(path)
        if module.startswith("hymeko_x.") and not is_allowed(part(named(path)), part(module))
    ]
    assert wrong == []


def test_formats_do_not_know_each_other() -> None:
    """`frontends/urdf` may not import `frontends/mjcf`, and likewise for backends; xacro is a preprocessor of URDF."""
    wrong = []
    for path in MODULES:
        who = named(path).split(".")
        for module in imports(path):
            whom = module.split(".")
            if len(who) > 2 and len(whom) > 2 and who[:2] == whom[:2] and who[1] in ("frontends", "backends"):
                allowed = who[2] == whom[2] or (who[2], whom[2]) == ("xacro", "urdf")
                wrong += [] if allowed else [f"{named(path)} imports {module}"]
    assert wrong == []


def test_the_verifier_does_not_use_our_own_readers_and_writers() -> None:
    """Nor their tables. Except for HyMeKo text, of which there is no other reader, and the sandbox in which the library xacro runs."""
    ours = ("hymeko_x.frontends", "hymeko_x.backends", "hymeko_x.pipeline", "hymeko_x.formats.")
    files = [path for path in (ROOT / "hymeko_x/verify").rglob("*.py") if path.name not in ("hymeko.py", "xacro.py")]
    assert files
    wrong = [f"{named(path)} imports {module}" for path in files for module in imports(path) if module.startswith(ours)]
    assert wrong == []


def test_heavy_libraries_are_imported_only_where_they_belong() -> None:
    wrong = [
        f"{path.relative_to(ROOT)} imports {module}"
        for path in MODULES
        for module in imports(path)
        for homes in [HOMES.get(module.split(".")[0])]
        if homes is not None and not path.relative_to(ROOT / "hymeko_x").as_posix().startswith(homes)
    ]
    assert wrong == []


@pytest.mark.parametrize(
    "words", [["formats"], ["import", "robot.urdf"], ["info", "robot.urdf"], ["convert", "robot.urdf", "robot.hymeko"]]
)
def test_reading_a_robot_loads_no_heavy_library(words: list[str], tmp_path: Path) -> None:
    heavy = {"numpy", "scipy", "mujoco", "pinocchio", "pxr", "trimesh", "rich"}
    (tmp_path / "robot.urdf").write_text("<robot name='r'><link name='base'/></robot>")
    program = f"import sys; from hymeko_x.cli import main; code = main({words!r}); print(code, {heavy!r} & {{*sys.modules}})"
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path, env={"PYTHONPATH": str(ROOT)}, check=True
    )
    assert run.stdout.splitlines()[-1] == "0 set()"


ROOMS = re.compile(r"(formats|frontends|backends|verify/readers)/(?!__init__\.py)|testing/|formats/__init__|targets/")
"""The rooms of formats, the table, the targets, each of which is for programs that read one format, and the strategies for tests."""

STILL_NAMED = frozenset(
    {
        "xml/namespaces.py",  # the prefix of a namespace, which is called as the format is
    }
)
"""Files that still name a format, to become fewer."""


def names_of_formats(path: Path) -> Iterator[str]:
    """The places in a file that name a format: its name as a whole text, its row in the table, or a module of its rooms."""
    names = {format.name for format in formats.FORMATS} - {"json"}  # the word for how reports and tables are printed as well
    tree = ast.parse(path.read_text("utf-8"))
    words = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # docstrings
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in names and id(node) not in words:
            yield f"{path.relative_to(ROOT)}:{node.lineno}: '{node.value}'"
        if isinstance(node, ast.Attribute) and node.attr.lower() in names and node.attr.isupper():
            yield f"{path.relative_to(ROOT)}:{node.lineno}: .{node.attr}"
        if isinstance(node, ast.ImportFrom) and re.match(r"hymeko_x\.(formats|frontends|backends)\.", node.module or ""):
            yield f"{path.relative_to(ROOT)}:{node.lineno}: {node.module}"


def test_no_module_outside_its_rooms_names_a_format() -> None:
    common = [path for path in MODULES if not ROOMS.match(path.relative_to(ROOT / "hymeko_x").as_posix())]
    found = {path.relative_to(ROOT / "hymeko_x").as_posix(): [*names_of_formats(path)] for path in common}
    assert [place for path, places in found.items() if path not in STILL_NAMED for place in places] == []
    assert [path for path in STILL_NAMED if not found.get(path)] == [], "these no longer name a format: take them off the list"


def test_records_are_copied_by_msgspec() -> None:
    """`dataclasses.replace` of a `msgspec.Struct` passes mypy and fails when it runs."""
    wrong = [
        str(path.relative_to(ROOT))
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.ImportFrom) and node.module == "dataclasses" and any(alias.name == "replace" for alias in node.names)
    ]
    assert wrong == []
