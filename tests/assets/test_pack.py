"""Packing: which files go where, under which names, in which form; and what is reported when one is missing."""

from __future__ import annotations

import io
from pathlib import Path

import mujoco
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from hymeko_x import formats
from hymeko_x.assets.pack import pack
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.assets.shelf import Shelf, safe_name
from hymeko_x.backends import mjcf
from hymeko_x.diagnostics import Report
from hymeko_x.formats import Assets
from hymeko_x.ir.mechanism import Id, Mechanism, layer_edge, shape_edge
from hymeko_x.ir.parts import Material, Mesh, MeshShape, Role, Shape, Texture
from hymeko_x.ir.values import IDENTITY
from hymeko_x.rewrite.context import Options
from hymeko_x.source import file_stem
from tests.meshes.test_mesh import BOX, STL, dae
from tests.robots import MemoryFiles, body, chain

FLAT = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"
TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"
LINE = b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"


def png(colour: tuple[int, int, int] = (255, 0, 0), kind: str = "PNG") -> bytes:
    out = io.BytesIO()
    Image.new("RGB", (2, 2), colour).save(out, kind)
    return out.getvalue()


def with_meshes(*meshes: Mesh, role: Role = Role.VISUAL, material: Id | None = None) -> Mechanism:
    """One body with one shape per mesh."""
    vertices = {Id("mesh", f"{file_stem(mesh.uri or 'inline')}/{n}"): mesh for n, mesh in enumerate(meshes)}
    edges = {
        Id("shape", f"s{n}"): shape_edge(Shape(MeshShape(), role, f"s{n}"), body("b0"), IDENTITY, key, material)
        for n, key in enumerate(vertices)
    }
    looks = {material: Material(material.name, (0.5, 0.5, 0.5, 1.0))} if material else {}
    return chain(vertices={**vertices, **looks}, edges=edges)


def packed(
    mechanism: Mechanism, files: dict[str, bytes], target: str = "mjcf", mode: Assets | None = None, out_dir: str | None = None
) -> tuple[Mechanism, dict[str, bytes], dict[str, str], list[str]]:
    report = Report()
    format = formats.by_name(target)
    result, new, copies = pack(mechanism, format, MemoryFiles(files), Shelf(mode or format.assets, out_dir), report)
    return result, new, copies, [f"{d.severity.value} {d.code.id} {d.message}" for d in report]


def uris(mechanism: Mechanism) -> list[str | None]:
    return [mesh.uri for _, mesh in mechanism.vertices(Mesh)]


def compiles(mechanism: Mechanism, files: dict[str, bytes]) -> mujoco.MjModel:
    result, new, copies, _ = packed(mechanism, files)
    text = mjcf.write(result, Options(), Report()).main.decode()
    return mujoco.MjModel.from_xml_string(text, assets={**new, **{name: files[path] for name, path in copies.items()}})


# ---- MuJoCo: which files ---------------------------------------------------------------------------------------------------------


def test_a_binary_stl_is_copied_as_it_is_under_its_own_name() -> None:
    result, new, copies, reported = packed(with_meshes(Mesh("package://p/Link 0.STL")), {"package://p/Link 0.STL": STL})
    assert (uris(result), new, reported) == (["meshes/Link_0.stl"], {}, [])
    assert copies == {"meshes/Link_0.stl": "package://p/Link 0.STL"}


def test_equal_content_is_stored_once_and_other_content_gets_another_name() -> None:
    other = trimesh.creation.box((3.0, 3.0, 3.0)).export(file_type="stl")
    files = {"a/part.stl": STL, "b/part.stl": STL, "c/PART.stl": other}
    result, _, copies, _ = packed(with_meshes(*map(Mesh, files)), files)
    assert uris(result) == ["meshes/part.stl", "meshes/part.stl", "meshes/PART_2.stl"]
    assert copies == {"meshes/part.stl": "a/part.stl", "meshes/PART_2.stl": "c/PART.stl"}


def test_text_stl_becomes_binary_stl() -> None:
    files = {"a.stl": BOX.export(file_type="stl_ascii").encode()}
    _, new, copies, reported = packed(with_meshes(Mesh("a.stl")), files)
    assert (list(new), copies) == (["meshes/a.stl"], {})
    assert reported == ["note HX202 mesh 'a/0' is STL as text or with a wrong length; MuJoCo reads only exact binary STL"]
    assert compiles(with_meshes(Mesh("a.stl")), files).mesh_facenum[0] == 12


