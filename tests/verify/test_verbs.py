"""The verbs around the verifier: what they print, and how they end."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x import codes
from hymeko_x.cli import exits, main
from hymeko_x.diagnostics import Refusal
from hymeko_x.verify.checks import QUANTITIES
from hymeko_x.verify.verdict import Check
from tests.reporting.robots import biped
from tests.verify.robots import ARM_MJCF, ARM_URDF, RIG_MJCF

Write = Callable[[str, str], Path]


@pytest.fixture
def arm(written: Write) -> str:
    return str(written("urdf", ARM_URDF))


@pytest.fixture
def longer_arm(written: Write) -> str:
    return str(written("urdf", ARM_URDF.replace('xyz="0 0.03 0.3"', 'xyz="0 0.03 0.4"')))


# ---- verify ----------------------------------------------------------------------------------------------------------


def test_verify_prints_a_table_and_ends_with_0(arm: str, written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", arm, arm, "--samples", "5", "-v"]) == exits.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "same"
    assert lines[1].strip().startswith("urdfdom in Pinocchio ")
    assert all(line.startswith(("  ok   ", "  -    ", "  note: ")) for line in lines[3:-1])
    assert {"  -    loops", "  -    actuators", "  -    armature"} < {*lines}
    assert "\x1b" not in "".join(lines)


def test_verify_says_what_a_format_cannot_say(arm: str, written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    mjcf = str(written("mjcf", ARM_MJCF))
    assert main(["verify", arm, mjcf, "--samples", "5"]) == exits.DONE
    assert capsys.readouterr().out.splitlines() == [
        "same as far as mjcf can say",
        "  mjcf cannot say velocity limits: 6 (joint 'shoulder', joint 'elbow', ...)",
        "22 checks passed, 1 note; -v has the table",
    ]
    assert main(["verify", arm, mjcf, "--samples", "5", "--strict"]) == exits.DIFFERENT
    capsys.readouterr()
    assert main(["verify", arm, mjcf, "--samples", "5", "--json"]) == exits.DONE
    document = json.loads(capsys.readouterr().out)
    assert document["verdict"] == "same as far as mjcf can say"
    gap = {"format": "mjcf", "quantity": "velocity limits", "count": 6, "names": ["joint 'shoulder'", "joint 'elbow'"]}
    assert document["cannot_say"] == [gap]


def test_a_walker_without_its_loops_springs_and_motors_is_not_plainly_the_same(
    written: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = str(written("mjcf", biped())), str(tmp_path / "biped.urdf")
    assert main(["convert", source, target, "-q"]) == exits.DONE
    assert main(["verify", source, target, "--samples", "5"]) == exits.DONE
    assert capsys.readouterr().out.splitlines() == [
        "same as far as urdf can say",
        "  urdf cannot say loops: 4 ('left-rod', 'left-plantar', ...)",
        "  urdf cannot say armature: 10 (joint 'left-hip-roll', joint 'left-hip-yaw', ...)",
        "  urdf cannot say springs: 4 (joint 'left-spring', joint 'left-heel-spring', ...)",
        "  urdf cannot say actuators: 10 ('left-hip-roll', 'left-hip-yaw', ...)",
        "18 checks passed, 2 notes; -v has the table",
    ]


def test_what_nothing_can_be_compared_of_is_not_the_same(written: Write) -> None:
    nothing = written("mjcf", "<mujoco/>")
    assert hx.verify(nothing, nothing).verdict == "not comparable"


def test_every_quantity_of_a_check_is_in_the_list(written: Write, arm: str) -> None:
    for one, other in ((arm, written("mjcf", ARM_MJCF)), (written("mjcf", biped()), written("mjcf", biped()))):
        verdict = hx.verify(one, other, samples=2)
        assert [*dict.fromkeys(check.quantity for check in verdict.checks)] == [q for q in QUANTITIES if q not in verdict.nothing]


def test_a_quantity_of_which_nothing_was_compared_has_no_row(written: Write) -> None:
    path = written("urdf", '<robot name="r"><link name="a"/></robot>')
    compared = {"bodies", "joints", "base", "forward kinematics, position", "forward kinematics, rotation"}
    assert {check.quantity for check in hx.verify(path, path, samples=2).checks} == compared


def test_verify_ends_with_4_when_the_robots_differ(arm: str, longer_arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", arm, longer_arm, "--samples", "5"]) == exits.DIFFERENT
    out = capsys.readouterr().out
    assert out.startswith("different\n")
    assert out.splitlines()[1:] == [
        "  FAIL forward kinematics, position, body 'fore' in the zero pose, worst at body 'left':"
        " [0.0572523 0.0176056 0.395486] and [0.0790874 0.0139099 0.493003] m (0.1 m off, 1e-09 allowed)",
        "22 checks passed; -v has the table",
    ]


def test_a_check_that_failed_shows_both_values_with_their_unit(arm: str, written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    other = written("urdf", ARM_URDF.replace('effort="80"', 'effort="70"').replace('<mass value="2"/>', '<mass value="2.5"/>'))
    assert main(["verify", arm, str(other), "--samples", "5"]) == exits.DIFFERENT
    assert capsys.readouterr().out.splitlines() == [
        "different",
        "  FAIL effort limits, joint 'shoulder': [-80 80] and [-70 70] N m or N (10 N m or N off, 8e-08 allowed)",
        "  FAIL mass, body 'upper': 2 and 2.5 kg (0.5 kg off, 2e-09 allowed)",
        "  FAIL mass matrix, joint 'shoulder' at all lower limits: 0.00599 relative off, 1e-08 allowed",
        "  FAIL gravity torque, joint 'shoulder' in the zero pose: 0.829312 and 0.8536 N m or N (0.0243 N m or N off, 1.61e-09 allowed)",
        "19 checks passed; -v has the table",
    ]


def test_verify_prints_json_with_the_keys_of_the_contract(arm: str, longer_arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", arm, longer_arm, "--json", "--samples", "5"]) == exits.DIFFERENT
    document = json.loads(capsys.readouterr().out)
    assert document.keys() == {"verdict", "engines", "checks", "nothing_to_compare", "cannot_say", "not_compared"}
    assert document["verdict"] == "different"
    assert len(document["engines"]) == 2
    assert all(check.keys() == {"quantity", "unit", "worst", "at", "allowed", "passed", "values"} for check in document["checks"])
    assert [check["quantity"] for check in document["checks"] if not check["passed"]][:1] == ["forward kinematics, position"]


def test_verify_says_in_the_engines_words_why_it_cannot_compare(arm: str, written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    broken = written("mjcf", ARM_MJCF.replace('type="slide"', 'type="slyde"', 1))
    assert main(["verify", arm, str(broken)]) == exits.FAILED
    out = capsys.readouterr().out
    assert out.startswith(f"not comparable: MuJoCo refuses {broken.name}: ")
    assert "slyde" in out


def test_a_urdf_that_urdfdom_refuses_is_not_comparable(written: Write) -> None:
    broken = written("urdf", ARM_URDF.replace('<limit lower="-2" upper="2.5" effort="80" velocity="3"/>', ""))
    verdict = hx.verify(broken, broken)
    assert verdict.verdict == "not comparable"
    sentences = "Joint [shoulder] is of type REVOLUTE but it does not specify limits; joint xml is not initialized correctly"
    assert verdict.reason == f"urdfdom refuses {broken.name}: {sentences}"


@pytest.mark.unread("HX021")
def test_an_inertia_without_products_is_compared_although_urdfdom_reads_none_of_it(written: Write, tmp_path: Path) -> None:
    text = '<robot name="m"><link name="a"><inertial><mass value="1.2"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link></robot>'
    source, heavier = written("urdf", text), written("urdf", text.replace('izz="0.1"', 'izz="0.15"'))
    hx.convert(source, str(tmp_path / "a.sdf"))
    verdict = hx.verify(source, str(tmp_path / "a.sdf"))
    assert (verdict.verdict, [note for note in verdict.not_compared if "all six entries" in note] != []) == ("same", True)
    assert [check.quantity for check in hx.verify(source, heavier).failed] == ["inertia tensor"]


def test_a_scale_of_four_numbers_means_that_shapes_are_not_compared(written: Write) -> None:
    text = '<robot name="r"><link name="a"><visual><geometry><mesh filename="a.stl" scale="1 1 1 1"/></geometry></visual></link></robot>'
    path = written("urdf", text)
    verdict = hx.verify(path, path)
    assert any("a shape of link 'a' has another size than it may have (a scale of 4 numbers)" in note for note in verdict.not_compared)


def test_mjcf_may_have_any_suffix(tmp_path: Path) -> None:
    """MuJoCo itself takes `.xml` only; what the file includes lies beside it."""
    (tmp_path / "arm.mjcf").write_text('<mujoco><worldbody><include file="parts/arm.xml"/></worldbody></mujoco>')
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/arm.xml").write_text('<mujocoinclude><body name="a"><joint name="j"/><geom size="1"/></body></mujocoinclude>')
    (tmp_path / "arm.xml").write_text((tmp_path / "arm.mjcf").read_text())
    assert hx.verify(tmp_path / "arm.mjcf", tmp_path / "arm.xml").verdict == "same"
    (tmp_path / "parts/arm.xml").write_text('<mujocoinclude><body name="a"><joint name="j"/><geom size="2"/></body></mujocoinclude>')
    (tmp_path / "other.xml").write_text('<mujoco><worldbody><body name="a"><joint name="j"/><geom size="1"/></body></worldbody></mujoco>')
    assert hx.verify(tmp_path / "arm.mjcf", tmp_path / "other.xml").verdict == "different"


def test_an_axis_of_zero_is_not_comparable(written: Write) -> None:
    broken = written("urdf", ARM_URDF.replace('<axis xyz="0 0.6 0.8"/>', '<axis xyz="0 0 0"/>'))
    verdict = hx.verify(broken, broken)
    assert verdict.verdict == "not comparable"
    assert "elbow" in verdict.reason


def test_a_missing_engine_is_named_with_its_package(written: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    file = written("mjcf", ARM_MJCF)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    monkeypatch.delitem(sys.modules, "hymeko_x.verify.readers.mjcf", raising=False)
    monkeypatch.delitem(sys.modules, "hymeko_x.verify.readers.mjcf.constraints", raising=False)
    with pytest.raises(Refusal) as caught:
        hx.verify(file, file)
    assert caught.value.diagnostic.code == codes.ENGINE_MISSING
    assert caught.value.diagnostic.hint == "pip install 'hymeko-x[mujoco]'"


def test_sdf_without_drake_names_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "robot.sdf"
    file.write_text("<sdf version='1.9'><model name='m'><link name='a'/></model></sdf>", "utf-8")
    for name in ["pydrake", *(name for name in sys.modules if name.startswith("pydrake."))]:
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.delitem(sys.modules, "hymeko_x.verify.readers.sdf", raising=False)
    with pytest.raises(Refusal) as caught:
        hx.verify(file, file)
    assert caught.value.diagnostic.message == "sdf is verified with pydrake, which is not installed"
    assert caught.value.diagnostic.hint == "pip install 'hymeko-x[sdf]'"


def test_a_file_that_is_not_there_is_refused_in_one_line(arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", arm, "nowhere.urdf"]) == exits.FAILED
    assert capsys.readouterr().err == "nowhere.urdf: error[HX001]: there is no file 'nowhere.urdf'\n"


def test_a_seed_gives_the_same_verdict_again(arm: str, longer_arm: str) -> None:
    first, again, other = (hx.verify(arm, longer_arm, samples=7, seed=seed).as_json() for seed in (3, 3, 4))
    assert first == again
    assert first != other


def test_a_check_of_numbers_of_numpy_is_json() -> None:
    check = Check("mass", "kg", np.float64(1.0), "body 'a'", np.float64(0.5))
    assert json.loads(json.dumps(check.as_json()))["passed"] is False


def test_a_mechanism_in_memory_is_verified_and_not_trusted(arm: str) -> None:
    verdict = hx.verify(arm, hx.load(arm).mechanism)
    assert verdict.verdict == "same"
    assert any(note.startswith("trust: the mechanism side was read by hymeko-x itself") for note in verdict.not_compared)


def test_verify_is_a_function_and_a_package() -> None:
    import hymeko_x.verify

    assert hx.verify is hymeko_x.verify
    assert callable(hx.verify)


# ---- convert --verify ------------------------------------------------------------------------------------------------


def test_convert_verifies_what_it_wrote(arm: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", arm, str(tmp_path / "out.xml"), "--verify", "--samples", "5"]) == exits.DONE
    assert capsys.readouterr().err.splitlines()[-3:-1] == [
        "same as far as mjcf can say",
        "  mjcf cannot say velocity limits: 6 (joint 'shoulder', joint 'elbow', ...)",
    ]


def test_convert_ends_with_4_when_the_result_is_another_robot(
    arm: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A rewriting rule that forgets the couplings, as a bug of ours might."""
    from hymeko_x.backends.mjcf import rules as rules_mjcf

    def forget(mechanism: hx.Mechanism, context: object) -> hx.Mechanism:
        gone = [key for key in mechanism.graph.edges if key.kind == "coupling"]
        return mechanism.replace(without=gone)

    monkeypatch.setattr(rules_mjcf, "RULES", (*rules_mjcf.RULES, forget))
    assert main(["convert", arm, str(tmp_path / "out.xml"), "--verify", "--samples", "5"]) == exits.DIFFERENT
    err = capsys.readouterr().err
    assert "\ndifferent\n" in err
    assert "joint 'right_slide' follows nothing in the other" in err


