"""Macros and their parameters are called after what they are."""

from __future__ import annotations

import re

import hymeko_x as hx

_MESH = '<{0}><origin xyz="{1} 0 0" rpy="0 0 0"/><geometry><mesh filename="package://arm/meshes/{2}"/></geometry></{0}>'
_LINK = """<link name="{name}"><inertial><mass value="1.{n}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
{shapes}</link>"""
_JOINT = """<joint name="{name}_joint" type="revolute"><origin xyz="0 0 0.{n}" rpy="0 0 0"/><parent link="{parent}"/><child link="{name}"/>
<axis xyz="{axis}"/><limit lower="-1" upper="1" effort="{n}0" velocity="3"/></joint>"""


def _macros(text: str) -> dict[str, list[str]]:
    """The parameters of each macro of the xacro file of a robot."""
    printed = hx.dumps(hx.loads(f'<robot name="r">{text}</robot>'.encode(), "urdf"), "xacro")
    found = re.findall(r'<xacro:macro name="(\w+)" params="([^"]*)"', printed)
    return {name: [word.partition(":=")[0] for word in re.findall(r"\w+(?::='[^']*'|:=\S+)?", params)] for name, params in found}


def _chain(shapes: str) -> str:
    names = ("base", "lower", "upper", "wrist", "hand")
    links = [_LINK.format(name=name, n=n, shapes=shapes.format(name=name, skin=n * n, hull=7 * n % 5)) for n, name in enumerate(names, 1)]
    axes = ("0 0 1", "0 1 0", "1 0 0", "0 0 -1")
    pairs = zip(names[1:], names, axes, strict=False)
    return "".join([*links, *(_JOINT.format(name=name, parent=parent, axis=axis, n=n) for n, (name, parent, axis) in enumerate(pairs, 1))])


def test_an_axis_is_called_axis_and_the_mesh_of_a_collision_after_it() -> None:
    shapes = _MESH.format("visual", "0", "{skin}.dae") + _MESH.format("collision", "0", "{hull}.stl")
    macros = _macros(_chain(shapes))
    assert "axis" in macros["joint"]
    assert macros["link"] == ["name", "mass", "mesh", "collision_mesh"]


def test_a_part_of_a_shape_is_no_macro_by_itself() -> None:
    shapes = _MESH.format("visual", "0.25", "{name}.dae") + _MESH.format("collision", "0.25", "{name}.dae")
    extra = (
        '<link name="foot">'
        + _MESH.format("visual", "0.25", "foot.dae")
        + '<visual name="x"><geometry><box size="1 2 3"/></geometry></visual></link>'
    )
    joint = '<joint name="f" type="fixed"><parent link="base"/><child link="foot"/></joint>'
    assert set(_macros(_chain(shapes) + extra + joint)) == {"link", "joint"}


def test_numbers_of_a_list_of_which_several_differ_are_one_parameter_and_one_alone_is_called_after_its_direction() -> None:
    shapes = _MESH.format("visual", "0", "{skin}.dae")
    assert _macros(_chain(shapes))["joint"] == ["prefix", "z", "parent", "axis", "effort"]
    printed = hx.dumps(hx.loads(f'<robot name="r">{_chain(shapes)}</robot>'.encode(), "urdf"), "xacro")
    assert '<axis xyz="${axis}"/>' in printed
    assert '<origin xyz="0 0 ${z}" rpy="0 0 0"/>' in printed


def test_a_default_is_what_half_of_the_calls_have_and_no_name() -> None:
    pads = ((1, "a", 1), (2, "a", 1), (3, "b", 1), (4, "c", 2), (5, "d", 3))
    links = "".join(
        f'<link name="pad_{n}"><visual name="{name}_skin"><origin xyz="0.0{n} 0.25 0.125" rpy="0 0 0"/>'
        f'<geometry><cylinder radius="{radius}.125" length="0.0{n}125"/></geometry></visual></link>'
        for n, name, radius in pads
    )
    joints = "".join(f'<joint name="j{n}" type="fixed"><parent link="pad_1"/><child link="pad_{n}"/></joint>' for n in range(2, 6))
    printed = hx.dumps(hx.loads(f'<robot name="r">{links}{joints}</robot>'.encode(), "urdf"), "xacro")
    assert "radius:=1.125" in printed
    assert "prefix:=" not in printed
    assert "length:=" not in printed