def test_an_stl_file_with_too_many_triangles_becomes_obj() -> None:
    files = {"a.stl": trimesh.creation.icosphere(subdivisions=7).export(file_type="stl")}
    model = compiles(with_meshes(Mesh("a.stl")), files)
    assert model.mesh_facenum[0] == 327680
    assert list(packed(with_meshes(Mesh("a.stl")), files)[1]) == ["meshes/a.obj"]


@pytest.mark.parametrize("suffix", ["glb", "ply", "off"])
def test_types_that_mujoco_does_not_read_become_obj(suffix: str) -> None:
    data = BOX.export(file_type=suffix)
    files = {f"a.{suffix}": data if isinstance(data, bytes) else data.encode()}
    mechanism = with_meshes(Mesh(f"a.{suffix}"), role=Role.COLLISION)
    assert list(packed(mechanism, files)[1]) == ["meshes/a.obj"]
    assert packed(mechanism, files)[3] == [f"note HX202 mesh 'a/0' is a {suffix.upper()} file, which MuJoCo does not read"]
    assert compiles(mechanism, files).nmesh == 1


def test_a_visual_with_three_materials_becomes_three_shapes_with_their_colours() -> None:
    files = {"a.dae": dae()}
    result, new, _, reported = packed(with_meshes(Mesh("a.dae"), material=Id("material", "grey")), files)
    assert list(new) == ["meshes/a_red.obj", "meshes/a_green.obj", "meshes/a_blue.obj"]
    assert reported == ["note HX202 mesh 'a/0' has 3 appearances; each one becomes a mesh of its own"]
    views = result.shapes[body("b0")]
    assert [view.shape.name for view in views] == ["s0", None, None]
    assert [view.material.name for view in views if view.material] == ["red", "green", "blue"]
    assert [result.vertex(view.material, Material).rgba for view in views if view.material] == [
        (1.0, 0.0, 0.0, 1.0),
        (0.0, 1.0, 0.0, 1.0),
        (0.0, 0.0, 1.0, 1.0),
    ]
    model = compiles(with_meshes(Mesh("a.dae", (2.0, 2.0, 2.0)), material=Id("material", "grey")), files)
    assert (model.ngeom, list(model.mesh_scale[0])) == (3, [2.0, 2.0, 2.0])


def test_materials_of_colours_that_are_alike_are_numbered() -> None:
    files = {"a.dae": dae(), "b.dae": dae().replace(b"<color>1 0 0 1", b"<color>0.9 0 0 1")}
    result, new, _, _ = packed(with_meshes(Mesh("a.dae"), Mesh("b.dae")), files)
    assert [material.name for _, material in result.vertices(Material)] == ["red", "green", "blue", "red_2"]
    assert list(new)[3:] == ["meshes/b_red.obj", "meshes/b_green.obj", "meshes/b_blue.obj"]


def test_the_colours_of_a_file_win_over_the_shapes_own_colour() -> None:
    key = Id("mesh", "m")
    shape = Shape(MeshShape(), Role.VISUAL, rgba=(0.1, 0.2, 0.3, 1.0))
    mechanism = chain(vertices={key: Mesh("a.dae")}, edges={Id("shape", "s"): shape_edge(shape, body("b0"), IDENTITY, key)})
    assert [view.shape.rgba for view in packed(mechanism, {"a.dae": dae()})[0].shapes[body("b0")]] == [None, None, None]
    plain = packed(mechanism, {"a.dae": dae(materials=0)})[0].shapes[body("b0")]
    assert [view.shape.rgba for view in plain] == [(0.1, 0.2, 0.3, 1.0)]


def test_a_collision_with_three_materials_stays_one_shape() -> None:
    result, new, _, _ = packed(with_meshes(Mesh("a.dae"), role=Role.COLLISION), {"a.dae": dae()})
    assert (len(result.shapes[body("b0")]), list(new)) == (1, ["meshes/a.obj"])


