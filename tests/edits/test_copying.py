"""Conversion within a format leaves the author's text as it is, and takes along what the text includes."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x import disk, formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.edits.copying import copied
from tests.edits.test_update import ARM
from tests.mjcf.mjmodels import differences
from tests.residue.samples import MJCF

XACRO = """<?xml version="1.0"?>
<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="parts/wheel.xacro"/>
  <link name="base"/>
  <xacro:wheel name="left"  y="${0.5 * 0.4}"/>
</robot>
"""
WHEEL = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="wheel" params="name y">
    <link name="${name}"/>
    <joint name="${name}_axle" type="fixed"><origin xyz="0 ${y} 0"/><parent link="base"/><child link="${name}"/></joint>
  </xacro:macro>
</robot>
"""
HYMEKO = "// as I like it\nr : robot {\n  base { mass 2.50 }   link { }\n  @j : revolute { + base - link  axis=Y }\n}\n"
USD = '#usda 1.0\n(\n    upAxis = "Z"\n)\n\ndef Xform "r" ( # the robot\n    prepend apiSchemas = ["PhysicsRigidBodyAPI"]\n)\n{\n}\n'
TEXTS = {"urdf": ARM, "mjcf": MJCF, "xacro": XACRO, "hymeko": HYMEKO, "usd": USD}
SUFFIXES = {"urdf": ".urdf", "mjcf": ".xml", "usd": ".usda", "hymeko": ".hymeko", "xacro": ".xacro"}


def test_a_binary_stage_becomes_text_where_the_suffix_asks_for_text(tmp_path: Path) -> None:
    hx.convert(written(tmp_path / "arm.urdf", ARM), tmp_path / "arm.usdc")
    stage = written(tmp_path / "arm.usd", (tmp_path / "arm.usdc").read_bytes())
    (tmp_path / "other").mkdir()
    hx.convert(stage, tmp_path / "other" / "same.usd")
    hx.convert(stage, tmp_path / "other" / "text.usda")
    assert (tmp_path / "other" / "same.usd").read_bytes() == stage.read_bytes()
    assert (tmp_path / "other" / "text.usda").read_text().startswith("#usda 1.0\n")
    assert hx.verify(stage, tmp_path / "other" / "text.usda", samples=5).verdict == "same"


def written(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("format", TEXTS)
@pytest.mark.parametrize("folder", ["", "other"])
def test_a_conversion_within_a_format_gives_the_same_bytes(format: str, folder: str, tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "parts/wheel.xacro").write_text(WHEEL)
    text = TEXTS[format].replace("\n", "\r\n")
    source, target = tmp_path / f"a{SUFFIXES[format]}", tmp_path / folder / f"b{SUFFIXES[format]}"
    source.write_bytes(text.encode())
    result = hx.convert(source, target)
    assert (target.read_bytes(), result.losses) == (text.encode(), ())
    assert (tmp_path / folder / "parts/wheel.xacro").exists() is (folder == "" or format == "xacro")


@pytest.mark.parametrize("uri", ["../plate.stl", "file://plate.stl"])
def test_of_a_file_that_moves_only_the_path_changes(uri: str, tmp_path: Path) -> None:
    text = ARM.replace('<box size="0.20 0.2 0.05"/>', f'<mesh filename="{uri}" scale="1.0 1 1"/>')
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    written(tmp_path / "a" / uri.removeprefix("file://"), "solid plate\nendsolid plate\n")
    hx.convert(written(tmp_path / "a/arm.urdf", text), tmp_path / "b/arm.urdf")
    assert (tmp_path / "b/arm.urdf").read_text() == text.replace(uri, "meshes/plate.stl")
    assert sorted(path.relative_to(tmp_path / "b").as_posix() for path in (tmp_path / "b").rglob("*.*")) == ["arm.urdf", "meshes/plate.stl"]


def test_an_option_that_changes_the_robot_gives_a_new_text(tmp_path: Path) -> None:
    source, target = tmp_path / "a.urdf", tmp_path / "b.urdf"
    source.write_text(ARM)
    hx.convert(source, target, base="free")
    assert target.read_text() != ARM


@pytest.mark.robots("urdf", "mjcf", "xacro", "usd", every=12)
@pytest.mark.unread("HX005", "HX040", "HX052")
def test_a_real_robot_keeps_its_bytes(robot: Path) -> None:
    source = disk.open_source(str(robot))
    format = formats.of_input(source.name, source.data)
    mechanism = pipeline.read(source, format, Report())
    beside = copied(source, format, mechanism, pipeline.OutputPlace(str(robot.parent)), Report())
    assert beside is not None
    assert (beside.main, beside.files, beside.copies) == (source.data, {}, {})


def test_what_is_included_from_above_goes_along_below_the_output(tmp_path: Path) -> None:
    for folder in ("home/robots", "home/parts/meshes", "home/meshes", "out"):
        (tmp_path / folder).mkdir(parents=True)
    tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 {}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    (tmp_path / "home/meshes/tip.obj").write_text(tetrahedron.format(1))
    (tmp_path / "home/parts/meshes/tip.obj").write_text(tetrahedron.format(2))
    main = '<mujoco>\n  <include file="../parts/assets.xml"/>\n  <asset><mesh name="tip" file="../meshes/tip.obj"/></asset>\n'
    main += '  <worldbody>\n    <include file="../parts/finger.xml"/>\n  </worldbody>\n</mujoco>\n'
    assets = '<mujocoinclude>\n  <asset>\n    <material name="red" rgba="1.0 0 0 1"/>\n  </asset>\n</mujocoinclude>\n'
    finger = '<mujocoinclude>\n  <body><joint/>  <geom type="mesh" mesh="tip" material="red"/></body>\n</mujocoinclude>\n'
    for name, text in (("robots/a.xml", main), ("parts/assets.xml", assets), ("parts/finger.xml", finger)):
        (tmp_path / "home" / name).write_text(text)
    hx.convert(tmp_path / "home/robots/a.xml", tmp_path / "out/a.xml")
    assert (tmp_path / "out/a.xml").read_text() == main.replace("../", "")
    assert [(tmp_path / "out" / name).read_text() for name in ("parts/assets.xml", "parts/finger.xml")] == [assets, finger]
    before, after = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("home/robots/a.xml", "out/a.xml"))
    assert differences(before, after) == []


