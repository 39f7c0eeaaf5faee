"""The project: what its Makefile, package and public face promise."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml

import hymeko_x

ROOT = Path(__file__).parents[1]


def test_every_public_name_is_there_and_loaded_only_when_used() -> None:
    assert [name for name in hymeko_x.__all__ if getattr(hymeko_x, name, None) is None] == []
    assert set(hymeko_x.__all__) <= set(dir(hymeko_x))
    with pytest.raises(AttributeError, match="module 'hymeko_x' has no attribute 'lod'"):
        hymeko_x.lod  # noqa: B018
    program = "import sys, hymeko_x; print([name for name in sys.modules if name.startswith('hymeko_x.')])"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True)
    assert run.stdout == "[]\n"


def test_public_functions_keep_their_names_after_their_modules_are_loaded() -> None:
    program = "import hymeko_x as hx, hymeko_x.cli.convert, hymeko_x.pipeline; print(callable(hx.convert), callable(hx.diff))"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True)
    assert run.stdout == "True True\n"


def test_the_console_script_and_the_typing_marker_are_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    assert project["project"]["scripts"] == {"hymeko-x": "hymeko_x.cli:main"}
    assert (ROOT / "hymeko_x/py.typed").exists()


def test_the_version_is_the_same_everywhere_and_that_of_the_tag() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    assert (project["project"]["dynamic"], project["tool"]["hatch"]["version"]["path"]) == (["version"], "hymeko_x/version.py")
    version = hymeko_x.__version__
    assert f"version: {version}\n" in (ROOT / "CITATION.cff").read_text("utf-8")
    done = subprocess.run(["git", "tag", "--points-at", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False)
    tags = [tag for tag in done.stdout.split() if re.fullmatch(r"v\d+\.\d+\.\d+", tag)]
    assert tags in ([], [f"v{version}"]), "the tag of a release is its version; a clone without tags has none to compare"


def test_the_ci_runs_what_the_makefile_calls_test() -> None:
    assert "exec make test" in (ROOT / ".ci/run").read_text("utf-8")
    assert (ROOT / ".ci/run").stat().st_mode & 0o111


@pytest.mark.slow
@pytest.mark.corpus
def test_the_wheel_carries_data_files_and_nothing_that_does_not_belong_there(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(tmp_path), str(ROOT)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0 and "hatchling" in run.stderr:
        pytest.skip("the build backend cannot be downloaded")
    assert run.returncode == 0, run.stderr
    names = zipfile.ZipFile(next(tmp_path.glob("*.whl"))).namelist()
    ours = {"hymeko_x/py.typed", "hymeko_x/corpus/catalog.toml", "hymeko_x/language/hymeko.lark", "hymeko_x/cli/convert.py"}
    assert ours - set(names) == set()
    assert [name for name in names if not name.startswith(("hymeko_x/", "hymeko_x-"))] == []


def test_the_hooks_and_the_action_install_what_their_files_need() -> None:
    """Each in an environment of its own, from this folder: the core and the extras that they name."""
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    hooks = {hook["id"]: hook for hook in yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text("utf-8"))}
    extras = {
        name: [word for text in hook.get("additional_dependencies", []) for word in text[2:-1].split(",")] for name, hook in hooks.items()
    }
    assert extras == {
        "hymeko-x-check": ["xacro"],
        "hymeko-x-agree": ["verify"],
        "hymeko-x-agree-sdf": ["verify", "sdf"],
        "hymeko-x-fmt": [],
    }
    assert {extra for words in extras.values() for extra in words} <= declared.keys()
    assert re.search(hooks["hymeko-x-check"]["files"], "arm.urdf.xacro")
    action = yaml.safe_load((ROOT / "action.yml").read_text("utf-8"))
    assert action["inputs"]["extras"]["default"] == "verify"
    assert re.search(r"hymeko-x\[.*\bxacro\b.*\]", declared["verify"][0])
