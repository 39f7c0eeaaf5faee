"""<replicate>, <attach> and <flexcomp> are expanded by MuJoCo, and frames are scaled by it: the model stays the same bit for bit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import pytest
from mjmodels import compiled, differences, read, read_text, through_hymeko, write

from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends import mjcf
from hymeko_x.ir.parts import Actuator, Body, Mesh
from hymeko_x.source import Source
from tests.robots import MemoryFiles

if TYPE_CHECKING:
    from pathlib import Path

ARM = """<mujoco model="arm"><compiler angle="radian" meshdir="shapes"/><default><geom rgba="1 0 0 1"/>
    <default class="strong"><joint damping="2"/></default></default><asset><mesh file="pyramid.obj"/></asset>
    <worldbody><frame name="mount" pos="0 0 1"><geom name="plate" size=".2"/></frame>
    <body name="upper" euler="0 0 1.1"><joint name="elbow" class="strong" range="-.3 .7" ref=".1"/><geom type="mesh" mesh="pyramid"/>
    <site name="tip"/></body></worldbody><actuator><motor joint="elbow"/></actuator>{}</mujoco>"""
KEYS = '<keyframe><key name="bent" qpos=".5"/></keyframe>'
NESTED = """<mujoco model="cart"><asset><model name="arm" file="arm.xml"/></asset><worldbody><body name="cart"><geom size=".1"/>
    <attach model="arm" body="upper" prefix="arm_"/></body></worldbody></mujoco>"""
PYRAMID = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
PART = '<mujocoinclude><body name="b"><joint name="j"/><geom size=".1"/></body></mujocoinclude>'

ATTACHED = {
    "a body": '<body name="a" pos="1 0 0"><attach model="arm" body="upper" prefix="x_"/></body>',
    "a frame": '<attach model="arm" frame="mount" prefix="x_"/>',
    "the whole": '<frame euler="0 30 0"><attach model="arm" prefix="x_"/></frame>',
    "twice": '<body name="a"><attach model="arm" body="upper" prefix="x_"/></body><attach model="arm" body="upper" prefix="y_"/>',
    "beside an own mesh": '<geom type="mesh" mesh="own"/><attach model="arm" body="upper" prefix="x_"/>',
}

SHEET = 'name="f" spacing=".1 .1 .1" mass="1" radius=".01"'
EXPANDED = {
    "replicate": """<worldbody><replicate count="11" offset="1 0 0" euler="0 0 30" sep="-"><body name="b"><joint name="j" range="-30 30"/>
        <geom size=".1"/></body></replicate></worldbody><sensor><jointpos joint="j-00"/></sensor>""",
    "replicate in a body": '<worldbody><body><replicate count="3" offset="0 0 1"><geom size=".1"/></replicate></body></worldbody>',
    "replicate in replicate": """<worldbody><replicate count="2" offset="1 0 0"><replicate count="2" offset="0 1 0">
        <body name="b"><freejoint/><geom size=".1"/></body></replicate></replicate></worldbody>""",
    "replicate of an included body": """<worldbody><replicate count="2" offset="1 0 0"><include file="part.xml"/></replicate></worldbody>
        <actuator><motor joint="j1"/></actuator>""",
    "replicate in a scaled frame": """<worldbody><frame scale="2"><replicate count="2" offset="1 0 0"><body name="b"><joint/>
        <geom size=".1"/></body></replicate></frame></worldbody>""",
    "cloth": f"""<worldbody><flexcomp {SHEET} type="grid" count="3 3 1" dim="2"><pin id="0"/><edge equality="true"/></flexcomp>
        </worldbody>""",
    "cable": f'<worldbody><flexcomp {SHEET} count="5 1 1" dim="1"><elasticity young="1e5"/></flexcomp></worldbody>',
    "jelly": f'<worldbody><flexcomp {SHEET} count="3 3 3" dim="3" dof="trilinear"><elasticity young="1e3"/></flexcomp></worldbody>',
    "a rigid block": f"""<worldbody><body name="b"><flexcomp {SHEET} type="box" count="3 3 3" dim="3" rigid="true"/></body>
        </worldbody>""",
    "a mesh made soft": f"""<worldbody><flexcomp {SHEET} type="mesh" file="shapes/pyramid.obj" dim="2"><edge equality="true"/></flexcomp>
        </worldbody>""",
    "points made soft": f"""<worldbody><flexcomp {SHEET} type="direct" dim="2" point="0 0 0 1 0 0 0 1 0" element="0 1 2" material="m">
        <elasticity young="1e3" poisson=".1"/></flexcomp></worldbody><asset><material name="m"/></asset>""",
    "a frame that scales all": """<worldbody><frame pos="1 0 0" scale="2"><body name="b" pos="1 0 0"><joint name="j" pos="0 0 1"/>
        <geom type="capsule" size=".1" fromto="0 0 0 0 0 1"/><site pos="1 1 1"/></body></frame></worldbody>""",
    "a frame that stretches": """<worldbody><frame scale="2 3 4" scaling="geometry" massscale="1"><body pos="1 0 0"><joint/>
        <geom type="box" size=".1 .1 .1"/></body></frame></worldbody>""",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with models and files to refer to."""
    (tmp_path / "parts" / "shapes").mkdir(parents=True)
    (tmp_path / "parts" / "arm.xml").write_text(ARM.format(""))
    (tmp_path / "parts" / "keyed.xml").write_text(ARM.format(KEYS))
    (tmp_path / "parts" / "cart.xml").write_text(NESTED)
    (tmp_path / "shapes").mkdir()
    for place in ("parts/shapes/pyramid.obj", "shapes/pyramid.obj", "shapes/own.obj"):
        (tmp_path / place).write_text(PYRAMID)
    (tmp_path / "part.xml").write_text(PART)
    return tmp_path


