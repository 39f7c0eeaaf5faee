"""MuJoCo numbers equality constraints of all kinds in their common order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

HEAD = """<mujoco><worldbody>
<body name="a"><joint name="j1"/><geom size="0.1"/><body name="b" pos="1 0 0"><joint name="j2"/><geom size="0.1"/></body></body>
<body name="c"><joint name="j3"/><geom size="0.1"/><body name="d" pos="1 0 0"><joint name="j4"/><geom size="0.1"/></body></body>
</worldbody><equality>"""
CONSTRAINTS = [
    '<connect name="z" body1="b" body2="d" anchor="0 0 0"/>',
    '<joint name="y" joint1="j2" joint2="j1" polycoef="0 1 0 0 0"/>',
    '<weld name="x" body1="a" body2="c"/>',
    '<joint joint1="j4" joint2="j3" polycoef="0 2 0 0 0"/>',
    '<connect body1="b" body2="d" anchor="0 0 0"/>',
    '<joint name="w" joint1="j3" joint2="j1" polycoef="0 2 0 0 0"/>',
]


def robot(path: Path, constraints: list[str]) -> Path:
    path.write_text(f"{HEAD}{''.join(constraints)}</equality></mujoco>")
    return path


@pytest.mark.parametrize("through", ["urdf", "xacro", "usda", "hymeko"])
def test_it_comes_back_where_it_is_kept(through: str, tmp_path: Path) -> None:
    source = robot(tmp_path / "a.xml", CONSTRAINTS)
    hx.convert(source, tmp_path / f"a.{through}", keep="inside")
    hx.convert(tmp_path / f"a.{through}", tmp_path / "b.xml")
    before, after = (mujoco.MjModel.from_xml_path(str(path)) for path in (source, tmp_path / "b.xml"))
    assert (after.eq_type.tolist(), after.eq_data.tolist()) == (before.eq_type.tolist(), before.eq_data.tolist())


@pytest.mark.parametrize("through", ["urdf", "usda"])
def test_another_order_is_a_loss(through: str, tmp_path: Path) -> None:
    source = robot(tmp_path / "a.xml", CONSTRAINTS)
    losses = hx.convert(source, tmp_path / f"a.{through}").losses or ()
    assert [loss.element for loss in losses if loss.field == "order of constraints"] == ["mechanism"]


def test_another_order_is_a_difference(tmp_path: Path) -> None:
    first = hx.load(robot(tmp_path / "a.xml", CONSTRAINTS[:3])).mechanism
    (tmp_path / "b").mkdir()
    second = hx.load(robot(tmp_path / "b" / "a.xml", [CONSTRAINTS[1], CONSTRAINTS[0], CONSTRAINTS[2]])).mechanism
    assert [str(difference) for difference in hx.diff(first, second)] == [
        "mechanism order of constraints: loop 'z' coupling 'y' loop 'x' -> coupling 'y' loop 'z' loop 'x'"
    ]
    assert hx.diff(first, first) == ()
