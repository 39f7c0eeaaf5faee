"""What acts and shines: MjcActuator prims, filtered pairs, friction, lights, in and out."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x import formats, pipeline
from hymeko_x.corpus import catalog
from hymeko_x.diagnostics import Report
from hymeko_x.frontends import mjcf
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Actuator, Contact, Drive, Light
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from tests.turns import cases
from tests.usd.stages import opened, read_text
from tests.usd.test_kept import missing
from tests.usd.test_read import ENDS, PLACE, body, joint, robot

ACTUATOR = (
    'def MjcActuator "act"\n{{\n    rel mjc:target = </robot/j>\n    uniform double[] mjc:gear = [50, 0, 0, 0, 0, 0]\n'
    "    uniform double mjc:ctrlRange:min = -1\n    uniform double mjc:ctrlRange:max = 2\n{more}}}\n"
)
SERVO = (
    '    uniform token mjc:biasType = "affine"\n    uniform double[] mjc:gainPrm = [7, 0, 0, 0, 0, 0, 0, 0, 0, 0]\n'
    "    uniform double[] mjc:biasPrm = [0, -7, -1, 0, 0, 0, 0, 0, 0, 0]\n"
)


def two(*more: str) -> str:
    return robot(body("a"), body("b"), joint("PhysicsRevoluteJoint", "j", ENDS), *more)


@pytest.mark.parametrize(
    ("more", "actuator"),
    [
        ("", Actuator("motor", (("ctrlrange", (-1.0, 2.0)),))),
        (
            SERVO,
            Actuator("general", (("biastype", "affine"), ("gainprm", (7.0,)), ("biasprm", (0.0, -7.0, -1.0)), ("ctrlrange", (-1.0, 2.0)))),
        ),
    ],
)
def test_an_actuator_of_mujoco_drives_its_joint(more: str, actuator: Actuator, tmp_path: Path) -> None:
    text = two(ACTUATOR.format(more=more))
    mechanism = read_text(text)
    assert mechanism.graph.vertices[Id("actuator", "act")] == actuator
    ((_, _, arcs),) = mechanism.edges(Drive)
    assert [(arc.target, arc.sign, arc.weight) for arc in arcs] == [(Id("actuator", "act"), 1, None), (Id("joint", "j"), -1, (50.0,))]
    assert missing(text, tmp_path) == {}


def test_bodies_that_are_filtered_against_each_other_do_not_collide(tmp_path: Path) -> None:
    text = robot(body("a", "    rel physics:filteredPairs = [</robot/b>, </robot/c>]\n", "PhysicsFilteredPairsAPI"), body("b"), body("c"))
    found = [(contact.kind, [arc.target.name for arc in arcs]) for _, contact, arcs in read_text(text).edges(Contact)]
    assert found == [("exclude", ["a", "b"]), ("exclude", ["a", "c"])]
    assert missing(text, tmp_path) == {}


def test_a_light_keeps_its_kind_and_colour_and_everything_else_of_it(tmp_path: Path) -> None:
    spot = '    def SphereLight "lamp" (prepend apiSchemas = ["ShapingAPI"])\n    {\n        color3f inputs:color = (1, 0.5, 0.25)\n'
    text = robot(body("a", spot + "        float inputs:intensity = 30\n" + PLACE.format(x=0, y=0, z=1) + "    }\n"))
    mechanism = read_text(text)
    assert mechanism.graph.vertices[Id("light", "lamp")] == Light("spot", (1.0, 0.5, 0.25))
    assert missing(text, tmp_path) == {}


MODEL = """<mujoco><worldbody>
  <body name="a"><joint name="j"/><geom name="g" size="0.1" friction="0.5 0.02 0.003"/>
    <light name="sun" type="directional" diffuse="1 0.5 0.25"/>
    <body name="b"><joint name="k"/><geom name="h" size="0.1" pos="1 0 0" friction="0.5 0.02 0.003"/></body></body>
  <body name="c"><freejoint/><geom name="i" size="0.1" pos="0 0 5"/></body></worldbody>
  <contact><exclude body1="a" body2="c"/></contact>
  <actuator><motor name="m" joint="j" gear="3" ctrlrange="-1 1"/>
    <general name="n" joint="k" biastype="affine" gainprm="2" biasprm="0 -2"/></actuator>
