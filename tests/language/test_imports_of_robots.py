"""Robots of other files as parts of a text: named, placed, joined, changed, in arrays, and written as any format."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.cli import main
from tests.robot.robots import ARM, HAND, URDF_HAND

XACRO_LINK = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="bar"><xacro:arg name="mass" default="1"/>
<link name="rod"><inertial><mass value="$(arg mass)"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""
CUBE = "\n".join(f"v {x} {y} {z}" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + "\nf 1 2 3\nf 4 5 6\nf 5 6 7\nf 1 3 7\n"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a few robots."""
    monkeypatch.chdir(tmp_path)
    files = {"arm.xml": ARM, "hand.xml": HAND, "claw.urdf": URDF_HAND, "bar.xacro": XACRO_LINK}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def read(path: str) -> hx.Robot:
    return hx.load(path)


def load(here: Path, text: str) -> hx.Robot:
    (here / "scene.hymeko").write_text(text)
    return read("scene.hymeko")


def refusal(here: Path, text: str, capsys: pytest.CaptureFixture[str]) -> str:
    (here / "scene.hymeko").write_text(text)
    assert main(["info", "scene.hymeko"]) == 1
    return capsys.readouterr().err


def test_an_instance_on_a_frame_is_what_attach_makes(here: Path) -> None:
    text = 'import "arm.xml" as arm import "hand.xml" as hand r : robot { a : arm {} h : hand { [[0 0 0.05] [5 10 15]] + a.flange } }'
    ours = load(here, text)
    pose = hx.Pose.from_rpy(np.radians([5, 10, 15]), (0, 0, 0.05))
    theirs = read("arm.xml").attach(read("hand.xml"), at="flange", prefix="h_", pose=pose)
    assert ours.mass == pytest.approx(theirs.mass, abs=1e-12)
    q = {"shoulder": 0.3, "elbow": -0.2}
    expected = theirs.fk(q)
    for name, found in ours.fk({f"a_{joint}": value for joint, value in q.items()}).items():
        known = expected.get(name.removeprefix("a_")) or expected[name]
        assert np.allclose(found.matrix(), known.matrix(), atol=1e-12)


def test_the_place_of_an_instance_may_be_a_field(here: Path) -> None:
    text = """import "arm.xml" as arm import "hand.xml" as hand
    r : robot {{ a : arm {{}} h : hand {{ {} }} spot {{ mass 1 }} other : hand {{ {} }} }}"""
    ours, theirs = load(here, text.format("at=a.flange", "at=spot")), load(here, text.format("+ a.flange", "+ spot"))
    assert ours == theirs
    assert ours.bodies["h_palm"].parent == ours.bodies["a_fore"]


def test_robots_of_mjcf_keep_what_only_mujoco_knows(here: Path) -> None:
    text = 'import "arm.xml" as arm import "hand.xml" as hand r : robot { a : arm {} h : hand { [0 0 0] + a.flange } }'
    ours = load(here, text).to_mujoco()
    spec, child, whole = mujoco.MjSpec.from_string(ARM), mujoco.MjSpec.from_string(HAND), mujoco.MjSpec()
    spec.attach(child, site=spec.site("flange"), prefix="hand/")
    whole.compiler.degree = False
    whole.attach(spec, frame=whole.worldbody.add_frame(), prefix="a_")
    model = whole.compile()
    compared = 0
    for name in dir(model):
        mine, known = getattr(ours, name), getattr(model, name)
        if isinstance(known, np.ndarray) and not name.startswith(("_", "name", "path", "key")) and "texid" not in name:
            assert mine.shape == known.shape, name
            assert np.allclose(mine, known, atol=1e-12, rtol=1e-12), name
            compared += 1
    assert compared > 300
    assert ours.key("a_home").qpos[:2] == pytest.approx([0.1, 0.2])


def test_a_joint_of_the_text_leads_to_the_root_of_an_instance(here: Path) -> None:
    free = HAND.replace('<body name="palm">', '<body name="palm" pos="0 0 0.5"><freejoint/>')
    (here / "free.xml").write_text(free)
    text = """import "arm.xml" as arm import "free.xml" as hand
    r : robot { a : arm {} @wrist : revolute { [0 0 0.1] + a.fore - tool axis=X limit [-90 90] } tool : hand {} }"""
    robot = load(here, text)
    assert robot.joints["wrist"].parent.name == "a_fore"
    assert [name for name, joint in robot.joints.items() if joint.type == "free"] == []
    poses = robot.fk({"wrist": 0.5})
    turned = hx.Pose.from_rpy((0.5, 0, 0), (0, 0, 0.1))
    at_palm = poses["a_fore"] @ turned @ hx.Pose((0, 0, 0.5))
    assert np.allclose(poses["tool_palm"].matrix(), at_palm.matrix(), atol=1e-12)


