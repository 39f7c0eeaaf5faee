"""How a stage is laid out: one file or several, bodies flat or nested; packages and variants on the way in."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Literal

import pytest
from msgspec.structs import replace
from pxr import Usd, UsdPhysics

import hymeko_x as hx
from hymeko_x import codes, formats, pipeline
from hymeko_x.cli import main
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends import usd
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Body
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Package, Source
from tests.usd.stages import HEADER, Texts, parsed
from tests.usd.test_usd_write import ARM, arm


def packed(format: str, layout: Literal["single", "layered"] | None = None, nested: bool | None = None) -> Package:
    options = Options(layout=layout, nested=nested, keep="inside")
    return pipeline.convert(arm(), formats.by_name(format), options, NoFiles(), Report()).package


def on_disk(package: Package, folder: Path, name: str) -> Usd.Stage:
    for place, data in {name: package.main, **package.files}.items():
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        (folder / place).write_bytes(data)
    return Usd.Stage.Open(str(folder / name))


# ---- out -----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("nested", [False, True])
@pytest.mark.parametrize("format", ["usd", "usdc", "usdz"])
def test_several_files_say_what_one_file_says(format: str, nested: bool, tmp_path: Path) -> None:
    single, layered = packed(format, nested=nested), packed(format, "layered", nested)
    suffix = {"usd": "usda"}.get(format, format)
    seen = parsed(on_disk(single, tmp_path, f"single.{suffix}"))
    assert parsed(on_disk(layered, tmp_path, f"layered.{suffix}")) == seen
    assert len(seen.bodies) == 3
    back = pipeline.read(Source(f"layered.{suffix}", layered.main, Texts(layered.files)), formats.by_name(format), Report())
    assert back == arm()


def test_the_interface_holds_everything_behind_one_payload(tmp_path: Path) -> None:
    package = packed("usd", "layered")
    assert sorted(package.files) == [f"my_arm_payload/{name}.usda" for name in ("contents", "geometry", "materials", "physics")]
    stage = on_disk(package, tmp_path, "arm.usda")
    root = stage.GetDefaultPrim()
    assert (str(root.GetPath()), root.HasPayload()) == ("/my_arm", True)
    stage.Unload("/my_arm")
    assert not stage.GetPrimAtPath("/my_arm/base")
    geometry = package.files["my_arm_payload/geometry.usda"].decode()
    assert "physics:" not in geometry
    assert "inputs:" not in geometry


def test_nested_bodies_are_inside_of_their_parents_and_stand_where_they_stood(tmp_path: Path) -> None:
    flat, nested = (on_disk(packed("usd", nested=wanted), tmp_path, f"{wanted}.usda") for wanted in (False, True))
    assert [str(prim.GetPath()) for prim in nested.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)] == [
        "/my_arm/base",
        "/my_arm/base/_1_upper_arm",
        "/my_arm/base/_1_upper_arm/före",
    ]
    there = {path.rpartition("/")[2]: pose for path, pose in parsed(nested).bodies.items()}
    for path, pose in parsed(flat).bodies.items():
        assert there[path.rpartition("/")[2]] == pytest.approx(pose, abs=1e-6)


def test_what_is_too_long_for_a_text_stands_in_a_crate_beside_it(tmp_path: Path) -> None:
    """A grid of 99 points in use; a tetrahedron stays in the text, and so does everything where there is no place beside it."""
    grid = "".join(f"v {x} {y} {x * y % 3}\n" for x in range(10) for y in range(10))
    grid += "".join(f"f {n} {n + 1} {n + 10}\n" for n in range(1, 90) if n % 10)
    (tmp_path / "grid.obj").write_text(grid)
    (tmp_path / "tetra.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    shape = '<visual><geometry><mesh filename="{}.obj"/></geometry></visual>'
    source = tmp_path / "robot.urdf"
    source.write_text(f'<robot name="r"><link name="a">{shape.format("grid")}{shape.format("tetra")}</link></robot>')
    out = tmp_path / "out.usda"
    assert main(["convert", str(source), str(out), "--keep=inside"]) == 0
    text = out.read_text()
    assert (text.count("point3f[] points"), len(text) < 10_000) == (1, True)
    stage = Usd.Stage.Open(str(out))
    assert sorted(len(prim.GetAttribute("points").Get()) for prim in stage.Traverse() if prim.GetTypeName() == "Mesh") == [4, 99]
    assert hx.load(out).mechanism == hx.load(source).mechanism
    assert hx.verify(source, out).is_same
    whole = tmp_path / "whole.usda"
    whole.write_text(hx.dumps(hx.load(source), "usd", keep="inside"))
    assert hx.load(whole).mechanism == hx.load(source).mechanism


# ---- packages in ----------------------------------------------------------------------------------------------------------------


def package_of(files: dict[str, str | bytes]) -> bytes:
    found = io.BytesIO()
    with zipfile.ZipFile(found, "w") as package:
        for name, data in files.items():
            package.writestr(name, data)
    return found.getvalue()


PART = HEADER.replace('"robot"', '"part"') + 'def Xform "part" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])\n{\n}\n'


LONG = """robot : robot {
  coarse : mesh { vertices [0 0 0 1 0 0 0 1 0 0 0 1] faces [0 1 2 0 1 3 1 2 3 0 2 3] }
  fine : mesh { vertices [%s] faces [%s] }
  a { mass 1 inertia [1 1 1] visual { mesh=coarse name=seen id "seen" } }
  b { mass 1 inertia [1 1 1] visual { mesh=fine name=seen id "seen#2" } }
  @j : joint { + a - b AXIS_X }
}
"""


@pytest.mark.unread("HX061")
def test_prims_keep_their_order_where_only_some_have_long_arrays(tmp_path: Path) -> None:
    points = " ".join(f"{number} {number * number} {number % 7}" for number in range(90))
    faces = " ".join(f"{number} {number + 1} {number + 2}" for number in range(88))
    hx.dump(hx.loads(LONG % (points, faces), "hymeko"), tmp_path / "r.usda")
    stage = Usd.Stage.Open(str(tmp_path / "r.usda"))
    assert (tmp_path / "r_meshes.usdc").exists()
    assert [prim.GetName() for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)] == ["a", "b"]
    source = hx.load(tmp_path / "r.usda").mechanism
    hx.dump(source, tmp_path / "again.usda")
    assert hx.diff(source, hx.load(tmp_path / "again.usda").mechanism) == ()


def test_layers_inside_of_a_package_are_found_there() -> None:
    main = HEADER + 'def Xform "robot"\n{\n    def "a" (\n        prepend references = @./parts/part.usda@\n    )\n    {\n    }\n}\n'
    data = package_of({"main.usda": main, "parts/part.usda": PART, "../outside.usda": PART})
    report = Report()
    mechanism = usd.read(Source("robot.usdz", data), report).mechanism
    assert [str(item) for item in report] == []
    assert [key.name for key, _ in mechanism.vertices(Body)] == ["a"]


@pytest.mark.parametrize("data", [package_of({"a.txt": "no layer"}), package_of({"main.usda": PART})[:-40], b"PK\x03\x04" + bytes(50)])
def test_a_damaged_package_is_refused(data: bytes) -> None:
    with pytest.raises(Refusal) as refusal:
        usd.read(Source("robot.usdz", data), Report())
    assert refusal.value.diagnostic.code == codes.CANNOT_READ


# ---- variants -------------------------------------------------------------------------------------------------------------------

BODY = '{0}def Xform "{1}" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])\n{0}{{\n{0}}}\n'
VARIANTS = (
    HEADER
    + 'def Xform "robot" (\n    variants = {\n        string arm = "short"\n    }\n    prepend variantSets = "arm"\n)\n{\n'
    + '    variantSet "arm" = {\n        "short" {\n'
    + BODY.format(" " * 12, "short_arm")
    + '        }\n        "long" (\n            prepend variantSets = "tip"\n        ) {\n'
    + BODY.format(" " * 12, "long_arm")
    + '            variantSet "tip" = {\n                "hook" {\n'
    + BODY.format(" " * 20, "hook")
    + "                }\n            }\n        }\n    }\n}\n"
)


@pytest.mark.parametrize(
    ("variants", "bodies"),
    [({}, ["short_arm"]), ({"arm": "long"}, ["long_arm"]), ({"arm": "long", "tip": "hook"}, ["hook", "long_arm"])],
)
def test_variants_are_chosen_also_those_that_another_one_brings_forth(variants: dict[str, str], bodies: list[str]) -> None:
    source = replace(Source("robot.usda", VARIANTS.encode()), variants=variants)
    mechanism = usd.read(source, Report()).mechanism
    assert sorted(key.name for key, _ in mechanism.vertices(Body)) == bodies
    assert Id("body", "short_arm") in mechanism.graph.vertices or variants


@pytest.mark.parametrize(
    ("variants", "message"),
    [({"arm": "lng"}, "the variant set 'arm' has no variant 'lng'"), ({"leg": "long"}, "no prim has a variant set 'leg'")],
)
def test_a_variant_that_is_not_there_is_refused(variants: dict[str, str], message: str) -> None:
    with pytest.raises(Refusal) as refusal:
        usd.read(replace(Source("robot.usda", VARIANTS.encode()), variants=variants), Report())
    assert refusal.value.diagnostic.message == message


def test_the_command_line_chooses_variants_and_layout(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in.usda").write_text(VARIANTS)
    out = tmp_path / "out.usda"
    assert main(["convert", str(tmp_path / "in.usda"), str(out), "--variant", "arm=long", "--layout", "layered", "--nested"]) == 0
    assert sorted(path.name for path in (tmp_path / "robot_payload").iterdir()) == [
        f"{name}.usda" for name in ("contents", "geometry", "materials", "physics")
    ]
    assert Usd.Stage.Open(str(out)).GetPrimAtPath("/robot/long_arm")
    (tmp_path / "arm.urdf").write_text(ARM)
    assert main(["info", str(tmp_path / "arm.urdf"), "--variant", "arm=long"]) == 2
    assert "--variant is for formats that have variants" in capsys.readouterr().err


def test_verify_looks_at_the_variant_that_is_meant(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stage, out = tmp_path / "in.usda", tmp_path / "out.usda"
    stage.write_text(VARIANTS)
    chosen = ["--variant", "arm=long", "--variant", "tip=hook"]
    assert main(["convert", str(stage), str(out), "--verify", *chosen]) == 0
    assert main(["verify", str(stage), str(out), *chosen]) == 0
    assert main(["verify", str(stage), str(out)]) == 4
    assert main(["verify", str(stage), str(out), "--variant", "arm=lng"]) == 1
    assert "the variant set 'arm' has no variant 'lng'" in capsys.readouterr().err