</mujoco>"""


def test_what_mjcf_says_stands_in_the_schemas_of_the_stage(tmp_path: Path) -> None:
    mechanism = mjcf.read(Source("m.xml", MODEL.encode()), Report()).mechanism
    data = pipeline.write(mechanism, formats.USD, Options(), NoFiles(), Report()).main
    stage = opened(data, tmp_path)
    root = stage.GetDefaultPrim().GetPath()
    motor, general = (stage.GetPrimAtPath(f"{root}/actuators/{name}") for name in "mn")
    assert motor.GetTypeName() == general.GetTypeName() == "MjcActuator"
    assert [str(path) for path in motor.GetRelationship("mjc:target").GetTargets()] == [f"{root}/joints/j"]
    assert (motor.GetAttribute("mjc:gear").Get()[0], motor.GetAttribute("mjc:ctrlRange:max").Get()) == (3.0, 1.0)
    assert list(general.GetAttribute("mjc:biasPrm").Get()) == [0.0, -2.0, *[0.0] * 8]
    assert [str(path) for path in stage.GetPrimAtPath(f"{root}/a").GetRelationship("physics:filteredPairs").GetTargets()] == [f"{root}/c"]
    bound = [stage.GetPrimAtPath(f"{root}/{path}").GetRelationship("material:binding:physics").GetTargets() for path in ("a/g", "b/h")]
    assert bound[0] == bound[1]
    material = stage.GetPrimAtPath(bound[0][0])
    assert material.GetAttribute("physics:dynamicFriction").Get() == 0.5
    assert (material.GetAttribute("mjc:torsionalfriction").Get(), material.GetAttribute("mjc:rollingfriction").Get()) == (0.02, 0.003)
    assert stage.GetPrimAtPath(f"{root}/a/sun").GetTypeName() == "DistantLight"


# ---- what a class of MJCF says ---------------------------------------------------------------------------------------------------

CLASSES = """<mujoco><default><general dyntype="none"/>
  <default class="k"><general dyntype="integrator" gainprm="5 0 0" biastype="affine" biasprm="1 -5 -2" ctrlrange="-1 1" gear="3"
    actlimited="true" actrange="-2 2"/></default>
  <default class="m"><general gaintype="muscle" biastype="muscle" dyntype="muscle" dynprm=".01 .04"
    gainprm=".7 1 -1 200 .5 1.6 1.5 1.3 1.2"/></default>
  </default>
  <worldbody><body name="a"><joint name="j"/><geom size=".1"/></body></worldbody>
  <actuator><general name="u" class="k" joint="j"/><general name="v" class="m" joint="j" lengthrange="1 2"
    biasprm=".7 1 -1 200 .5 1.6 1.5 1.3 1.2"/>
    <general name="w" class="k" joint="j" gainprm="7" dyntype="filter" dynprm=".3"/></actuator>
