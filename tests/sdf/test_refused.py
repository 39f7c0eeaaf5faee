"""What libsdformat refuses: one file for each rule. It is read with a diagnostic that says so, or refused as well."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from tests.sdf.names import is_accepted, library
from tests.sdf.samples import TWO, model

if TYPE_CHECKING:
    from pathlib import Path


def world(inside: str) -> str:
    """A file with a world."""
    return f'<sdf version="1.9"><world name="w">{inside}</world></sdf>'


def joint(ends: str = "<parent>a</parent><child>b</child>", axis: str = "<axis><xyz>0 0 1</xyz></axis>", kind: str = "revolute") -> str:
    """A model with two links, a frame and a joint."""
    return model(f'{TWO}<frame name="f" attached_to="b"/><joint name="j" type="{kind}">{ends}{axis}</joint>')


def visual(inside: str) -> str:
    """A model with a link that has visuals."""
    return model(f'<link name="a">{inside}</link>')


BALL = "<geometry><sphere><radius>1</radius></sphere></geometry>"
LINK = '<link name="l"/>'
_INERTIA = "<inertial><mass>{}</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>{}</izz></inertia></inertial>"
PART = f'<model name="m">{LINK}</model>'

RULES = {
    "a version that there is not": ('<sdf version="1.99"><model name="m"><link name="a"/></model></sdf>', "HX027"),
    "no version": ('<sdf><model name="m"><link name="a"/></model></sdf>', "HX027"),
    "a root of old files": ('<gazebo version="1.0"><model name="m"><link name="a"/></model></gazebo>', "HX006"),
    "a damaged tag": ('<sdf version="1.9"><model name="m"><link name="a"></model></sdf>', "HX010"),
    "no model": ('<sdf version="1.9"></sdf>', "HX045"),
    "several models without a world": (f'<sdf version="1.9">{PART}<model name="n">{LINK}</model></sdf>', "HX047"),
    "several worlds": (f'<sdf version="1.9"><world name="w">{PART}</world><world name="w">{PART}</world></sdf>', "HX047"),
    "a model without links": (model('<frame name="f"/>'), "HX045"),
    "a nested model without links": (model('<link name="a"/><model name="n"><frame name="f"/></model>'), "HX045"),
    "a link without a name": (model("<link/>"), "HX022"),
    "two links of one name": (model(LINK + LINK), "HX023"),
    "two models of one name": (world(PART + PART), "HX023"),
    "a link and a joint of one name": (joint().replace('name="j"', 'name="a"'), "HX023"),
    "a link and a frame of one name": (model(f'{LINK}<frame name="l"/>'), "HX023"),
    "a link and a nested model of one name": (model(f'{LINK}<model name="l">{LINK}</model>'), "HX023"),
    "a model and a frame of one name": (world(f'{PART}<frame name="m"/>'), "HX023"),
    "a model and a light of one name": (world(f'{PART}<light name="m" type="point"/>'), "HX023"),
    "two visuals of one name": (visual(f'<visual name="v">{BALL}</visual><visual name="v">{BALL}</visual>'), "HX023"),
    "two collisions of one name": (visual(f'<collision name="c">{BALL}</collision><collision name="c">{BALL}</collision>'), "HX023"),
    "a link that is called as the world": (model('<link name="world"/>'), "HX022"),
    "a reserved name": (model(f'{LINK}<frame name="__frame__"/>'), "HX022"),
    "a colon in a name": (model('<link name="a::b"/>'), "HX022"),
    "a script without a file": (visual(f'<visual name="v">{BALL}<material><script><name>Red</name></script></material></visual>'), "HX045"),
    "a script without a name": (visual(f'<visual name="v">{BALL}<material><script><uri>a</uri></script></material></visual>'), "HX045"),
    "a visual with a reserved name": (visual(f'<visual name="__v__">{BALL}</visual>'), "HX022"),
    "a sensor that is called as the world": (visual('<sensor name="world" type="imu"/>'), "HX022"),
    "two sensors of one name on a joint": (joint(axis='<sensor name="s" type="force_torque"/>' * 2, kind="fixed"), "HX023"),
    "a model and a light without a world": (f'<sdf version="1.9">{PART}<light name="l" type="point"/></sdf>', "HX047"),
    "a negative mass": (visual(_INERTIA.format(-1, 1)), "HX315"),
    "an inertia that no body has": (visual(_INERTIA.format(1, 2.1)), "HX316"),
    "a pose of words": (model('<link name="a"><pose>bad 0 0 0 0 0</pose></link>'), "HX020"),
    "a colour of words": (visual(f'<visual name="v">{BALL}<material><diffuse>red 0 0 1</diffuse></material></visual>'), "HX020"),
    "a number of words in what is kept as written": (visual("<velocity_decay><linear>bad</linear></velocity_decay>"), "HX020"),
    "two numbers for a vector": (world(f"{PART}<wind><linear_velocity>1 2</linear_velocity></wind>"), "HX020"),
    "a gravity of words": (world(f"{PART}<gravity>down</gravity>"), "HX020"),
    "a frame of a pose that is not there": (model('<link name="a"><pose relative_to="x"/></link>'), "HX040"),
    "a frame of the only model that is not there": (model(f'<pose relative_to="x"/>{LINK}'), "HX040"),
    "frames in a circle": (
        model(f'{LINK}<frame name="f"><pose relative_to="g"/></frame><frame name="g"><pose relative_to="f"/></frame>'),
        "HX043",
    ),
    "frames that are attached in a circle": (model(f'{LINK}<frame name="f" attached_to="g"/><frame name="g" attached_to="f"/>'), "HX043"),
    "a frame that is attached to nothing": (model(f'{LINK}<frame name="f" attached_to="x"/>'), "HX040"),
    "a frame of the world that is attached to a link inside": (world(f'{PART}<frame name="f" attached_to="m::x"/>'), "HX040"),
    "a canonical link that is not there": (model(LINK).replace('name="m"', 'name="m" canonical_link="x"'), "HX040"),
    "a placement frame that is not there": (
        model(f"<pose>1 0 0 0 0 0</pose>{LINK}").replace('name="m"', 'name="m" placement_frame="x"'),
        "HX040",
    ),
    "a joint of an unknown type": (joint(kind="revolut"), "HX027"),
    "a joint without an axis": (joint(axis=""), "HX045"),
    "a joint with an axis of zero": (joint(axis="<axis><xyz>0 0 0</xyz></axis>"), "HX026"),
    "an axis in a frame that is not there": (joint(axis='<axis><xyz expressed_in="x">0 0 1</xyz></axis>'), "HX040"),
    "a joint whose parent is not there": (joint("<parent>x</parent><child>b</child>"), "HX040"),
    "a joint whose child is not there": (joint("<parent>a</parent><child>x</child>"), "HX040"),
    "a joint without a parent": (joint("<child>b</child>"), "HX040"),
    "a joint whose child is the world": (joint("<parent>a</parent><child>world</child>"), "HX040"),
    "a joint that joins a link to itself": (joint("<parent>a</parent><child>a</child>"), "HX043"),
    "a joint that joins a link to a frame on it": (joint("<parent>b</parent><child>f</child>"), "HX043"),
    "a joint that is its own parent": (joint("<parent>j</parent><child>b</child>"), "HX043"),
    "a joint that is its own child": (joint("<parent>a</parent><child>j</child>"), "HX043"),
    "a joint of the world whose child is the world": (
        world(f'{PART}<joint name="j" type="ball"><parent>m</parent><child>world</child></joint>'),
        "HX040",
    ),
    "a model that is not there": (world("<include><uri>missing</uri></include>"), "HX053"),
    "a model of no name": (world("<include><name>a</name></include>"), "HX053"),
    "a model of the network": (world("<include><uri>https://fuel.gazebosim.org/1.0/a/models/b</uri></include>"), "HX053"),
}


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.unread("HX010")
def test_it_is_reported(rule: str) -> None:
    text, code = RULES[rule]
    report = Report()
    try:
        hx.loads(text, "sdf", report=report, lenient=True)
    except hx.Refusal as refusal:
        report.diagnostics.append(refusal.diagnostic)
    assert code in [diagnostic.code.id for diagnostic in report]


ACCEPTED_BY_DRAKE = ("a negative mass", "an inertia that no body has")
"""Drake takes a ball of water instead of what libsdformat refuses."""


@pytest.mark.parametrize("rule", [rule for rule in RULES if rule not in ACCEPTED_BY_DRAKE])
def test_libsdformat_refuses_it(rule: str, tmp_path: Path) -> None:
    pytest.importorskip("pydrake")
    from hymeko_x.verify import model_of

    (tmp_path / "m.sdf").write_text(RULES[rule][0], "utf-8")
    with pytest.raises(hx.Refusal, match="HX302"):
        model_of(tmp_path / "m.sdf")


@pytest.mark.skipif(library() is None, reason="libsdformat is not installed")
@pytest.mark.parametrize("rule", ACCEPTED_BY_DRAKE)
def test_its_own_check_refuses_it(rule: str, tmp_path: Path) -> None:
    (tmp_path / "m.sdf").write_text(RULES[rule][0], "utf-8")
    assert not is_accepted(str(tmp_path / "m.sdf"))
