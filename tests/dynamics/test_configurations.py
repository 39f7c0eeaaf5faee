"""Named configurations of a file as operating points and starts: keyframes of MJCF, group states, poses of HyMeKo."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import hymeko_x as hx
from hymeko_x.cli import main
from hymeko_x.diagnostics import Refusal
from hymeko_x.dynamics.spatial import of_quaternion
from tests.dynamics.test_lumped import LISTING

LEG = """<mujoco><worldbody>
  <body name="a" pos="0 0 1"><joint name="x" axis="1 0 0"/><joint name="y" axis="0 1 0"/><geom size=".1" pos="0 0 .3"/>
    <body name="b" pos="0 0 .5"><joint name="ball" type="ball"/><geom size=".1" pos="0 0 .2"/>
      <body name="c" pos="0 0 .3"><joint name="last" type="slide" axis="1 0 0"/><geom size=".1" pos=".2 0 0"/></body>
    </body>
    <body name="d"><joint name="free" axis="0 0 1"/><geom size=".1" pos=".1 0 0"/></body>
  </body>
</worldbody>
<equality><joint joint1="free" joint2="x" polycoef="0 2 0 0 0"/></equality>
<keyframe><key name="home" qpos=".1 .2 .6 .8 0 0 .3 .2"/><key name="odd" qpos="1 0 0 2 0 0 0 2"/></keyframe></mujoco>"""


def test_a_keyframe_is_an_operating_point() -> None:
    leg = hx.dynamics(hx.loads(LEG, "mjcf"))
    named = leg.at("home")
    assert named.positions == pytest.approx([0.1, 0.2, 0.6, 0.8, 0, 0, 0.3], abs=1e-15)
    model = mujoco.MjModel.from_xml_string(LEG)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    needed = data.qfrc_bias + mass_of(model, data) @ np.insert(named.rates, 6, 2 * named.rates[0])  # "free" follows "x"
    assert np.abs(named.inputs).max() > 0.1
    assert named.inputs == pytest.approx([needed[0] + 2 * needed[6], needed[1], needed[5]], abs=1e-9)
    assert needed[2:5] == pytest.approx(0, abs=1e-9)
    with pytest.raises(Refusal, match=r"HX407\]: 'hom' is no configuration") as error:
        leg.at("hom")
    assert error.value.diagnostic.hint == "named configurations of the file: home, odd; or joint=0.5,other=1 in rad and m"


def mass_of(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    return whole


def test_a_keyframe_has_the_pose_of_a_free_body() -> None:
    """Gravity along its own axes depends on how it is turned, and its position on where its frame stands."""
    text = """<mujoco><worldbody><body name="a" pos="0 0 1" euler="0 0 90"><freejoint name="f"/><geom size=".1"/></body></worldbody>
      <keyframe><key name="fallen" qpos="1 2 3 2 2 0 0"/></keyframe></mujoco>"""
    box = hx.dynamics(hx.loads(text, "mjcf"))
    point = box.at("fallen")
    rotation = np.array(of_quaternion(point.positions[3:]))
    assert point.positions[:3] == pytest.approx([2, -1, 2])
    assert np.linalg.norm(point.positions[3:]) == pytest.approx(1)
    assert point.rates[:3] == pytest.approx(rotation.T @ [0, 0, -9.81])
    assert rotation[:, 1] == pytest.approx([0, 0, 1])


def test_a_simulation_starts_at_a_keyframe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "leg.xml").write_text(LEG)
    assert main(["simulate", str(tmp_path / "leg.xml"), "--at", "odd", "--time", "0.01", "--step", "0.01"]) == 0
    head, first = (line.split(",") for line in capsys.readouterr().out.splitlines()[:2])
    assert {name: float(value) for name, value in zip(head, first, strict=True) if value != "0"} == {"x.position": 1, "ball.qx": 1}


def test_a_network_has_no_operating_point(capsys: pytest.CaptureFixture[str]) -> None:
    for verb in ("dynamics", "simulate"):
        assert main([verb, str(LISTING), "--at", "home"]) == 1
        assert "HX407]: quarter_vehicle_model is a network, whose equations count from rest" in capsys.readouterr().err


@pytest.mark.parametrize("step", [0.01, 0.001])
def test_a_robot_at_rest_stays_there_with_its_energy(step: float) -> None:
    bar = hx.dynamics(hx.load(LISTING.parents[2] / "examples" / "four_bar.hymeko"))
    form = bar.port_hamiltonian()
    positions = bar.start("")
    start = form.state(positions, [0.0] * (len(form.states) - len(positions)))
    flow = form.simulate(start, np.zeros((int(0.2 / step), len(bar.system.inputs))), step)
    assert np.abs(flow.states - start).max() < 1e-9
    assert np.abs(flow.energies - flow.energies[0]).max() < 1e-12
