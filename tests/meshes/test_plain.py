"""The readers of plain COLLADA and OBJ files: the same triangles as the loader that knows all of these formats, or none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from hymeko_x.meshes.collada import collada_groups
from hymeko_x.meshes.obj import material_entries, obj_groups
from hymeko_x.meshes.reader import merged, read_colours, read_parts, read_whole
from hymeko_x.meshes.submesh import Appearance, MaterialEntry
from tests.meshes.test_mesh import IN_PLACE, dae, nothing_else, triangles
from tests.pace import assert_within

if TYPE_CHECKING:
    from hymeko_x.meshes.submesh import ColouredMesh

POLYGONS = (
    '<polylist count="2" material="s0"><input semantic="VERTEX" source="#v" offset="1"/><input semantic="NORMAL" source="#p" offset="0"/>'
    "<vcount>4 3</vcount><p>0 0 0 1 0 2 0 3 0 4 0 5 0 6</p></polylist>"
)
MOVES = (
    f"<matrix>{IN_PLACE}</matrix>",
    "<translate>1 2 3</translate><scale>2 1 -1</scale>",
    "<rotate>0 0.6 0.8 30</rotate><matrix>0 -1 0 5 1 0 0 0 0 0 1 0 0 0 0 1</matrix>",
)
CUBE = b"v 0 0 0\nv 1 0 0 \nv 1 1 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvt 0 0\n"


def moved(text: str) -> bytes:
    return dae().replace(f"<matrix>{IN_PLACE}</matrix>".encode(), text.encode())


@pytest.mark.parametrize("text", MOVES)
def test_nodes_move_a_plain_collada_file_as_the_general_loader_does(text: str) -> None:
    data = moved(text)
    assert collada_groups(data) is not None
    whole, parts = read_whole(data, ".dae", nothing_else), merged(read_parts(data, ".dae", nothing_else))
    assert triangles(whole) == triangles(parts)
    assert len(whole.faces) == 6
    assert len(whole.points) == len(parts.points)


def test_polygons_of_a_plain_collada_file_are_fans() -> None:
    data = dae().replace(b"</mesh>", POLYGONS.encode() + b"</mesh>")
    tables = collada_groups(data)
    assert tables is not None
    assert tables[-1].faces.tolist() == [[0, 1, 2], [0, 2, 3], [4, 5, 6]]
    whole, parts = read_whole(data, ".dae", nothing_else), merged(read_parts(data, ".dae", nothing_else))
    assert triangles(whole) == triangles(parts)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (f"<matrix>{IN_PLACE}</matrix>", "<rotate>0 0 2 30</rotate>"),
        (f"<matrix>{IN_PLACE}</matrix>", "<lookat>1 0 0 0 0 0 0 0 1</lookat>"),
        (f"<matrix>{IN_PLACE}</matrix>", "<matrix>1 0 0</matrix>"),
        ("<instance_geometry", '<instance_node url="#n"/><instance_geometry'),
        ('url="#g"', 'url="other.dae#g"'),
        ('stride="3"', 'stride="4"'),
        ("0 0 500 1000", "0 0 nan 1000"),
        ("0 0 500 1000", "0 0 x 1000"),
        ("<p>0 1 2", "<p>0 1 9"),
        ("<p>0 1 2", "<p>0 1 -2"),
        ("<triangles", "<tristrips"),
        ("</COLLADA>", ""),
    ],
)
def test_what_is_not_plain_collada_is_left_to_others(old: str, new: str) -> None:
    data = dae().replace(old.encode(), new.encode())
    assert data != dae()
    assert collada_groups(data) is None


def test_what_a_node_shows_besides_geometry_is_passed_over() -> None:
    data = dae().replace(b"<instance_geometry", b'<instance_camera url="#c"/><extra/><!-- c --><node/><instance_geometry')
    tables = collada_groups(data)
    assert tables is not None
    assert [len(table.faces) for table in tables] == [2, 2, 2]


@pytest.mark.parametrize("faces", [b"f 1 2 3 4\nf 1 2 5", b"f 1/1 2/1 3/1 4/1\nf 1/1 2/1 5/1", b"f 1//1 2//1 3//1 4//1\nf 1//1 2//1 5//1 "])
def test_a_plain_obj_file_says_its_corners_in_any_form(faces: bytes) -> None:
    (table,) = obj_groups(CUBE + faces) or ()
    assert table[1].tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4]]
    assert table[0].tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1]]


@pytest.mark.parametrize(
    "faces",
    [b"f -5 -4 -3", b"f 1 2 \\\n 3", b" f 1 2 3", b"f 1 2 9", b"f 1 2 x", b"f 1 2/1 3", b"f 1 2 3\nv 1 2\n", b"f 1 2.5 3"],
)
def test_what_is_not_plain_obj_is_left_to_others(faces: bytes) -> None:
    assert obj_groups(CUBE + faces) is None


LIBRARY = b"newmtl wood\nKd 0.5 0.5 0.5\nmap_Kd wood.png\nnewmtl paint\nKd 1 0 0\n"
MATERIALS = b"""mtllib a.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vt 1 0
f 1 2 3
usemtl wood
f 4/1 3/2 2/1
f 4/1 3/2 2/1 1/2
usemtl nothing
usemtl paint
f 1//1 2//1 4//1
usemtl other
f 2/1 3/1 4/1
"""


def tables_of(data: bytes, *, mapped: bool = False) -> list[tuple[str, MaterialEntry, list[list[float]], list[list[float]] | None]]:
    """Name, entry, and of every triangle the first coordinates of its corners and of their places."""
    tables = obj_groups(data, {"a.mtl": LIBRARY}.get, mapped=mapped)
    assert tables is not None
    return [
        (
            table.material,
            table.entry,
            table.points[table.faces].sum(axis=2).tolist(),
            None if table.uv is None or table.corners is None else table.uv[table.corners][:, :, 0].tolist(),
        )
        for table in tables
    ]


WOOD, PAINT = MaterialEntry((0.5, 0.5, 0.5, 1.0), "wood.png"), MaterialEntry((1.0, 0.0, 0.0, 1.0))


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_materials_of_an_obj_file_are_runs_of_its_lines_each_in_its_own_form(end: bytes) -> None:
    assert tables_of(MATERIALS.replace(b"\n", end)) == [
        ("", MaterialEntry(), [[0, 1, 2]], None),
        ("wood", WOOD, [[1, 2, 1], [1, 2, 1], [1, 1, 0]], [[0, 1, 0], [0, 1, 0], [0, 0, 1]]),
        ("paint", PAINT, [[0, 1, 1]], None),
        ("other", MaterialEntry(), [[1, 2, 1]], None),
    ]


@pytest.mark.parametrize(
    ("text", "alpha"),
    [
        ("", 1.0),
        ("d 0.25", 0.25),
        ("d 0.25 # hides a quarter", 0.25),
        ("Tr 0.9", 0.1),
        ("Tr 0.9\nd 0.25", 0.25),
        ("d 0.25\nTr 0.9", 0.25),
        ("Tr 1.0", 1.0),
        ("d 0", 1.0),
        ("d 1\nTr 1", 1.0),
        ("d -halo 0.5", 1.0),
        ("d", 1.0),
        ("d half\nTr nan", 1.0),
        ("d 1.5\nTr -2", 1.0),
    ],
)
def test_what_hides_a_part_of_what_is_behind_it_says_so_in_either_word(text: str, alpha: float) -> None:
    library = f"newmtl glass\nKd 0.5 0.5 0.5\n{text}\nnewmtl paint\nKd 1 0 0\n".encode()
    glass, paint = MaterialEntry((0.5, 0.5, 0.5, alpha)), MaterialEntry((1.0, 0.0, 0.0, 1.0))
    assert material_entries(library) == {"glass": glass, "paint": paint}
    assert material_entries(library.replace(b"Kd 0.5 0.5 0.5\n", b"")) == {"paint": paint}
    data = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl glass\nf 1 2 3\nusemtl paint\nf 1 2 4\n"
    appearances = {part.appearance for part in read_parts(data, ".obj", {"a.mtl": library}.__getitem__)}
    assert appearances == {Appearance("glass", glass.rgba), Appearance("paint", paint.rgba)}


def test_an_image_without_a_place_that_exists_is_not_shown() -> None:
    for data in (MATERIALS.replace(b"4/1 3/2", b"4/1 3/9"), MATERIALS.replace(b"vt ", b"vp ").replace(b"vn ", b"vp ")):
        assert tables_of(data)[1][1:] == (WOOD._replace(image=""), [[1, 2, 1], [1, 2, 1], [1, 1, 0]], None)


def test_without_a_library_all_of_an_obj_file_is_one_table() -> None:
    faces = MATERIALS.partition(b"usemtl wood\n")[2].partition(b"usemtl nothing")[0]
    data = CUBE + b"mtllib b.mtl\nusemtl wood\n" + faces.replace(b"/2", b"/1") + b"usemtl x\nf 1/1 2/1 3/1\n"
    assert [(name, len(faces)) for name, _, faces, _ in tables_of(data)] == [("", 4)]
    assert tables_of(data, mapped=True)[0][3] == [[0, 0, 0]] * 4


def test_thousands_of_uses_of_a_material_take_linear_time() -> None:
    count = 20_000
    points = b"".join(b"v %d 0 1\n" % number for number in range(3 * count))
    rows = np.arange(3 * count).reshape(count, 3)
    names = (b"paint", b"other")
    uses = b"".join(b"usemtl %s\nf %d %d %d\n" % (names[number % 2], *(rows[number] + 1).tolist()) for number in range(count))

    def work() -> ColouredMesh:
        return read_colours(b"mtllib a.mtl\n" + points + uses, ".obj", {"a.mtl": LIBRARY}.__getitem__)

    assert_within(2.0, work)
    painted = work()
    assert (painted.mesh.points[painted.mesh.faces][:, :, 0] == rows).all()
    assert [(appearance, faces.tolist()) for appearance, faces in painted.appearances] == [
        (Appearance("paint", PAINT.rgba), list(range(0, count, 2)))
    ]


def test_materials_that_take_turns_leave_triangles_and_their_places_in_the_order_of_the_file() -> None:
    points = b"".join(b"v %d 0 1\nvt %d 1\n" % (number, 10 * number) for number in range(9))
    uses = b"""usemtl paint