@pytest.mark.parametrize("is_known", [False, True])
def test_a_package_that_is_not_found_from_the_output_gives_way_to_paths(is_known: bool, tmp_path: Path) -> None:
    for folder in ("ws/cart_parts/urdf", "ws/cart/urdf", "out"):
        (tmp_path / folder).mkdir(parents=True)
    for package in ("cart", "cart_parts"):
        (tmp_path / "ws" / package / "package.xml").write_text(f"<package><name>{package}</name></package>")
    (tmp_path / "ws/cart_parts/urdf/wheel.xacro").write_text(WHEEL)
    middle = WHEEL.replace(
        '<xacro:macro name="wheel"', '<xacro:include filename="$(find cart_parts)/urdf/wheel.xacro"/>\n  <xacro:macro name="other"'
    )
    (tmp_path / "ws/cart/urdf/middle.xacro").write_text(middle)
    text = XACRO.replace("parts/wheel.xacro", "$(find cart)/urdf/middle.xacro")
    source = written(tmp_path / "ws/cart/urdf/cart.xacro", text)
    hx.convert(source, tmp_path / "out/cart.xacro", search_path=[tmp_path / "ws"] if is_known else [])
    files = {path.relative_to(tmp_path / "out").as_posix(): path.read_text() for path in (tmp_path / "out").rglob("*.xacro")}
    if is_known:
        assert files["cart.xacro"] == text
        return
    assert files == {
        "cart.xacro": text.replace("$(find cart)/urdf/", ""),
        "middle.xacro": middle.replace("$(find cart_parts)", "cart_parts"),
        "cart_parts/urdf/wheel.xacro": WHEEL,
    }
    assert hx.diff(hx.load(source).mechanism, hx.load(tmp_path / "out/cart.xacro").mechanism) == ()


@pytest.mark.parametrize("suffix", ["urdf", "usda"])
@pytest.mark.parametrize("folder", ["", "other"])
@pytest.mark.unread("HX101")
def test_what_is_kept_inside_goes_along_in_the_text_itself(suffix: str, folder: str, tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    (tmp_path / "a.xml").write_text(MJCF)
    first, second, plain = (tmp_path / name for name in (f"b.{suffix}", f"{folder}/c.{suffix}", f"{folder}/d.{suffix}"))
    hx.convert(tmp_path / "a.xml", first, keep="inside")
    hx.convert(first, second, keep="inside")
    assert second.read_bytes() == first.read_bytes()
    hx.convert(first, plain)
    assert "residue" not in plain.read_text()


def test_what_is_kept_inside_goes_along_where_a_macro_has_the_path_that_changes(tmp_path: Path) -> None:
    geom = '<geom type="mesh" mesh="part" density="500"/>'
    leg = '<body name="{0}_leg" pos="0 {1} 0"><joint name="{0}_hip" range="-1 1"/>' + geom + "</body>"
    legs = leg.format("left", 1) + leg.format("right", -1)
    mesh = '<mesh name="part" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>'
    text = f'<mujoco model="r"><asset>{mesh}</asset><worldbody><body name="trunk">{geom}{legs}</body></worldbody>'
    text += '<sensor><jointpos name="at" joint="left_hip"/></sensor></mujoco>'
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    first, second = tmp_path / "a/r.xacro", tmp_path / "b/r.xacro"
    hx.convert(written(tmp_path / "r.xml", text), first, keep="inside")
    assert b"xacro:macro" in first.read_bytes()
    hx.convert(first, second, keep="inside", assets="reference")
    assert list(hx.load(first).sensors) == list(hx.load(second).sensors) == ["at"]
