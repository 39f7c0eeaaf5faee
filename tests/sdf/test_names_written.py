"""Names in SDF output: elements beside each other have different ones, as libsdformat demands, and those of the robot come home."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.parts import Box, Shape
from hymeko_x.testing import mechanisms
from tests.sdf.names import is_accepted, library, refused_names

SHAPE = "<geometry><sphere radius='1'/></geometry>"
INERTIAL = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"


def urdf(inside: str, beside: str = "") -> str:
    return f'<robot name="m"><link name="a">{INERTIAL}{inside}</link>{beside}</robot>'


def mjcf(inside: str, beside: str = "") -> str:
    return (
        f'<mujoco model="m"><worldbody>{beside}<body name="a"><freejoint/><geom name="ball" size="1"/>{inside}</body></worldbody></mujoco>'
    )


def shapes(*names: tuple[str, str | None]) -> str:
    """Visuals and collisions of a link of URDF, by tag and name."""
    return "".join(f"<{tag}{'' if name is None else f' name={name!r}'}>{SHAPE}</{tag}>" for tag, name in names)


FILES = {
    "a geom is seen and collides": ("m.xml", mjcf(""), ["visual ball", "collision ball_collision"]),
    "a visual and a collision of one name": (
        "m.urdf",
        urdf(shapes(("visual", "x"), ("collision", "x"))),
        ["visual x", "collision x_collision"],
    ),
    "the name that the collision gets is another one's": (
        "m.urdf",
        urdf(shapes(("visual", "x"), ("collision", "x_collision"), ("collision", "x"))),
        ["visual x", "collision x_collision", "collision x_collision_2"],
    ),
    "three visuals of one name": (
        "m.urdf",
        urdf(shapes(("visual", "x"), ("visual", "x"), ("visual", "x"))),
        ["visual x", "visual x_2", "visual x_3"],
    ),
    "a collision is called as visuals without a name": (
        "m.urdf",
        urdf(shapes(("visual", None), ("visual", None), ("collision", "visual"))),
        ["visual visual_2", "visual visual_3", "collision visual"],
    ),
    "names that SDF reserves": (
        "m.urdf",
        urdf(shapes(("visual", "world"), ("visual", "__x__"), ("collision", "a::b"), ("collision", ""))),
        ["visual visual_world", "visual visual_x", "collision a_b", "collision collision"],
    ),
    "a camera is called as a geom": (
        "m.xml",
        mjcf('<camera name="ball"/>'),
        ["visual ball_visual", "collision ball_collision", "sensor ball"],
    ),
    "a camera and a light of one name": (
        "m.xml",
        mjcf('<camera name="eye"/><light name="eye"/>'),
        ["visual ball", "collision ball_collision", "sensor eye", "light eye_light"],
    ),
    "cameras of models that are none here": (
        "m.xml",
        mjcf('<camera name="l::eye"/><camera name="r::eye"/>'),
        ["visual ball", "collision ball_collision", "sensor l_eye", "sensor r_eye"],
    ),
    "a sensor of a fragment is called as a visual": (
        "m.urdf",
        urdf(
            shapes(("visual", "eye")), '<gazebo reference="a"><sensor name="eye" type="imu"/><plugin name="eye" filename="f.so"/></gazebo>'
        ),
        ["visual eye_visual", "sensor eye"],
    ),
}


@pytest.mark.parametrize("case", FILES)
@pytest.mark.unread("HX022", "HX101")
def test_what_a_link_holds_has_different_names(case: str, tmp_path: Path) -> None:
    name, text, expected = FILES[case]
    (tmp_path / name).write_text(text, "utf-8")
    hx.convert(tmp_path / name, tmp_path / "out.sdf", keep="inside")
    written = (tmp_path / "out.sdf").read_text("utf-8")
    link = written.partition("</link>")[0]
    assert [" ".join(found) for found in re.findall(r'<(visual|collision|sensor|light) name="([^"]*)"', link)] == expected
    assert refused_names(written) == []
    back = tmp_path / f"back{Path(name).suffix}"
    hx.convert(tmp_path / "out.sdf", back)
    assert hx.load(back).mechanism == hx.load(tmp_path / name).mechanism


def test_a_light_of_the_world_is_not_called_as_the_model() -> None:
    written = hx.dumps(hx.loads(mjcf("", '<light name="m"/>'), "mjcf"), "sdf")
    assert '<light name="m_light"' in written
    assert refused_names(written) == []


def test_an_edit_of_the_written_file_comes_home_under_the_author_s_names(tmp_path: Path) -> None:
    original, there = tmp_path / "m.xml", tmp_path / "m.sdf"
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    original.write_text(mjcf(f'{inertial}<geom name="box" type="box" size="1 2 3"/>'), "utf-8")
    hx.convert(original, there)
    text = there.read_text("utf-8")
    there.write_text(text.replace("<size>2 4 6</size>", "<size>2 4 8</size>"), "utf-8")
    found = hx.update(original, there)
    assert list(map(str, found.edits)) == ["shape 'a/shape#2' geometry.size: [2 4 6] -> [2 4 8]"]
    assert original.read_text("utf-8") == mjcf(f'{inertial}<geom name="box" type="box" size="1 2 4"/>')


def test_a_shape_that_is_added_to_a_robot_of_sdf_gets_free_names() -> None:
    shape = '<visual name="x_collision"><geometry><sphere><radius>1</radius></sphere></geometry></visual>'
    robot = hx.loads(f'<sdf version="1.9"><model name="m"><link name="a">{shape}</link></model></sdf>', "sdf")
    with robot.edit() as e:
        e.add_shape("x", Box((1.0, 1.0, 1.0)), on="a")
    written = hx.dumps(e.robot.mechanism, "sdf")
    assert re.findall(r'<(?:visual|collision) name="([^"]*)"', written) == ["x_collision", "x", "x_collision_2"]


@settings(max_examples=max(10, settings.default.max_examples // 10), deadline=None, suppress_health_check=list(HealthCheck))
@given(mechanism=mechanisms(), names=st.lists(st.sampled_from([None, "x", "visual", "x_collision", "collision_2"]), min_size=1))
@pytest.mark.unread
def test_no_name_of_a_written_file_is_refused(mechanism: Mechanism, names: list[str | None]) -> None:
    edges = {}
    for number, (key, shape, _) in enumerate(mechanism.edges(Shape)):
        edges[key] = replace(mechanism.graph.edges[key], data=replace(shape, name=names[number % len(names)]))
    mechanism = mechanism.replace(edges=edges)
    try:
        written = hx.dumps(mechanism, "sdf")
    except Refusal:
        return
    assert refused_names(written) == []


# ---- libsdformat itself, where it is installed -----------------------------------------------------------------------------------

_needs_library = pytest.mark.skipif(library() is None, reason="libsdformat is not installed")


@_needs_library
@pytest.mark.parametrize("case", FILES)
@pytest.mark.unread("HX022", "HX101")
def test_libsdformat_accepts_what_is_written(case: str, tmp_path: Path) -> None:
    name, text, _ = FILES[case]
    (tmp_path / name).write_text(text, "utf-8")
    hx.convert(tmp_path / name, tmp_path / "out.sdf")
    assert is_accepted(str(tmp_path / "out.sdf"))