f 1 2 3 4
f 2 3 4
usemtl wood
f 3/3 4/4 5/5
usemtl paint
f 4//1 5//1 6//1
usemtl wood
f 5/1/1 6/2/1 7/3/1 8/4/1
usemtl paint
f 6 7 8
usemtl wood
f 7/7 8/8 9/9
"""
    painted = read_colours(b"mtllib a.mtl\n" + points + uses, ".obj", {"a.mtl": LIBRARY, "wood.png": b"image"}.__getitem__)
    part = painted.mesh
    assert part.uv is not None
    assert part.corners is not None
    triangles = [(1, 2, 3), (1, 3, 4), (2, 3, 4), (3, 4, 5), (4, 5, 6), (5, 6, 7), (5, 7, 8), (6, 7, 8), (7, 8, 9)]
    assert (part.points[part.faces][:, :, 0] + 1).tolist() == [list(corners) for corners in triangles]
    places = [(0, 0, 0), (0, 0, 0), (0, 0, 0), (20, 30, 40), (0, 0, 0), (0, 10, 20), (0, 20, 30), (0, 0, 0), (60, 70, 80)]
    assert part.uv[part.corners][:, :, 0].tolist() == [list(corners) for corners in places]
    assert [(appearance.name, faces.tolist()) for appearance, faces in painted.appearances] == [
        ("paint", [0, 1, 2, 4, 7]),
        ("wood", [3, 5, 6, 8]),
    ]


def test_corners_from_the_end_of_an_obj_file_count_too() -> None:
    whole = read_whole(CUBE + b"f -5 -4 -3\n", ".obj", nothing_else)
    assert whole.points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0]]


# ---- files that are large --------------------------------------------------------------------------------------------------


def shown_alone(number: int) -> tuple[str, str, str, str]:
    """A triangle with a material of its own: geometry, material, effect and node."""
    points = f'<source id="s{number}"><float_array>0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor stride="3">'
    points += "<param/><param/><param/></accessor></technique_common></source>"
    corners = f'<vertices id="v{number}"><input semantic="POSITION" source="#s{number}"/></vertices>'
    corners += f'<triangles material="m"><input semantic="VERTEX" offset="0" source="#v{number}"/><p>0 1 2</p></triangles>'
    appearance = f'<instance_material symbol="m" target="#m{number}"/>'
    bound = f"<bind_material><technique_common>{appearance}</technique_common></bind_material>"
    colour = "<profile_COMMON><technique><phong><diffuse><color>1 0 0 1</color></diffuse></phong></technique></profile_COMMON>"
    return (
        f'<geometry id="g{number}"><mesh>{points}{corners}</mesh></geometry>',
        f'<material id="m{number}"><instance_effect url="#e{number}"/></material>',
        f'<effect id="e{number}">{colour}</effect>',
        f'<node><instance_geometry url="#g{number}">{bound}</instance_geometry></node>',
    )


def test_thousands_of_geometries_with_their_materials_take_linear_time() -> None:
    geometries, materials, effects, nodes = map("".join, zip(*map(shown_alone, range(3000)), strict=True))
    libraries = f"<library_geometries>{geometries}</library_geometries><library_materials>{materials}</library_materials>"
    libraries += f"<library_effects>{effects}</library_effects>"
    scenes = f'<library_visual_scenes><visual_scene id="v">{nodes}</visual_scene></library_visual_scenes>'
    data = f'<COLLADA>{libraries}{scenes}<scene><instance_visual_scene url="#v"/></scene></COLLADA>'.encode()
    assert_within(5.0, lambda: collada_groups(data))
    tables = collada_groups(data)
    assert tables is not None
    assert [table.entry.rgba for table in tables] == [(1.0, 0.0, 0.0, 1.0)] * 3000


def test_primitives_that_share_points_keep_their_own() -> None:
    alone = '<triangles><input semantic="VERTEX" offset="0" source="#v"/><p>3 1 2</p></triangles>'
    tables = collada_groups(dae().replace(b"</mesh>", (alone * 3).encode() + b"</mesh>"))
    assert tables is not None
    assert [len(table.points) for table in tables[-3:]] == [3, 3, 3]
    whole = tables[0].points
    assert np.array_equal(tables[-1].points[tables[-1].faces], whole[[[3, 1, 2]]])