def test_a_file_without_looks_leaves_the_shape_its_own_material() -> None:
    grey = Id("material", "grey")
    for name, data in (("a.stl", STL), ("a.dae", dae(materials=0))):
        result, _, _, _ = packed(with_meshes(Mesh(name), material=grey), {name: data})
        assert [view.material for view in result.shapes[body("b0")]] == [grey]


def test_an_obj_with_one_material_is_copied_and_brings_its_colour_along() -> None:
    obj = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl skin\nf 1 2 3\nf 1 3 4\n"
    files = {"dir/a.obj": obj, "dir/a.mtl": b"newmtl skin\nKd 0.25 0.5 0.75\n"}
    result, new, copies, _ = packed(with_meshes(Mesh("dir/a.obj")), files)
    assert (new, copies) == ({}, {"meshes/a.obj": "dir/a.obj"})
    assert dict(result.vertices(Material)) == {Id("material", "skin"): Material("skin", (0.25, 0.5, 0.75, 1.0))}


# ---- MuJoCo: meshes that it would refuse -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("other", ["f 1 2 4\n", "f 1 2 3\n"])
def test_a_look_that_lies_on_a_line_is_left_out(other: str) -> None:
    obj = f"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl blue\n{other}".encode()
    files = {"a.obj": obj, "a.mtl": b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n"}
    result, new, _, reported = packed(with_meshes(Mesh("a.obj")), files)
    is_seen = other == "f 1 2 4\n"
    assert [view.material for view in result.shapes.get(body("b0"), ())] == [Id("material", "blue")] * is_seen
    assert list(new) == ["meshes/a_blue.obj"] * is_seen
    assert reported[1:] == (
        ["note HX202 mesh 'a/0' shows 'red' on a line, where nothing is seen; that is left out"]
        if is_seen
        else ["warning HX203 mesh 'a/0': 'a.obj' cannot be read: all of its parts lie on lines; left out: visual 's0' of body 'b0'"]
    )
    assert compiles(with_meshes(Mesh("a.obj")), files).ngeom == is_seen


@pytest.mark.parametrize("role", list(Role))
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (1e-5, 1e-5, 1e-5)])
@pytest.mark.parametrize("data", [FLAT, TRIANGLE, BOX.export(file_type="obj").encode()])
def test_flat_tiny_and_mirrored_meshes_compile_in_every_role(data: bytes, scale: tuple[float, float, float], role: Role) -> None:
    assert compiles(with_meshes(Mesh("a.obj", scale), role=role), {"a.obj": data}).ngeom == 1


def test_a_flat_visual_is_copied_and_a_flat_collision_gets_a_thickness() -> None:
    assert packed(with_meshes(Mesh("a.obj")), {"a.obj": FLAT})[1:] == ({}, {"meshes/a.obj": "a.obj"}, [])
    _, new, _, reported = packed(with_meshes(Mesh("a.obj"), role=Role.COLLISION), {"a.obj": FLAT})
    assert list(new) == ["meshes/a.obj"]
    assert reported == ["note HX202 mesh 'a/0' is flat, and a hull needs a volume: it gets a thickness of 0.0001 of its size"]


def test_a_flat_mesh_used_for_both_is_shown_as_it_is_and_felt_with_a_thickness() -> None:
    key = Id("mesh", "m")
    shapes = {
        Id("shape", role.value): shape_edge(Shape(MeshShape(), role), body("b0"), IDENTITY, key) for role in (Role.VISUAL, Role.COLLISION)
    }
    mechanism = chain(vertices={key: Mesh("a.obj")}, edges=shapes)
    result, new, copies, _ = packed(mechanism, {"a.obj": FLAT})
    assert [view.mesh for view in result.shapes[body("b0")]] == [Id("mesh", "m_visual"), key]
    assert (list(new), copies) == (["meshes/a.obj"], {"meshes/a_2.obj": "a.obj"})
    assert compiles(mechanism, {"a.obj": FLAT}).ngeom == 2


def test_inline_data_stays_inline_unless_mujoco_would_refuse_it() -> None:
    solid = Mesh(vertices=(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), faces=(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3))
    flat = Mesh(vertices=(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0), faces=(0, 1, 2, 0, 2, 3))
    for mesh, stored in ((solid, []), (flat, ["meshes/inline_0.obj"])):
        mechanism = with_meshes(mesh, role=Role.COLLISION)
        assert list(packed(mechanism, {})[1]) == stored
        assert compiles(mechanism, {}).ngeom == 1