def assert_same(folder: Path, text: str) -> None:
    main = folder / "main.xml"
    main.write_text(text)
    original = mujoco.MjModel.from_xml_path(str(main))
    robot = read(main)
    assert differences(original, compiled(write(robot), folder)) == []
    assert differences(original, compiled(write(through_hymeko(robot)), folder)) == []


@pytest.mark.parametrize("content", [pytest.param(text, id=name) for name, text in EXPANDED.items()])
def test_what_mujoco_expands_is_the_same_model(folder: Path, content: str) -> None:
    assert_same(folder, f"<mujoco>{content}</mujoco>")


@pytest.mark.parametrize("model", ["arm", "keyed"])
@pytest.mark.parametrize("content", [pytest.param(text, id=name) for name, text in ATTACHED.items()])
def test_attached_models_are_the_same_with_files_from_their_own_folders(folder: Path, content: str, model: str) -> None:
    assets = f'<asset><mesh file="own.obj"/><model name="arm" file="parts/{model}.xml"/></asset>'
    assert_same(folder, f'<mujoco><compiler meshdir="shapes"/>{assets}<worldbody>{content}</worldbody></mujoco>')


def test_a_model_that_attaches_models_is_the_same(folder: Path) -> None:
    assets = '<asset><model name="cart" file="parts/cart.xml"/></asset>'
    assert_same(folder, f'<mujoco>{assets}<worldbody><attach model="cart" prefix="l_"/></worldbody></mujoco>')


def test_files_of_attached_models_are_seen_from_the_main_file(folder: Path) -> None:
    main = folder / "main.xml"
    assets = '<asset><mesh file="own.obj"/><model name="arm" file="parts/arm.xml"/></asset>'
    attach = '<worldbody><attach model="arm" prefix="x_"/></worldbody>'
    main.write_text(f'<mujoco><compiler meshdir="shapes"/>{assets}{attach}</mujoco>')
    robot = read(main)
    assert {part.uri for _, part in robot.vertices(Mesh)} == {"shapes/own.obj", "shapes/../parts/shapes/pyramid.obj"}
    main.write_text(f'<mujoco><compiler meshdir="shapes" strippath="true"/>{assets}{attach}</mujoco>')
    assert {part.uri for _, part in read(main).vertices(Mesh)} == {"shapes/own.obj", "parts/shapes/pyramid.obj"}


def test_a_note_says_that_mujoco_expanded_it() -> None:
    report = Report()
    read_text('<mujoco><worldbody><flexcomp name="f" count="2 2 1" mass="1"/></worldbody></mujoco>', report)
    assert [diagnostic.message for diagnostic in report] == ["<flexcomp> was expanded by MuJoCo; what it became has its line"]


def test_no_place_is_one_of_the_expanded_text() -> None:
    text = """<mujoco>
      <worldbody>
        <body name="arm">
          <joint name="j"/>
          <geom size="1"/>
        </body>
        <replicate count="2" offset="1 0 0">
          <body name="b"><geom size=".1"/></body>
        </replicate>
      </worldbody>
      <actuator><motor name="m" joint="j"/></actuator>
    </mujoco>"""
    robot = read_text(text)
    assert {key.name: origin.line for key, _ in robot.vertices(Body) if (origin := robot.origin(key))} == {"arm": 3, "b0": 7, "b1": 7}
    assert {key.name: origin.line for key, _ in robot.vertices(Actuator) if (origin := robot.origin(key))} == {"m": 11}
    wrong = '<mujoco><worldbody>\n<flexcomp name="f" count="2 2 1" dim="7"/></worldbody></mujoco>'
    assert refused(wrong).endswith("expand <flexcomp>: XML Error: Invalid dim, must be between 1 and 3 Element 'flexcomp'")


def refused(main: str, **files: str) -> str:
    memory = MemoryFiles({name.replace("_", "."): text.encode() for name, text in files.items()})
    with pytest.raises(Refusal) as caught:
        mjcf.read(Source("main.xml", main.encode(), memory), Report())
    return str(caught.value)


def test_a_sub_model_that_is_missing_or_attaches_itself_is_refused() -> None:
    main = '<mujoco><asset><model name="c" file="c.xml"/></asset><worldbody><attach model="c" prefix="x"/></worldbody></mujoco>'
    assert refused(main) == "main.xml:1: error[HX001]: the model 'c.xml' was not found"
    assert refused(main, c_xml=main) == "c.xml:1: error[HX047]: the model 'c.xml' attaches itself"


class Forgetful(MemoryFiles):
    """Files that are found, and gone when they are read."""

    def read(self, path: str) -> bytes:
        raise FileNotFoundError(path)


def test_a_file_that_vanishes_is_missing() -> None:
    main = b'<mujoco><worldbody><flexcomp name="f" type="mesh" file="no.obj" mass="1"/></worldbody></mujoco>'
    with pytest.raises(Refusal, match="Error opening file 'no.obj'"):
        mjcf.read(Source("main.xml", main, Forgetful({"no.obj": b""})), Report())


def test_what_mujoco_says_names_the_files_as_the_author_did() -> None:
    main = '<mujoco><worldbody><flexcomp name="f" type="mesh" file="no.obj" mass="1"/></worldbody></mujoco>'
    message = "MuJoCo refuses to expand <flexcomp>: XML Error: Error: Error opening file 'no.obj' Element 'flexcomp'"
    assert refused(main) == f"main.xml:1: error[HX302]: {message}"
