"""The world, a link that represents it, and a body that only has its name: all writers agree on what is called how."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Literal

import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
HEAVY = f"""<robot name="r">
  <link name="world">{INERTIAL}</link>
  <link name="arm">{INERTIAL}</link>
  <joint name="j" type="continuous"><parent link="world"/><child link="arm"/><axis xyz="0 1 0"/></joint>
</robot>
"""
NAMES = ["b.urdf", "b.xml", "b.sdf", "b.usda", "b.xacro"]


@pytest.mark.unread("HX102")
@pytest.mark.parametrize("base", ["fixed", "free"])
def test_all_writers_give_a_body_called_world_the_same_name(base: Literal["fixed", "free"], tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(HEAVY)
    for name in NAMES:
        hx.convert(tmp_path / "a.urdf", tmp_path / name, base=base)
        assert set(hx.load(tmp_path / name).bodies) - {"world"} == {"world_link", "arm"}
    verdicts = {(a, b): hx.verify(tmp_path / a, tmp_path / b) for a, b in combinations(["a.urdf", *NAMES], 2)}
    assert {pair: str(found) for pair, found in verdicts.items() if not found.is_same} == {}


@pytest.mark.unread("HX102")
@pytest.mark.parametrize("base", ["fixed", "free"])
def test_a_body_called_world_beside_the_world_is_only_renamed(base: Literal["fixed", "free"], tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(HEAVY)
    report = hx.convert(tmp_path / "a.urdf", tmp_path / "b.urdf", base=base)
    assert [(loss.element, loss.field, loss.before, loss.after) for loss in report.losses] == [
        ("body 'world'", "name", "'world'", "'world_link'")
    ]
