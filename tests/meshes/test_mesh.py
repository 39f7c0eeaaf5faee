"""Reading mesh files of all types, damaged ones too, and writing STL and OBJ."""

from __future__ import annotations

import io
import json
import struct

import numpy as np
import pytest
import trimesh
from PIL import Image

from hymeko_x.ir.parts import Mesh
from hymeko_x.meshes.measures import extents, thickened, volume_of_sheets
from hymeko_x.meshes.obj import obj_bytes
from hymeko_x.meshes.reader import inline_part, merged, read_parts, read_whole
from hymeko_x.meshes.stl import read_stl, stl_bytes, stl_is_exact
from hymeko_x.meshes.submesh import Submesh, Unreadable

BOX = trimesh.creation.box((1.0, 2.0, 3.0))
STL: bytes = BOX.export(file_type="stl")


def nothing_else(name: str) -> bytes:
    raise FileNotFoundError(name)


def size_of(part: Submesh) -> list[float]:
    return np.ptp(part.points, axis=0).tolist()


# ---- STL -----------------------------------------------------------------------------------------------------------------------


def test_binary_and_text_stl_give_the_same_triangles() -> None:
    text = BOX.export(file_type="stl_ascii").encode()
    assert read_stl(text) == pytest.approx(read_stl(STL))
    assert (stl_is_exact(STL), stl_is_exact(text)) == (True, False)


def test_a_binary_stl_that_begins_with_solid_is_binary() -> None:
    disguised = b"solid facet".ljust(80) + STL[80:]
    assert len(read_stl(disguised)) == 12


def test_bytes_after_the_last_triangle_do_not_count() -> None:
    assert len(read_stl(STL + b"more")) == 12
    assert not stl_is_exact(STL + b"more")


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (STL[:80] + struct.pack("<I", 10**9) + STL[84:], "its header promises 1000000000 triangles, and there is room for 12"),
        (STL[:50], "it has 50 bytes, and an STL file has at least 84"),
        (STL[:80] + struct.pack("<I", 0), "it has no triangles"),
        (STL[:96] + struct.pack("<f", float("nan")) + STL[100:], "a coordinate is not a finite number"),
        (b"solid a\nfacet normal 0 0 1\nvertex 0 0 0\nvertex 1 0 0\n", "the number of its vertices is not a multiple of three"),
        (b"solid a\nfacet normal 0 0 1\nvertex 0 0 zero\n", "a vertex is not three numbers (could not convert string to float: b'zero')"),
    ],
)
def test_a_damaged_stl_is_refused_with_its_reason(data: bytes, reason: str) -> None:
    with pytest.raises(Unreadable) as refusal:
        read_stl(data)
    assert str(refusal.value) == reason


# ---- other types ---------------------------------------------------------------------------------------------------------------

DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
  <library_effects>{effects}</library_effects>
  <library_materials>{materials}</library_materials>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="pa" count="24">0 0 0 1000 0 0 1000 1000 0 0 1000 0
      0 0 500 1000 0 500 1000 1000 500 0 1000 500</float_array>
      <technique_common><accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
      <param name="Z" type="float"/></accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>{triangles}
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s"><node id="n"><matrix>{matrix}</matrix>
    <instance_geometry url="#g"><bind_material><technique_common>{bound}</technique_common></bind_material></instance_geometry>
  </node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>"""
TRIANGLES = ("0 1 2 0 2 3", "4 5 6 4 6 7", "0 1 5 0 5 4")
COLOURS = ("1 0 0 1", "0 1 0 1", "0 0 1 1")
IN_PLACE = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"


def dae(*, matrix: str = IN_PLACE, materials: int = 3) -> bytes:
    """A slab of 1000 x 1000 x 500 mm, open at the sides, whose faces have three colours."""
    numbers = range(materials)
    effect = (
        '<effect id="e{0}"><profile_COMMON><technique sid="t"><phong><diffuse><color>{1}</color></diffuse></phong></technique>'
        "</profile_COMMON></effect>"
    )
    return DAE.format(
        effects="".join(effect.format(n, COLOURS[n]) for n in numbers),
        materials="".join(f'<material id="m{n}"><instance_effect url="#e{n}"/></material>' for n in numbers),
        triangles="".join(
            f'<triangles count="2" material="s{n}"><input semantic="VERTEX" source="#v" offset="0"/><p>{TRIANGLES[n]}</p></triangles>'
            for n in range(3)
        ),
        bound="".join(f'<instance_material symbol="s{n}" target="#m{n}"/>' for n in numbers),
        matrix=matrix,
    ).encode()


def test_a_collada_file_has_one_part_per_material_with_its_colour() -> None:
    parts = read_parts(dae(), ".dae", nothing_else)
    assert [part.appearance and part.appearance.rgba for part in parts] == [
        (1.0, 0.0, 0.0, 1.0),
        (0.0, 1.0, 0.0, 1.0),
        (0.0, 0.0, 1.0, 1.0),
    ]
    assert [len(part.faces) for part in parts] == [2, 2, 2]


def test_the_unit_of_a_collada_file_counts_and_its_up_axis_does_not() -> None:
    assert size_of(merged(read_parts(dae(), ".dae", nothing_else))) == pytest.approx([1.0, 1.0, 0.5])


def test_the_nodes_of_a_collada_file_move_and_mirror_its_geometry() -> None:
    moved = "0 -1 0 2000 1 0 0 0 0 0 1 0 0 0 0 1"
    part = merged(read_parts(dae(matrix=moved), ".dae", nothing_else))
    assert part.points.min(axis=0) == pytest.approx([1.0, 0.0, 0.0])
    plain = read_parts(dae(), ".dae", nothing_else)[0]
    mirrored = read_parts(dae(matrix="-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), ".dae", nothing_else)[0]
    assert normal(mirrored) == pytest.approx(normal(plain))


def normal(part: Submesh) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    a, b, c = part.points[part.faces[0]]
    direction = np.cross(b - a, c - a)
    return np.asarray(direction / np.linalg.norm(direction))


def test_triangles_without_a_material_have_no_look() -> None:
    assert [part.appearance for part in read_parts(dae(materials=0), ".dae", nothing_else)] == [None]


def test_a_collada_file_with_entities_is_refused() -> None:
    bomb = dae().replace(b'<?xml version="1.0"?>', b'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>')
    with pytest.raises(Unreadable, match="it declares XML entities, which are not expanded"):
        read_parts(bomb, ".dae", nothing_else)


OBJ = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl one\nf 1/1 2/2 3/3\nusemtl two\nf 1/1 3/2 4/3\n"


def material_file(name: str) -> bytes:
    assert name == "a.mtl"
    return b"newmtl one\nKd 0.123456 0.5 0.25\nnewmtl two\nKd 0 0 1\n"


def test_an_obj_file_has_one_part_per_material_with_exact_colours() -> None:
    parts = read_parts(OBJ, ".obj", material_file)
    appearances = {part.appearance.name: part.appearance.rgba for part in parts if part.appearance}
    assert appearances == {"one": (0.123456, 0.5, 0.25, 1.0), "two": (0.0, 0.0, 1.0, 1.0)}


def test_an_obj_file_whose_material_file_is_missing_is_one_part_without_a_look() -> None:
    parts = read_parts(OBJ, ".obj", nothing_else)
    assert [(part.appearance, len(part.faces)) for part in parts] == [(None, 2)]


@pytest.mark.parametrize(("name", "kind"), [("skin.png", "PNG"), ("skin.jpg", "JPEG")])
def test_an_image_of_a_material_comes_bit_by_bit_with_its_coordinates(name: str, kind: str) -> None:
    image = io.BytesIO()
    Image.new("RGB", (2, 2), (255, 0, 0)).save(image, kind)
    files = {"a.mtl": f"newmtl one\nmap_Kd {name}\nnewmtl two\nKd 0 0 1\n".encode(), name: image.getvalue()}
    part = next(part for part in read_parts(OBJ, ".obj", files.__getitem__) if part.appearance and part.appearance.image)
    assert part.appearance is not None
    assert part.appearance.image == image.getvalue()
    assert part.appearance.rgba is None
    assert part.uv is not None
    assert len(part.uv) == len(part.points)


@pytest.mark.parametrize("suffix", [".glb", ".ply", ".off", ".obj"])
def test_every_type_gives_the_same_box(suffix: str) -> None:
    data = BOX.export(file_type=suffix[1:])
    part = merged(read_parts(data.encode() if isinstance(data, str) else data, suffix, nothing_else))
    assert size_of(part) == pytest.approx([1.0, 2.0, 3.0])
    assert (len(part.points), len(part.faces)) == (8, 12)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".dae", ".glb", ".gltf", ".ply", ".off"])
@pytest.mark.parametrize(
    "data", [b"", b"\0" * 200, b"solid", b"<COLLADA/>", b"glTF\x02\0\0\0\xff\xff\xff\xff", b"ply\nformat ascii 1.0\n", b"{}"]
)
def test_rubbish_of_any_type_is_refused_in_one_line(data: bytes, suffix: str) -> None:
    with pytest.raises(Unreadable) as refusal:
        read_parts(data, suffix, nothing_else)
    assert str(refusal.value)
    assert "\n" not in str(refusal.value)


def gltf_of_zeros(count: int, views: list[object], suffix: str) -> bytes:
    """A mesh of so many corners at the origin, of which nothing is in the file."""
    accessors = [{"componentType": 5126, "type": "VEC3", "count": 3}, {"componentType": 5125, "type": "SCALAR", "count": count}]
    meshes = [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]
    found = {"scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": meshes, "accessors": accessors}
    found |= {"asset": {"version": "2.0"}, "buffers": [{"byteLength": 12, "uri": "data:;base64,AAAAAAAAAAAAAAAA"}]}
    found |= {"bufferViews": views} if views else {}
    text = json.dumps(found).encode()
    return text if suffix == ".gltf" else struct.pack("<4sIIII", b"glTF", 2, len(text) + 20, len(text), 0x4E4F534A) + text


@pytest.mark.parametrize("suffix", [".gltf", ".glb"])
def test_a_gltf_file_that_asks_for_more_zeros_than_a_mesh_has_corners_is_refused(suffix: str) -> None:
    views = [{"buffer": 0, "byteLength": 12}]
    with pytest.raises(Unreadable, match="it has 900000003 elements without data, at most 60000000 are read"):
        read_parts(gltf_of_zeros(900_000_000, views, suffix), suffix, nothing_else)
    with pytest.raises(Unreadable, match="no triangles"):
        read_parts(gltf_of_zeros(0, views, suffix), suffix, nothing_else)


@pytest.mark.parametrize("suffix", [".gltf", ".glb"])
def test_a_gltf_file_without_any_data_is_refused(suffix: str) -> None:
    with pytest.raises(Unreadable):
        read_parts(gltf_of_zeros(3, [], suffix), suffix, nothing_else)


def test_a_type_that_is_not_read_is_refused() -> None:
    with pytest.raises(Unreadable, match=r"meshes of type '\.step' are not read; known: \.stl, \.obj, \.dae"):
        read_parts(b"ISO-10303-21", ".step", nothing_else)


def test_a_triangle_of_corners_that_do_not_exist_is_refused() -> None:
    with pytest.raises(Unreadable):
        read_parts(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\n", ".obj", nothing_else)


# ---- parts and measures ----------------------------------------------------------------------------------------------------------


def test_reading_twice_gives_the_same_bytes() -> None:
    assert [obj_bytes(p) for p in read_parts(dae(), ".dae", nothing_else)] == [
        obj_bytes(p) for p in read_parts(dae(), ".dae", nothing_else)
    ]


def test_written_stl_and_obj_read_back_as_the_same_surface() -> None:
    part = read_parts(STL, ".stl", nothing_else)[0]
    for data, suffix in ((stl_bytes(part), ".stl"), (obj_bytes(part), ".obj")):
        back = merged(read_parts(data, suffix, nothing_else))
        assert np.array_equal(back.points[back.faces], part.points[part.faces])
    assert stl_is_exact(stl_bytes(part))


def test_a_flat_mesh_has_no_volume_until_it_is_thickened() -> None:
    flat = inline_part(Mesh(vertices=(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0), faces=(0, 1, 2, 0, 2, 3)))
    assert (volume_of_sheets(flat), extents(flat)[0]) == (0.0, 0.0)
    solid = thickened(flat, 1e-3)
    assert extents(solid)[0] == pytest.approx(1e-3 * extents(flat)[2])
    assert volume_of_sheets(solid) > 0.0


def test_the_volume_of_a_box_is_its_own() -> None:
    assert volume_of_sheets(read_parts(STL, ".stl", nothing_else)[0]) == pytest.approx(6.0)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".dae"])
def test_a_whole_file_is_its_parts_put_together(suffix: str) -> None:
    data = {".stl": STL, ".obj": OBJ.encode() if isinstance(OBJ, str) else OBJ, ".dae": dae()}[suffix]
    whole, parts = (read(data, suffix, lambda name: b"") for read in (read_whole, lambda *all: merged(read_parts(*all))))
    assert triangles(whole) == triangles(parts)  # the parts stand by appearance
    assert len(whole.points) == len(parts.points)


def triangles(part: Submesh, digits: int = 5) -> list[list[list[float]]]:
    """The corners of all triangles, each from its least one on, in order."""
    corners = (part.points[part.faces].round(digits) + 0.0).tolist()
    return sorted(min(three[turn:] + three[:turn] for turn in range(3)) for three in corners)


def test_points_that_are_equal_become_one_in_the_order_of_the_file_whatever_the_sign_of_their_zeros() -> None:
    dice = np.random.default_rng(0)
    corners = dice.integers(-2, 3, (500, 3, 3)) * dice.choice([-1.0, 1.0], (500, 3, 3))
    part = read_whole(stl_bytes(inline_part(Mesh(vertices=tuple(corners.ravel()), faces=tuple(range(1500))))), ".stl", nothing_else)
    assert list(map(tuple, part.points.tolist())) == list(dict.fromkeys(map(tuple, (corners.reshape(-1, 3) + 0.0).tolist())))
