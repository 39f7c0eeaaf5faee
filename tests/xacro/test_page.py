"""The example in Python of the page on xacro."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import hymeko_x as hx

PAGE = Path(__file__).parents[2] / "docs/mapping/xacro.md"
ROBOT = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="name" default="none"/>
  <xacro:include filename="$(find ur_description)/link.xacro"/>
  <link name="$(arg name)"/>
  <joint name="j" type="fixed"><parent link="included"/><child link="$(arg name)"/></joint>
</robot>"""


def test_the_python_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "ur_description").mkdir()
    (tmp_path / "here/robot.urdf.xacro").write_text(ROBOT)
    (tmp_path / "ur_description/link.xacro").write_text('<robot><link name="included"/></robot>')
    monkeypatch.chdir(tmp_path / "here")
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    names: dict[str, object] = {"hx": hx}
    exec(compile(f"robot = {code}", "xacro.md", "exec"), names)
    robot = names["robot"]
    assert isinstance(robot, hx.Robot)
    assert sorted(robot.bodies) == ["included", "ur5e"]
