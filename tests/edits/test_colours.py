"""A mesh of several colours, which MJCF shows as one mesh for each: an edit of one of them arrives, and so does one of all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import pytest
from lxml import etree

import hymeko_x as hx
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import Id
from hymeko_x.residue.delta import residue_of
from hymeko_x.residue.merge import restore
from tests.edits.test_copying import written

if TYPE_CHECKING:
    from collections.abc import Callable

POINTS = "".join(f"v {x + shift} {y} {z}\n" for shift in (0, 3) for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
FACES = "".join(
    f"usemtl {name}\n"
    + "".join(f"f {a} {b} {c}\n" for a, b, c in ((n, n + 2, n + 1), (n, n + 1, n + 3), (n, n + 3, n + 2), (n + 1, n + 2, n + 3)))
    for n, name in ((1, "red"), (5, "blue"))
)
COLOURS = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n"
ARM = """<robot name="arm">
  <link name="base">
    <visual>
      <geometry><mesh filename="pair.obj"/></geometry>
    </visual>
  </link>
  <link name="hand">
    <visual>
      <geometry><mesh filename="pair.obj"/></geometry>
    </visual>
  </link>
  <joint name="wrist" type="fixed">
    <parent link="base"/>
    <child link="hand"/>
  </joint>
</robot>
"""
PIECE = '<geom class="visual" type="mesh" mesh="pair_{}" material="{}"/>'
RED, BLUE = (PIECE.format(name, name) for name in ("red", "blue"))
UP = 'pos="0 0 1"'


def raised(geom: str) -> str:
    return geom.replace('type="mesh"', f'type="mesh" {UP}')


def written_pair(folder: Path) -> None:
    """A mesh in two colours."""
    (folder / "pair.obj").write_text(f"mtllib pair.mtl\n{POINTS}{FACES}")
    (folder / "pair.mtl").write_text(COLOURS)


def converted(folder: Path, keep: Literal["beside"] | None = None, assets: Literal["copy", "reference"] | None = None) -> tuple[Path, Path]:
    """The arm, and the arm as MJCF."""
    (folder / "there").mkdir()
    original, there = folder / "arm.urdf", folder / "there/arm.xml"
    original.write_text(ARM)
    written_pair(folder)
    hx.convert(original, there, keep=keep, assets=assets)
    text = there.read_text()
    assert (text.count(RED), text.count(BLUE)) == (2, 2)
    return original, there


def visuals(text: str, link: str) -> list[tuple[str, str]]:
    """The place and the mesh of each visual of a link, in order of places."""
    found = etree.fromstring(text.encode()).findall(f"link[@name='{link}']/visual")
    places = [(visual.find("origin"), visual.find("geometry/mesh")) for visual in found]
    return sorted(("" if origin is None else origin.get("xyz").replace("0 0 0", ""), mesh.get("filename")) for origin, mesh in places)


WHOLE = [("", "pair.obj")]
EDITS: list[tuple[str, Callable[[str], str], list[tuple[str, str]]]] = [
    ("first", lambda text: text.replace(RED, raised(RED), 1), [("", "pair_blue.obj"), ("0 0 1", "pair_red.obj")]),
    ("second", lambda text: text.replace(BLUE, raised(BLUE), 1), [("", "pair_red.obj"), ("0 0 1", "pair_blue.obj")]),
    ("removed", lambda text: text.replace(BLUE, "", 1), [("", "pair_red.obj")]),
    ("without the first", lambda text: text.replace(RED, "", 1), [("", "pair_blue.obj")]),
    ("together", lambda text: text.replace(RED, raised(RED), 1).replace(BLUE, raised(BLUE), 1), [("0 0 1", "pair.obj")]),
    ("all removed", lambda text: text.replace(RED, "", 1).replace(BLUE, "", 1), []),
]


@pytest.mark.parametrize(("edit", "expected"), [pytest.param(edit, expected, id=name) for name, edit, expected in EDITS])
@pytest.mark.parametrize("assets", [None, "reference"])
@pytest.mark.unread("HX101", "HX105", "HX202")
def test_an_edit_of_one_colour_of_a_mesh_arrives(
    edit: Callable[[str], str], expected: list[tuple[str, str]], assets: Literal["reference"] | None, tmp_path: Path
) -> None:
    original, there = converted(tmp_path, assets=assets)
    there.write_text(edit(there.read_text()))
    report = hx.update(original, there).report
    assert [row.message for row in report if row.code.id == "HX118"] == []
    assert visuals(original.read_text(), "base") == expected
    assert all((tmp_path / name).is_file() for _, name in visuals(original.read_text(), "hand"))
    again = hx.update(original, there)
    assert (again.edits, [row.message for row in again.report if row.code.id == "HX118"]) == ((), [])


@pytest.mark.parametrize("number", [0, 1, 2, 4])
@pytest.mark.unread("HX101", "HX105", "HX202")
def test_pieces_of_a_mesh_that_is_touched_as_well_are_pieces(number: int, tmp_path: Path) -> None:
    """What is touched stays whole, and is a mesh of its own in MJCF."""
    (tmp_path / "there").mkdir()
    original, there = tmp_path / "arm.urdf", tmp_path / "there/arm.xml"
    collision = '    <collision>\n      <geometry><mesh filename="pair.obj"/></geometry>\n    </collision>\n'
    original.write_text(ARM.replace("    </visual>\n", f"    </visual>\n{collision}"))
    written_pair(tmp_path)
    hx.convert(original, there)
    _, edit, expected = EDITS[number]
    there.write_text(edit(there.read_text()))
    hx.update(original, there)
    assert visuals(original.read_text(), "base") == expected
    assert original.read_text().count(collision) == 2
    assert hx.update(original, there).edits == ()


PAINT = '<material name="paint"><color rgba="0 0 1 1"/></material>'


@pytest.mark.parametrize("number", [1, 4])
@pytest.mark.unread("HX101", "HX105", "HX202")
def test_pieces_in_the_colour_of_a_material_of_the_robot_are_pieces(number: int, tmp_path: Path) -> None:
    """The blue piece has that material, which is not declared twice."""
    (tmp_path / "there").mkdir()
    original, there = tmp_path / "arm.urdf", tmp_path / "there/arm.xml"
    original.write_text(ARM.replace("    </visual>", f"      {PAINT}\n    </visual>"))
    written_pair(tmp_path)
    hx.convert(original, there)
    text, blue = there.read_text(), PIECE.format("blue", "paint")
    assert (text.count(RED), text.count(blue), text.count("<material ")) == (2, 2, 2)
    _, edit, expected = EDITS[number]
    there.write_text(edit(text.replace(blue, BLUE)).replace('material="blue"', 'material="paint"'))
    hx.update(original, there)
    assert visuals(original.read_text(), "base") == expected
    assert hx.update(original, there).edits == ()


@pytest.mark.parametrize(("edit", "expected"), [pytest.param(edit, expected, id=name) for name, edit, expected in EDITS])
@pytest.mark.unread("HX101", "HX105", "HX112", "HX202")
def test_an_edit_of_one_colour_of_a_kept_mesh_comes_home(
    edit: Callable[[str], str], expected: list[tuple[str, str]], tmp_path: Path
) -> None:
    _, there = converted(tmp_path, keep="beside")
    there.write_text(edit(there.read_text()))
    hx.convert(there, tmp_path / "home.urdf")
    text = (tmp_path / "home.urdf").read_text()
    assert [(place, Path(mesh).name) for place, mesh in visuals(text, "base")] == [(place, Path(mesh).name) for place, mesh in expected]
    assert visuals(text, "hand") == WHOLE


@pytest.mark.unread("HX101", "HX105", "HX202")
def test_what_the_image_lacks_shows_the_whole_mesh_where_another_is_taken_apart(tmp_path: Path) -> None:
    """Of the two shapes of the mesh the image has only one, and of that a piece is moved."""
    original, there = converted(tmp_path, assets="reference")
    source = hx.load(original).mechanism
    base, hand = there.read_text().split('<body name="hand">')
    image, edited = (
        hx.load(written(there, f'{text}<body name="hand">{hand.replace(RED, "").replace(BLUE, "")}')).mechanism
        for text in (base, base.replace(BLUE, raised(BLUE)))
    )
    home = restore(edited, residue_of(source, image), Report()).mechanism
    shape = source.graph.edges[Id("shape", "hand/visual")]
    assert home.graph.edges[Id("shape", "hand/visual")] == shape
    (mesh,) = (arc.target for arc in shape.arcs if arc.role == "mesh")
    assert home.graph.vertices[mesh] == source.graph.vertices[mesh]
