"""Nobody else sees a residue: other readers make the same of a file with one as of a file without."""

from __future__ import annotations

import logging
import subprocess
import sys
import warnings
from pathlib import Path

import mujoco
import pinocchio
import pytest
import yourdfpy
from pxr import Usd

import hymeko_x as hx
from tests.mjcf.mjmodels import differences
from tests.residue.samples import MJCF, PLAIN_MJCF, URDF


def both(text: str, own: str, target: str) -> tuple[str, str]:
    """The robot in another format, with and without its residue."""
    robot = hx.loads(text, own)
    carrying, pure = hx.dumps(robot, target), hx.dumps(robot, target, pure=True)
    assert "residue" in carrying
    assert "residue" not in pure
    return carrying, pure


def test_pinocchio_sees_the_same_urdf(capfd: pytest.CaptureFixture[str]) -> None:
    models = [pinocchio.buildModelFromXML(text) for text in both(MJCF, "mjcf", "urdf")]
    assert models[0] == models[1]
    said = capfd.readouterr()
    assert "hymeko" not in said.out + said.err


def test_yourdfpy_sees_the_same_urdf(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    seen = []
    for number, text in enumerate(both(MJCF, "mjcf", "urdf")):
        path = tmp_path / f"{number}.urdf"
        path.write_text(text)
        with caplog.at_level(logging.WARNING):
            seen.append(yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=False, build_collision_scene_graph=False).robot)
    assert [[part.name for part in (*robot.links, *robot.joints)] for robot in seen[:1]] == [
        [part.name for part in (*robot.links, *robot.joints)] for robot in seen[1:]
    ]
    assert seen[0].joints == seen[1].joints
    assert "hymeko" not in caplog.text


def test_mujoco_sees_the_same_mjcf_but_for_the_text() -> None:
    carrying, pure = both(URDF, "urdf", "mjcf")
    spec = mujoco.MjSpec.from_string(carrying)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = spec.compile()
    assert [text.name for text in spec.texts] == ["hymeko-x residue"]
    assert model.ntext == 1
    for text in spec.texts:
        spec.delete(text)
    assert differences(mujoco.MjModel.from_xml_string(pure), spec.compile()) == []


def test_mujoco_sees_the_same_urdf() -> None:
    carrying, pure = (mujoco.MjModel.from_xml_string(text) for text in both(PLAIN_MJCF, "mjcf", "urdf"))
    assert differences(pure, carrying) == []


def test_xacro_expands_the_same() -> None:
    texts = both(MJCF, "mjcf", "xacro")
    expanded = [
        subprocess.run([sys.executable, "-c", _EXPAND], input=text, capture_output=True, text=True, check=True).stdout for text in texts
    ]
    head, _, tail = expanded[0].partition("<hymeko:residue")
    assert "".join((head + tail.partition("</hymeko:residue>")[2]).split()) == "".join(expanded[1].split())


_EXPAND = """
import os, sys, tempfile, xacro
os.chdir(tempfile.mkdtemp())
open("robot.xacro", "w").write(sys.stdin.read())
print(xacro.process_file("robot.xacro").toprettyxml(indent=""))
"""


def test_usd_sees_the_same_stage_but_for_its_custom_data(tmp_path: Path) -> None:
    stages = []
    for number, text in enumerate(both(MJCF, "mjcf", "usd")):
        path = tmp_path / f"{number}.usda"
        path.write_text(text)
        stages.append(Usd.Stage.Open(str(path)))
    carrying, pure = (stage.GetRootLayer() for stage in stages)
    assert list(carrying.customLayerData) == ["hymeko:residue"]
    carrying.pseudoRoot.ClearInfo("customLayerData")
    assert carrying.ExportToString() == pure.ExportToString()
