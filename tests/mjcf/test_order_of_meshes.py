"""The order of meshes in a file, which MuJoCo keeps, follows from the text of the robot or from the names with which its runs begin."""

from __future__ import annotations

import re
from itertools import permutations

import pytest

import hymeko_x as hx

TETRA = 'vertex="0 0 0 1 0 0 0 1 0 0 0 1"'
NAMES = ("base", "base_hull", "arm", "arm_hull")


def _mjcf(order: tuple[str, ...]) -> str:
    meshes = "".join(f'<mesh name="{name}" {TETRA}/>' for name in order)
    geoms = {name: f'<geom type="mesh" mesh="{name}" {"" if "hull" in name else PLAIN}/>' for name in NAMES}
    return (
        f'<mujoco model="r"><asset>{meshes}</asset><worldbody><body name="base">{geoms["base"]}{geoms["base_hull"]}'
        f'<body name="arm"><joint name="turn"/>{geoms["arm"]}{geoms["arm_hull"]}</body></body></worldbody></mujoco>'
    )


PLAIN = 'contype="0" conaffinity="0"'


@pytest.mark.parametrize("order", list(permutations(NAMES)), ids="-".join)
def test_every_order_comes_back_through_text(order: tuple[str, ...]) -> None:
    robot = hx.loads(_mjcf(order).encode(), "mjcf").mechanism
    text = hx.dumps(robot, "hymeko")
    back = hx.loads(text.encode(), "hymeko").mechanism
    assert back == robot
    written = hx.dumps(back, "mjcf")
    assert tuple(re.findall(r'<mesh name="(\w+)"', written)) == order


@pytest.mark.parametrize(
    ("order", "note"),
    [
        (NAMES, None),
        (("base_hull", "arm_hull", "base", "arm"), "meshes=collisions"),
        (("base", "arm", "base_hull", "arm_hull"), "meshes=visuals"),
        (("arm", "arm_hull", "base", "base_hull"), "meshes=sorted"),
        (("arm_hull", "base", "base_hull", "arm"), 'meshes "arm_hull base"'),
    ],
)
@pytest.mark.unread("HX201")
def test_an_order_is_a_word_or_the_beginnings_of_its_runs(order: tuple[str, ...], note: str | None) -> None:
    named = _mjcf(order)
    for name in NAMES:
        named = named.replace(f'<mesh name="{name}" {TETRA}/>', f'<mesh name="{name}" file="{name}.stl"/>')
    found = re.findall(r"meshes\S* ?(?:\"[^\"]*\")?", hx.dumps(hx.loads(named.encode(), "mjcf"), "hymeko"))
    assert [text.strip() for text in found] == ([] if note is None else [note])