@pytest.mark.parametrize("place", ["at [[5 0 0] [0 0 90]]", "[[5 0 0] [0 0 90]] + world"])
def test_what_floats_in_its_own_file_floats_in_the_world_of_the_text(here: Path, place: str) -> None:
    drone = """<mujoco model="drone"><worldbody><body name="hull" pos="0 0 1"><freejoint name="fly"/><geom size=".1"/></body></worldbody>
      <keyframe><key name="up" qpos="1 0 2 1 0 0 0"/></keyframe></mujoco>"""
    (here / "drone.xml").write_text(drone)
    robot = load(here, f'import "arm.xml" as arm import "drone.xml" as drone air : robot {{ arm : arm {{}} d : drone {{ {place} }} }}')
    pose = hx.Pose.from_rpy((0, 0, 90 * hx.deg), (5, 0, 0))
    composed = hx.compose((hx.load(here / "arm.xml"), hx.load(here / "drone.xml")), ((0, 0, 0), pose), name="air")
    ours, theirs = robot.to_mujoco(), composed.to_mujoco()
    assert (robot.joints["d_fly"].type, ours.nq) == ("free", theirs.nq)
    assert ours.qpos0.tolist() == theirs.qpos0.tolist()
    assert ours.key("d_up").qpos.tolist() == theirs.key("drone/up").qpos.tolist()
    assert ours.key("d_up").qpos[2:5] == pytest.approx([5, 1, 2])
    fixed = load(here, 'import "arm.xml" as arm import "drone.xml" as drone air : robot { a : arm {} d : drone { + a.flange } }')
    assert fixed.joints["d_fly"].type == "fixed"


def test_elements_of_an_instance_change_from_inside_and_outside(here: Path) -> None:
    robot = load(
        here,
        """import "claw.urdf" as claw
        r : robot { left : claw { at [0 1 0] palm { mass 0.7 visual { sphere 0.1 } } } right : claw { at [0 -1 0] }
          @right.close { limit [-10 10] damping 2 axis=Y } right.finger { com [0 0 1mm] urdf { foo 1 } } }""",
    )
    assert (robot.bodies["left_palm"].mass, robot.bodies["right_palm"].mass) == (0.7, 0.5)
    assert len(robot.bodies["left_palm"].shapes) == 3
    joint = robot.joints["right_close"]
    assert (joint.limits.lower, joint.limits.upper, joint.limits.effort) == (np.radians(-10), np.radians(10), 5)
    assert (joint.damping, joint.axis) == (2, (0, 1, 0))
    assert robot.joints["left_close"].damping == 0
    assert robot.bodies["right_finger"].com == (0, 0, 0.001)
    assert 'foo="1"' in hx.dumps(robot.mechanism, "urdf")


def test_elements_of_assemblies_change_in_the_same_way() -> None:
    leg = "leg() : assembly { foot { mass 1 } toe { mass 2 } @ankle { + foot - toe damping 1 } }"
    robot = hx.loads(f"r : robot {{ {leg} a : leg {{}} b : leg {{}} a.foot {{ mass 3 }} @b.ankle {{ damping 4 }} }}", "hymeko")
    assert [body.mass for body in robot.bodies.values()] == [3, 2, 1, 2]
    assert [joint.damping for joint in robot.joints.values()] == [1, 4]


def test_arrays_number_their_elements(here: Path) -> None:
    robot = load(
        here,
        """import "claw.urdf" as claw
        r : robot { pad(size) : link { mass ${size} } base {} n() : assembly { foot [2] : link { mass ${i+1} } }
          row [3] : pad(size=${2*i+1}) {} @arm [3] : fixed { [${i} 0 0] + base - `row_${i}` }
          hand [2] : claw { [0 ${i} 0] + base } m : n {} }""",
    )
    assert [robot.bodies[f"row_{number}"].mass for number in range(3)] == [1, 3, 5]
    assert robot.bodies["hand_1_palm"].world_pose().xyz == (0, 1, 0)
    assert robot.bodies["m_foot_1"].mass == 2


def test_arguments_go_to_formats_that_take_them(here: Path) -> None:
    robot = load(here, 'import "bar.xacro" as bar r : robot { a : bar(mass=3) { at [0 0 0] } b : bar { at [1 0 0] } }')
    assert (robot.bodies["a_rod"].mass, robot.bodies["b_rod"].mass) == (3, 1)


def test_meshes_are_found_from_the_file_that_imports(here: Path) -> None:
    folder = here / "far" / "pkg"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>far_away</name></package>")
    (folder / "cube.obj").write_text(CUBE)
    visual = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
    for name, uri in (("a", "cube.obj"), ("b", "package://far_away/cube.obj")):
        (folder / f"{name}.urdf").write_text(f'<robot name="r"><link name="l">{visual.format(uri)}</link></robot>')
    (here / "scene.hymeko").write_text(
        'import "far/pkg/a.urdf" as a import "far/pkg/b.urdf" as b r : robot { x : a { at [0 0 0] } y : b { at [0 0 1] } }'
    )
    assert main(["convert", "scene.hymeko", "out/scene.xml"]) == 1, "there is no folder yet"
    (here / "out").mkdir()
    assert main(["convert", "scene.hymeko", "out/scene.xml"]) == 0
    assert mujoco.MjModel.from_xml_path("out/scene.xml").nmesh == 2
    assert main(["verify", "scene.hymeko", "out/scene.xml"]) == 0