# ---- roundtrip -------------------------------------------------------------------------------------------------------


def test_roundtrip_prints_a_leg_per_format_and_comes_back(arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["roundtrip", arm, "--through", "hymeko", "--samples", "5"]) == exits.DONE
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [row[1] for row in rows] == ["format", "urdf", "hymeko", "urdf"]
    assert [row[-1] for row in rows[2:]] == ["same", "same"]


def test_roundtrip_prints_json(arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["roundtrip", arm, "--through", "hymeko", "--samples", "5", "--json"]) == exits.DONE
    document = json.loads(capsys.readouterr().out)
    assert document["source"]["bytes"] == len(ARM_URDF.encode())
    assert [(leg["format"], leg["verdict"], leg["differences"]) for leg in document["legs"]] == [("hymeko", "same", 0), ("urdf", "same", 0)]


# ---- dh --------------------------------------------------------------------------------------------------------------


def test_dh_prints_a_table_per_chain_and_proves_it(written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dh", str(written("mjcf", RIG_MJCF)), "--check"]) == exits.DONE
    out = capsys.readouterr().out
    assert "torso -> rod (standard)" in out
    errors = [float(line.rpartition(" ")[2]) for line in out.splitlines() if "Pinocchio" in line]
    assert len(errors) >= 3
    assert max(errors) < 1e-12


def test_dh_prints_json_of_one_chain(arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dh", arm, "--tip", "hand", "--convention", "modified", "--json"]) == exits.DONE
    (table,) = json.loads(capsys.readouterr().out)
    assert (table["from"], table["to"], table["convention"]) == ("base", "hand", "modified")
    assert [row["joint"] for row in table["rows"]] == ["shoulder", "elbow", "roll", "rail"]


def test_dh_of_a_body_that_is_not_there(arm: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["dh", arm, "--tip", "foot"]) == exits.FAILED
    assert capsys.readouterr().err == "error[HX303]: there is no body 'foot'\n  hint: chains end at: left, right\n"


# ---- check -----------------------------------------------------------------------------------------------------------

LISTING = """<robot name="r">
  <link name="a">
    <visual><geometry><box size="1 1 1"/></geometry></visual><collision><geometry><box size="1 1 1"/></geometry></collision>
  </link>
  <link name="b">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><sphere radius="1"/></geometry></visual><collision><geometry><sphere radius="1"/></geometry></collision>
  </link>
  <joint name="j" type="revolute">
    <parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>"""

FAULTS = {
    "no mass on a moving link": ('<mass value="1"/>', '<mass value="0"/>', "HX314"),
    "a negative mass": ('<mass value="1"/>', '<mass value="-1"/>', "HX315"),
    "a tensor that is not positive definite": ('izz="1"', 'izz="-1"', "HX316"),
    "a tensor that breaks the triangle inequality": ('izz="1"', 'izz="5"', "HX316"),
    "no visual": ("<visual><geometry><sphere radius='1'/></geometry></visual>".replace("'", '"'), "", "HX317"),
    "no collision": ("<collision><geometry><sphere radius='1'/></geometry></collision>".replace("'", '"'), "", "HX318"),
    "a radius of zero": ('<visual><geometry><sphere radius="1"/>', '<visual><geometry><sphere radius="0"/>', "HX319"),
    "a size in millimetres": ('<visual><geometry><sphere radius="1"/>', '<visual><geometry><sphere radius="2500"/>', "HX319"),
    "a mesh that is not there": ('<visual><geometry><sphere radius="1"/>', '<visual><geometry><mesh filename="m.stl"/>', "HX201"),
    "limits that contradict each other": ('lower="-1" upper="1"', 'lower="1" upper="-1"', "HX313"),
    "limits in degrees": ('lower="-1" upper="1"', 'lower="-180" upper="180"', "HX313"),
    "a negative effort": ('effort="1"', 'effort="-1"', "HX313"),
    "an axis of zero": ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "HX026"),
    "a child that is not defined": ('<child link="b"/>', '<child link="c"/>', "HX040"),
    "a link that is defined twice": ('<link name="b">', '<link name="a">', "HX023"),
    "a link without a joint": ("<robot name='r'>".replace("'", '"'), '<robot name="r"><link name="lost"/>', "HX042"),
    "a type that does not exist": ('type="revolute"', 'type="revolut"', "HX027"),
}


def found_codes(file: Path, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, set[str]]:
    code = main(["check", str(file), "--json", *words])
    document = json.loads(capsys.readouterr().out)
    assert document["passed"] == (code == exits.DONE)
    return code, {row["code"] for row in document["diagnostics"] if row["severity"] != "note"}


def test_check_finds_nothing_wrong_with_a_sound_robot(written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert found_codes(written("urdf", LISTING), capsys, "--links", "2", "--joints", "1") == (exits.DONE, set())


@pytest.mark.parametrize("fault", FAULTS)
def test_check_finds(fault: str, written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    before, after, expected = FAULTS[fault]
    assert before in LISTING
    code, found = found_codes(written("urdf", LISTING.replace(before, after, 1)), capsys, "--fail-on", "warning")
    assert code == exits.FAIL_ON
    assert expected in found


def test_check_compares_the_declared_numbers(written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    assert found_codes(written("urdf", LISTING), capsys, "--links", "3") == (exits.FAIL_ON, {"HX312"})


def test_a_profile_asks_only_for_what_it_needs(written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    file = written("urdf", LISTING.replace('<mass value="1"/>', '<mass value="0"/>'))
    assert found_codes(file, capsys, "--profile", "kinematics") == (exits.DONE, set())
    assert found_codes(file, capsys, "--profile", "simulation") == (exits.FAIL_ON, {"HX314"})


@pytest.mark.parametrize(
    ("shape", "found"), [("", set()), (' mass="2"', set()), (' density="0"', {"HX314"}), (' mass="0"', {"HX314"})], ids=str
)
def test_shapes_that_weigh_in_mujoco_are_masses(shape: str, found: set[str], written: Write, capsys: pytest.CaptureFixture[str]) -> None:
    body = f'<body name="b"><freejoint/><body name="fixed"><geom name="g" size="1"{shape}/></body></body>'
    assert found_codes(written("mjcf", f"<mujoco><worldbody>{body}</worldbody></mujoco>"), capsys)[1] == found


def test_a_hypergraph_without_bodies_is_no_robot(tmp_path: Path) -> None:
    text = tmp_path / "plain.hymeko"
    text.write_text("plain\nnode0 {\nx1 x2\nx3 x4\n@e1 {+x1 +x2 -x3 -x4}\n}\n")
    assert hx.verify(text, text).reason == "the HyMeKo text describes a hypergraph without bodies, which is no robot"


def test_a_scene_without_bodies_is_compared_by_its_shapes(written: Write, tmp_path: Path) -> None:
    scene = written("mjcf", '<mujoco><worldbody><geom type="box" size="2 2 1"/><camera name="eye"/></worldbody></mujoco>')
    text = tmp_path / "scene.hymeko"
    hx.convert(scene, text)
    assert hx.verify(scene, text).verdict == "same"
    text.write_text(text.read_text().replace("[4 4 2]", "[4 5 2]"))
    assert hx.verify(scene, text).verdict == "different"


def test_a_root_link_called_world_is_a_body_where_it_weighs_something(tmp_path: Path) -> None:
    text = tmp_path / "heavy.hymeko"
    bodies = "world : link {{ {} }} arm {{ mass 1 inertia [1 1 1] }} @turn : continuous {{ + `world` - arm }}"
    for mass, names in (("mass 1 inertia [1 1 1]", ["world", "arm"]), ("", ["arm"])):
        text.write_text("r : robot { " + bodies.format(mass) + " }")
        assert [body.name for body in hx.verify.model_of(text).bodies[1:]] == names
