"""Constraints that a program of MuJoCo may switch on later hold nothing: formats without a switch are written without them."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.ir.parts import Coupling, Loop

_TWO_ARMS_AND_A_BALL = """<mujoco model="m"><worldbody>
<body name="a"><joint name="ja" axis="0 0 1"/><geom size=".1"/></body>
<body name="b" pos="1 0 0"><joint name="jb" axis="0 0 1"/><geom size=".1"/></body>
<body name="c" pos="2 0 0"><freejoint name="jc"/><geom size=".1"/></body>
</worldbody><equality>
<joint name="follow" joint1="ja" joint2="jb" polycoef="0 1" active="false"/>
<weld name="hold" body1="a" body2="c" active="false"/>
<connect name="meet" body1="a" body2="b" anchor="0.5 0 0" active="false"/>
</equality></mujoco>"""


@pytest.mark.unread("HX104")
@pytest.mark.parametrize("suffix", ["urdf", "sdf", "urdf.xacro", "usda", "hymeko", "xml"])
def test_an_inactive_constraint_does_not_hold_anything_in_any_format(tmp_path: Path, suffix: str) -> None:
    source, target = tmp_path / "source.xml", tmp_path / f"target.{suffix}"
    source.write_text(_TWO_ARMS_AND_A_BALL)
    hx.convert(source, target)
    assert hx.verify(source, target).verdict == "same"
    active = hx.load(target).mechanism
    assert not [key for key, data, _ in (*active.edges(Loop), *active.edges(Coupling)) if data.active]


def test_the_report_names_the_constraints_that_are_left_out(tmp_path: Path) -> None:
    source = tmp_path / "source.xml"
    source.write_text(_TWO_ARMS_AND_A_BALL)
    report = hx.convert(source, tmp_path / "target.sdf").report
    assert sorted(item.message for item in report if item.code.id == "HX104") == [
        "coupling 'follow' is not active; it is left out",
        "loop 'hold' is not active; it is left out",
        "loop 'meet' is not active; it is left out",
    ]
