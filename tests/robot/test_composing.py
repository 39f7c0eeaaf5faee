"""Robots from robots: one on another, taken apart again, as part of a scene."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.ir.parts import Dof, DofKind, Joint
from tests.robot.robots import ARM, HAND, arm, check_same_model, claw, hand

PARTS = {"mjcf": hand, "urdf": claw}


@pytest.mark.parametrize("host", [arm, claw], ids=["mjcf", "urdf"])
@pytest.mark.parametrize("part", [hand, claw], ids=["mjcf", "urdf"])
def test_a_part_is_on_the_host_with_its_mass_and_its_kinematics(host, part) -> None:  # type: ignore[no-untyped-def]
    at = "flange" if host is arm else "finger"
    pose = hx.Pose.from_rpy((0.1, 0.2, 0.3), (0, 0, 0.05))
    whole = host().attach(part(), at=at, prefix="hand/", pose=pose)
    assert whole.mass == pytest.approx(host().mass + part().mass, abs=1e-12)
    q = {name: 0.1 + 0.01 * number for number, (name, joint) in enumerate(whole.joints.items()) if joint.dofs}
    own = {name.removeprefix("hand/"): value for name, value in q.items() if name.startswith("hand/")}
    alone = part().fk(own)
    poses = whole.fk(q)
    mount = (whole.frames[at] if host is arm else whole.bodies[at]).world_pose(q) @ pose
    for name, found in alone.items():
        assert np.allclose(poses[f"hand/{name}"].matrix(), (mount @ found).matrix(), atol=1e-12)
    model = whole.to_mujoco()
    data = mujoco.MjData(model)
    for name, value in q.items():
        data.joint(name).qpos[:] = value
    mujoco.mj_kinematics(model, data)
    for name, found in poses.items():
        assert data.body(name).xpos == pytest.approx(found.xyz, abs=1e-12)
    assert whole.to_pinocchio().existBodyName("hand/palm")
    assert whole.to_usd().GetDefaultPrim()


def test_within_mjcf_the_model_is_the_one_that_mujoco_attaches() -> None:
    whole = arm().attach(hand(), at="flange", prefix="hand/").to_mujoco()
    spec, child = mujoco.MjSpec.from_string(ARM), mujoco.MjSpec.from_string(HAND)
    spec.attach(child, site=spec.site("flange"), prefix="hand/")
    model = spec.compile()
    check_same_model(whole, model)
    assert whole.names == model.names


def test_keyframes_of_both_fit_the_whole() -> None:
    with_key = HAND.replace("</mujoco>", "<keyframe><key name='open' qpos='0.01 0.02' ctrl='3'/></keyframe></mujoco>")
    model = arm().attach(hx.loads(with_key, "mjcf"), at="flange", prefix="hand/").to_mujoco()
    assert (model.key("home").qpos.tolist(), model.key("home").ctrl.tolist()) == ([0.1, 0.2, 0, 0], [0.1, 0, 0])
    assert (model.key("hand/open").qpos.tolist(), model.key("hand/open").ctrl.tolist()) == ([0, 0, 0.01, 0.02], [0, 0, 3])


def test_a_joint_between_the_two_moves_the_part() -> None:
    whole = arm().attach(hand(), at="flange", prefix="hand/", joint=Joint((Dof(DofKind.SLIDE, (0, 0, 1)),)))
    assert whole.joints["hand/palm"].type == "slide"
    assert whole.fk({"hand/palm": 0.1})["hand/palm"].xyz[2] == pytest.approx(whole.fk()["hand/palm"].xyz[2] + 0.1)
    with pytest.raises(hx.EditError, match="there is no type 'hing'"):
        arm().attach(hand(), at="flange", prefix="hand/", joint="hing")


def test_clashing_names_and_unknown_frames_are_errors() -> None:
    with pytest.raises(hx.EditError, match="material 'steel' is in robot 'arm' and in robot 'hand'; give a prefix"):
        arm().attach(hand(), at="flange")
    with pytest.raises(KeyError, match="there is no body or frame 'flang'; did you mean 'flange'?"):
        arm().attach(hand(), at="flang", prefix="hand/")


@pytest.mark.unread("HX104")
def test_what_was_attached_comes_off_as_it_was() -> None:
    rest, back = claw().attach(claw(), at="finger", prefix="hand/", pose=hx.Pose.from_rpy((1, 2, 3), (0.1, 0.2, 0.3))).detach("hand/")
    assert (hx.diff(rest, claw()), hx.diff(back, claw())) == ((), ())
    rest, back = arm().attach(hand(), at="flange", prefix="hand/").detach("hand/")
    for ours, theirs in ((rest, arm()), (back, hand())):
        assert hx.verify(ours, theirs, samples=5).verdict == "same"
        assert ours.to_mujoco().geom_solref.tolist() == theirs.to_mujoco().geom_solref.tolist()


def test_attaching_is_associative() -> None:
    one = claw().attach(claw(), at="finger", prefix="b/").attach(claw(), at="b/finger", prefix="b/c/")
    other = claw().attach(claw().attach(claw(), at="finger", prefix="c/"), at="finger", prefix="b/")
    assert hx.diff(one, other) == ()


@pytest.mark.unread("HX104")
def test_a_subtree_and_the_rest_are_the_whole() -> None:
    robot = arm()
    part = robot.subtree("fore")
    rest, off = robot.detach("fore")
    assert hx.diff(part, off) == ()
    assert [*part.bodies] == ["fore"]
    assert [*rest.bodies] == ["base", "upper"]
    assert part.mass + rest.mass == pytest.approx(robot.mass)
    assert ([*part.frames], [*rest.frames], [*rest.actuators]) == (["flange"], [], ["turn"])
    assert part.to_mujoco().nbody == 2
    with pytest.raises(KeyError, match="there is no body or prefix 'foree'; did you mean 'fore'"):
        robot.detach("foree")


def test_a_scene_comes_apart_into_its_robots() -> None:
    scene = hx.compose((arm(), claw()), ((0, 0, 0), (0.5, 0, 1)), name="table")
    parts = scene.split()
    assert [[*part.bodies] for part in parts] == [["arm/base", "arm/upper", "arm/fore"], ["claw/palm", "claw/finger"]]
    assert sum(part.mass for part in parts) == pytest.approx(scene.mass)
    whole = scene.fk()
    for part in parts:
        assert {name: pose.xyz for name, pose in part.fk().items()} == {name: whole[name].xyz for name in part.bodies}
        assert [*part.split()[0].bodies] == [*part.bodies]
    assert parts[0].to_mujoco().nq == arm().to_mujoco().nq


def test_a_scene_has_all_robots_at_their_poses() -> None:
    scene = hx.compose((arm(), arm(), claw()), ((0, 0, 0), hx.Pose.from_rpy((0, 0, 180 * hx.deg), (1, 0, 0)), (0.5, 0, 1)), name="table")
    assert [*scene.bodies] == [
        *("arm/base", "arm/upper", "arm/fore", "arm#2/base", "arm#2/upper", "arm#2/fore"),
        *("claw/palm", "claw/finger"),
    ]
    assert scene.bodies["arm#2/base"].world_pose().xyz == pytest.approx((1, 0, 0.1))
    assert scene.bodies["claw/palm"].world_pose().xyz == (0.5, 0, 1)
    assert scene.to_mujoco().nq == 5
    with pytest.raises(hx.EditError, match="scene 'scene' has 1 robots and 2 poses"):
        hx.compose((arm(),), ((0, 0, 0), (0, 0, 0)))


def test_meshes_of_several_folders_are_found(tmp_path) -> None:  # type: ignore[no-untyped-def]
    box = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    for name, height in (("arm", 1), ("hand", 2)):
        (tmp_path / name / "meshes").mkdir(parents=True)
        (tmp_path / name / "meshes/part.obj").write_text(box.format(height))
        (tmp_path / name / f"{name}.urdf").write_text(
            f"<robot name='{name}'><link name='{name}'><visual><geometry><mesh filename='meshes/part.obj'/></geometry></visual></link>"
            "</robot>"
        )
    (tmp_path / "out").mkdir()
    whole = hx.load(tmp_path / "arm/arm.urdf").attach(hx.load(tmp_path / "hand/hand.urdf"), at="arm", prefix="hand/")
    report = hx.dump(whole, tmp_path / "out/both.xml")
    assert [str(line) for line in report if "not found" in line.message] == []
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out/both.xml"))
    assert (model.nmesh, model.ngeom) == (2, 2)
    hx.dump(whole, tmp_path / "out/both.hymeko")
    again = hx.load(tmp_path / "out/both.hymeko")
    assert again.to_mujoco().nmesh == 2


def test_meshes_of_equal_file_names_are_handed_over_in_memory(tmp_path) -> None:  # type: ignore[no-untyped-def]
    text = """<mujoco model="{0}"><asset><mesh name="part" file="part.obj"/></asset>
      <worldbody><body name="x"><geom type="mesh" mesh="part"/></body></worldbody></mujoco>"""
    for name, height in (("a", 1), ("b", 2)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "part.obj").write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 {height}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
        (tmp_path / name / "robot.xml").write_text(text.format(name))
    a, b = hx.load(tmp_path / "a/robot.xml"), hx.load(tmp_path / "b/robot.xml")
    whole = a.attach(b, at="x", prefix="p/")
    (tmp_path / "out").mkdir()
    hx.dump(whole, tmp_path / "out/robot.xml")
    for robot in (whole, hx.load(tmp_path / "out/robot.xml")):
        assert robot.to_mujoco().body("p/x").mass == pytest.approx(b.to_mujoco().body("x").mass)
    assert b.mass == pytest.approx(2 * a.mass)


def test_soft_bodies_come_along_with_all_their_names() -> None:
    soft = """<mujoco model="soft"><worldbody><flexcomp name="cloth" type="grid" dim="2" count="3 3 1" spacing=".1 .1 .1" mass="1"
      radius=".01"><edge equality="true"/></flexcomp></worldbody></mujoco>"""
    with arm().edit() as e:
        e.add_frame("place", on="world")
    spec, child = mujoco.MjSpec.from_string(ARM), mujoco.MjSpec.from_string(soft)
    spec.worldbody.add_site(name="place")
    spec.attach(child, site=spec.site("place"), prefix="s/")
    check_same_model(e.robot.attach(hx.loads(soft, "mjcf"), at="place", prefix="s/").to_mujoco(), spec.compile())


def test_sensors_of_a_hand_in_mjcf_come_along_on_an_arm_in_another_format() -> None:
    sensors = """<sensor><force name="f" site="tip"/><jointpos name="p" joint="left"/><tendonpos name="t" tendon="split"/>
      <actuatorfrc name="a" actuator="grip"/>
      <framepos name="o" objtype="site" objname="tip" reftype="body" refname="left"/></sensor></mujoco>"""
    text = HAND.replace("</mujoco>", sensors).replace('<geom name="block"', '<site name="tip"/><geom name="block"')
    with claw().attach(hx.loads(text, "mjcf"), at="finger", prefix="h/").edit() as e:
        e.add_sensor("own", "jointpos", of=e.joints["close"])
        e.add_sensor("other", "force_torque", of=e.joints["close"])
    model = e.robot.to_mujoco()
    assert [model.sensor(number).name for number in range(model.nsensor)] == ["h/f", "h/p", "h/t", "h/a", "h/o", "own"]
    assert model.joint(model.sensor("own").objid[0]).name == "close"
    assert model.site(model.sensor("h/f").objid[0]).name == "h/tip"


def test_a_hand_in_mjcf_keeps_its_contacts_on_an_arm_in_another_format() -> None:
    pads = hx.loads(
        """<mujoco><default><default class="pad"><geom condim="4" solref=".002 1" conaffinity="5"/></default></default><worldbody>
        <body name="palm" gravcomp="1"><joint name="close" solreflimit=".005 1"/>
        <geom name="pad" class="pad" type="box" size=".1 .1 .1" contype="6"/><site name="tip" group="3"/></body></worldbody></mujoco>""",
        "mjcf",
    )
    model = claw().attach(pads, at="finger", prefix="h/").to_mujoco()
    pad = model.geom("h/pad")
    assert (pad.contype, pad.conaffinity, pad.condim, pad.solref[0]) == (6, 5, 4, 0.002)
    assert model.jnt_solref[model.joint("h/close").id][0] == 0.005
    assert model.site("h/tip").group == 3
    assert model.body_gravcomp[model.body("h/palm").id] == 1


def test_what_floats_in_its_own_world_floats_in_a_scene() -> None:
    drone = """<mujoco model="drone"><worldbody><body name="hull" pos="0 0 1"><freejoint name="fly"/><geom size=".1"/></body></worldbody>
      <keyframe><key name="up" qpos="1 0 2 1 0 0 0"/></keyframe></mujoco>"""
    part = hx.loads(drone, "mjcf")
    scene = hx.compose((arm(), part), ((0, 0, 0), hx.Pose.from_rpy((0, 0, 90 * hx.deg), (5, 0, 0))), name="air")
    model = scene.to_mujoco()
    assert model.nq == 2 + 7
    assert model.body("drone/hull").pos == pytest.approx([5, 0, 1])
    assert model.key("drone/up").qpos[2:5] == pytest.approx([5, 1, 2])
    assert model.key("drone/up").qpos[5:] == pytest.approx([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    assert [robot.dofs for robot in scene.split()] == [2, 6]
    (_, back) = scene.detach("drone/")
    check_same_model(back.to_mujoco(), part.to_mujoco())
    assert arm().attach(part, at="flange", prefix="d/").to_mujoco().nq == 2
