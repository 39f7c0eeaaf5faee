"""Each extra alone makes its verbs work, in an environment that has what this extra brings and nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from hymeko_x import extras

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
ARM = """<robot name="arm"><link name="base"/><link name="tip"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><visual><geometry>{geometry}</geometry></visual>
  <collision><geometry>{geometry}</geometry></collision></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
GRID = '<mujoco><worldbody><replicate count="3" offset="1 0 0"><body><geom size="1"/></body></replicate></worldbody></mujoco>'
L_SHAPE = """v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1
f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n"""
STAGE = '#usda 1.0\n(\n    defaultPrim = "r"\n)\ndef Xform "r" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {}\n'
FILES = {
    "arm.urdf": ARM.format(geometry='<box size="1 1 1"/>'),
    "again.urdf": ARM.format(geometry='<box size="1 1 1"/>'),
    "mesh.urdf": ARM.format(geometry='<mesh filename="l.obj"/>'),
    "l.obj": L_SHAPE,
    "grid.xml": GRID,
    "arm.xacro": '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    '<xacro:property name="n" value="tip"/><link name="${n}"/></robot>',
    "hymeko.toml": '[[robot]]\nname = "arm"\nfiles = ["arm.urdf", "again.urdf"]\n',
}

VERBS_OF = {
    "completion": ["completion bash"],
    "convex": ["convert mesh.urdf out.urdf --collision decompose -q"],
    "corpus": ["corpus list"],
    "draw": ["render arm.urdf -o arm.png", "graph arm.urdf -o arm.png"],
    "dynamics": ["dynamics arm.urdf --to sympy", "simulate arm.urdf --time 0.01"],
    "lsp": ["lsp"],
    "mcp": ["mcp"],
    "meshes": ["convert mesh.urdf out.urdf --collision hull -q"],
    "mujoco": ["convert grid.xml grid.hymeko"],
    "usd": ["convert arm.urdf arm.usda", "convert arm.urdf arm.usdz", "info stage.usda"],
    "verify": [
        "verify arm.urdf again.urdf",
        "agree",
        "dh arm.urdf",
        "report arm.urdf again.urdf -o both.html",
        "roundtrip arm.urdf --through mjcf,usd,hymeko",
        "generate arm.urdf --to mjcf --with faults:1",
    ],
    "xacro": ["convert arm.xacro out.urdf", "convert arm.urdf again.xacro"],
}
"""The verbs that need each extra; the first one is tried in every run, the others with `make test-full`.

Not here: `ray`, `sdf` and `testing` have no verbs, and `view` serves until it is stopped.
"""


def required(name: str, wanted: frozenset[str]) -> Iterator[tuple[str, frozenset[str]]]:
    """The distributions that one requires with these extras, with the extras that it requires of them."""
    if name == "hymeko-x":
        lines = [*PROJECT["dependencies"], *(line for extra in wanted for line in PROJECT["optional-dependencies"][extra])]
    else:
        lines = distribution(name).requires or []
    for line in lines:
        needed = Requirement(line)
        if needed.marker is None or any(needed.marker.evaluate({"extra": extra}) for extra in wanted | {""}):
            yield str(canonicalize_name(needed.name)), frozenset(needed.extras)


@cache
def closure(extra: str) -> frozenset[str]:
    """The names of all distributions that the program brings with this extra."""
    found: set[tuple[str, frozenset[str]]] = set()
    waiting = [("hymeko-x", frozenset((extra,)))]
    while waiting:
        one = waiting.pop()
        if one in found:
            continue
        found.add(one)
        try:
            waiting.extend(required(*one))
        except PackageNotFoundError:
            pytest.skip(f"{one[0]} is not installed")
    return frozenset(name for name, _ in found)


def environment(extra: str, folder: Path) -> dict[str, str]:
    """The variables of an environment in a folder that has links to what an extra brings, and to nothing else."""
    for name in closure(extra) - {"hymeko-x"}:
        for entry in {file.parts[0] for file in distribution(name).files or () if file.parts[0] not in ("..", "__pycache__")}:
            if not (folder / entry).exists():
                (folder / entry).symlink_to(distribution(name).locate_file(entry))
    places = [folder, *folder.glob("cmeel.prefix/lib/python*/site-packages"), ROOT]
    return {"PATH": os.environ["PATH"], "HOME": os.environ["HOME"], "PYTHONPATH": os.pathsep.join(map(str, places))}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("extra", "words"),
    [
        pytest.param(extra, words, marks=[pytest.mark.full] if number else [])
        for extra, lines in VERBS_OF.items()
        for number, words in enumerate(lines)
    ],
)
def test_an_extra_alone_makes_its_verbs_work(extra: str, words: str, tmp_path: Path) -> None:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "stage.usda").write_text(STAGE)
    (tmp_path / "environment").mkdir()
    variables = environment(extra, tmp_path / "environment")
    command = [sys._base_executable, "-S", "-m", "hymeko_x", *words.split()]  # type: ignore[attr-defined]
    done = subprocess.run(
        command, cwd=tmp_path, env=variables, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300, check=False
    )
    assert "HX011" not in done.stderr, done.stderr
    assert done.returncode == 0, done.stderr


def test_every_extra_that_verbs_need_is_tried() -> None:
    named = {*extras.OF_LIBRARIES.values(), *extras.OF_ROOMS.values()}
    assert named - VERBS_OF.keys() == {"ray", "sdf", "testing", "view"}
