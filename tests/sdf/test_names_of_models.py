"""A link that is called as its model: names in a model mean what is in it."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

PENDULUM = """<robot name="pendulum"><link name="support"/><link name="pendulum"/>
<joint name="pivot" type="continuous"><origin xyz="0 0 1"/>
<parent link="support"/><child link="pendulum"/><axis xyz="1 0 0"/></joint></robot>"""


@pytest.mark.unread("HX101", "HX103")
def test_a_link_may_be_called_as_its_model(tmp_path: Path) -> None:
    (tmp_path / "p.urdf").write_text(PENDULUM, "utf-8")
    hx.convert(tmp_path / "p.urdf", tmp_path / "p.sdf")
    joint = next(iter(hx.load(tmp_path / "p.sdf").mechanism.joints.values()))
    assert (joint.parent.name, joint.child.name) == ("support", "pendulum")
    hx.convert(tmp_path / "p.sdf", tmp_path / "back.urdf")
    assert hx.verify(str(tmp_path / "p.sdf"), str(tmp_path / "back.urdf"), samples=10).is_same


def test_the_name_of_a_model_means_nothing_in_it(tmp_path: Path) -> None:
    text = '<sdf version="1.9"><model name="m"><link name="a"><pose relative_to="m">1 0 0 0 0 0</pose></link></model></sdf>'
    (tmp_path / "m.sdf").write_text(text, "utf-8")
    with pytest.raises(hx.Refusal, match="relative to 'm', which is not defined"):
        hx.load(tmp_path / "m.sdf")
