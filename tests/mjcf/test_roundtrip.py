"""MJCF -> mechanism -> MJCF, directly and through HyMeKo text: MuJoCo cannot tell the result from the original."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import pytest
from mjmodels import compiled, differences, read, read_text, through_hymeko, write

from hymeko_x.compare.diff import diff
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Body, Inertial, InertialWritten
from hymeko_x.ir.values import Z, pose, quat_about, rotate_tensor
from hymeko_x.rewrite import legalize

if TYPE_CHECKING:
    from pathlib import Path

BODY = '<body name="b"><freejoint/><geom name="g" size=".1"/>{}</body>'
CUBE = "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1"

ROBOTS = {
    "degrees": '<worldbody><body><joint range="-33.3 77.7" ref="12.5" springref="-3"/><geom size=".1"/></body></worldbody>',
    "a slide": '<worldbody><body><joint type="slide" range="-.3 .7" ref=".1"/><geom size=".1"/></body></worldbody>',
    "a flag that a class has set": """<default><joint limited="true"/></default>
        <worldbody><body><joint limited="false" name="j"/><geom size=".1"/></body></worldbody>""",
    "a range without a flag": """<compiler autolimits="false"/>
        <worldbody><body><joint limited="true" range="0 90"/><joint limited="false" range="0 9"/><geom size=".1"/></body></worldbody>""",
    "every orientation": """<compiler eulerseq="zyX"/><worldbody><body euler="12.3 45.6 78.9"/><body axisangle="1 2 3 40"/>
        <body xyaxes="1 .1 0 .2 1 .3"/><body zaxis="1 -2 .5"/><body quat="1 2 -3 .5"/><body quat="-1 0 0 0"/></worldbody>""",
    "angles about fixed axes": """<compiler eulerseq="XYZ"/><worldbody><body euler="12.3 45.6 78.9"><body euler="0 0 0"/></body>
        <geom size=".1" euler="90 0 0"/></worldbody>""",
    "turned inertia": """<worldbody><body><freejoint/>
        <inertial pos=".1 .2 .3" mass="2" diaginertia=".3 .2 .4" euler="10 20 30"/></body></worldbody>""",
    "inertia in a frame": """<worldbody><body><freejoint/><geom size=".1"/><frame pos="1 2 3" euler="0 0 30">
        <inertial pos=".1 .2 .3" mass="2" diaginertia=".3 .2 .4" zaxis="1 0 1"/></frame></body></worldbody>""",
    "full inertia": """<worldbody><body><freejoint/>
        <inertial pos=".1 .2 .3" mass="2" fullinertia=".3 .2 .4 .01 .02 .03"/></body></worldbody>""",
    "from point to point": """<worldbody><geom type="capsule" size=".013" fromto=".1 .2 .3 .7 .1 -.4"/>
        <geom type="box" size=".1 .2" fromto="0 0 0 .3 .2 .1"/><site type="cylinder" size=".1" fromto="0 0 0 .3 .2 .1"/></worldbody>""",
    "sizes that mean nothing": '<worldbody><geom size=".1 .2 .3"/><geom type="capsule" size=".1 .2 .3"/></worldbody>',
    "several joints": """<worldbody><body><joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/>
        <joint name="r" axis="1 2 3" pos=".1 .2 .3"/><geom size=".1"/></body></worldbody>""",
    "a joint of three kinds of stiffness": """<worldbody><body><joint stiffness="1 2 3" damping=".1 .2 .3"/><geom size=".1"/></body>
        </worldbody>""",
    "frames": """<default><default class="c"><geom rgba="1 0 0 1"/></default></default><worldbody><frame pos=".1 .2 .3" euler="10 20 30">
        <frame childclass="c" axisangle="1 1 0 33"><body name="b" pos="1 2 3"><joint axis="0 1 0" pos=".1 0 0"/><geom size=".1"/>
        <frame euler="0 0 45"><joint axis="1 0 0" pos=".3 .2 .1"/><geom size=".2" pos="1 0 0"/><site name="s"/></frame></body></frame>
        <light/><camera pos="1 0 0"/></frame></worldbody>""",
    "classes": """<default><geom rgba="1 0 0 1"/><default class="a"><geom rgba="0 1 0 1" size=".3"/><joint damping="3"/>
        <default class="b"><geom friction=".3"/></default></default></default><worldbody><body childclass="a"><freejoint/>
        <geom/><geom class="b"/><body childclass="b"><joint/><geom size=".1" friction=".5 .1"/></body></body></worldbody>""",
    "planes": '<worldbody><geom type="plane" size="0 0 1"/><geom type="plane" size="1 2 .05"/></worldbody>',
    "meshes out of order": f"""<asset><mesh name="z" vertex="{CUBE}"/><mesh name="a" vertex="{CUBE}" scale="1 2 3"/></asset>
        <worldbody><geom type="mesh" mesh="a"/><geom type="mesh" mesh="z"/><geom type="box" mesh="z"/></worldbody>""",
    "meshes in order": f"""<asset><mesh name="a" vertex="{CUBE}" inertia="exact"/><mesh name="b" vertex="{CUBE}"/>
        <mesh name="c" vertex="{CUBE}" scale="1 2 3"/></asset>
        <worldbody><geom type="mesh" mesh="c"/><geom type="mesh" mesh="a"/></worldbody>""",
    "a height field": """<asset><hfield name="h" nrow="2" ncol="2" size="1 1 1 1" elevation="0 1 2 3"/></asset>
        <worldbody><geom type="hfield" hfield="h"/></worldbody>""",
    "materials": """<asset><texture name="t" type="2d" builtin="checker" width="8" height="8" rgb1="1 0 0" rgb2="0 1 0"/>
        <texture type="skybox" builtin="flat" width="4" height="4"/><material name="m" texture="t" texrepeat="3 3" specular=".1"/>
        <material name="l"><layer role="rgb" texture="t"/><layer role="normal" texture="t"/></material></asset>
        <worldbody><geom size=".1" material="m"/><geom size=".1" material="l"/></worldbody>""",
    "mocap, gravity and users": f"""<size nuser_body="2"/><worldbody>{BODY.format("")}<body name="m" mocap="true" gravcomp="1"/>
        <body user="1 2" gravcomp=".5"/></worldbody><keyframe><key name="k" qpos="0 0 1 1 0 0 0" mpos="1 2 3"/></keyframe>""",
    "closures": f"""<worldbody>{BODY.format('<site name="s"/>')}
        <body name="c" pos="1 0 0"><freejoint/><geom size=".1"/><site name="t"/></body></worldbody>
        <equality><weld body1="b" body2="c" relpose="1 2 3 1 1 0 0" torquescale="2"/><connect body1="b" anchor="1 2 3"/>
        <weld body1="b" body2="c"/><connect name="n" body1="c" body2="b" anchor=".1 .2 .3" active="false" solref=".1 1"/>
        <weld site1="s" site2="t"/></equality>""",
    "couplings": """<worldbody><body><joint name="x" ref="10" type="slide"/><joint name="r" ref="30"/><geom size=".1"/>
        <body><joint name="j"/><geom size=".1"/></body></body></worldbody><equality><joint joint1="x" joint2="r" polycoef=".1 .2 .3"/>
        <joint joint1="j" polycoef=".5"/><joint joint1="r" joint2="j"/></equality>""",
    "tendons": """<worldbody><site name="s"/><geom name="w" type="cylinder" size=".1 1" pos="1 0 0"/><body name="b" pos="2 0 0">
        <joint name="j"/><joint name="k" axis="1 0 0"/><geom size=".1"/><site name="t"/><site name="side" pos="0 1 0"/></body></worldbody>
        <tendon><spatial name="a" range="0 3" width=".01"><site site="s"/><geom geom="w" sidesite="side"/><site site="t"/>
        <pulley divisor="2"/><site site="s"/><site site="t"/></spatial><fixed stiffness="2"><joint joint="j" coef=".3"/>
        <joint joint="k" coef="-1"/></fixed></tendon><equality><tendon tendon1="a"/></equality>
        <actuator><motor tendon="a" gear="3"/></actuator>""",
    "actuators": """<default><position kp="7"/><default class="c"><motor gear="5" ctrlrange="-2 2"/></default></default>
        <worldbody><body><joint name="j"/><joint name="k" axis="1 0 0" range="-1 1"/><geom size=".1"/><site name="s"/></body>
        <site name="r"/></worldbody><actuator><motor class="c" joint="j"/><position joint="k" kv="2" inheritrange="1"/>
        <general name="g" jointinparent="j" dyntype="filter" dynprm=".1" gainprm="3" biastype="affine" biasprm="1 2 3"/>
        <velocity site="s" refsite="r" gear="0 0 1 0 0 0"/><muscle joint="j" lengthrange="0 1"/><damper joint="j" kv="2" ctrlrange="0 1"/>
        <motor name="touch" cranksite="s" slidersite="r" cranklength=".3"/></actuator>""",
    "sensors": f"""<worldbody>{BODY.format('<site name="s"/><camera name="c"/>')}<body><joint name="j"/><geom name="h" size=".1"/></body>
        </worldbody><sensor><accelerometer site="s" noise=".1"/><jointpos name="accelerometer" joint="j"/>
        <framepos objtype="xbody" objname="b" reftype="site" refname="s"/><framequat objtype="geom" objname="g"/><clock/>
        <subtreecom body="b"/><distance geom1="g" geom2="h" cutoff="1"/><contact geom1="g" data="found dist"/><user dim="2"/></sensor>""",
    "contacts": f"""<worldbody>{BODY.format("")}<body name="c"><freejoint/><geom name="h" size=".1"/></body></worldbody>
        <contact><pair geom1="g" geom2="h" condim="1" friction="1 2 .1 .2 .3"/><exclude body1="b" body2="c"/></contact>""",
    "what only MuJoCo knows": """<option timestep=".003"><flag gravity="disable"/></option><visual><map znear=".1"/></visual>
        <statistic extent="3"/><custom><numeric name="n" data="1 2"/><text name="t" data="a &lt; b"/></custom>
        <worldbody><body><joint solreflimit=".1 .2" margin=".1" group="2"/><geom size=".1" condim="4" solref=".1 1" priority="2"/></body>
        </worldbody>""",
    "lights and cameras": """<worldbody><light dir="1 2 -3" pos="1 0 0" directional="true"/><light type="point" diffuse=".1 .2 .3"/>
        <camera fovy="33" mode="targetbody" target="b"/><camera resolution="10 20" focal=".1 .2" sensorsize=".1 .2"/><body name="b"/>
        </worldbody>""",
}


@pytest.mark.parametrize("content", [pytest.param(text, id=name) for name, text in ROBOTS.items()])
def test_the_model_is_the_same_bit_for_bit(content: str) -> None:
    text = f'<mujoco model="robot">{content}</mujoco>'
    robot = read_text(text)
    assert differences(compiled(text), compiled(write(robot))) == []


@pytest.mark.parametrize("content", [pytest.param(text, id=name) for name, text in ROBOTS.items()])
def test_what_is_written_is_read_as_the_same_mechanism(content: str) -> None:
    robot = read_text(f'<mujoco model="robot">{content}</mujoco>')
    assert list(diff(robot, read_text(write(robot)))) == []


@pytest.mark.parametrize("content", [pytest.param(text, id=name) for name, text in ROBOTS.items()])
def test_hymeko_text_loses_nothing_of_it(content: str) -> None:
    text = f'<mujoco model="robot">{content}</mujoco>'
    robot = read_text(text)
    back = through_hymeko(robot)
    assert list(diff(robot, back)) == []
    assert write(back) == write(robot)


def test_degrees_and_notations_are_written_as_they_were() -> None:
    geom = '<geom name="g" type="capsule" size="0.1" fromto="0 0 0 1 0 0"/>'
    body = f'<body name="b" euler="12.3 45 -7"><joint name="j" range="-33.3 77.7"/>{geom}</body>'
    written = write(read_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>"))
    for attribute in ('euler="12.3 45 -7"', 'range="-33.3 77.7"', 'fromto="0 0 0 1 0 0"'):
        assert attribute in written


def test_what_a_class_gives_is_not_written_again() -> None:
    head = '<default><default class="c"><joint damping="2" range="-90 90"/></default></default>'
    written = write(read_text(f'<mujoco>{head}<worldbody><body><joint name="j" class="c"/><geom size=".1"/></body></worldbody></mujoco>'))
    assert '<joint name="j" class="c"/>' in written


@pytest.mark.robots("mjcf", every=5)
@pytest.mark.slow
def test_real_models_are_the_same_bit_for_bit(robot: Path) -> None:
    original = mujoco.MjModel.from_xml_path(str(robot))
    mechanism = read(robot)
    assert differences(original, compiled(write(mechanism), robot.parent)) == []
    back = through_hymeko(mechanism)
    assert list(diff(mechanism, back)) == []
    assert write(back) == write(mechanism)


@pytest.mark.robots("mjcf")
def test_no_rule_touches_what_came_from_mjcf(robot: Path) -> None:
    report = Report()
    mechanism = read(robot)
    assert legalize(mechanism, "mjcf", report) == mechanism
    assert list(report) == []


def test_inertias_that_mujoco_is_told_to_mend_stay() -> None:
    inertial = '<body><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 9"/></body>'
    robot = read_text(f'<mujoco><compiler balanceinertia="true"/><worldbody>{inertial}</worldbody></mujoco>')
    assert 'diaginertia="1 1 9"' in write(legalize(robot, "mjcf", Report()))


# ---- files that are large or deep ---------------------------------------------------------------------------------------------


def test_ten_thousand_nested_bodies_are_read_and_written() -> None:
    count = 10_000
    bodies = '<body pos="0 0 1"><joint/><geom size=".1"/>' * count + "</body>" * count
    robot = read_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    assert len(robot.joints) == count
    assert write(robot).count("<body ") == count


def test_included_files_are_read_in_place_and_only_once(tmp_path: Path) -> None:
    (tmp_path / "part.xml").write_text('<mujocoinclude><geom name="g" size=".1"/></mujocoinclude>')
    main = tmp_path / "main.xml"
    main.write_text('<mujoco><worldbody><body name="b"><include file="part.xml"/></body></worldbody></mujoco>')
    assert differences(mujoco.MjModel.from_xml_path(str(main)), compiled(write(read(main)))) == []
    main.write_text('<mujoco><worldbody><include file="part.xml"/>\n<include file="part.xml"/></worldbody></mujoco>')
    with pytest.raises(Refusal, match=r"main.xml:2: error\[HX047\]: the file 'part.xml' is included twice; the first time in main.xml:1"):
        read(main)


def test_replicate_is_expanded_by_mujoco_with_a_note() -> None:
    text = '<mujoco><worldbody><replicate count="3" offset="1 0 0"><body name="b"><geom size=".1"/></body></replicate></worldbody></mujoco>'
    report = Report()
    robot = read_text(text, report)
    assert [key.name for key, _ in robot.vertices(Body)] == ["b0", "b1", "b2"]
    assert [diagnostic.message for diagnostic in report] == ["<replicate> was expanded by MuJoCo; what it became has its line"]
    assert differences(compiled(text), compiled(write(robot))) == []


def test_a_tensor_whose_author_wrote_products_in_axes_of_their_own_is_written_whole() -> None:
    text = '<mujoco><worldbody><body name="b"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>'
    robot, key = read_text(text), Id("body", "b")
    frame, tensor = pose(quat=quat_about(Z, 0.5)), (1.0, 1.25, 1.5, 0.125, 0.0, 0.0)
    inertial = Inertial(1.0, (0.0, 0.0, 0.0), rotate_tensor(frame.quat, tensor), InertialWritten(frame, tensor))
    edited = robot.replace(vertices={key: Body(inertial)})
    assert read_text(write(edited)).vertex(key, Body).inertial == inertial
