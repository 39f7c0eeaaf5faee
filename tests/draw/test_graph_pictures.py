"""Pictures of hypergraphs: every vertex, edge, sign and weight is there once, no labels overlap, and names are text."""

from __future__ import annotations

import io
from collections import Counter
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from PIL import Image

import hymeko_x as hx
from hymeko_x.cli import main
from hymeko_x.draw.graph.diagram import diagram
from hymeko_x.draw.graph.facts import SIGNS, weight
from hymeko_x.draw.graph.incidence import incidence_picture
from hymeko_x.draw.graph.layers import Size, columns, layered
from hymeko_x.draw.graph.letters import shown, width
from hymeko_x.draw.graph.listings import WRITERS
from hymeko_x.draw.graph.raster import png
from hymeko_x.draw.graph.selection import EDGE_KINDS, Wanted
from hymeko_x.draw.graph.svg import SIZE, SMALL
from hymeko_x.draw.graph.tree import tree
from hymeko_x.draw.graph.tree_picture import tree_picture
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, RobotEdge, coupling_edge, joint_edge, shape_edge
from hymeko_x.ir.values import Pose
from hymeko_x.testing import mechanisms
from tests.pace import assert_within

HINGE = parts.Joint((parts.Dof(axis=(0.0, 0.0, 1.0)),))
FLOOR = parts.Shape(parts.Box((1.0, 1.0, 1.0)), parts.Role.BOTH)
WHOLE = Wanted()
SVG = "{http://www.w3.org/2000/svg}"
ROOT = Path(__file__).parents[2]
FILES = sorted((ROOT / "corpus").glob("*/*.hymeko")) + sorted((ROOT / "examples").glob("*.hymeko"))
HOSTILE = ("<script>alert(1)</script>", "a\"b|c]d${x}'&amp;", "left\u202efoot", "line\nbreak", "]]>-->", "日本語の腕", "עברית", "x" * 300)


def chain(count: int, names: tuple[str, ...] = ()) -> Mechanism:
    """A robot of so many links, of which every third joint follows the first."""
    links = [*names, *(f"link{number}" for number in range(len(names), count))]
    joints = {Id("joint", f"to {end}"): (Id("body", start), Id("body", end)) for start, end in pairwise(links)}
    edges: dict[Id, RobotEdge] = {key: joint_edge(HINGE, start, end, Pose((0.0, 0.0, 0.1))) for key, (start, end) in joints.items()}
    leader, *followers = edges
    edges |= {Id("coupling", f"c {key.name}"): coupling_edge(key, ((leader, (0.0, 1.0)),)) for key in followers[1::3]}
    body = parts.Body(parts.Inertial(1.0, tensor=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0)))
    return Mechanism("chain", Hypergraph({Id("body", name): body for name in links}, edges))


def texts(picture: str) -> list[ElementTree.Element]:
    return list(ElementTree.fromstring(picture).iter(f"{SVG}text"))


def groups(picture: str, kind: str) -> list[ElementTree.Element]:
    return [group for group in ElementTree.fromstring(picture).iter(f"{SVG}g") if group.get("class") == kind]


def named(picture: str, kind: str) -> Counter[tuple[str | None, str | None]]:
    return Counter((group.get("data-kind"), group.get("data-name")) for group in groups(picture, kind))


def boxes(picture: str) -> list[tuple[float, float, float, float, str]]:
    """The bounding boxes of all labels: left, top, right, bottom."""
    found = []
    for text in texts(picture):
        size = SMALL if text.get("class") in ("fact", "weight") else SIZE
        words = text.text or ""
        across = width(words, size)
        left = float(text.get("x", 0)) - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.get("text-anchor", "start")] * across
        y = float(text.get("y", 0))
        found.append((left, y - 0.9 * size, left + across, y + 0.3 * size, words))
    return found


def assert_no_labels_overlap(picture: str) -> None:
    """From top to bottom, each label with those that begin before it ends; lengths are rounded to a tenth."""
    waiting: list[tuple[float, float, float, float, str]] = []
    for box in sorted(boxes(picture), key=lambda box: box[1]):
        waiting = [other for other in waiting if other[3] > box[1] + 0.2]
        for other in waiting:
            assert box[0] >= other[2] - 0.2 or other[0] >= box[2] - 0.2, (box, other)
        waiting.append(box)


