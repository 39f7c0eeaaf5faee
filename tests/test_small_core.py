"""What works with the three libraries of the core alone, and the advice where an optional one is missing."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x import extras
from hymeko_x.cli import VERBS

ROOT = Path(__file__).parents[1]
CORE = ("lark", "lxml", "msgspec")
ROBOT = """<robot name="arm"><link name="base"/><link name="tip"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><visual><geometry><box size="1 1 1"/></geometry></visual></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""

ALONE = """
import sys
from importlib.abc import MetaPathFinder

class OnlyTheCore(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {optional!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, OnlyTheCore())
from hymeko_x.cli import main
sys.exit(main(sys.argv[1:]))
"""
"""Runs a command as in an environment without the optional libraries."""


def run(folder: Path, *words: str, installed: tuple[str, ...] = ()) -> subprocess.CompletedProcess[str]:
    optional = sorted({*extras.OF_LIBRARIES} - {*installed})
    program = ALONE.format(optional=optional)
    return subprocess.run([sys.executable, "-c", program, *words], cwd=folder, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.urdf").write_text(ROBOT)
    return tmp_path


def test_text_formats_need_the_core_alone(folder: Path) -> None:
    for words in (
        ("convert", "arm.urdf", "arm.xml"),
        ("convert", "arm.xml", "arm.hymeko"),
        ("convert", "arm.hymeko", "again.urdf"),
        ("check", "again.urdf"),
        ("info", "again.urdf"),
        ("diff", "arm.urdf", "again.urdf"),
        ("graph", "arm.urdf", "-o", "all.svg", "--view", "incidence"),
    ):
        done = run(folder, *words)
        assert done.returncode in (0, 4), (words, done.stderr)
        assert "HX901" not in done.stderr
        assert "HX011" not in done.stderr


@pytest.mark.parametrize("there", ["there.xml", "there.hymeko", "there.sdf"])
def test_edits_of_text_formats_come_home_with_the_core_alone(there: str, folder: Path) -> None:
    (folder / "arm.urdf").write_text(hx.dumps(hx.loads(ROBOT, "urdf"), "urdf"))
    assert run(folder, "convert", "arm.urdf", there).returncode == 0
    text = (folder / there).read_text()
    (folder / there).write_text(text.replace('mass="1"', 'mass="2"').replace("<mass>1<", "<mass>2<").replace("mass 1", "mass 2"))
    done = run(folder, "update", "arm.urdf", there)
    assert done.returncode == 0, done.stderr
    assert '<mass value="2"/>' in (folder / "arm.urdf").read_text()


SLOW_TO_LOAD = ("ast", "dataclasses", "difflib", "email", "hashlib", "importlib.metadata", "inspect", "lark", "lxml", "socket", "tempfile")
"""Modules that take milliseconds to load, and that no conversion of a sound text needs: together more than the conversion itself."""


def test_a_conversion_loads_no_module_that_it_has_no_use_for(folder: Path) -> None:
    program = f"""
import sys, msgspec  # which loads some of them where typing_extensions is installed
before = {{*sys.modules}}
from hymeko_x.cli import main
code = main(["convert", "arm.urdf", "arm.xml"])
print(code, [name for name in {SLOW_TO_LOAD!r} if name in sys.modules and name not in before])
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout == "0 []\n", done.stderr


ADVICE = {
    "agree": ("", "verify"),
    "attach": ("arm.urdf arm.urdf --at tip -o two.urdf", None),
    "check": ("arm.urdf", None),
    "completion": ("bash", "completion"),
    "convert": ("arm.urdf arm.usda", "usd"),
    "corpus": ("list", "corpus"),
    "dh": ("arm.urdf", "verify"),
    "diff": ("arm.urdf arm.urdf", None),
    "dynamics": ("arm.urdf", "dynamics"),
    "explain": ("HX011", None),
    "export": ("arm.hymeko --to xacro", "xacro"),
    "fmt": ("arm.hymeko", None),
    "formats": ("", None),
    "generate": ("arm.hymeko --to urdf --with faults:1", "verify"),
    "grammar": ("--to gbnf", None),
    "graph": ("arm.urdf -o tree.svg", None),
    "import": ("arm.urdf", None),
    "info": ("arm.urdf", None),
    "lsp": ("", "lsp"),
    "mcp": ("", "mcp"),
    "render": ("arm.urdf -o arm.png", "draw"),
    "report": ("arm.urdf arm.urdf -o both.html", "verify"),
    "roundtrip": ("arm.urdf", "verify"),
    "schema": ("", None),
    "simulate": ("arm.urdf", "dynamics"),
    "skill": ("--card", None),
    "update": ("arm.urdf arm.urdf", None),
    "verify": ("arm.urdf arm.urdf", "verify"),
    "view": ("arm.urdf", "view"),
}
"""For each verb words that it works with on the core alone, or else the extra whose installation it advises."""


@pytest.mark.parametrize("verb", VERBS)
def test_a_verb_works_with_the_core_alone_or_names_its_extra(verb: str, folder: Path) -> None:
    (folder / "arm.hymeko").write_text(hx.dumps(hx.loads(ROBOT, "urdf", lenient=True), "hymeko", lenient=True))
    (folder / "hymeko.toml").write_text('[[robot]]\nname = "arm"\nfiles = ["arm.urdf", "arm.hymeko"]\n')
    words, extra = ADVICE[verb]
    done = run(folder, verb, *words.split())
    assert "HX901" not in done.stderr
    if extra is None:
        assert done.returncode == 0, done.stderr
        return
    assert done.returncode == 1
    assert "HX011" in done.stderr
    assert f"pip install 'hymeko-x[{extra}]'" in done.stderr
    assert extra not in extras.PURPOSES or f"{extras.PURPOSES[extra]} needs the library " in done.stderr


def test_every_extra_that_is_named_exists() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert [line.partition(">")[0] for line in project["dependencies"]] == list(CORE)
    assert {*extras.OF_LIBRARIES.values(), *extras.OF_ROOMS.values()} <= {*project["optional-dependencies"]}
