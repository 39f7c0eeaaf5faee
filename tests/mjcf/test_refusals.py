"""What MuJoCo refuses we refuse as well, with the place, the reason, and what changed since the words were right."""

from __future__ import annotations

import warnings
from pathlib import Path

import mujoco
import pytest
from mjmodels import read_text

from hymeko_x.diagnostics import Refusal


def situations() -> list[tuple[str, str]]:
    """The texts of refused.txt, each with the message that stands below it."""
    _, robot, *lines = Path(__file__).with_name("refused.txt").read_text().splitlines()
    found: list[tuple[str, str]] = []
    for line in lines:
        if line.startswith("    error"):
            found[-1] = (found[-1][0], f"robot.xml:1: {line.strip()}")
        elif line.startswith("    "):
            found[-1] = (found[-1][0], f"{found[-1][1]}\n  {line.strip()}")
        elif line:
            found.append((line.replace("ROBOT", robot), ""))
    return found


@pytest.mark.parametrize(("text", "message"), situations())
def test_mujoco_refuses_it_and_we_say_where_and_why(text: str, message: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises((ValueError, mujoco.FatalError)):
            mujoco.MjModel.from_xml_string(text)
    with pytest.raises(Refusal) as caught:
        read_text(text)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    "text",
    [
        '<mujoco><worldbody><body pos="" mocap="true"><geom size=".1" rgba=" "/></body></worldbody></mujoco>',
        '<mujoco><worldbody><geom size=".1" margin="0x10" gap="+.5" solref="1. 1e-400"/></worldbody></mujoco>',
        '<mujoco><worldbody><geom size=".1" group=" +3 "/></worldbody></mujoco>',
        '<mujoco xmlns:x="urn:x" x:y="1"><worldbody/></mujoco>',
        "<?nobody reads?><mujoco><worldbody/></mujoco>",
        '<mujoco><visual><headlight active="1"/></visual><worldbody/></mujoco>',
        '<mujoco><worldbody><camera output="rgb depth"/></worldbody></mujoco>',
        '<mujoco><worldbody><body><joint type="ball" actuatorfrcrange="-1 1"/><geom size=".1"/></body></worldbody></mujoco>',
    ],
)
def test_what_mujoco_reads_is_read(text: str) -> None:
    mujoco.MjModel.from_xml_string(text)
    read_text(text)