def both_pictures(robot: Mechanism, wanted: Wanted = WHOLE) -> tuple[str, str]:
    return tree_picture(tree(robot, wanted)), incidence_picture(diagram(robot, wanted))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_vertex_edge_sign_and_weight_is_in_the_incidence_graph_once(path: Path) -> None:
    robot = hx.load(path).mechanism
    picture = incidence_picture(diagram(robot, Wanted(only=EDGE_KINDS)))
    edges = robot.graph.edges
    ends = {arc.target for edge in edges.values() for arc in edge.arcs}
    vertices = Counter((key.kind, shown(key.name)) for key in robot.graph.vertices if key in ends)
    assert Counter({key: count for key, count in named(picture, "vertex").items() if key[0] != "axis"}) == vertices
    assert named(picture, "edge") == Counter((key.kind, shown(key.name)) for key in edges)
    arcs = Counter(
        (shown(key.name), shown(arc.target.name), f"{SIGNS[arc.sign]} {weight(arc)}".rstrip())
        for key, edge in edges.items()
        for arc in edge.arcs
    )
    drawn = Counter(
        (group.get("data-edge"), group.get("data-target"), group.findtext(f"{SVG}text")) for group in groups(picture, "incidence")
    )
    axes = {node.get("data-name") for node in groups(picture, "vertex") if node.get("data-kind") == "axis"}
    assert Counter({arc: count for arc, count in drawn.items() if arc[1] not in axes}) == arcs
    assert_no_labels_overlap(picture)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_body_joint_and_hyperedge_is_in_the_tree_once(path: Path) -> None:
    robot = hx.load(path).mechanism
    picture = tree_picture(tree(robot, Wanted()))
    bodies = Counter(("body", shown(key.name)) for key, _ in robot.vertices(parts.Body))
    drawn = named(picture, "vertex")
    drawn.pop(("world", "world"), None)
    assert drawn == bodies
    kinds = {KINDS[part] for part in (parts.Joint, parts.Coupling, parts.Loop, parts.Tendon)}
    assert named(picture, "edge") == Counter((key.kind, shown(key.name)) for key in robot.graph.edges if key.kind in kinds)
    assert_no_labels_overlap(picture)


@settings(max_examples=40, deadline=None)
@given(mechanisms())
def test_whatever_the_mechanism_labels_do_not_overlap_and_bytes_are_stable(robot: Mechanism) -> None:
    for wanted in (Wanted(), Wanted(only=EDGE_KINDS), Wanted(depth=1, fold=True)):
        pictures = both_pictures(robot, wanted)
        for picture in pictures:
            assert_no_labels_overlap(picture)
        assert pictures == both_pictures(robot, wanted)


def test_hostile_names_are_text_in_every_format() -> None:
    robot = chain(20, HOSTILE)
    for picture in both_pictures(robot):
        words = {text.text for text in texts(picture)}
        assert "<script>alert(1)</script>" in words
        assert r"left\u202efoot" in words
        assert not list(ElementTree.fromstring(picture).iter(f"{SVG}script"))
        assert_no_labels_overlap(picture)
    shape = diagram(robot, Wanted())
    for write in WRITERS.values():
        text = write(shape)
        assert "\u202e" not in text
        assert len(text.splitlines()) == len(shape.nodes) + len(shape.lines) + {"dot": 3, "mermaid": 1, "d2": 1}[write.__name__]
    assert "<script>" not in WRITERS[".mmd"](shape)


def test_repeated_legs_are_drawn_once_with_the_names_of_the_others(tmp_path: Path) -> None:
    legs = "\n".join(
        f"hip{n} {{ mass 1 inertia [1 1 1] }} foot{n} {{ mass 0.5 inertia [1 1 1] }} @h{n} : revolute {{ + trunk - hip{n} axis=X }}"
        f"@k{n} : revolute {{ + hip{n} - foot{n} axis=Y }}"
        for n in range(4)
    )
    (tmp_path / "dog.hymeko").write_text(f"dog : robot {{ trunk {{ mass 9 inertia [1 1 1] }}\n{legs}\n}}")
    assert main(["graph", str(tmp_path / "dog.hymeko"), "-o", str(tmp_path / "dog.svg"), "--fold"]) == 0
    picture = (tmp_path / "dog.svg").read_text("utf-8")
    assert [key[1] for key in named(picture, "vertex")] == ["trunk", "hip0", "foot0"]
    assert "×4, also hip1, hip2, hip3" in picture
    assert main(["graph", str(tmp_path / "dog.hymeko"), "-o", str(tmp_path / "dog.svg"), "--depth", "1"]) == 0
    picture = (tmp_path / "dog.svg").read_text("utf-8")
    assert [key[1] for key in named(picture, "vertex")] == ["trunk", "hip0", "hip1", "hip2", "hip3"]
    assert picture.count("+ 1 body") == 4


