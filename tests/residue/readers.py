"""What other people's readers make of two files of one robot, one with a residue and one without: it has to be the same."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import mujoco
import pinocchio
import yourdfpy
from pxr import Sdf, Usd

from tests.mjcf.mjmodels import differences


def assert_same_urdf(carrying: Path, pure: Path) -> None:
    """For Pinocchio, with urdfdom below it, and for yourdfpy."""
    a, b = (pinocchio.buildModelFromUrdf(str(path)) for path in (carrying, pure))
    assert a == b
    seen = [
        yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=False, build_collision_scene_graph=False).robot
        for path in (carrying, pure)
    ]
    assert [part.name for part in (*seen[0].links, *seen[0].joints)] == [part.name for part in (*seen[1].links, *seen[1].joints)]
    assert seen[0].joints == seen[1].joints


def assert_same_mjcf(carrying: Path, pure: Path) -> None:
    """For MuJoCo, but for the text that carries the residue."""
    spec = mujoco.MjSpec.from_file(str(carrying))
    for text in tuple(spec.texts):
        if text.name.startswith("hymeko-x residue"):
            spec.delete(text)
    assert differences(mujoco.MjModel.from_xml_path(str(pure)), spec.compile()) == []


def assert_same_xacro(carrying: Path, pure: Path) -> None:
    """For xacro: the same expansion."""
    expanded = [_expansion(path) for path in (carrying, pure)]
    assert "".join(re.sub(r"<hymeko:residue.*?</hymeko:residue>", "", expanded[0], flags=re.DOTALL).split()) == "".join(expanded[1].split())


def _expansion(path: Path) -> str:
    program = "import sys, xacro; print(xacro.process_file(sys.argv[1]).toprettyxml(indent=''))"
    return subprocess.run([sys.executable, "-c", program, path.name], cwd=path.parent, capture_output=True, text=True, check=True).stdout


def assert_same_stage(carrying: Path, pure: Path) -> None:
    """For usd-core: the same composed stage, but for the layer's custom data."""
    a, b = (Usd.Stage.Open(str(path)).Flatten() for path in (carrying, pure))
    assert _without_residue(a).replace(str(carrying.parent), str(pure.parent)) == _without_residue(b)  # images have whole paths there


def _without_residue(layer: Sdf.Layer) -> str:
    layer.customLayerData = {name: value for name, value in layer.customLayerData.items() if name != "hymeko:residue"}
    layer.documentation = ""  # in which a flattened stage names the files that it was made of
    text: str = layer.ExportToString()
    return text


ASSERTS: Mapping[str, Callable[[Path, Path], None]] = {
    "urdf": assert_same_urdf,
    "mjcf": assert_same_mjcf,
    "xacro": assert_same_xacro,
    "usd": assert_same_stage,
}
"""The readers by format."""
