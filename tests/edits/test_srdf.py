"""`update` where the original is URDF with an SRDF beside it: poses and pairs of links are edited there."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = f"""<robot name="r">
  <link name="base">{INERTIAL}</link>
  <link name="arm">{INERTIAL}</link>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="2"/></joint>
</robot>
"""
SRDF = """<robot name="r"> <!-- by hand -->
  <group name="all"><chain base_link="base" tip_link="arm"/></group>
  <group_state name="home" group="all"><joint name="elbow" value="0.50"/></group_state>
  <disable_collisions link1="base"  link2="arm" reason="Adjacent"/>
</robot>
"""


@pytest.mark.parametrize(
    ("name", "old", "new", "changed"),
    [
        ("r.xml", 'qpos="0.5"', 'qpos="0.7"', {'value="0.50"': 'value="0.7"'}),
        ("r.xml", '"arm"', '"forearm"', {'tip_link="arm"': 'tip_link="forearm"', 'link2="arm"': 'link2="forearm"'}),
        ("r.hymeko", "0.5", "0.7", {'value="0.50"': 'value="0.7"'}),
    ],
)
def test_an_edit_changes_only_its_values_in_the_srdf(name: str, old: str, new: str, changed: dict[str, str], tmp_path: Path) -> None:
    for suffix, text in ((".urdf", URDF), (".srdf", SRDF)):
        (tmp_path / f"r{suffix}").write_text(text)
    hx.convert(tmp_path / "r.urdf", tmp_path / name, base="fixed")
    text = (tmp_path / name).read_text()
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new))
    found = hx.update(tmp_path / "r.urdf", tmp_path / name)
    expected = SRDF
    for before, after in changed.items():
        expected = expected.replace(before, after)
    assert (tmp_path / "r.srdf").read_text() == expected
    assert [row.message for row in found.report if row.code.id == "HX118"] == []
    assert (tmp_path / "r.urdf").read_text() == (URDF.replace('"arm"', '"forearm"') if "arm" in old else URDF)