def test_only_some_edges_leave_the_bodies_to_which_they_lead() -> None:
    robot = chain(9)
    assert [key[1] for key in named(incidence_picture(diagram(robot, Wanted(only=("coupling",)))), "edge")] == [
        "c to link3", "c to link6", "to link3", "to link1", "to link6",
    ]  # fmt: skip
    only = tree_picture(tree(robot, Wanted(only=("coupling",))))
    assert [key[1] for key in named(only, "vertex")] == [f"link{number}" for number in range(7)]


def test_a_tree_without_bodies_has_the_hyperedges_alone() -> None:
    ground = Mechanism("ground", Hypergraph({WORLD: parts.World()}, {Id("shape", "floor"): shape_edge(FLOOR, WORLD)}))
    picture = tree_picture(tree(ground, Wanted(only=("shape",))))
    assert named(picture, "edge") == {("shape", "floor"): 1}
    assert_no_labels_overlap(picture)


def test_cycles_and_loops_on_one_node_have_a_layout() -> None:
    sizes = [Size(10, 5, 5)] * 4
    arcs = [(0, 1), (1, 2), (2, 0), (0, 3)]
    column = columns(4, arcs)
    assert all(column[start] != column[end] for start, end in arcs)
    forward = [(start, end) if column[start] < column[end] else (end, start) for start, end in arcs]
    assert len(layered(sizes, column, forward, 10).passing) == 4


def test_a_thousand_links_are_drawn_in_less_than_two_seconds() -> None:
    robot = chain(1000)
    for draw in (lambda: tree_picture(tree(robot, Wanted())), lambda: incidence_picture(diagram(robot, Wanted()))):
        assert_within(2.0, draw)


def test_a_wrong_suffix_and_a_tree_for_other_programs_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(ROOT / "corpus/listings/scara_robot.hymeko")
    assert main(["graph", path, "-o", str(tmp_path / "a.jpg")]) == 2
    assert "the suffix of the output is one of .svg, .png, .dot, .mmd, .d2, not '.jpg'" in capsys.readouterr().err
    assert main(["graph", path, "-o", str(tmp_path / "a.dot"), "--view", "tree"]) == 2
    assert main(["graph", str(ROOT / "corpus/listings/simple.hymeko"), "-o", str(tmp_path / "a.svg"), "--view", "tree"]) == 2
    assert "the input has no bodies, and so no tree" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_pixels_show_what_the_svg_does(tmp_path: Path) -> None:
    robot = str(ROOT / "corpus/listings/scara_robot.hymeko")
    for suffix in ("svg", "png"):
        assert main(["graph", robot, "-o", str(tmp_path / f"a.{suffix}"), "--view", "incidence"]) == 0
    root = ElementTree.parse(tmp_path / "a.svg").getroot()
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == pytest.approx((2 * float(root.attrib["width"]), 2 * float(root.attrib["height"])), abs=1)
        colours = {colour for _, colour in picture.convert("RGB").getcolors(1 << 24)}
    assert {(255, 255, 255), (0xE3, 0xF0, 0xFA), (0x00, 0x72, 0xB2), (0x1A, 0x1A, 0x1A)} <= colours, "page, circles, their edge, and text"


def test_a_very_large_picture_has_fewer_pixels() -> None:
    found = png('<svg xmlns="http://www.w3.org/2000/svg" width="2000" height="90000"><rect width="9" height="9"/></svg>')
    with Image.open(io.BytesIO(found)) as picture:
        assert picture.width * picture.height == pytest.approx(40_000_000, rel=0.01)
