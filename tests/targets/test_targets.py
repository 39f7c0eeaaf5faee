"""Targets: what `--for` adds for the program that takes the output, and what it says about it."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x import formats, targets
from hymeko_x.cli import exits, main
from hymeko_x.diagnostics import Refusal, Severity

ARM = """arm : robot {
  base { mass 1 inertia [0.1 0.1 0.1] }
  upper { mass 1 inertia [0.1 0.1 0.1] com [0.2 0 0] }
  @shoulder : revolute { limit [-1 1] effort 20 + base - upper axis=Y }
}
"""


TOUCHING = """arm : robot {
  base { mass 1 inertia [0.1 0.1 0.1] collision { box [0.2 0.2 0.2] } }
  upper { mass 1 inertia [0.1 0.1 0.1] com [0.2 0 0] }
  fore { mass 1 inertia [0.1 0.1 0.1] collision { box [0.2 0.2 0.2] } }
  @shoulder : revolute { limit [0.5rad 1rad] + base - upper axis=Z }
  @elbow : revolute { limit [-1 1] [0.05 0 0] + upper - fore axis=Z }
}
"""


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    path = tmp_path / "arm.hymeko"
    path.write_text(ARM)
    return path


def test_every_row_names_formats_and_a_module_with_rules() -> None:
    for target in targets.TARGETS:
        assert all(formats.by_name(name).backend for name in target.formats)
        assert all(map(callable, formats.loaded(target.rules).RULES))
        assert target.beside is None or callable(formats.loaded(target.beside))


def test_formats_lists_the_targets(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formats"]) == exits.DONE
    _, listed = capsys.readouterr().out.split("\n\n")
    assert [line.split()[0] for line in listed.splitlines()] == ["target", *(target.name for target in targets.TARGETS)]


def test_a_typo_is_one_line_with_a_suggestion(arm: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", str(arm), str(arm.with_suffix(".xml")), "--for", "mujocco"]) == exits.FAILED
    assert capsys.readouterr().err == "error[HX012]: there is no target 'mujocco'; did you mean 'mujoco'?\n"
    assert not arm.with_suffix(".xml").exists()


def test_a_target_of_another_format_is_refused(arm: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", str(arm), str(arm.with_suffix(".urdf")), "--for", "mujoco"]) == exits.FAILED
    assert capsys.readouterr().err == "error[HX012]: target 'mujoco' takes mjcf, and the output is urdf\n"
    with pytest.raises(Refusal, match="HX012"):
        hx.convert(arm, arm.with_suffix(".urdf"), target="mujoco")


def test_the_target_chooses_the_format_of_standard_output(arm: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", str(arm), "-", "--for", "mujoco"]) == exits.DONE
    assert capfd.readouterr().out.startswith("<mujoco ")


def test_a_drive_is_integrated_implicitly_and_reported(arm: Path) -> None:
    done = hx.convert(arm, arm.with_suffix(".xml"), base="fixed", actuators="position", target="mujoco")
    assert '<option integrator="implicitfast"/>' in arm.with_suffix(".xml").read_text()
    assert [d.code.id for d in done.report if "implicitfast" in d.message] == ["HX114"]
    assert not [loss for loss in done.losses or () if "option" in loss.field]


def test_the_integrator_of_the_author_stays(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(
        '<mujoco><option integrator="RK4"/><worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>'
        '<actuator><position joint="j" kp="1"/></actuator></mujoco>'
    )
    hx.convert(tmp_path / "a.xml", tmp_path / "b.xml", target="mujoco")
    assert re.findall("integrator=.*?/>", (tmp_path / "b.xml").read_text()) == ['integrator="RK4"/>']


def test_update_finds_the_target_out(arm: Path) -> None:
    output = arm.with_suffix(".xml")
    hx.convert(arm, output, base="fixed", target="mujoco", actuators="velocity")
    assert hx.update(arm, output, dry_run=True).edits == ()


def test_home_is_a_keyframe_in_which_nothing_pushes(tmp_path: Path) -> None:
    (tmp_path / "arm.hymeko").write_text(TOUCHING)
    done = hx.convert(tmp_path / "arm.hymeko", tmp_path / "arm.xml", base="fixed", actuators="position", target="mujoco")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert (model.key(0).name, list(data.qpos), list(data.ctrl), data.ncon) == ("home", [0.5, 0.0], [0.5, 0.0], 0)
    assert [d.message for d in done.report if "touch" in d.message] == [
        "--for mujoco: 1 pair of bodies touching at home excluded from collision: 'base' and 'fore'"
    ]
    assert done.losses == ()
    assert '<exclude body1="base" body2="fore"/>' in (tmp_path / "arm.xml").read_text()


HELD = """
held : robot {
  base {} upper { mass 1 inertia [0.1 0.1 0.1] box [0.1 0.1 0.1] } fore { mass 1 inertia [0.1 0.1 0.1] box [0.1 0.1 0.1] }
  @lift : revolute { + base - upper axis=Y limit [-2 2] }
  @bend : revolute { [0 0 0.5] + upper - fore axis=Y limit [-2 2] }
  lifts : actuator.general { [2] - lift ctrlrange [0 255] gainprm 0.5 biastype "affine" biasprm [1 -20 -2] }
  bends : actuator.position { - bend kp 10 }
  rest : pose { [0.5] ~ lift [-0.25] ~ bend }
}
"""


def test_named_poses_are_keyframes_in_which_the_servos_hold_the_robot(tmp_path: Path) -> None:
    """A general law with a slope is a servo, and one with damping asks for the implicit integrator."""
    (tmp_path / "held.hymeko").write_text(HELD)
    done = hx.convert(tmp_path / "held.hymeko", tmp_path / "held.xml", base="fixed", target="mujoco")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "held.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert ([model.key(number).name for number in range(model.nkey)], list(data.qpos)) == (["rest"], [0.5, -0.25])
    assert list(data.ctrl) == [38.0, -0.25]  # 0.5 c + 1 - 20 (2 * 0.5) = 0
    assert list(data.qfrc_actuator) == [0.0, 0.0]
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert "--for mujoco: keyframes have the controls of servos: 'rest'" in [item.message for item in done.report]


def test_what_the_target_added_is_there_in_hymeko_text_as_well(tmp_path: Path) -> None:
    (tmp_path / "arm.hymeko").write_text(TOUCHING)
    robot = hx.convert(tmp_path / "arm.hymeko", tmp_path / "arm.xml", base="fixed", actuators="position", target="mujoco").mechanism
    text = hx.dumps(robot, "hymeko")
    assert hx.dumps(hx.loads(text, "hymeko"), "mjcf") == (tmp_path / "arm.xml").read_text().partition("\n")[2]


def test_without_a_target_nothing_is_added(arm: Path) -> None:
    report = hx.convert(arm, arm.with_suffix(".xml"), base="fixed").report
    assert "<option" not in arm.with_suffix(".xml").read_text()
    assert "HX114" not in {d.code.id for d in report}


def test_a_scene_stands_beside_the_model(tmp_path: Path) -> None:
    (tmp_path / "arm.hymeko").write_text(TOUCHING)
    hx.convert(tmp_path / "arm.hymeko", tmp_path / "arm.xml", base="fixed", actuators="position", target="mujoco")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["arm.hymeko", "arm.xml", "scene.xml"]
    model, scene = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("arm.xml", "scene.xml"))
    assert (scene.nbody, scene.nq, scene.nu, scene.nkey) == (model.nbody, model.nq, model.nu, model.nkey)
    assert (scene.ngeom, scene.nlight) == (model.ngeom + 1, 1)
    assert scene.geom("ground").pos[2] == -0.1
    data = mujoco.MjData(scene)
    mujoco.mj_resetDataKeyframe(scene, data, 0)
    mujoco.mj_forward(scene, data)
    assert (data.contact.dist >= -1e-9).all()


def test_a_second_robot_in_the_folder_has_a_scene_of_its_own(tmp_path: Path) -> None:
    for name in ("arm", "leg"):
        (tmp_path / f"{name}.hymeko").write_text(TOUCHING)
        hx.convert(tmp_path / f"{name}.hymeko", tmp_path / f"{name}.xml", base="fixed", target="mujoco")
    assert '<include file="arm.xml"/>' in (tmp_path / "scene.xml").read_text()
    assert '<include file="leg.xml"/>' in (tmp_path / "leg_scene.xml").read_text()


CYLINDERS = """arm : robot {
  base { mass 1 inertia [0.1 0.1 0.1] collision { box [0.2 0.2 0.2] } }
  upper { mass 1 inertia [0.1 0.1 0.1] }
  fore { mass 1 inertia [0.1 0.1 0.1] collision { cylinder [0.1 0.2] } }
  @shoulder : revolute { limit [-1rad 1rad] + base - upper axis=Z }
  @elbow : revolute { limit [-1rad 1rad] [0.5 0 0] + upper - fore axis=Z }
}
"""


def test_mjx_is_given_what_it_has_and_told_what_it_lacks(tmp_path: Path) -> None:
    (tmp_path / "arm.hymeko").write_text(CYLINDERS)
    done = hx.convert(tmp_path / "arm.hymeko", tmp_path / "arm.xml", base="fixed", target="mjx")
    assert [d.message for d in done.report if d.severity is Severity.WARNING] == [
        "--for mjx: MJX refuses contacts of box and cylinder, and 1 pairs of shapes may touch: bodies 'base' and 'fore'"
    ]
    (tmp_path / "a.xml").write_text(
        '<mujoco><option integrator="implicit" solver="PGS"/><worldbody><body><joint name="j"/><geom size="1"/></body></worldbody></mujoco>'
    )
    hx.convert(tmp_path / "a.xml", tmp_path / "b.xml", target="mjx")
    assert '<option integrator="implicitfast" solver="Newton"/>' in (tmp_path / "b.xml").read_text()