def test_the_station_of_the_reference_has_two_arms_with_hands(here: Path) -> None:
    page = (Path(__file__).parents[2] / "docs/language.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"```text\n(import .*?)```", page, re.DOTALL)
    robot = load(here, text)
    assert robot.dofs == 2 * (2 + 2) + 1
    assert robot.bodies["right_fore"].mass == 0.8
    assert robot.bodies["right_hand_palm"].parent == robot.bodies["right_fore"]
    assert robot.bodies["post_3"].world_pose().xyz == pytest.approx((-0.55, -0.35, 0.375))
    model = robot.to_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 20)
    assert np.isfinite(data.qpos).all()


@pytest.mark.parametrize("suffix", ["urdf", "xml", "usda", "sdf", "hymeko"])
def test_a_text_that_imports_is_verified_against_what_it_becomes(here: Path, suffix: str) -> None:
    (here / "scene.hymeko").write_text("""import "arm.xml" as arm import "claw.urdf" as claw
    r : robot { table { mass 9 shape { box [1 1 0.1] } } @stand : fixed { + world - table }
      a : arm { [0 0 0.1] + table } c : claw { + a.flange } other : arm { at [2 0 0] } }""")
    assert main(["convert", "scene.hymeko", f"out.{suffix}"]) == 0
    words = ["verify", "scene.hymeko", f"out.{suffix}"]
    verdict = main(words) if suffix not in ("xml", "sdf") else 0
    assert verdict == 0
    whole, parts = read(f"out.{suffix}"), [read("arm.xml"), read("arm.xml"), read("claw.urdf")]
    assert whole.mass == pytest.approx(9 + sum(part.mass for part in parts), abs=1e-9)


def test_a_printed_robot_stands_inside_another_one(here: Path) -> None:
    hx.dump(hx.load("arm.xml"), "arm.hymeko")
    text = 'import "{}" as arm r : robot {{ a : arm {{}} }}'
    assert load(here, text.format("arm.hymeko")) == load(here, text.format("arm.xml"))


REFUSED = {
    'import "none.urdf" as a r : robot { x : a {} }': "error[HX040]: the imported file 'none.urdf' was not found",
    'import "claw.urdf" r : robot { }': "error[HX063]: the robot in 'claw.urdf' is imported without a name for it",
    'import "claw.urdf" as c r : robot { x : c(n=1) {} }': "error[HX063]: the robot in 'claw.urdf' is urdf, which takes no arguments",
    'import "claw.urdf" as c r : robot { x : c, link {} }': "error[HX063]: 'x' is the robot 'c' and cannot have other types",
    'import "claw.urdf" as c r : robot { x : c { mass 1 } }': "error[HX062]: 'mass' has no meaning in the block of the robot 'x'",
    'import "claw.urdf" as c r : robot { x : c { at [0 0 1] + world } }': "error[HX062]: 'x' is placed 2 times",
    'import "claw.urdf" as c r : robot { x : c { at=x.palm } }': "error[HX062]: 'x' is placed on itself: on body 'x_palm'",
    'import "claw.urdf" as c r : robot { x : c { + x.finger } }': "error[HX062]: 'x' is placed on itself: on body 'x_finger'",
    'import "claw.urdf" as c r : robot { x : c { at=x.close } }': "error[HX040]: 'x.close' is a joint; expected a body or world or frame",
    'import "claw.urdf" as c r : robot { x : c {} x.plam { mass 1 } }': "error[HX040]: 'x.plam' is changed, and there is no such element",
    'import "claw.urdf" as c r : robot { x : c {} x.palm { size 1 } }': "error[HX062]: 'size' of body 'x_palm' cannot be changed here",
    'import "claw.urdf" as c r : robot { x : c {} @x.close { - x.palm } }': "error[HX062]: 'an arc' of joint 'x_close' cannot be changed",
    'import "claw.urdf" as c r : robot { x : c {} x : c {} }': "error[HX023]: body 'x_palm' is defined twice",
    'import "scene.hymeko" as c r : robot { x : c {} }': "error[HX063]: the import of 'scene.hymeko' leads back to itself",
    'import "two.urdf" as t r : robot { x : t {} b {} @j { + b - x } }': "error[HX045]: the robot 'x' has 2 roots, and one was expected",
    "r : robot { a [2.5] : link {} }": "error[HX063]: the size of the array 'a' is one whole number in brackets",
    "r : robot { a [1e9] : link {} }": "error[HX007]: the templates make more than 500020 items",
}


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: text[:60])
def test_what_cannot_be_is_refused(here: Path, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "two.urdf").write_text('<robot name="t"><link name="a"/><link name="b"/></robot>')
    if "two.urdf" in text:
        (here / "two.hymeko").write_text("t : robot { a {} b {} }")
        text = text.replace("two.urdf", "two.hymeko")
    assert REFUSED[text.replace("two.hymeko", "two.urdf")] in refusal(here, text, capsys)