@pytest.mark.parametrize(
    ("mesh", "files", "words"),
    [
        (Mesh("gone.stl"), {}, "HX201 mesh 'gone/0': 'gone.stl' was not found"),
        (
            Mesh("a.stl"),
            {"a.stl": STL[:100]},
            "HX203 mesh 'a/0': 'a.stl' cannot be read: its header promises 12 triangles, and there is room for 0",
        ),
        (Mesh("a.obj"), {"a.obj": LINE}, "HX203 mesh 'a/0': 'a.obj' cannot be read: all of its points lie on a line"),
        (Mesh("a.stl", (0.0, 1.0, 1.0)), {"a.stl": STL}, "HX203 mesh 'a/0': 'a.stl' is scaled to nothing"),
        (Mesh(None), {}, "HX201 mesh 'inline/0': it names no file"),
    ],
)
def test_a_mesh_that_cannot_be_used_leaves_out_its_shapes_with_a_warning(mesh: Mesh, files: dict[str, bytes], words: str) -> None:
    for role in (Role.VISUAL, Role.COLLISION):
        result, new, copies, reported = packed(with_meshes(mesh, role=role), files)
        assert reported == [f"warning {words}; left out: {role.value} 's0' of body 'b0'"]
        assert (dict(result.shapes), uris(result), new, copies) == ({}, [], {}, {})


# ---- MuJoCo: textures ------------------------------------------------------------------------------------------------------------


def textured(uri: str) -> Mechanism:
    skin, image = Id("material", "skin"), Id("texture", "image")
    return chain(vertices={skin: Material("skin"), image: Texture(uri)}, edges={Id("layer", "l"): layer_edge(image, skin)})


def test_png_is_copied_and_other_images_are_converted() -> None:
    _, new, copies, _ = packed(textured("a/skin.png"), {"a/skin.png": png()})
    assert (new, copies) == ({}, {"textures/skin.png": "a/skin.png"})
    _, new, copies, _ = packed(textured("a/skin.jpg"), {"a/skin.jpg": png(kind="JPEG")})
    assert (list(new), copies) == (["textures/skin.png"], {})
    assert compiles(textured("a/skin.jpg"), {"a/skin.jpg": png(kind="JPEG")}).ntex == 1


def test_an_image_that_cannot_be_read_is_left_out() -> None:
    for uri, data, code in (("a.png", None, "HX201"), ("a.png", png()[:40], "HX203"), ("a.tga", b"rubbish", "HX203")):
        files = {} if data is None else {uri: data}
        result, _, _, reported = packed(textured(uri), files)
        assert [line.split()[1] for line in reported] == [code]
        assert not list(result.vertices(Texture))
        assert compiles(textured(uri), files).ntex == 0


# ---- references ------------------------------------------------------------------------------------------------------------------


def test_reference_mode_copies_nothing_and_points_from_the_output_to_the_file() -> None:
    result, new, copies, _ = packed(with_meshes(Mesh("/r/meshes/a.stl")), {"/r/meshes/a.stl": STL}, mode="reference", out_dir="/r/out/x")
    assert (uris(result), new, copies) == (["../../meshes/a.stl"], {}, {})


def test_urdf_keeps_packages_and_copies_relative_files_to_the_same_place() -> None:
    names = ["package://p/a.stl", "model://p/b.stl", "meshes/c.stl", "../d.stl", "/abs/e.stl", "file:///abs/f.stl", "https://x.org/g.stl"]
    files = {name: name.encode() for name in names[2:6]}
    result, new, copies, reported = packed(with_meshes(*map(Mesh, names)), files, "urdf")
    assert uris(result) == [*names[:3], "meshes/d.stl", "meshes/e.stl", "meshes/f.stl", names[6]]
    assert (new, reported) == ({}, [])
    assert copies == {
        "meshes/c.stl": "meshes/c.stl",
        "meshes/d.stl": "../d.stl",
        "meshes/e.stl": "/abs/e.stl",
        "meshes/f.stl": "file:///abs/f.stl",
    }