</mujoco>"""
LAWS = (
    *("dyntype", "gaintype", "biastype", "dynprm", "gainprm", "biasprm", "gear"),
    *("ctrllimited", "ctrlrange", "forcelimited", "forcerange", "actlimited", "actrange"),
)


def other_laws(source: Path, folder: Path) -> list[str]:
    """How actuators drive otherwise in the MJCF of the stage without residue that the source becomes, by name."""
    stage, back = folder / "stage.usda", folder / "back.xml"
    hx.convert(source, stage)
    hx.convert(stage, back)
    a, b = (mujoco.MjModel.from_xml_path(str(path)) for path in (source, back))
    assert a.nu == b.nu > 0
    pairs = [(i, b.actuator(a.actuator(i).name).id) for i in range(a.nu)]
    values = {name: (getattr(a, f"actuator_{name}"), getattr(b, f"actuator_{name}")) for name in LAWS}
    return [f"{a.actuator(i).name} {name}" for i, j in pairs for name, (x, y) in values.items() if not np.allclose(x[i], y[j], rtol=1e-6)]


def test_what_a_class_says_of_an_actuator_is_in_a_stage_without_residue(tmp_path: Path) -> None:
    source = tmp_path / "classes.xml"
    source.write_text(CLASSES)
    assert other_laws(source, tmp_path) == []


FEW = ("rodent.xml", "adroit_hammer.xml", "panda_free_base.xml", "manipulator.xml")
REAL = {file.id: file for file in catalog.development_files("mjcf") if Path(file.path).name in FEW}
LATER = ("gymnasium_robotics/adroit_hammer.xml", "genesis_world/panda_free_base.xml")


@pytest.mark.corpus
@pytest.mark.parametrize("robot", cases(REAL, LATER), indirect=True)
def test_actuators_of_a_real_robot_drive_alike_in_a_stage_without_residue(robot: Path, tmp_path: Path) -> None:
    assert other_laws(robot, tmp_path) == []


@pytest.mark.parametrize("law", ['kp="20" kv="3"', 'kp="20" timeconst="0.1" dampratio="0.7"', 'kp="1"'])
def test_a_servo_that_inherits_its_range_comes_back_as_itself(law: str, tmp_path: Path) -> None:
    servo = f'<position name="p" tendon="t" {law} inheritrange="1"/>'
    text = f"""<mujoco><worldbody><body><joint name="j" range="-30 30"/><geom size="0.05"/></body></worldbody>
<tendon><fixed name="t" range="-1 1"><joint joint="j" coef="1"/></fixed></tendon><actuator>{servo}</actuator></mujoco>"""
    (tmp_path / "a.xml").write_text(text)
    hx.convert(tmp_path / "a.xml", tmp_path / "b.usda")
    hx.convert(tmp_path / "b.usda", tmp_path / "c.xml")
    ours, theirs = (hx.load(tmp_path / name).mechanism.vertex(Id("actuator", "p"), Actuator) for name in ("c.xml", "a.xml"))
    assert (ours.kind, dict(ours.parameters)) == (theirs.kind, dict(theirs.parameters))
    ranges = [mujoco.MjModel.from_xml_path(str(tmp_path / name)).actuator_ctrlrange.tolist() for name in ("a.xml", "c.xml")]
    assert ranges == [[[-1.0, 1.0]], [[-1.0, 1.0]]]


@pytest.mark.unread("HX101")
def test_a_servo_of_a_joint_that_inherits_its_range_is_a_drive_and_comes_back_as_itself(tmp_path: Path) -> None:
    authored = '<position name="j" joint="j" kp="10" kv="1" inheritrange="1"/>'
    text = f"""<mujoco><worldbody><body><joint name="j" range="-30 60"/><geom size="0.05"/></body></worldbody>
<actuator>{authored}</actuator></mujoco>"""
    (tmp_path / "a.xml").write_text(text)
    hx.convert(tmp_path / "a.xml", tmp_path / "b.usda")
    assert "drive:angular:physics:stiffness" in (tmp_path / "b.usda").read_text()
    hx.convert(tmp_path / "b.usda", tmp_path / "c.xml")
    assert dict(hx.load(tmp_path / "c.xml").mechanism.vertex(Id("actuator", "j"), Actuator).parameters) == {
        "kp": 10.0,
        "kv": 1.0,
        "inheritrange": 1.0,
    }
    ranges = [mujoco.MjModel.from_xml_path(str(tmp_path / name)).actuator_ctrlrange.tolist() for name in ("a.xml", "c.xml")]
    assert ranges[0] == ranges[1]