def test_hymeko_refers_to_relative_files_and_keeps_packages() -> None:
    names = ["package://p/a.stl", "/r/meshes/c.stl"]
    result, _, copies, _ = packed(with_meshes(*map(Mesh, names)), {names[1]: STL}, "hymeko", out_dir="/r/out")
    assert (uris(result), copies) == (["package://p/a.stl", "../meshes/c.stl"], {})


def test_the_author_s_own_way_to_a_file_is_kept_where_it_leads_there_from_the_output_too(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "c.stl").write_bytes(STL)
    robot = with_meshes(*map(Mesh, ("./meshes/c.stl", "meshes/../meshes/c.stl", str(tmp_path / "meshes/c.stl"))))
    beside = pack(robot, formats.HYMEKO, DiskFiles(tmp_path), Shelf("reference", str(tmp_path)), Report())[0]
    assert uris(beside) == ["./meshes/c.stl", "meshes/../meshes/c.stl", "meshes/c.stl"]
    below = pack(robot, formats.HYMEKO, DiskFiles(tmp_path), Shelf("reference", str(tmp_path / "out")), Report())[0]
    assert uris(below) == ["../meshes/c.stl"] * 3


def test_urdf_can_be_made_self_contained() -> None:
    name = "package://p/a.dae"
    assert packed(with_meshes(Mesh(name)), {name: b"x"}, "hymeko", "copy")[2] == {"meshes/a.dae": name}


def test_a_reference_that_leads_nowhere_is_kept_with_a_warning() -> None:
    result, _, _, reported = packed(with_meshes(Mesh("meshes/gone.stl")), {}, "urdf")
    assert uris(result) == ["meshes/gone.stl"]
    assert reported == ["warning HX201 mesh 'gone/0': 'meshes/gone.stl' was not found; the reference is kept"]


def test_two_files_that_want_the_same_place_do_not_overwrite_each_other() -> None:
    files = {"../meshes/a.stl": b"one", "meshes/a.stl": b"two"}
    _, _, copies, _ = packed(with_meshes(*map(Mesh, files)), files, "urdf")
    assert sorted(copies.values()) == sorted(files)


# ---- names -----------------------------------------------------------------------------------------------------------------------


@given(st.text(max_size=200))
def test_a_file_name_never_leads_anywhere(name: str) -> None:
    safe = safe_name(file_stem(name))
    assert safe
    assert not safe.startswith(".")
    assert not set(safe) & set('/\\:*?"<>|\0\n')
    assert len(safe.encode()) <= 255


@pytest.mark.parametrize(
    ("name", "safe"),
    [
        ("link_0", "link_0"),
        ("../../etc/passwd", "_.._etc_passwd"),
        ("a b", "a_b"),
        ("", "file"),
        ("..", "file"),
        ("CON", "_CON"),
        ("$(x)", "_(x)"),
    ],
)
def test_file_names_are_made_harmless(name: str, safe: str) -> None:
    assert safe_name(name) == safe


def test_a_shelf_never_gives_one_place_to_two_files() -> None:
    shelf = Shelf("copy", None)
    assert shelf.copy_as("meshes/a.stl", "one")
    assert not shelf.copy_as("meshes/A.stl", "two")
    assert shelf.place("meshes", "a", ".stl", b"three") == "meshes/a_2.stl"


def _tetrahedron(name: bytes, x: int, first: int) -> bytes:
    points = b"".join(b"v %d %d %d\n" % (x + a, b, c) for a, b, c in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
    faces = b"".join(b"f %d %d %d\n" % (first + a, first + b, first + c) for a, b, c in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)))
    return b"o " + name + b"\n" + points + faces


def test_an_obj_of_several_objects_becomes_one_because_mujoco_keeps_only_the_first() -> None:
    two = _tetrahedron(b"left", 0, 1) + _tetrahedron(b"right", 5, 5)
    robot = with_meshes(Mesh("two.obj"))
    _, _, copies, reported = packed(robot, {"two.obj": two})
    assert copies == {}
    assert [line for line in reported if "has 2 objects, and MuJoCo keeps the first of them" in line]
    assert len(compiles(robot, {"two.obj": two}).mesh_vert) == 8
    one = _tetrahedron(b"left", 0, 1)
    assert packed(with_meshes(Mesh("one.obj")), {"one.obj": one})[2] == {"meshes/one.obj": "one.obj"}
